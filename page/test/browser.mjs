// Uses the page as a person would, in Chromium. usage: node page/test/browser.mjs PAGE TOPRISE DIRECTORY
// TOPRISE is the program whose bytes a saved recording must have; screenshots go into DIRECTORY.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { chromium } from "playwright-core";

const [page, toprise, directory] = process.argv.slice(2).map((path) => resolve(path));
const url = `file://${page}`;
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--js-flags=--expose-gc"] });
const context = await browser.newContext({ viewport: { width: 1500, height: 950 }, acceptDownloads: true, offline: true });
const faults = [];

async function open(hash = "") {
  const tab = await context.newPage();
  tab.on("pageerror", (error) => faults.push(error.message));
  tab.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  await tab.goto(`${url}${hash}`);
  await tab.waitForSelector("body.ready");
  return tab;
}
const summary = (tab) => tab.textContent("#summary");
const becomes = (tab, text) => tab.waitForFunction((text) => document.getElementById("summary").textContent.includes(text), text);
const picture = (tab, id) => tab.evaluate((id) => document.getElementById(id).toDataURL(), id);
const box = (tab, path) => tab.locator(`[data-path="${path}"] input[type=text]`);
const shot = (tab, name) => tab.screenshot({ path: join(directory, `${name}.png`) });

