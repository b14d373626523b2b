// Web worker that runs toprise. Simulations run in slices, so a superseded one can be abandoned.
import { load } from "./toprise.mjs";

const SLICE = 4000; // records
let toprise;
let newest = 0;

const pause = () => new Promise((resume) => setTimeout(resume));

async function simulate(id, scenario, columns) {
  const start = toprise.ask({ start: scenario });
  if (start.error) return { error: start.error };
  let progress;
  do {
    progress = toprise.ask({ advance: { records: SLICE } });
    await pause();
    if (id !== newest) return null;
  } while (!progress.error && !progress.sentence);
  if (progress.error) return { error: progress.error };
  const values = columns.map((name, index) => [name, toprise.column(index, progress.samples)]);
  return { scenario, ...start, ...progress, columns: Object.fromEntries(values) };
}

function record(question) {
  const answer = toprise.ask(question);
  return answer.error ? answer : { ...answer, bytes: toprise.file(answer.length) };
}

onmessage = async ({ data: { id, module, question, columns } }) => {
  newest = id;
  if (module) toprise = await load(module);
  else if (question.simulate) {
    const run = await simulate(id, question.simulate, columns);
    const buffers = Object.values(run?.columns ?? {}).map((column) => column.buffer);
    postMessage({ id, answer: run }, buffers);
    return;
  }
  const answer = module ? toprise.ask({ tables: {} }) : question.record ? record(question) : toprise.ask(question);
  postMessage({ id, answer });
};
