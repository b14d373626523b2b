// The program in the page: WebAssembly in two web workers.

/** A web worker that answers requests to toprise. A newer simulation supersedes an older one. */
export class Engine {
  constructor(module, progress = () => {}) {
    const script = document.getElementById("worker").textContent;
    this.worker = new Worker(URL.createObjectURL(new Blob([script], { type: "text/javascript" })));
    this.waiting = new Map();
    this.id = 0;
    this.worker.onmessage = ({ data }) => {
      if (data.progress) progress(data.progress);
      this.waiting.get(data.id)?.(data.response);
      this.waiting.delete(data.id);
    };
    this.tables = this.send({ module });
  }

  /** Sends a message; resolves with the response, or with null if a newer simulation superseded it. */
  send(message) {
    const id = ++this.id;
    return new Promise((resolve) => {
      this.waiting.set(id, resolve);
      this.worker.postMessage({ id, ...message });
    });
  }

  request(request) {
    return this.send({ request });
  }
}

/** The WebAssembly in this file. */
export async function compiled() {
  const packed = Uint8Array.from(atob(document.getElementById("wasm").textContent.trim()), (letter) => letter.charCodeAt(0));
  const bytes = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(bytes).arrayBuffer());
}
