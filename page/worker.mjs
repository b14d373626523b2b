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

function fit(request, file) {
  try {
    toprise.upload(file);
    return toprise.ask(request);
  } catch (error) {
    // WebAssembly has no other way to say so.
    return { error: `The file is too large for the memory of this page, or the fit failed (${error.message}).` };
  }
}

const PROGRESS_PERIOD = 100; // ms
let reported = 0;

/** Passes a text on, unless another one has just been. */
function report(progress) {
  if (performance.now() - reported < PROGRESS_PERIOD) return;
  reported = performance.now();
  postMessage({ progress });
}

onmessage = async ({ data: { id, module, simulate: run, request, file } }) => {
  newest = id;
  if (module) {
    toprise = await load(module, report);
    postMessage({ id, response: toprise.ask({ tables: {} }) });
  } else if (run) await simulate(id, run);
  else if (file) {
    postMessage({ id, response: fit(request, file) });
  } else postMessage({ id, response: request.record ? record(request) : toprise.ask(request) });
};
