// Prints the SHA-256 of presets' recordings as toprise writes them in WebAssembly, in JSON and protobuf, and their content digest.
// usage: node digests.mjs FILE.wasm RUN…, each a preset and, as in a link, its changes: paper&friction.k=0.02
import { createHash } from "node:crypto";
import { readFile } from "node:fs/promises";
import { load } from "../toprise.mjs";

const [path, ...runs] = process.argv.slice(2);
const toprise = await load(await WebAssembly.compile(await readFile(path)));
for (const run of runs) {
  const [preset, ...changes] = run.split("&");
  const set = Object.fromEntries(changes.map((change) => change.split("=")));
  const digests = ["json", "protobuf"].map((encoding) => {
    const { length, digest, error } = toprise.ask({ record: { scenario: { preset, set }, encoding } });
    if (error) throw new Error(error);
    return { file: createHash("sha256").update(toprise.file(length)).digest("hex"), content: digest };
  });
  console.log(digests[0].file, digests[1].file, digests[0].content);
}
