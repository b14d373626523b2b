// Checks that a page, by default target/toprise.html, has today's program: the content digests of all presets, as its WebAssembly computes them, are those of
// tests/suite/golden.rs. usage: node page/test/golden.mjs [FILE]
import { readFile } from "node:fs/promises";
import { gunzipSync } from "node:zlib";
import { load } from "../toprise.mjs";

const read = (path) => readFile(new URL(path, import.meta.url), "utf8");
const page = process.argv[2] ? await readFile(process.argv[2], "utf8") : await read("../../target/toprise.html");
const [, packed] = page.match(/id="wasm">([^<]*)</);
const toprise = await load(await WebAssembly.compile(gunzipSync(Buffer.from(packed, "base64"))));
const golden = [...(await read("../../tests/suite/golden.rs")).matchAll(/\("([\w-]+)", \d+, \d+, "([0-9a-f]{64})"\)/g)];
const presets = toprise.ask({ tables: {} }).presets.map(({ name }) => name);
const missing = presets.filter((preset) => !golden.some(([, name]) => name === preset));
const stale = golden.filter(([, preset, expected]) => {
  const { digest, error } = toprise.ask({ record: { scenario: { preset, set: {} }, encoding: "protobuf" } });
  if (digest !== expected) console.log(`${preset}: ${error ?? digest}, not ${expected}`);
  return digest !== expected;
});
if (stale.length > 0 || missing.length > 0) {
  console.log("the page is stale: page/build makes it anew");
  process.exit(1);
}
console.log(`the page has the golden digests of ${golden.length} presets`);
