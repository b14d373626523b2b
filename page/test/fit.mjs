// Fits with the page's WebAssembly in Node: the same numbers and errors as the program.
// usage: node page/test/fit.mjs [FILE [TOPRISE]], by default target/toprise.html and target/debug/toprise
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { gunzipSync } from "node:zlib";
import { quotedWord } from "../fit.mjs";
import { angleError, freeParameters, heldText } from "../free.mjs";
import { keyName } from "../names.mjs";
import { measuredRange } from "../measured.mjs";
import { sentenceText } from "../sentence.mjs";
import { load } from "../toprise.mjs";

const root = resolve(import.meta.dirname, "../..");
const [page = join(root, "target/toprise.html"), program = join(root, "target/debug/toprise")] = process.argv.slice(2).map((path) => resolve(path));
const [, packed] = readFileSync(page, "utf8").match(/id="wasm">([^<]*)</);
const shown = [];
const toprise = await load(await WebAssembly.compile(gunzipSync(Buffer.from(packed, "base64"))), (text) => shown.push(text));

/** The scenario from which a set of measured data is to be fitted. */
function startOf(name) {
  const { truth, start } = JSON.parse(readFileSync(join(root, `tests/data/fit/${name}.json`), "utf8"));
  const known = Object.entries(truth.values).filter(([key]) => key.startsWith("top.") || key === "gravity");
  const set = [...known, ...Object.entries(start)].filter(([key]) => key !== "offset").map(([key, value]) => [key, String(value)]);
  return { preset: "full-coulomb", set: Object.fromEntries(set) };
}

function fit(scenario, file, bytes, { free = "", sigma = "" } = {}) {
  toprise.upload(bytes);
  return toprise.ask({ fit: { scenario, file, free, sigma } });
}

const folder = mkdtempSync(join(tmpdir(), "toprise-fit-"));

