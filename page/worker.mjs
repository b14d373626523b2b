// Web worker that runs toprise. Simulations run in slices, so a superseded one can be abandoned.
import { load, simulated } from "./toprise.mjs";

let toprise;
let newest = 0;

const pause = () => new Promise((resume) => setTimeout(resume));

async function simulate(id, { scenario, columns }) {
  const run = await simulated(toprise, scenario, columns, async () => {
    await pause();
    return id === newest;
  });
  postMessage({ id, response: run }, Object.values(run?.columns ?? {}).map((column) => column.buffer));
}

function record(request) {
  const response = toprise.ask(request);
  return response.error ? response : { ...response, bytes: toprise.file(response.length) };
}

onmessage = async ({ data: { id, module, simulate: run, request } }) => {
  newest = id;
  if (module) {
    toprise = await load(module);
    postMessage({ id, response: toprise.ask({ tables: {} }) });
  } else if (run) await simulate(id, run);
  else postMessage({ id, response: request.record ? record(request) : toprise.ask(request) });
};
