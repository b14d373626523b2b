// Uses the page as a person would, in Chromium. usage: node page/test/browser.mjs PAGE TOPRISE DIRECTORY
// TOPRISE is the program whose bytes a saved recording must have; screenshots go into DIRECTORY. The environment variable
// TEST selects the tests whose names contain it.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { chromium } from "playwright-core";

const [page, toprise, directory] = process.argv.slice(2).map((path) => resolve(path));
const url = `file://${page}`;
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--js-flags=--expose-gc"] });
const context = await browser.newContext({ viewport: { width: 1366, height: 768 }, acceptDownloads: true, offline: true });
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
const becomes = (tab, text) => tab.waitForFunction((text) => document.getElementById("summary").textContent.replaceAll("\u00a0", " ").includes(text), text);
const picture = (tab, id) => tab.evaluate((id) => document.getElementById(id).toDataURL(), id);
const box = (tab, path) => tab.locator(`[data-path="${path}"] input[type=text]`);
const titleOf = (tab, preset) => tab.textContent(`#preset option[value="${preset}"]`);
const shot = (tab, name) => tab.screenshot({ path: join(directory, `${name}.png`) });
const clock = (tab) => tab.textContent("#clock").then(parseFloat);
const clockBecomes = (tab, text) => tab.waitForFunction((text) => document.getElementById("clock").textContent === text, text);
const errorBecomes = (tab, start) => tab.waitForFunction((start) => document.getElementById("error").textContent.startsWith(start), start);

/** Stops playback. */
const pause = async (tab) => (await tab.textContent("#play")) === "Pause" && (await tab.click("#play"));

/** Opens all sections of all keys. */
const openAll = (tab) => tab.evaluate(() => document.querySelectorAll("#form details").forEach((section) => (section.open = true)));

/** Two fingers that touch an element and move apart by a factor and sideways, through Chromium's input. */
async function pinch(tab, id, factor, sideways = 0) {
  const { x, y, width, height } = await tab.locator(`#${id}`).boundingBox();
  const session = await tab.context().newCDPSession(tab);
  const fingers = (half, shift) => [-1, 1].map((side) => ({ x: x + width / 2 + shift + side * half, y: y + height / 2, id: side + 1 }));
  await session.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: fingers(40, 0) });
  for (let part = 1; part <= 5; part++) {
    const half = 40 * (1 + ((factor - 1) * part) / 5);
    await session.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: fingers(half, (sideways * part) / 5) });
  }
  await session.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  await tab.waitForTimeout(200);
}

/** Drops a file on the page: a text, or bytes. */
async function drop(tab, name, content) {
  const dropped = ([name, content]) => {
    const data = new DataTransfer();
    data.items.add(new File([Uint8Array.from(atob(content), (letter) => letter.charCodeAt(0))], name));
    return data;
  };
  const dataTransfer = await tab.evaluateHandle(dropped, [name, Buffer.from(content).toString("base64")]);
  await tab.dispatchEvent("body", "dragover", { dataTransfer });
  assert.ok(await tab.evaluate(() => document.body.classList.contains("dropping")));
  await tab.dispatchEvent("body", "drop", { dataTransfer });
  assert.ok(!(await tab.evaluate(() => document.body.classList.contains("dropping"))));
}

