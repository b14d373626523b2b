// Wrapper of the toprise WebAssembly module: JSON requests, data columns, files.

/** Starts toprise from a compiled module. `progress` is called with a text while a fit is under way. */
export async function load(module, progress = () => {}) {
  const decoded = (address, length) => new TextDecoder().decode(view(Uint8Array, address, length));
  const imports = { page: { show_progress: (address, length) => progress(decoded(address, length)) } };
  const toprise = (await WebAssembly.instantiate(module, imports)).exports;
  const view = (Type, address, length) => new Type(toprise.memory.buffer, address, length);
  return {
    ask(request) {
      const text = new TextEncoder().encode(JSON.stringify(request));
      view(Uint8Array, toprise.input(text.length), text.length).set(text);
      const length = toprise.ask();
      return JSON.parse(decoded(toprise.output(), length));
    },
    /** Makes bytes the content of the file that the next request reads. */
    upload: (bytes) => view(Uint8Array, toprise.file_input(bytes.length), bytes.length).set(bytes),
    column: (index, length) => view(Float64Array, toprise.column(index), length).slice(),
    file: (length) => view(Uint8Array, toprise.file(), length).slice(),
  };
}

/**
 * Adds the mechanical energy with the zero of the energy areas: the centre of mass at the height of the table. (The
 * program's own zero is at the peg's centre.)
 */
function withMechanical(columns) {
  const { kinetic, height_energy: height } = columns;
  return { ...columns, mechanical: kinetic.map((energy, index) => energy + height[index]) };
}

/**
 * Simulates a scenario in slices, and calls `goOn` between them; null if it answers false.
 * Returns what `start` says of the scenario, the end of the run and its columns by name, or `{ error }`.
 */
export async function simulated(toprise, scenario, columns, goOn = () => true) {
  const SLICE = 4000; // records
  const start = toprise.ask({ start: scenario });
  if (start.error) return start;
  let progress;
  do {
    progress = toprise.ask({ advance: { records: SLICE } });
    if (!(await goOn())) return null;
  } while (!progress.error && !progress.outcome);
  if (progress.error) return { error: progress.error };
  const values = columns.map((name, index) => [name, toprise.column(index, progress.samples)]);
  return { scenario, ...start, ...progress, columns: withMechanical(Object.fromEntries(values)) };
}
