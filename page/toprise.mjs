// Wrapper of the toprise WebAssembly module: JSON requests, data columns, files.

/** Starts toprise from a compiled module. */
export async function load(module) {
  const toprise = (await WebAssembly.instantiate(module, {})).exports;
  const view = (Type, address, length) => new Type(toprise.memory.buffer, address, length);
  return {
    ask(question) {
      const text = new TextEncoder().encode(JSON.stringify(question));
      view(Uint8Array, toprise.input(text.length), text.length).set(text);
      const length = toprise.ask();
      return JSON.parse(new TextDecoder().decode(view(Uint8Array, toprise.output(), length)));
    },
    column: (index, length) => view(Float64Array, toprise.column(index), length).slice(),
    file: (length) => view(Uint8Array, toprise.file(), length).slice(),
  };
}