const tests = {
  async "a slider changes the run, its curves and the top"(tab) {
    assert.match(await summary(tab), /^paper: risen at t = 24\.719386 s$/);
    const before = [await picture(tab, "curves"), await picture(tab, "top")];
    await tab.locator('[data-path="friction.k"] input[type=range]').fill("600");
    await becomes(tab, "paper, friction.k = 0.0631");
    await tab.waitForTimeout(100);
    assert.notEqual(await picture(tab, "curves"), before[0]);
    assert.equal(await tab.textContent("#command"), "toprise run paper --set friction.k=0.0631");
    await shot(tab, "slider");
  },
  async "a run is pinned and compared"(tab) {
    await tab.click("#pin");
    await tab.waitForFunction(() => document.getElementById("comparison").textContent.includes("This run is pinned as A."));
    await box(tab, "friction.k").fill("0.045");
    await becomes(tab, "paper, friction.k = 0.045");
    await tab.waitForSelector("#comparison td");
    const rows = await tab.locator("#comparison td").allTextContents();
    assert.deepEqual(rows.slice(0, 3), ["24.7194", "16.4733", "−8.25 s ± 54.1 ms"]);
    await shot(tab, "pair");
  },
  async "a saved recording has the program's bytes"(tab) {
    await box(tab, "stop.duration").evaluate((box) => (box.closest("details").open = true));
    await box(tab, "stop.duration").fill("2");
    await becomes(tab, "stop.duration = 2");
    for (const encoding of ["json", "protobuf"]) {
      await tab.selectOption("#encoding", encoding);
      const [download] = await Promise.all([tab.waitForEvent("download"), tab.click("#save")]);
      const saved = readFileSync(await download.path());
      const file = join(directory, `${encoding}.mcap`);
      const words = ["run", "paper", "--set", "stop.duration=2", "--encoding", encoding, "-o", file, "--force", "-q"];
      execFileSync(toprise, words);
      assert.ok(saved.equals(readFileSync(file)), encoding);
    }
    assert.match(await tab.textContent("#digest"), /[0-9a-f]{64}/);
  },
  async "all presets have their golden digests"(tab) {
    const golden = readFileSync("tests/suite/golden.rs", "utf8").matchAll(/\("([\w-]+)", \d+, \d+, "([0-9a-f]{64})"\)/g);
    await tab.selectOption("#encoding", "protobuf");
    for (const [, preset, digest] of golden) {
      await tab.selectOption("#preset", preset);
      await becomes(tab, `${preset}:`);
      await Promise.all([tab.waitForEvent("download"), tab.click("#save")]);
      assert.ok((await tab.textContent("#digest")).endsWith(digest), preset);
    }
  },
  async "a link opens the same view"(tab) {
    await box(tab, "friction.k").fill("0.021");
    await becomes(tab, "friction.k = 0.021");
    await tab.click("#pin");
    await tab.selectOption("#preset", "full-coulomb");
    await becomes(tab, "full-coulomb:");
    const hash = new URL(tab.url()).hash;
    assert.equal(hash, "#full-coulomb&vs=paper&friction.k=0.021");
    const other = await open(`${hash}&at=3.2`);
    assert.equal(await summary(other), await summary(tab));
    assert.equal(await other.textContent("#clock"), "3.200 s");
    assert.equal(await other.textContent("#pin"), "Unpin A");
    await other.close();
  },
  async "a bad value is refused in the program's words, and the next good one is run"(tab) {
    await box(tab, "friction.k").fill("-1");
    await tab.waitForFunction(() => document.getElementById("error").textContent !== "");
    assert.equal(await tab.textContent("#error"), "friction.k = -1: must be a number from 0 to 100");
    for (const id of ["pin", "save", "copy-command", "copy-link"]) assert.ok(await tab.isDisabled(`#${id}`), id);
    await box(tab, "friction.k").fill("0,03");
    await tab.waitForFunction(() => document.getElementById("error").textContent.endsWith("with a decimal point, e.g. 0.03"));
    await box(tab, "friction.k").fill("0.03");
    await tab.waitForFunction(() => document.getElementById("error").textContent === "");
    assert.ok(await tab.isEnabled("#save"));
  },
  async "a link that is wrong says so"(tab) {
    for (const [hash, error] of [
      ["#papr", 'unknown preset "papr" (did you mean paper'],
      ["#paper&friction.kk=1", "unknown key friction.kk"],
      ["#paper&%", "unknown key %"],
      ["#paper&vs=papr", null],
    ]) {
      const other = await open(hash);
      const told = await other.textContent("#error");
      if (error) assert.ok(told.startsWith(error), told);
      else assert.match(await summary(other), /^paper:/);
      await other.close();
    }
    assert.match(await summary(tab), /^paper:/);
  },
  async "keys that don't apply are not there"(tab) {
    assert.equal(await box(tab, "friction.viscous_speed").count(), 0);
    await tab.locator('[data-path="friction.law"] select').selectOption("viscous");
    await becomes(tab, "friction.law = viscous");
    assert.equal(await box(tab, "friction.viscous_speed").inputValue(), "0.5");
    await tab.locator('[data-path="friction.law"] select').selectOption("none");
    await becomes(tab, "keys changed");
    assert.equal(await box(tab, "friction.k").count(), 0);
  },
  async "a peg is let go"(tab) {
    await tab.locator('[data-path="support.kind"] select').evaluate((select) => (select.closest("details").open = true));
    await tab.locator('[data-path="support.kind"] select').selectOption("free");
    await becomes(tab, "keys changed");
    assert.equal(await tab.textContent("#error"), "");
    assert.match(await tab.textContent("#also"), /^This also sets .*formulation = body.*\.$/);
    await shot(tab, "free");
  },
  async "a run without end is ended, and says so"(tab) {
    await tab.selectOption("#preset", "frictionless");
    await becomes(tab, "frictionless:");
    await box(tab, "stop.duration").evaluate((box) => (box.closest("details").open = true));
    await box(tab, "stop.duration").fill("1000000");
    await tab.waitForFunction(() => document.getElementById("error").textContent.includes("too long"), null, { timeout: 60_000 });
    await box(tab, "stop.duration").fill("1");
    await becomes(tab, "stop.duration = 1");
  },
  async "it plays, and the keyboard moves through it"(tab) {
    await tab.click("#play");
    await tab.waitForFunction(() => parseFloat(document.getElementById("clock").textContent) > 0.1);
    await tab.click("#play");
    await tab.locator("#stage").click({ position: { x: 5, y: 5 } });
    await tab.keyboard.press("Home");
    await tab.waitForFunction(() => document.getElementById("clock").textContent === "0.000 s");
    await tab.keyboard.press("ArrowRight");
    await tab.waitForFunction(() => document.getElementById("clock").textContent === "0.010 s");
    await tab.focus("#events");
    await tab.keyboard.press("ArrowDown");
    await tab.waitForFunction(() => document.getElementById("clock").textContent === "24.270 s");
  },
  async "two tabs don't disturb each other"(tab) {
    const other = await open("#tippe-top");
    await box(tab, "friction.k").fill("0.05");
    await becomes(tab, "friction.k = 0.05");
    assert.match(await summary(other), /^tippe-top:/);
    await shot(other, "tippe-top");
    await other.close();
  },
  async "it fits a phone"(tab) {
    await tab.setViewportSize({ width: 390, height: 844 });
    const [inner, outer] = await tab.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
    assert.ok(inner <= outer, `${inner} > ${outer}`);
    await shot(tab, "phone");
  },
  async "memory does not grow with the changes"(tab) {
    const grown = await tab.evaluate(async () => {
      const slider = document.querySelector('[data-path="friction.k"] input[type=range]');
      const sizes = [];
      for (let change = 0; change < 300; change++) {
        slider.value = 300 + (change % 200);
        slider.dispatchEvent(new Event("input"));
        await new Promise((resume) => setTimeout(resume, 60));
        if (change % 100 === 99) {
          gc();
          sizes.push(performance.memory.usedJSHeapSize);
        }
      }
      return sizes.at(-1) / sizes[0];
    });
    assert.ok(grown < 1.2, `${grown} times`);
  },
  async "a move of a slider shows at once"(tab) {
    const times = await tab.evaluate(async () => {
      const slider = document.querySelector('[data-path="friction.k"] input[type=range]');
      const shown = document.getElementById("summary");
      const times = [];
      for (let place = 500; place < 520; place++) {
        const start = performance.now();
        const changed = new Promise((resolve) => new MutationObserver(resolve).observe(shown, { childList: true }));
        slider.value = place;
        slider.dispatchEvent(new Event("input"));
        await changed;
        await new Promise(requestAnimationFrame);
        times.push(performance.now() - start);
      }
      return times.sort((a, b) => a - b);
    });
    // On a busy machine without a graphics card; a laptop takes a tenth.
    assert.ok(times[10] < 1000, `${times[10]} ms`);
    console.log(`  median ${times[10].toFixed(0)} ms, longest ${times.at(-1).toFixed(0)} ms`);
  },
};

let failed = 0;
for (const [name, test] of Object.entries(tests)) {
  const tab = await open();
  try {
    await test(tab);
    assert.deepEqual(faults, []);
    console.log(`ok: ${name}`);
  } catch (error) {
    failed += 1;
    console.log(`FAILED: ${name}: ${error.message}`);
    faults.length = 0;
  }
  await tab.close();
}
await browser.close();
process.exit(failed ? 1 : 0);