const tests = {
  "a fit has the program's numbers, to the last digit"() {
    const file = "offset_camera.csv";
    const bytes = readFileSync(join(root, "tests/data/fit", file));
    writeFileSync(join(folder, file), bytes);
    const scenario = startOf("offset");
    for (const sigma of ["1.5mrad", ""]) {
      const start = performance.now();
      const { error, report, words, arguments: command, set, signals, free } = fit(scenario, file, bytes, { sigma });
      console.log(`  ${((performance.now() - start) / 1000).toFixed(1)} s for ${report?.evaluations} simulations`);
      assert.equal(error, undefined);
      const printed = JSON.parse(execFileSync(program, [...command, "--format", "json"], { cwd: folder, encoding: "utf8" }));
      // The page is of one version, and says so elsewhere.
      const { $schema, toprise_version, ...expected } = printed;
      assert.ok($schema.endsWith(":FitReport") && toprise_version);
      assert.deepEqual({ ...report, written: [] }, expected);
      assert.equal(free, "friction.k,initial");
      assert.equal(Number(set["friction.k"]), report.parameters[0].value);
      const text = spawnSync(program, [...command, "--format", "markdown"], { cwd: folder, encoding: "utf8" }).stdout;
      const [, parameters, measured] = words.sections.map(({ parts }) => parts.find((part) => part.table)?.table);
      const [friction, ...others] = parameters.rows.map((row) => row.map(sentenceText));
      for (const said of [sentenceText(words.verdict), ...friction.slice(1)]) assert.ok(text.includes(said.replaceAll("\u00a0", " ")), said);
      // Angles are also in degrees.
      const tilt = others.find(([name]) => name === "tilt θ [rad]");
      const estimate = report.parameters.find(({ name }) => name === "initial.theta");
      const [, inDegrees] = tilt[1].split("(");
      assert.ok(Math.abs(parseFloat(inDegrees) - (180 / Math.PI) * estimate.value) < (180 / Math.PI) * estimate.sd, tilt[1]);
      assert.ok(measured.rows.every((row) => sentenceText(row[2]).includes("°)")), JSON.stringify(measured.rows));
      assert.equal(sentenceText(words.sections[0].note).includes("can't be tested"), sigma === "");
      // The best fit passes through the measured values.
      for (const { points, windows } of signals) {
        assert.equal(points.length, 961);
        for (const { until, curve } of windows) {
          assert.equal(curve.time.at(-1), until);
          for (const [time, value] of points.filter(([time]) => time <= until)) {
            const nearest = curve.value[Math.round((time / until) * (curve.time.length - 1))];
            assert.ok(Math.abs(nearest - value) < 0.03, `${time} s: ${value} ${nearest}`);
          }
        }
      }
    }
    assert.match(shown.at(-1), /^fitting 8\.00 of 8\.00 s of data: χ² = .*, \d+ simulations$/);
  },
  "errors are the program's, with file, line and column"() {
    const scenario = { preset: "full-coulomb", set: {} };
    for (const [name, text] of [
      ["text", "t,theta\n0,0.5\n0.1,abc\n"],
      ["no signal", "t,x\n0,0.5\n"],
      ["one sample", "t,theta,phi\n0,0.5,0.1\n"],
      ["degrees", "t,theta\n0,28\n0.1,29\n0.2,28\n0.3,27\n"],
      ["no header", "0,0.5\n0.1,0.4\n"],
      ["nothing", ""],
    ]) {
      writeFileSync(join(folder, "a.csv"), text);
      const { error, sentence } = fit(scenario, "a.csv", Buffer.from(text));
      const told = spawnSync(program, ["fit", "full-coulomb", "a.csv", "--free", "friction.k,initial"], { cwd: folder, encoding: "utf8" });
      // What can be done about it, each says in its own terms.
      assert.ok(error && told.stderr.includes(error.split("; ")[0]), `${name}: ${error}\n${told.stderr}`);
      assert.ok(!sentenceText(sentence).includes("--"), `${name}: ${error}`);
    }
    assert.match(fit(scenario, "a.csv", Buffer.from("t,theta\n0,0.5\n1,0.4\n"), { sigma: "1 rpm" }).error, /"rpm" is not a unit of angle/);
    assert.match(fit(scenario, "a.csv", Buffer.from("t,theta\n0,0.5\n1,0.4\n"), { free: "friction.q" }).error, /friction\.q/);
  },
  "a top without friction has none to find, unless only its start is wanted"() {
    const text = Buffer.from("t,theta\n0,0.5\n1,0.4\n");
    assert.match(fit({ preset: "frictionless", set: {} }, "a.csv", text).error, /no friction to find: switch friction on/);
    assert.match(fit({ preset: "frictionless", set: {} }, "a.csv", text, { free: "friction.k" }).error, /has no friction; choose a law/);
    assert.doesNotMatch(fit({ preset: "frictionless", set: {} }, "a.csv", text, { free: "start" }).error ?? "", /friction/);
  },
  "parameters are found in the words of the sliders, and in any case"() {
    const keys = toprise.ask({ form: { preset: "full-coulomb", set: {} } });
    for (const [text, free] of [
      ["", ""],
      ["friction and start", "friction,start"],
      ["Friction, START", "friction,start"],
      ["k", "friction.k"],
      ["Friction k, SPIN", "friction.k,initial.psi_dot"],
      ["friction.k,initial", "friction.k,start"],
      ["k, tilt θ and spin ψ̇", "friction.k,initial.theta,initial.psi_dot"],
      ["Θ, ψ̇, φ", "initial.theta,initial.psi_dot,initial.phi"],
      ["change of tilt", "initial.theta_dot"],
      ["top.mass", "top.mass"],
    ]) {
      assert.deepEqual(freeParameters(text, keys), { free }, text);
    }
    // What the page writes into the field, it reads.
    for (const { path } of keys) assert.deepEqual(freeParameters(keyName(path), keys), { free: path }, path);
    for (const text of ["foo", "friction.q", "k, foo"]) {
      const { error } = freeParameters(text, keys);
      assert.match(error, /is nothing that can be found\. Write friction, start, or some of k, spin, tilt, precession,/, text);
      assert.ok(error.length < 200 && !error.includes("initial."), error);
    }
  },
  "errors of angles are read with their sign, and nonsense is answered in a sentence"() {
    for (const [text, sigma] of [["", ""], ["±", ""], ["0.3", "0.3"], ["0,3 deg", "0.3 deg"], ["± 0.3 deg", "0.3 deg"], ["±5 mrad", "5 mrad"], ["+/- 0.3°", "0.3°"], ["1e-3 rad", "1e-3 rad"]]) {
      assert.deepEqual(angleError(text), { sigma }, text);
    }
    for (const text of ["abc", "-1 deg", "0", "0.3.4", "1-2 deg"]) {
      assert.match(angleError(text).error, /is no error of an angle: write a positive number of degrees, such as 0\.3/, text);
    }
  },
  "a fit names what it held"() {
    const keys = toprise.ask({ form: { preset: "full-coulomb", set: {} } });
    const scenario = { keys, values: { "friction.k": "0.03", "initial.theta": "0.5", "initial.psi_dot": "120", "initial.phi_dot": "0", "initial.theta_dot": "0" } };
    const start = ["initial.theta", "initial.theta_dot", "initial.phi_dot"];
    assert.equal(heldText(["friction.k", ...start], scenario), "Held at spin ψ̇ = 120\u00a0rad/s: the result holds only if this is right.");
    assert.equal(heldText(["friction.k", ...start, "initial.psi_dot"], scenario), "");
    assert.match(heldText(start, scenario), /friction k = 0\.03, spin ψ̇ = 120\u00a0rad\/s: the result holds only if these are right/);
  },
  "arguments are those of the page"() {
    for (const [argument, expected] of [
      [{ name: "signal", values: ["theta=Winkel (°)"] }, "theta (°)"],
      [{ name: "signal", values: ["/top/state.theta=tilt:SIGMA"] }, "“angles are right to ± SIGMA”"],
      [{ name: "signal", values: ["/top/state.theta:1mrad"] }, "a table with the columns t and theta"],
      [{ name: "signal", values: [] }, "the line that names the columns"],
      [{ name: "time", values: ["t (ms)"] }, "t (ms)"],
      [{ name: "decimal", values: [","] }, "semicolons or tabs between the cells"],
      [{ name: "until", values: ["4.995"] }, "a file that ends at 4.995\u00a0s"],
      [{ name: "set", values: [] }, "the sliders"],
    ]) {
      assert.equal(sentenceText([{ argument }]), expected);
    }
  },
  "angles are also in degrees, with the digits that they have in radians"() {
    for (const [piece, expected] of [
      [{ number: { text: "0.5", value: 0.5, unit: "rad", has_unit: true } }, "0.5\u00a0rad (28.6°)"],
      [{ number: { text: "0.611132", value: 0.611132, unit: "rad", has_unit: false } }, "0.611132 (35.0153°)"],
      [
        { estimate: { text: "0.611049", error_text: "0.000042", value: 0.611049, error: 4.2e-5, unit: "rad", has_unit: false } },
        "0.611049\u00a0±\u00a00.000042 (35.0105°\u00a0±\u00a00.0024°)",
      ],
      [{ number: { text: "231.0", value: 231, unit: "rad/s", has_unit: true } }, "231.0\u00a0rad/s"],
    ]) {
      assert.equal(sentenceText([piece]), expected);
    }
  },
  "words of the command are quoted for a shell"() {
    for (const word of ["a.csv", "theta=tilt (deg):1deg", "it's.csv", "friction.k,initial"]) {
      assert.equal(execFileSync("sh", ["-c", `printf %s ${quotedWord(word)}`], { encoding: "utf8" }), word);
    }
  },
  "outliers don't stretch the axis of a picture"() {
    const values = Array.from({ length: 200 }, (_, index) => (index === 77 ? 1e6 : Math.sin(index)));
    const [low, high] = measuredRange([-1, 1], values);
    assert.ok(low < -1 && low > -1.5 && high > 1 && high < 1.5, `${low} ${high}`);
  },
};

let failed = 0;
for (const [name, test] of Object.entries(tests)) {
  try {
    test();
    console.log(`ok: ${name}`);
  } catch (error) {
    failed += 1;
    console.log(`FAILED: ${name}: ${error.stack}`);
  }
}
rmSync(folder, { recursive: true });
process.exit(failed ? 1 : 0);