const tests = {
  async "the first screen shows a spinning top and what to do, without scrolling"(tab) {
    for (const [width, height] of [[1366, 768], [1920, 1080]]) {
      await tab.setViewportSize({ width, height });
      for (const id of ["presets", "knobs", "pin", "top", "arrows", "player", "curves", "energy", "energy-numbers", "to-lesson"]) {
        const { x, y, width: wide, height: high } = await tab.locator(`#${id}`).boundingBox();
        assert.ok(x >= 0 && y >= 0 && x + wide <= width && y + high <= height, `${id} at ${width} × ${height}`);
      }
      await shot(tab, `first-${width}`);
    }
    assert.equal(await tab.textContent("#play"), "Pause");
    const before = await clock(tab);
    await tab.waitForFunction((before) => parseFloat(document.getElementById("clock").textContent) > before + 0.1, before);
  },
  async "a slider changes the run, its curves and the top"(tab) {
    assert.match(await summary(tab), /^The paper's rise: upright after 24\.72\u00a0s$/);
    await pause(tab);
    const before = [await picture(tab, "curves"), await picture(tab, "top")];
    await tab.fill("#knob-k", "200");
    await becomes(tab, "The paper's rise, friction k = 0.12");
    await tab.waitForTimeout(100);
    assert.notEqual(await picture(tab, "curves"), before[0]);
    assert.notEqual(await picture(tab, "top"), before[1]);
    assert.equal(await tab.textContent("#command"), "toprise run paper --set friction.k=0.12");
  },
  async "spin and tilt are shown in turns and degrees"(tab) {
    assert.equal(await tab.textContent('[data-knob="initial.psi_dot"] output'), "27.1 rev/s 170 rad/s");
    assert.equal(await tab.textContent('[data-knob="initial.theta"] output'), "28.6° 0.5 rad");
    assert.match(await tab.textContent('[data-knob="initial.psi_dot"] .ends'), /ω·n = ψ̇ \+ φ̇ cos θ = 27\.3 rev\/s/);
    await tab.fill("#knob-theta", "125");
    await becomes(tab, "tilt θ = 0.755 rad");
    assert.equal(await tab.textContent('[data-knob="initial.theta"] output'), "43.3° 0.755 rad");
  },
  async "friction is switched off, and on as it was"(tab) {
    await tab.fill("#knob-k", "150");
    await becomes(tab, "friction k = 0.0475");
    await tab.uncheck("#friction");
    await becomes(tab, "The paper's rise, without friction: ");
    assert.ok(await tab.isDisabled("#knob-k"));
    await tab.fill("#knob-theta", "125");
    await becomes(tab, "The paper's rise, without friction, tilt θ = 0.755 rad: ");
    await tab.click("#pin");
    await tab.check("#friction");
    await becomes(tab, "B: The paper's rise, friction k = 0.0475, tilt θ = 0.755 rad: upright");
    await tab.click("#pin");
    await tab.click('#presets [value="frictionless"]');
    await becomes(tab, "No friction:");
    await tab.check("#friction");
    await becomes(tab, "No friction, friction law = coulomb");
  },
  async "presets have buttons"(tab) {
    for (const preset of ["tippe-top", "frictionless", "drop", "paper"]) {
      await tab.click(`#presets [value="${preset}"]`);
      await becomes(tab, `${await titleOf(tab, preset)}:`);
      assert.equal(await tab.locator("#presets [aria-pressed=true]").getAttribute("value"), preset);
      await tab.waitForTimeout(1000);
      await shot(tab, preset);
    }
  },
  async "a run is kept as A and compared"(tab) {
    await openAll(tab);
    await tab.click("#pin");
    await tab.waitForFunction(() => document.getElementById("comparison").textContent.includes("This run is kept as A."));
    assert.match(await tab.textContent("#pin-note"), /^A \(grey\) is The paper's rise\./);
    await box(tab, "friction.k").fill("0.045");
    await becomes(tab, "The paper's rise, friction k = 0.045");
    await tab.waitForSelector("#comparison td");
    const rows = await tab.locator("#comparison td").allTextContents();
    assert.deepEqual(rows.slice(0, 3), ["24.7194", "16.4733", "−8.25"]);
    await shot(tab, "pair");
    // The sentence is about the runs that are shown.
    await tab.click("#pin");
    assert.ok(!(await tab.textContent("#summary")).includes("A: "));
    await tab.click("#pin");
    await becomes(tab, "A: The paper's rise, friction k = 0.045: ");
  },
  async "a comparison of earlier runs is dimmed from the moment another run is shown"(tab) {
    await tab.click("#pin");
    await tab.waitForFunction(() => document.getElementById("comparison").textContent.includes("This run is kept as A."));
    for (const preset of ["tippe-top", "drop", "paper"]) {
      /** What the comparison says when the run's name changes, and whether it is dimmed. */
      const seen = tab.evaluate(
        (start) =>
          new Promise((resolve) => {
            const [named, compared] = ["summary", "compared"].map((id) => document.getElementById(id));
            const look = () => named.textContent.includes(start) && resolve([compared.getAttribute("aria-busy"), compared.textContent]);
            new MutationObserver(() => requestAnimationFrame(look)).observe(named, { childList: true });
          }),
        `B: ${await titleOf(tab, preset)}:`,
      );
      await tab.click(`#presets [value="${preset}"]`);
      const [isBusy, text] = await seen;
      const isA = preset === "paper";
      assert.equal(isBusy, String(!isA), preset);
      assert.equal(text.includes("This run is kept as A."), isA, `${preset}: ${text}`);
      await tab.waitForSelector('#compared[aria-busy="false"]');
      assert.equal((await tab.locator("#comparison table").count()) > 0, !isA);
    }
  },
  async "arrows keep their scale when friction changes, and are chosen by checkboxes"(tab) {
    const scale = await tab.textContent("#scale-force");
    assert.equal(scale, "(1 cm = 20 mN)");
    await tab.fill("#knob-k", "165");
    await becomes(tab, "friction k = 0.06");
    assert.equal(await tab.textContent("#scale-force"), scale);
    await tab.check("#show-momentum");
    await tab.waitForFunction(() => document.getElementById("scale-momentum").textContent === "(1 cm = 2 mN m s)");
    await tab.check("#show-torque");
    await pause(tab);
    await tab.waitForTimeout(200);
    const withArrows = await picture(tab, "top");
    await tab.uncheck("#show-momentum");
    await tab.waitForTimeout(200);
    assert.notEqual(await picture(tab, "top"), withArrows);
  },
  async "the view is turned, brought closer and reset"(tab) {
    await pause(tab);
    // While it plays, names stay where they were if they fit.
    await tab.click("#reset-view");
    await tab.waitForTimeout(200);
    const before = await picture(tab, "top");
    const { x, y } = await tab.locator("#top").boundingBox();
    await tab.mouse.move(x + 200, y + 200);
    await tab.mouse.down();
    await tab.mouse.move(x + 260, y + 220, { steps: 3 });
    await tab.mouse.up();
    await tab.waitForTimeout(200);
    assert.notEqual(await picture(tab, "top"), before);
    await pinch(tab, "top", 2);
    await tab.click("#reset-view");
    await tab.waitForTimeout(200);
    assert.equal(await picture(tab, "top"), before);
  },
  async "two fingers zoom and move the curves"(tab) {
    await pause(tab);
    await tab.waitForTimeout(200);
    const whole = await picture(tab, "curves");
    await pinch(tab, "curves", 3);
    const zoomed = await picture(tab, "curves");
    assert.notEqual(zoomed, whole);
    await pinch(tab, "curves", 1, 60);
    assert.notEqual(await picture(tab, "curves"), zoomed);
    const time = await clock(tab);
    await tab.focus("#curves");
    await tab.keyboard.press("-");
    await tab.waitForTimeout(200);
    assert.equal(await clock(tab), time);
  },
  async "recordings are verified with the program's words, explained and compared"(tab) {
    const folder = mkdtempSync(join(directory, "verify-"));
    const program = (...words) => execFileSync(toprise, words, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] });
    for (const k of ["0.03", "0.04"]) program("run", "paper", "--set", "stop.duration=2", "--set", `friction.k=${k}`, "-o", `${k}.mcap`, "--quiet");
    const bytes = (name) => readFileSync(join(folder, name));
    const cut = bytes("0.04.mcap").subarray(0, 300_000);
    writeFileSync(join(folder, "cut.mcap"), cut);
    /** Drops a file, and what the page says of it. */
    async function dropped(name, content) {
      await drop(tab, name, content);
      const isTold = (name) => document.querySelector("#verify-report h3")?.textContent.startsWith(`${name}:`) || document.querySelector("#verify-status.wrong");
      await tab.waitForFunction(isTold, name);
      return (await tab.textContent("#verify-report h3")).replaceAll("\u00a0", " ");
    }
    for (const name of ["0.03.mcap", "0.04.mcap", "cut.mcap"]) {
      let said;
      try {
        said = program("verify", name);
      } catch ({ stdout }) {
        said = stdout; // it ends with another code if anything is missing
      }
      assert.equal(await dropped(name, bytes(name)), said.split("\n")[0]);
    }
    assert.ok((await tab.textContent("#verify-report")).includes("lost"));
    await dropped("0.04.mcap", bytes("0.04.mcap"));
    assert.ok((await tab.textContent("#verify-before")).includes("cut.mcap"));
    const [, digest] = program("info", "0.04.mcap").match(/sha-256 (\w+)/);
    assert.ok((await tab.textContent("#verify-digest")).includes(digest));
    assert.ok((await tab.textContent("#verify-scenario")).includes("k = 0.04"));
    assert.ok((await tab.textContent("#verify-story")).length > 50);
    await shot(tab, "verified");
    await tab.click("#verify-show");
    await becomes(tab, "friction k = 0.04");
    await drop(tab, "other.mcap", Buffer.concat([bytes("0.03.mcap").subarray(0, 8), Buffer.alloc(8)]));
    await tab.waitForSelector("#verify-status.wrong, #verify-report h3");
    await tab.click("#verify-close");
    assert.ok(await tab.locator("#verify").isHidden());
  },
  async "a saved recording has the program's bytes and name"(tab) {
    await openAll(tab);
    await box(tab, "stop.duration").fill("2");
    await becomes(tab, "after 2.00");
    for (const encoding of ["json", "protobuf"]) {
      await tab.selectOption("#encoding", encoding);
      const [download] = await Promise.all([tab.waitForEvent("download"), tab.click("#save")]);
      const saved = readFileSync(await download.path());
      const folder = mkdtempSync(join(directory, "saved-"));
      execFileSync(toprise, ["run", "paper", "--set", "stop.duration=2", "--encoding", encoding, "-q"], { cwd: folder });
      const [file] = readdirSync(join(folder, "recordings")).filter((name) => name.endsWith(".mcap"));
      assert.equal(download.suggestedFilename(), file);
      assert.ok(saved.equals(readFileSync(join(folder, "recordings", file))), encoding);
      rmSync(folder, { recursive: true });
    }
    assert.match(await tab.textContent("#digest"), /[0-9a-f]{64}/);
  },
  async "all presets have their golden digests"(tab) {
    const golden = readFileSync("tests/suite/golden.rs", "utf8").matchAll(/\("([\w-]+)", \d+, \d+, "([0-9a-f]{64})"\)/g);
    await openAll(tab);
    await tab.selectOption("#encoding", "protobuf");
    for (const [, preset, digest] of golden) {
      await tab.selectOption("#preset", preset);
      await becomes(tab, `${await titleOf(tab, preset)}:`);
      const [download] = await Promise.all([tab.waitForEvent("download"), tab.click("#save")]);
      assert.equal(download.suggestedFilename(), `${preset}.mcap`);
      assert.ok((await tab.textContent("#digest")).endsWith(digest), preset);
    }
  },
  async "a link opens the same view"(tab) {
    await openAll(tab);
    await box(tab, "friction.k").fill("0.021");
    await becomes(tab, "friction k = 0.021");
    await tab.click("#pin");
    await tab.selectOption("#preset", "full-coulomb");
    await becomes(tab, "Full friction:");
    const hash = new URL(tab.url()).hash;
    assert.equal(hash, "#full-coulomb&vs=paper&friction.k=0.021");
    const other = await open(`${hash}&at=3.2`);
    assert.equal(await summary(other), await summary(tab));
    assert.equal(await other.textContent("#clock"), "3.200 s");
    assert.equal(await other.textContent("#pin"), "Remove A");
    await other.close();
  },
  async "each step of the lesson sets the page up, asks, and has an answer to open"(tab) {
    const runs = ["No friction:", "Full friction:", "Full friction:", "Full friction, friction k = 0.06:", "Tippe top:"];
    await tab.click("#to-lesson");
    for (const [index, run] of runs.entries()) {
      if (index > 0) await tab.click("#lesson .onward");
      await tab.waitForSelector(`#lesson a[aria-current=step]:has-text("${index + 1}")`);
      // The guess comes first: paused at the start, without the outcome.
      await becomes(tab, "Guess first.");
      assert.equal(await tab.textContent("#play"), "Play");
      await clockBecomes(tab, "0.000 s");
      assert.ok(!(await tab.isVisible("#story")) && !(await tab.isVisible("#events")));
      assert.ok(!(await tab.isVisible("#lesson details p")));
      await tab.waitForTimeout(200);
      const hidden = await picture(tab, "curves");
      await tab.click("#lesson summary");
      await becomes(tab, run);
      await tab.waitForTimeout(200);
      assert.notEqual(await picture(tab, "curves"), hidden);
      assert.equal(await tab.isVisible("#compared"), index === 0 || index === 3);
      assert.ok(await tab.isVisible("#lesson details p"));
      const momentum = (await tab.textContent("#momentum-parts")).slice(0, 13);
      assert.equal(momentum, index === 1 ? "L: horizontal" : "");
      const { y, height } = await tab.locator("#player").boundingBox();
      assert.ok(y + height <= 768, `the player is below the fold in step ${index + 1}`);
      await shot(tab, `lesson-${index + 1}`);
    }
    assert.equal(await tab.isChecked("#show-torque"), false);
    await tab.click("#lesson details a:has-text('Back')");
    await tab.waitForSelector('#lesson a[aria-current=step]:has-text("4")');
    // At once, while A of the fourth step is being simulated.
    await tab.goto(`${url}#lesson=5`);
    await tab.click("#lesson summary");
    await becomes(tab, "Tippe top:");
    assert.equal(await tab.textContent("#lesson .onward"), "Try your own");
    await tab.click("#lesson .onward");
    assert.ok(!(await tab.isVisible("#lesson")));
    assert.equal(new URL(tab.url()).hash, "#tippe-top");
    const second = await open("#lesson=2");
    await becomes(second, "Guess first.");
    await second.click("#play");
    await becomes(second, "Watch: does your guess come true?");
    await second.click("#play");
    await second.locator("#time").evaluate((slider) => {
      slider.value = slider.max;
      slider.dispatchEvent(new Event("input"));
    });
    await becomes(second, "Full friction: upright");
    for (const name of ["torque", "momentum"]) assert.ok(await second.isChecked(`#show-${name}`));
    await second.fill("#knob-k", "150");
    await becomes(second, "friction k = 0.0475");
    assert.equal(new URL(second.url()).hash, "#full-coulomb&friction.k=0.0475&lesson=2");
    await second.reload();
    await becomes(second, "friction k = 0.0475");
    assert.ok(await second.isVisible("#lesson"));
    await second.close();
  },
  async "the worksheet fills one page, and has lines for a name and for answers"(tab) {
    await tab.emulateMedia({ media: "print" });
    for (const [format, height] of [["A4", 297], ["Letter", 279.4]]) {
      const margin = 12; // mm
      await tab.setViewportSize({ width: 703, height: 800 });
      const used = await tab.evaluate(() => document.getElementById("teacher").getBoundingClientRect().height);
      const part = used / (((height - 2 * margin) / 25.4) * 96);
      assert.ok(part > 0.8 && part < 1, `${format}: ${part}`);
      const side = `${margin}mm`;
      const printed = await tab.pdf({ format, margin: { top: side, bottom: side, left: side, right: side } });
      assert.match(printed.toString("latin1"), /\/Count 1\b/, format);
    }
    assert.equal(await tab.textContent("#address"), `the file ${page.split("/").at(-1)}`);
    assert.deepEqual(await tab.locator(".fields span").allTextContents(), ["Name", "Class", "Date"]);
    const answers = await tab.locator("#guesses li").all();
    for (const answer of answers) {
      const { height } = await answer.boundingBox();
      assert.ok(height > 100, `${height} px for a question and its answer`);
    }
    await shot(tab, "worksheet");
  },
  async "until the program has started, the title and a top are shown"(tab) {
    assert.ok(!(await tab.isVisible("#still")));
    const other = await context.newPage();
    await other.addInitScript(() => (WebAssembly.compile = () => new Promise(() => {})));
    await other.goto(url);
    assert.ok(await other.isVisible("#still"));
    assert.ok(await other.isVisible("h1"));
    await shot(other, "still");
    await other.close();
  },
  async "texts of the picture don't lie on each other, in any preset"() {
    const watched = await browser.newContext({ offline: true, reducedMotion: "reduce" });
    const other = await watched.newPage();
    await other.addInitScript(() => {
      const { fillText } = CanvasRenderingContext2D.prototype;
      window.drawn = new Map();
      CanvasRenderingContext2D.prototype.fillText = function (text, x, y, ...rest) {
        if (this.canvas.id === "top") {
          const { e, a } = this.getTransform();
          const { width, actualBoundingBoxAscent: up, actualBoundingBoxDescent: down } = this.measureText(text);
          const left = x + e / a;
          // The last place of a text is that of the picture that is shown.
          window.drawn.set(`${text} ${Math.round(e / a)}`, [left, y - up, left + width, y + down]);
        }
        return fillText.call(this, text, x, y, ...rest);
      };
    });
    await other.goto(url);
    await other.waitForSelector("body.ready");
    for (const name of ["torque", "momentum"]) await other.check(`#show-${name}`);
    await openAll(other);
    const overlaps = [];
    for (const [width, height] of [[1366, 768], [1920, 1080], [390, 844]]) {
      await other.setViewportSize({ width, height });
      for (const preset of await other.locator("#preset option").evaluateAll((options) => options.map(({ value }) => value))) {
        await other.selectOption("#preset", preset);
        await becomes(other, `${await titleOf(other, preset)}:`);
        for (const part of [0, 0.2, 0.4, 0.7, 1]) {
          const found = await other.evaluate(async (part) => {
            const frame = () => new Promise(requestAnimationFrame);
            const slider = document.getElementById("time");
            await frame();
            slider.value = part * slider.max;
            window.drawn.clear();
            slider.dispatchEvent(new Event("input"));
            await frame();
            await frame();
            const boxes = [...window.drawn];
            return boxes.flatMap(([a, [l, t, r, b]], i) => boxes.slice(i + 1).filter(([, [x, y, z, w]]) => Math.min(r, z) - Math.max(l, x) > 0.5 && Math.min(b, w) - Math.max(t, y) > 0.5).map(([other]) => `${a} / ${other}`));
          }, part);
          overlaps.push(...found.map((pair) => `${width} ${preset} ${part}: ${pair}`));
        }
      }
    }
    await watched.close();
    assert.deepEqual(overlaps, []);
  },
  async "a link far below shows the top"(tab) {
    for (const link of ['#teacher a[href="#lesson=3"]', "#worksheet tbody a >> nth=1", "#worksheet tbody a >> nth=1"]) {
      await tab.click("#worksheet-answers summary");
      await tab.click(link);
      await tab.waitForFunction(() => scrollY === 0 && !document.getElementById("worksheet-answers").open);
    }
    await becomes(tab, "friction k = 0.02: upright");
  },
  async "the changes of energy stand below its areas"(tab) {
    const other = await open("#full-coulomb&at=24.73");
    assert.equal(await other.textContent("#energy-numbers"), "Changes since the start:height +2.64 mJspin −239.67 mJother motion −0.03 mJlost as heat +237.07 mJ");
    await other.close();
  },
  async "a bad value is refused in the program's words, and the next good one is run"(tab) {
    await openAll(tab);
    await box(tab, "friction.k").fill("-1");
    await errorBecomes(tab, "friction.k = -1: must be a number from 0 to 100");
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
      const message = await other.textContent("#error");
      if (error) assert.ok(message.startsWith(error), message);
      else assert.match(await summary(other), /^The paper's rise:/);
      // A click on a preset leads back.
      await other.click('#presets [value="paper"]');
      await becomes(other, "The paper's rise: upright");
      await other.close();
    }
  },
  async "keys that don't apply are not there"(tab) {
    await openAll(tab);
    assert.equal(await box(tab, "friction.viscous_speed").count(), 0);
    await tab.locator('[data-path="friction.law"] select').selectOption("viscous");
    await becomes(tab, "friction law = viscous");
    assert.ok(Number(await box(tab, "friction.viscous_speed").inputValue()) > 0);
    await tab.locator('[data-path="friction.law"] select').selectOption("none");
    await tab.waitForFunction(() => !document.querySelector('[data-path="friction.k"]'));
    assert.equal(await tab.textContent("#error"), "");
  },
  async "a peg is let go"(tab) {
    await openAll(tab);
    await tab.locator('[data-path="support.kind"] select').selectOption("free");
    await becomes(tab, "values changed");
    assert.equal(await tab.textContent("#error"), "");
    assert.match(await tab.textContent("#also"), /^This also sets .*formulation = body.*\.$/);
    assert.equal(await tab.locator('[data-path="formulation"] select').inputValue(), "body");
    await shot(tab, "free");
  },
  async "numbers in fields are short"(tab) {
    await openAll(tab);
    await tab.click('#presets [value="tippe-top"]');
    await becomes(tab, "Tippe top:");
    assert.equal(await box(tab, "top.transverse_moment").inputValue(), "3.7143e-6");
    assert.equal(await tab.textContent("#command"), "toprise run tippe-top");
    const slider = tab.locator('[data-path="top.center_distance"] input[type=range]');
    for (const place of ["0", "250", "750", "1000"]) {
      await slider.fill(place);
      await tab.waitForTimeout(400);
      assert.equal(await tab.textContent("#error"), "", place);
    }
  },
  async "a run without end is ended, and says so"(tab) {
    await openAll(tab);
    await tab.click('#presets [value="frictionless"]');
    await becomes(tab, "No friction:");
    await box(tab, "stop.duration").fill("1000000");
    await tab.waitForFunction(() => document.getElementById("error").textContent.includes("too long"), null, { timeout: 60_000 });
    await box(tab, "stop.duration").fill("1");
    await becomes(tab, "after 1.00");
  },
  async "it plays on its own, and the keyboard moves through it"(tab) {
    await tab.waitForFunction(() => parseFloat(document.getElementById("clock").textContent) > 0.1);
    await tab.locator("#stage").click({ position: { x: 5, y: 5 } });
    await tab.keyboard.press(" ");
    assert.equal(await tab.textContent("#play"), "Play");
    await tab.keyboard.press("Home");
    await clockBecomes(tab, "0.000 s");
    await tab.keyboard.press("ArrowRight");
    await clockBecomes(tab, "0.010 s");
    await tab.focus("#events");
    await tab.keyboard.press("ArrowDown");
    await clockBecomes(tab, "24.270 s");
    await tab.focus("#top");
    const before = await picture(tab, "top");
    await tab.keyboard.press("ArrowLeft");
    await tab.waitForTimeout(200);
    assert.notEqual(await picture(tab, "top"), before);
    await clockBecomes(tab, "24.270 s");
    await tab.keyboard.press("?");
    assert.match(await tab.textContent("#keys"), /Space/);
    await tab.keyboard.press("Escape");
    assert.ok(!(await tab.isVisible("#keys")));
    await tab.keyboard.press("a");
    await tab.waitForFunction(() => document.getElementById("pin").textContent === "Remove A");
  },
  async "Space plays or pauses, and A keeps the run, wherever the focus is"(tab) {
    await pause(tab);
    for (const id of ["knob-k", "time", "play", "show-slip", "speed", "reset-view", "to-lesson"]) {
      await tab.evaluate((id) => {
        document.activeElement.blur();
        document.getElementById(id).focus({ focusVisible: false });
      }, id);
      const isChecked = await tab.isChecked("#show-slip");
      await tab.keyboard.press(" ");
      assert.equal(await tab.textContent("#play"), "Pause", id);
      await tab.keyboard.press(" ");
      assert.equal(await tab.textContent("#play"), "Play", id);
      assert.equal(await tab.isChecked("#show-slip"), isChecked);
      await tab.keyboard.press("a");
      assert.equal(await tab.textContent("#pin"), "Remove A", id);
      await tab.keyboard.press("a");
    }
    await tab.click('#presets [value="drop"]');
    await becomes(tab, "Dropped on the table:");
    await tab.keyboard.press(" ");
    assert.equal(await tab.textContent("#play"), "Pause");
    await pause(tab);
    // Text fields take both; a box that was reached by Tab takes Space.
    await openAll(tab);
    await box(tab, "friction.k").focus();
    await tab.keyboard.press(" ");
    await tab.keyboard.press("a");
    assert.deepEqual([await tab.textContent("#play"), await tab.textContent("#pin")], ["Play", "Keep as A"]);
    await tab.evaluate(() => document.getElementById("show-slip").focus({ focusVisible: true }));
    await tab.keyboard.press(" ");
    assert.equal(await tab.isChecked("#show-slip"), false);
  },
  async "a run of one sample says that it has no curves"() {
    const other = await open("#paper&stop.duration=1e-9");
    assert.match(await summary(other), /after 0\.000\u00a0s/);
    await other.waitForTimeout(200);
    assert.match(await other.getAttribute("#curves", "aria-label"), /ends at its start/);
    await shot(other, "moment");
    await other.close();
  },
  async "it starts again at the end"(tab) {
    await tab.selectOption("#speed", "5");
    await tab.locator("#time").evaluate((slider) => {
      slider.value = 24.6;
      slider.dispatchEvent(new Event("input"));
    });
    await tab.waitForFunction(() => parseFloat(document.getElementById("clock").textContent) < 5);
  },
  async "the time slider stays where a person holds or leaves it while the top plays"(tab) {
    const slider = tab.locator("#time");
    const { x, y, width, height } = await slider.boundingBox();
    const end = await slider.evaluate(({ max }) => Number(max));
    assert.equal(await tab.textContent("#play"), "Pause");
    await tab.mouse.move(x + width / 2, y + height / 2);
    await tab.mouse.down();
    await tab.waitForTimeout(100);
    const held = await clock(tab);
    await tab.waitForTimeout(300);
    assert.equal(await clock(tab), held);
    await tab.mouse.move(x + width + 20, y + height / 2, { steps: 5 });
    // Longer than the pause before playback starts again by itself.
    for (const wait of [100, 2000]) {
      await tab.waitForTimeout(wait);
      assert.ok(Math.abs((await clock(tab)) - end) < 0.001);
    }
    await tab.mouse.up();
    await tab.waitForTimeout(2000);
    assert.ok(Math.abs((await clock(tab)) - end) < 0.001);
    // Play then starts from the beginning, and goes on after the slider has been let go elsewhere.
    await tab.click("#play");
    await tab.waitForFunction((end) => parseFloat(document.getElementById("clock").textContent) < end / 2, end);
    await tab.mouse.click(x + width / 4, y + height / 2);
    const left = await clock(tab);
    await tab.waitForFunction((left) => parseFloat(document.getElementById("clock").textContent) > left, left);
  },
  async "indices of symbols are set below the line, and keys are not raw"() {
    const other = await open("#tippe-top");
    await other.waitForSelector("#explanation sub");
    assert.deepEqual(await other.locator("#explanation sub").allTextContents(), ["n", "z′"]);
    await other.goto(`${url}#paper`);
    await other.waitForFunction(() => document.getElementById("explanation").textContent.includes("would damp the nutation"));
    assert.ok(!/friction\.|_|In this time/.test(await other.textContent("#reading > section:first-child")));
    await other.close();
  },
  async "angles are told in degrees, too, in Why, the events and the comparison"() {
    const other = await open("#drop&vs=paper");
    await other.waitForSelector('#compared[aria-busy="false"] td');
    assert.match(await other.textContent("#explanation"), /θ = 0\.5000\u00a0rad \(28\.65°\).* between 0\.3855 \(22\.\d\d°\) and 0\.3868\u00a0rad \(22\.\d\d°\)/);
    assert.match(await other.textContent("#events"), /starts at θ = 0\.5000\u00a0rad \(28\.65°\)/);
    assert.match(await other.textContent("#comparison"), /crosses 0\.392\u00a0rad \(22\.5°\) \[s\].*mean θ at [\d.]+\u00a0s, most different \[rad\]0\.489902 \(28\.\d{4}°\)0\.385561 \(22\.\d{4}°\)−0\.104/);
    assert.doesNotMatch(await other.textContent("#comparison"), /– \(/);
    await other.close();
  },
  async "a run without a known cause says so"() {
    const other = await open("#full-coulomb&stop.duration=0.06");
    await other.waitForFunction(() => document.querySelector("#explanation p") !== null);
    assert.match(await other.textContent("#story"), /^The numbers of this run show none of the causes/);
    await other.close();
  },
  async "the playback speed stays what was chosen"(tab) {
    await tab.selectOption("#speed", "0.1");
    await tab.fill("#knob-k", "200");
    await becomes(tab, "friction k = 0.12");
    await tab.click('#presets [value="drop"]');
    await becomes(tab, "Dropped on the table:");
    assert.equal(await tab.inputValue("#speed"), "0.1");
  },
  async "two tabs don't disturb each other"(tab) {
    const other = await open("#tippe-top");
    await openAll(tab);
    await box(tab, "friction.k").fill("0.05");
    await becomes(tab, "friction k = 0.05");
    assert.match(await summary(other), /^Tippe top:/);
    await other.close();
  },
  async "it fits a phone, and the picture stays in sight while a slider moves"(tab) {
    await tab.setViewportSize({ width: 390, height: 844 });
    const [inner, outer] = await tab.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
    assert.ok(inner <= outer, `${inner} > ${outer}`);
    await shot(tab, "phone");
    await tab.locator("#knob-theta").evaluate((slider) => slider.scrollIntoView({ block: "end" }));
    await tab.fill("#knob-theta", "150");
    await becomes(tab, "tilt θ");
    const [top, slider] = [await tab.locator("#top").boundingBox(), await tab.locator("#knob-theta").boundingBox()];
    assert.ok(top.y >= 0 && top.y + top.height <= slider.y && slider.y + slider.height <= 844, JSON.stringify([top, slider]));
    await shot(tab, "phone-slider");
  },
  async "a phone shows a question of the lesson with what is to be watched"(tab) {
    await tab.setViewportSize({ width: 390, height: 844 });
    for (const [step, watched] of [[1, "#curves"], [3, "#energy"], [3, "#energy-numbers"], [4, "#knob-k"]]) {
      await tab.goto(`${url}#lesson=${step}`);
      await tab.waitForFunction((step) => document.querySelector("#lesson [aria-current]")?.textContent === step, String(step));
      await tab.waitForTimeout(500);
      for (const id of ["#lesson .watch", "#top", watched]) {
        const { y } = await tab.locator(id).boundingBox();
        // Of the curves, the uppermost is to be watched: a sixth of them.
        assert.ok(y >= 0 && y + 60 <= 844, `${id} in step ${step}: ${y}`);
      }
      await shot(tab, `phone-lesson-${step}`);
    }
  },
  async "a narrow phone has no sideways scroll, a time slider of full width and all boxes of arrows"(tab) {
    for (const width of [320, 360, 390]) {
      await tab.setViewportSize({ width, height: 640 });
      const [inner, outer] = await tab.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
      assert.ok(inner <= outer, `${inner} > ${outer}`);
      const time = await tab.locator("#time").boundingBox();
      assert.ok(time.width > 0.85 * width, `${time.width} of ${width}`);
      for (const label of await tab.locator("#arrows label").all()) {
        const { x, width: wide } = await label.boundingBox();
        assert.ok(x >= 0 && x + wide <= width, `${await label.textContent()} at ${width}`);
      }
      await shot(tab, `phone-${width}`);
    }
  },
  async "texts have a contrast of 4.5 to 1, on light and dark"(tab) {
    await openAll(tab);
    await tab.click("#pin");
    await box(tab, "friction.k").fill("-1");
    await errorBecomes(tab, "friction.k = -1");
    for (const colorScheme of ["light", "dark"]) {
      await tab.emulateMedia({ colorScheme });
      const poor = await tab.evaluate(() => {
        const pen = Object.assign(document.createElement("canvas"), { width: 1, height: 1 }).getContext("2d", { willReadFrequently: true });
        const rgba = (color) => {
          pen.clearRect(0, 0, 1, 1);
          pen.fillStyle = color;
          pen.fillRect(0, 0, 1, 1);
          return [...pen.getImageData(0, 0, 1, 1).data];
        };
        const luminance = (color) => {
          const [r, g, b] = rgba(color).map((value) => (value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4));
          return 0.2126 * r + 0.7152 * g + 0.0722 * b;
        };
        const contrast = (a, b) => {
          const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y);
          return (high + 0.05) / (low + 0.05);
        };
        const backgroundOf = (place) => (rgba(getComputedStyle(place).backgroundColor)[3] > 0 ? getComputedStyle(place).backgroundColor : backgroundOf(place.parentElement));
        const texts = [...document.body.querySelectorAll("*")].filter((each) => each.offsetParent && !each.disabled && [...each.childNodes].some((node) => node.nodeType === 3 && node.data.trim()));
        const style = getComputedStyle(document.body);
        const card = style.getPropertyValue("--card");
        return [
          ...texts.map((each) => [each.textContent.slice(0, 20), contrast(getComputedStyle(each).color, backgroundOf(each))]),
          ...["--a", "--b", "--soft", "--ink"].map((name) => [name, contrast(style.getPropertyValue(name), card)]),
        ].filter(([, ratio]) => ratio < 4.5);
      });
      assert.deepEqual(poor, [], colorScheme);
    }
  },
  async "the picture names a run's end, a body below the table, and the spin that it shows"() {
    /** The texts of the picture of a link. */
    async function textsOf(hash) {
      const other = await context.newPage();
      await other.addInitScript(() => {
        window.texts = new Set();
        const { fillText } = CanvasRenderingContext2D.prototype;
        CanvasRenderingContext2D.prototype.fillText = function (text, ...place) {
          if (this.canvas.id === "top") window.texts.add(text);
          return fillText.call(this, text, ...place);
        };
      });
      await other.goto(`${url}${hash}`);
      await other.waitForSelector("body.ready");
      await other.waitForTimeout(300);
      const texts = await other.evaluate(() => [...window.texts].join("\n"));
      const changes = await other.textContent("#energy-numbers small");
      await other.close();
      return { texts, changes };
    }
    const ended = await textsOf("#frictionless&vs=full-coulomb&at=22");
    assert.match(ended.texts, /^ended at 20\.00 s$/m);
    assert.equal(ended.changes, "Changes of B since the start, until its end:");
    const running = await textsOf("#frictionless&vs=full-coulomb&at=12");
    assert.doesNotMatch(running.texts, /ended/);
    assert.match(running.texts, /^spin ω·n 27\.3 rev\/s$/m);
    assert.doesNotMatch(running.texts, /only the peg/);
    assert.match((await textsOf("#full-coulomb&initial.theta=1.4&at=0.2")).texts, /^only the peg touches the table in this model$/m);
  },
  async "a browser that is too old says so"() {
    const other = await context.newPage();
    await other.addInitScript(() => delete window.DecompressionStream);
    await other.goto(url);
    assert.match(await other.textContent("#summary"), /^This browser is too old/);
    await other.close();
  },
  async "the start of a run under reduced motion is still"() {
    const still = await browser.newContext({ reducedMotion: "reduce", offline: true });
    const other = await still.newPage();
    await other.goto(url);
    await other.waitForSelector("body.ready");
    assert.equal(await other.textContent("#play"), "Play");
    assert.equal(await other.textContent("#clock"), "0.000 s");
    await still.close();
  },
  async "memory does not grow with the changes"(tab) {
    await pause(tab);
    const grown = await tab.evaluate(async () => {
      const slider = document.getElementById("knob-k");
      const sizes = [];
      for (let change = 0; change < 300; change++) {
        slider.value = 75 + (change % 100);
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
    await pause(tab);
    const times = await tab.evaluate(async () => {
      const slider = document.getElementById("knob-k");
      const shown = document.getElementById("summary");
      const times = [];
      for (let place = 126; place < 146; place++) {
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
    console.log(`  median ${times[10].toFixed(0)} ms, shortest ${times[0].toFixed(0)} ms, longest ${times.at(-1).toFixed(0)} ms`);
  },
  async "the comparison says how far the motions agree, in words of the page"(tab) {
    for (const [link, sentence] of [
      ["tippe-top&stop.duration=2&vs=tippe-top&stop.duration=3", /^As long as both run, the motions agree: 2,001\u00a0samples are identical, bit for bit\. B ends first, at 2\.0000\u00a0s, at the time limit; A ends at 3\.0000\u00a0s, at the time limit\.$/],
      ["drop&vs=drop&support.restitution=0.3", /^The motions are identical, bit for bit, until 0\.03\d+\u00a0s, when an impact parts them\.$/],
      ["paper&vs=paper&integrator.relative_tolerance=1e-10", /integration error, θ by /],
    ]) {
      await tab.goto("about:blank");
      await tab.goto(`${url}#${link}`);
      await tab.waitForSelector("#comparison p", { timeout: 120_000 });
      await tab.waitForFunction(() => document.getElementById("compared").ariaBusy === "false" && !document.getElementById("comparison").textContent.startsWith("This run is kept"));
      const said = await tab.locator("#comparison p").allTextContents();
      assert.ok(said.some((text) => sentence.test(text)), said.join("\n"));
    }
  },
  async "the frame of a focused slider covers no text"(tab) {
    await tab.focus("#knob-psi_dot");
    await tab.keyboard.press("ArrowRight");
    const [bottom, top] = await tab.evaluate(() => {
      const slider = document.getElementById("knob-psi_dot");
      const { outlineOffset, outlineWidth } = getComputedStyle(slider);
      const frame = slider.getBoundingClientRect().bottom + parseFloat(outlineOffset) + parseFloat(outlineWidth);
      return [frame, slider.parentElement.querySelector(".ends small").getBoundingClientRect().top];
    });
    assert.ok(bottom <= top, `${bottom} ${top}`);
  },
  async "what is opened in the form is in sight"(tab) {
    await tab.setViewportSize({ width: 1366, height: 768 });
    await tab.click("#take summary");
    await tab.waitForFunction(() => {
      const [form, take] = ["form", "take"].map((id) => document.getElementById(id).getBoundingClientRect());
      return take.bottom <= form.bottom && take.height > 100;
    });
  },
  async "the paper is named as the source of its own models only"(tab) {
    for (const [preset, source] of [["paper", "The paper:"], ["full-coulomb", "The paper:"], ["tippe-top", "Beyond the paper:"], ["drop", "Beyond the paper:"]]) {
      await tab.goto(`${url}#${preset}`);
      await tab.waitForFunction((source) => document.getElementById("source").textContent.startsWith(source), source);
    }
  },
  async "words in low pictures leave room for the arc of the tilt"() {
    const other = await context.newPage();
    await other.setViewportSize({ width: 390, height: 844 });
    await other.addInitScript(() => {
      const { fillText } = CanvasRenderingContext2D.prototype;
      window.texts = {};
      CanvasRenderingContext2D.prototype.fillText = function (words, x, y, ...rest) {
        if (this.canvas.id === "top") window.texts[words] = y / this.canvas.clientHeight;
        return fillText.call(this, words, x, y, ...rest);
      };
    });
    await other.goto(`${url}#paper&initial.theta=1.45&at=1`);
    await other.waitForSelector("body.ready");
    await other.waitForFunction(() => Object.keys(window.texts).length > 2);
    const texts = Object.entries(await other.evaluate(() => window.texts));
    const heightOf = (start) => texts.find(([words]) => words.startsWith(start))[1];
    assert.ok(texts.some(([words]) => /^tilt θ [\d.]+°, spin ω·n [\d.]+ rev\/s$/.test(words)), JSON.stringify(texts));
    assert.ok(heightOf("tilt θ") < 0.1 && heightOf("only the peg") > 0.6, JSON.stringify(texts));
    await other.close();
  },
  async "a CSV that is dropped is fitted, and the sliders take the fit over"(tab) {
    await drop(tab, "camera.csv", readFileSync("tests/data/fit/offset_camera.csv", "utf8"));
    await tab.waitForFunction(() => /^fitting [\d.]+ of [\d.]+ s of data(, with \d+ of up to \d+ other spins)?: χ² = /.test(document.getElementById("fit-status").textContent));
    assert.ok(await tab.isVisible("#fit-cancel"));
    await tab.click("#fit-cancel");
    assert.equal(await tab.textContent("#fit-status"), "Stopped.");
    // The top of these data.
    const { truth, start } = JSON.parse(readFileSync("tests/data/fit/offset.json", "utf8"));
    const known = Object.entries({ ...truth.values, ...start }).filter(([key]) => /^(top|initial|friction)\./.test(key));
    await tab.goto(`${url}#${["full-coulomb", ...known.map(([key, value]) => `${key}=${value}`)].join("&")}`);
    await becomes(tab, "Full friction, ");
    await drop(tab, "camera.csv", readFileSync("tests/data/fit/offset_camera.csv", "utf8"));
    await tab.waitForSelector("#fit-result:not([hidden])", { timeout: 300_000 });
    assert.match(await tab.textContent("#fit-headline .verdict"), /^Full friction: describes the data$/);
    assert.match(await tab.textContent("#fit-headline .estimate"), /^friction k = 0\.0387\d+\u00a0±\u00a00\.0000\d\d, 95 % interval 0\.038\d+ to 0\.038\d+$/);
    const cells = await tab.locator("#fit-report th, #fit-report td").allTextContents();
    assert.ok(cells.includes("tilt θ [rad]") && cells.some((text) => text.endsWith("°)")) && !cells.some((text) => /initial\.|\/top\//.test(text)), cells.join());
    assert.match(await tab.textContent("#fit-command"), /^toprise fit full-coulomb camera\.csv --set .* --free friction\.k,initial$/);
    assert.equal(await tab.locator("#fit-plots canvas").count(), 4);
    await tab.locator("#fit").screenshot({ path: join(directory, "fit.png") });
    await tab.click("#fit-take");
    await tab.waitForFunction(() => document.querySelector('[data-knob="friction.k"] output').textContent.startsWith("0.0387"));
    await tab.click("#fit-close");
    assert.ok(!(await tab.isVisible("#fit")));
  },
  async "what a table must be like is said before a file is chosen, and an example is fitted"(tab) {
    await tab.click("#fit-choose");
    assert.match(await tab.textContent("#fit-format"), /^t, theta \(deg\), phi \(deg\)\n/);
    assert.ok(!(await tab.isVisible("#fit-options")));
    const chooser = tab.waitForEvent("filechooser");
    await tab.click("#fit-file");
    await chooser;
    await tab.locator("#fit").screenshot({ path: join(directory, "fit-format.png") });
    await tab.click("#fit-example");
    await tab.waitForSelector("#fit-result:not([hidden])", { timeout: 300_000 });
    assert.match(await tab.textContent("#fit-headline .verdict"), /^Full friction: /);
    // Made with k = 0.05.
    assert.match(await tab.textContent("#fit-headline .estimate"), /^friction k = 0\.0(49|50)\d*\u00a0±\u00a00\.000/);
    assert.equal(await tab.textContent("#fit-command"), "toprise fit full-coulomb top.csv --free friction.k,initial");
  },
  async "a fit with several spins shows no single value, fits its panel, and is repeated with a held spin"() {
    const other = await context.newPage();
    await other.addInitScript(() => {
      const keys = ["friction.k", "initial.theta", "initial.phi_dot", "initial.theta_dot", "initial.psi_dot"];
      const texts = (cells) => cells.map((text) => (text === "" ? [] : [{ text }]));
      const estimate = (text, error_text, unit = "") => [{ estimate: { text, error_text, value: Number(text), error: Number(error_text), unit, has_unit: false } }];
      const row = [...texts(["2.65"]), estimate("0.05594", "0.00042"), estimate("0.4999", "0.0010", "rad"), estimate("1.50", "0.28"), estimate("0.209", "0.067"), estimate("190.12", "0.14")];
      const section = (title, ...parts) => ({ title: [{ text: title }], tone: "neutral", note: [], parts });
      const line = (...pieces) => ({ line: pieces });
      const words = {
        verdict: [{ text: "describes the data with 9 different spins" }],
        headline: [{ key: "friction.k" }, { text: ": 0.0288 to 0.0597 (95 %), because θ alone does not show the spin" }],
        sections: [
          section("The paper's rise", line({ text: "300 samples in 10 s." })),
          section(
            "Parameters",
            {
              table: {
                header: texts(["", "estimate ± sd", "95 % interval", "start value"]),
                rows: [...keys, "initial.center_x_dot"].map((key) => [[{ key }, { text: " [rad]" }], estimate("0.249974", "0.000030", "rad"), ...texts(["−0.249914 to −0.250033", "−0.00017"])]),
                left: 1,
              },
            },
            line({ text: "The data fix …: " }, { key: "initial.center_x_dot" }, { text: " and " }, { key: "initial.theta_dot" }, { text: " (correlation −0.989)." }),
            line({ count: { count: 9, noun: "more pair" } }, { text: " with " }, { argument: { name: "all", values: [] } }, { text: "." }),
          ),
          section("Signals", { table: { header: texts(["", "samples", "σ", "RMS/σ", "uncorrelated", ""]), rows: [[[{ field: "/top/state.theta" }], ...texts(["300", "0.00536 rad (estimated)", "0.979", "p = 0.30", "1 above 5 σ"])]], left: 1 } }),
          section("Remarks", line({ text: "Measure φ, too, or hold " }, { key: "initial.psi_dot" }, { text: " at a known value." })),
          section("What describes the data as well", { table: { header: [...texts(["Δχ²"]), ...keys.map((key) => [{ key }])], rows: Array(8).fill(row), left: 0 } }),
        ],
      };
      const report = { law: "coulomb", quality: { is_converged: true }, modes: [{ delta_chi2: 2.65 }], parameters: keys.map((name) => ({ name })) };
      const { postMessage } = Worker.prototype;
      window.asked = [];
      Worker.prototype.postMessage = function (message, ...rest) {
        if (!message.file) return postMessage.call(this, message, ...rest);
        window.asked.push(message.request.fit.free);
        const response = { words, report, arguments: ["fit"], free: "friction.k,initial", set: {}, signals: [] };
        return setTimeout(() => this.onmessage({ data: { id: message.id, response } }));
      };
    });
    await other.goto(url);
    await other.waitForSelector("body.ready");
    await drop(other, "tilt.csv", "t,theta (deg)\n0,28\n");
    await other.waitForSelector("#fit-result:not([hidden])");
    assert.equal(await other.textContent("#fit-headline"), "The paper's rise: describes the data with 9 different spinsfriction k: 0.0288 to 0.0597 (95 %), because θ alone does not show the spin");
    assert.match(await other.textContent("#fit-report"), /hold spin ψ̇ at a known value/);
    // Not a list of pairs before the answer, and no key of the program.
    assert.match(await other.textContent("#fit-report"), /velocity of the centre along x and change of tilt θ̇ \(correlation −0\.989\)/);
    assert.match(await other.textContent("#fit-report"), /9\u00a0more pairs with the program's option --all/);
    assert.ok(!/minim|initial[. ]|center/.test(await other.textContent("#fit-report")));
    for (const width of [1366, 390, 320]) {
      await other.setViewportSize({ width, height: 800 });
      // A value stays in one line with its error.
      const broken = await other.locator("#fit-report td").evaluateAll((cells) => cells.map((cell) => cell.textContent).filter((text) => text.includes(" ± ")));
      assert.deepEqual(broken, [], `${width}`);
      const outside = await other.evaluate(() => {
        const { right } = document.getElementById("fit").getBoundingClientRect();
        const cells = [...document.querySelectorAll("#fit-report td, #fit-report th, #fit-report p")];
        return cells.filter((cell) => cell.getBoundingClientRect().right > right || cell.scrollWidth > cell.clientWidth + 1).map((cell) => cell.textContent);
      });
      assert.deepEqual(outside, [], `${width}`);
    }
    assert.equal(await other.textContent("#fit-take"), "Set the sliders to the best of these");
    assert.match(await other.textContent("#fit-lines"), /lines are the best fit:/);
    await other.click("#fit-hold");
    await other.waitForFunction(() => window.asked.length === 2);
    assert.deepEqual(await other.evaluate(() => window.asked), ["", "friction.k,initial.theta,initial.phi_dot,initial.theta_dot"]);
    assert.equal(await other.inputValue("#fit-free"), "friction k, tilt θ, precession φ̇, change of tilt θ̇");
    // One sentence says what is wrong, without a fit.
    await other.fill("#fit-free", "foo");
    await other.click("#fit-again");
    assert.match(await other.textContent("#fit-status.wrong"), /^“foo” is nothing that can be found/);
    await other.fill("#fit-free", "");
    await other.fill("#fit-sigma", "abc");
    await other.click("#fit-again");
    assert.match(await other.textContent("#fit-status.wrong"), /^“abc” is no error of an angle/);
    assert.equal(await other.evaluate(() => window.asked.length), 2);
    await other.close();
  },
  async "a fit without a minimum offers no values for the sliders"() {
    const other = await context.newPage();
    await other.addInitScript(() => {
      const words = { verdict: [{ text: "no minimum was found" }], headline: [], sections: [{ title: [], tone: "bad", note: [], parts: [] }] };
      const report = { law: "coulomb", quality: { is_converged: false }, modes: [], parameters: [] };
      const { postMessage } = Worker.prototype;
      Worker.prototype.postMessage = function (message, ...rest) {
        if (!message.file) return postMessage.call(this, message, ...rest);
        const response = { words, report, arguments: ["fit"], set: {}, signals: [] };
        return setTimeout(() => this.onmessage({ data: { id: message.id, response } }));
      };
    });
    await other.goto(url);
    await other.waitForSelector("body.ready");
    await drop(other, "tilt.csv", "t,theta (deg)\n0,28\n");
    await other.waitForSelector("#fit-result:not([hidden])");
    assert.equal(await other.textContent("#fit-headline .verdict"), "The paper's rise: no minimum was found");
    assert.match(await other.textContent("#fit-lines"), /lines are where the search ended:/);
    assert.ok(!(await other.isVisible("#fit-take")));
    await other.close();
  },
  async "a broken CSV is named with line and column, and can be chosen again"(tab) {
    await tab.click("#fit-choose");
    const [chooser] = await Promise.all([tab.waitForEvent("filechooser"), tab.click("#fit-file")]);
    await chooser.setFiles({ name: "broken.csv", mimeType: "text/csv", buffer: Buffer.from("t,theta\n0,0.5\n0.1,abc\n") });
    await tab.waitForSelector("#fit-status.wrong");
    assert.equal(await tab.textContent("#fit-status"), 'broken.csv:3: column theta: "abc" is not a number');
    assert.ok(!(await tab.isVisible("#fit-result")) && !(await tab.isVisible("#fit-cancel")));
    await drop(tab, "other.csv", "a,b\n1,2\n");
    await tab.waitForFunction(() => document.getElementById("fit-status").textContent.startsWith("other.csv: "));
  },
};

let failed = 0;
for (const [name, test] of Object.entries(tests)) {
  if (!name.includes(process.env.TEST ?? "")) continue;
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
