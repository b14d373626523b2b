// Checks with the page's WebAssembly in Node: the lesson's answers, the arrows' scales, the axes, and the sliders' ranges.
// usage: node page/test/runs.mjs [FILE], by default target/toprise.html
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { gunzipSync } from "node:zlib";
import { ARROWS, arrowScale, momentumParts, vectorAt } from "../arrows.mjs";
import { axisRange, axisTicks, constantOf, scaleOf } from "../axes.mjs";
import { placeOf, roundText, sliderRange, validText, valueAt } from "../controls.mjs";
import { quantities } from "../curves.mjs";
import { EnergyAreas, PARTS, changesShown, energyChanges, isBelowTable } from "../energy.mjs";
import { KNOB_STEPS } from "../knobs.mjs";
import { STEPS_OF_LESSON } from "../lesson.mjs";
import { nameLines, nameParts, runName } from "../names.mjs";
import { degrees, fixed, imagined, prefixed, revolutions, typed, written } from "../numbers.mjs";
import { Labels, besideArrow, commonArea, lengthInside } from "../labels.mjs";
import { isHidden, spinRing } from "../ring.mjs";
import { Scenario, linkOf, parseLink, scenarioFrom } from "../scenario.mjs";
import { sentenceText } from "../sentence.mjs";
import { orientationOf, stripeContrast, turned, visibleFaces } from "../shape.mjs";
import { load, simulated } from "../toprise.mjs";
import { RISE_TIMES } from "../worksheet.mjs";

const page = await readFile(process.argv[2] ?? new URL("../../target/toprise.html", import.meta.url), "utf8");
const [, packed] = page.match(/id="wasm">([^<]*)</);
const toprise = await load(await WebAssembly.compile(gunzipSync(Buffer.from(packed, "base64"))));
const tables = toprise.ask({ tables: {} });

/** The run of a link, as the page has it. */
async function runOf(link) {
  const run = await simulated(toprise, new Scenario(tables.presets, ...scenarioFrom(link)).request, tables.columns);
  assert.equal(run.error, undefined, link);
  return { ...run, end: run.columns.time.at(-1), flies: run.columns.flying.includes(1) };
}

const last = (column) => column.at(-1);
const flat = ({ columns }, index) => Math.hypot(columns.momentum_x.at(index), columns.momentum_y.at(index));

/** Asserts that the answer to a step contains a text. */
function says(step, text) {
  const { answer } = STEPS_OF_LESSON[step - 1];
  assert.ok(answer.includes(text), `step ${step} doesn't say ${text}: ${answer}`);
}

const tests = {
  async "lesson 1: without friction the tilt stays"() {
    const [b, a] = [await runOf(STEPS_OF_LESSON[0].ours), await runOf(STEPS_OF_LESSON[0].theirs)];
    const tilts = b.columns.theta.map(degrees);
    assert.ok(Math.max(...tilts) - Math.min(...tilts) < 0.01);
    says(1, `${fixed(tilts[0], 1)}°, to a hundredth of a degree`);
    says(1, `from ${fixed(degrees(a.columns.theta[0]), 1)}° to ${fixed(degrees(last(a.columns.theta)), 1)}° in ${fixed(a.end, 1)} s`);
  },
  async "lesson 2: the friction torque shortens the horizontal part of L"() {
    const run = await runOf(STEPS_OF_LESSON[1].ours);
    const { columns: c } = run;
    c.time.forEach((_, i) => {
      // Opposite to the horizontal part of L, within a degree, and horizontal.
      const [torque, part] = [Math.hypot(c.torque_x[i], c.torque_y[i]), flat(run, i)];
      assert.ok((c.torque_x[i] * c.momentum_x[i] + c.torque_y[i] * c.momentum_y[i]) / (torque * part) < -Math.cos(Math.PI / 180));
      assert.ok(Math.abs(c.torque_z[i]) < 1e-12 * torque);
      assert.equal(fixed(1e3 * c.momentum_z[i], 2), "10.95");
      // The axis stays near L, within 2°: in the last samples the top is nearly upright, and nutates.
      const [qw, qx, qy, qz] = [c.qw[i], c.qx[i], c.qy[i], c.qz[i]];
      const axis = [2 * (qx * qz + qw * qy), 2 * (qy * qz - qw * qx), 1 - 2 * (qx * qx + qy * qy)];
      const along = (axis[0] * c.momentum_x[i] + axis[1] * c.momentum_y[i] + axis[2] * c.momentum_z[i]) / Math.hypot(part, c.momentum_z[i]);
      assert.ok(along > Math.cos((2 * Math.PI) / 180));
    });
    assert.equal(momentumParts(run, 0), "horizontal 5.90, vertical 10.95 mN m s");
    assert.equal(momentumParts(run, run.end), "horizontal 0.22, vertical 10.95 mN m s");
    says(2, `from ${fixed(1e3 * flat(run, 0), 2)} to ${fixed(1e3 * flat(run, -1), 2)} mN m s, and leaves the vertical part at 10.95 mN m s`);
  },
  async "lesson 3: the spin pays"() {
    const run = await runOf(STEPS_OF_LESSON[2].ours);
    const [height, spin, other, heat] = energyChanges(run, run.end).map((change) => 1e3 * change);
    assert.ok(Math.abs(height + spin + other + heat) < 1e-9);
    says(3, `loses ${fixed(-spin, 1)} mJ: ${fixed(height, 1)} mJ of them lift the top, ${fixed(heat, 1)} mJ become heat`);
    says(3, `ω·n falls from ${fixed(revolutions(run.columns.axial_rate[0]), 1)} to ${fixed(revolutions(last(run.columns.axial_rate)), 1)} rev/s`);
    assert.equal((heat / height).toFixed(0), "90"); // in the notes for teachers
    says(3, `by ${fixed(height / run.top.weight, 1)} mm`);
  },
  async "the curve of energy is the sum of the areas, and changes as the program's energy does"() {
    for (const preset of ["full-coulomb", "tippe-top", "drop"]) {
      const { columns: c } = await runOf(preset);
      c.time.forEach((_, i) => {
        const sum = PARTS.slice(0, 3).reduce((sum, { at }) => sum + at(c, i), 0);
        assert.ok(Math.abs(sum - c.mechanical[i]) < 1e-12, preset);
        assert.ok(Math.abs(c.mechanical[i] - c.mechanical[0] - (c.energy[i] - c.energy[0])) < 1e-9, preset);
      });
    }
  },
  async "lesson 4: friction and spin decide the time"() {
    const end = async (link) => fixed((await runOf(link)).end, 1);
    says(4, `${await end(STEPS_OF_LESSON[3].ours)} s instead of ${await end(STEPS_OF_LESSON[3].theirs)} s`);
    // The student lowers the spin of B, whose k is 0.06.
    const { ours } = STEPS_OF_LESSON[3];
    says(4, `at k = 0.06 and 100 rad/s (${fixed(revolutions(100), 1)} rev/s) B is upright after ${await end(`${ours}&initial.psi_dot=100`)} s`);
    const weak = await runOf(`${ours}&initial.psi_dot=30`);
    assert.match(weak.outcome, /^fallen/);
    says(4, `at 30 rad/s (${fixed(revolutions(30), 1)} rev/s), after ${fixed(weak.end, 1)} s`);
  },
  async "lesson 5: a tippe top's spin reverses about its axis, but not about the vertical"() {
    const run = await runOf(STEPS_OF_LESSON[4].ours);
    const { columns: c } = run;
    const [height, , , heat] = energyChanges(run, run.end).map((change) => 1e3 * change);
    const motion = [0, -1].map((index) => c.kinetic.at(index));
    says(5, `${fixed(1e3 * motion[1], 2)} instead of ${fixed(1e3 * motion[0], 2)} mJ of motion. Of the rest, ${fixed(height, 2)} mJ lift the centre of mass by ${fixed(height / run.top.weight, 1)} mm, and ${fixed(heat, 2)} mJ become heat`);
    // Jellett's integral at the start, and the least energy of motion with it once the top has turned over.
    const [l, tilt] = [Number(tables.presets.find(({ name }) => name === "tippe-top").values["top.center_distance"]), c.theta[0]];
    const { peg_radius: radius, axial_moment: moment } = run.top;
    const [line, turnedLine] = [Math.hypot(radius * Math.cos(tilt) + l, radius * Math.sin(tilt)), radius - l];
    says(5, `${fixed(1e3 * turnedLine, 0)} instead of ${fixed(1e3 * line, 0)} mm`);
    const jellett = moment * c.axial_rate[0] * (radius * Math.cos(tilt) + l);
    assert.ok(Math.abs(motion[1] / (jellett ** 2 / (2 * moment * turnedLine ** 2)) - 1) < 1e-3);
    assert.ok(c.momentum_z.every((vertical) => vertical > 0));
    says(5, `at ${fixed(revolutions(last(c.axial_rate)), 1)} instead of ${fixed(revolutions(c.axial_rate[0]), 1)} rev/s`);
  },
  "every k of the worksheet has a position of the slider, and positions differ"() {
    const key = { typical: [0.003, 0.3], range: [0, 100], is_logarithmic: true };
    for (const [k] of [...RISE_TIMES, [0.01], [0.05], [0.1], [0.11], [0.3]]) {
      const place = Math.round(KNOB_STEPS * placeOf(key, k));
      assert.equal(roundText(key, place / KNOB_STEPS, 1 / KNOB_STEPS), String(k));
    }
    for (const each of [key, { typical: [0, 300], range: [-1e4, 1e4] }, { typical: [0.06, 1.45], range: [0, 3.2] }]) {
      const values = Array.from({ length: KNOB_STEPS + 1 }, (_, place) => Number(roundText(each, place / KNOB_STEPS, 1 / KNOB_STEPS)));
      values.slice(1).forEach((value, index) => assert.ok(value > values[index], `${values[index]} ${value}`));
    }
  },
  async "the worksheet has the times of the runs"() {
    for (const [k, time] of RISE_TIMES) {
      const { end } = await runOf(`full-coulomb&friction.k=${k}`);
      assert.equal(Number(end.toFixed(1)), time);
      assert.equal((k * end).toFixed(3), "0.742");
    }
    assert.ok(Math.abs((await runOf("full-coulomb&friction.k=0.01&stop.duration=100")).end - 74) < 0.5);
    assert.match((await runOf("full-coulomb&friction.k=0.01")).outcome, /^after 60\.00\u00a0s still spinning, tilted by/);
  },
  async "arrows have round scales, and stay in the picture in every preset"() {
    for (const { name: preset } of tables.presets) {
      const run = await runOf(preset);
      for (const name of Object.keys(ARROWS)) {
        const scale = arrowScale([run], name);
        assert.match(scale.toExponential(), /^[125]e/, `${preset} ${name}`);
        const longest = run.columns.time.reduce((most, _, i) => Math.max(most, Math.hypot(...vectorAt(run, ARROWS[name], i))), 0);
        assert.ok(longest <= 1.2 * run.shape.size * scale, `${preset} ${name}`);
      }
    }
  },
  "names in the picture cover neither texts nor lines, and stay where they are while they can"() {
    assert.equal(lengthInside([0, 0], [10, 0], [2, -1, 5, 1]), 3);
    assert.equal(lengthInside([0, 5], [10, 5], [2, -1, 5, 1]), 0);
    assert.equal(lengthInside([3, 0], [3, 0], [2, -1, 5, 1]), 0);
    const kept = {};
    /** The box of L at the end of an arrow that points into the text in the corner. */
    const boxOf = (end) => {
      const labels = new Labels(400, 300, kept);
      const text = [0, 0, 160, 44];
      labels.cover(text);
      labels.line([[10, 100], [390, 100]]);
      labels.add({ words: "L", wide: 10, places: besideArrow([150, 150], end) });
      const [{ place: [x, y] }] = labels.placed();
      const box = [x, y - 13, x + 10, y + 4];
      assert.equal(commonArea(box, text), 0, `${end}`);
      assert.equal(lengthInside([10, 100], [390, 100], box), 0, `${end}`);
      assert.ok(x >= 3 && x <= 387 && box[1] >= 3 && box[3] <= 297, `${end}`);
      return box;
    };
    for (const end of [[150, 46], [150, 20], [200, 97], [2, 140], [398, 298], [150, 150]]) boxOf(end);
    // A place that was the second best stays when the best one becomes free.
    const [x] = boxOf([150, 46]);
    assert.ok(Math.abs(boxOf([150, 62])[0] - x) < 20);
  },
  async "runs that the time limit ends say what the top does then"() {
    for (const [link, outcome] of [
      ["frictionless&stop.duration=25", "after 25.00\u00a0s still spinning, tilted by 28.6°"],
      ["drop", /^after 2\.00\u00a0s still spinning, tilted by 2\d\.\d°, rolling since 0\.6\d+\u00a0s$/],
      ["tippe-top", /^turns over at 5\.49\u00a0s; after 12\.00\u00a0s still spinning, tilted by 17\d\.\d°$/],
      ["tippe-top-hangs", /^does not turn over; after 5\.00\u00a0s still spinning, tilted by \d\.\d°, rolling since 0\.022\u00a0s$/],
      ["frictionless&initial.psi_dot=0", /^passes the horizontal at 0\.119\u00a0s; after 20\.00\u00a0s tilted by 1\d\d\.\d°$/],
      ["frictionless&initial.psi_dot=0&initial.phi_dot=0&initial.theta_dot=0&stop.duration=0.01", /^after 0\.010\u00a0s tilted by/],
    ]) {
      const run = await runOf(link);
      if (typeof outcome === "string") assert.equal(run.outcome, outcome);
      else assert.match(run.outcome, outcome);
      const tilt = degrees(last(run.columns.theta));
      assert.ok(Math.abs(Number(run.outcome.match(/tilted by ([\d.]+)°/)[1]) - tilt) < 0.1, link);
    }
  },
  async "energy that a model feeds in is called so"() {
    const run = await runOf("paper-precession-term-only");
    const { label, text } = changesShown(run, run.end).at(-1);
    const energy = run.columns.energy;
    assert.deepEqual([label, text], ["energy fed in", `+${fixed(last(energy) - energy[0], 2)} J`]);
    const lost = changesShown(await runOf("full-coulomb"), 24).at(-1);
    assert.equal(lost.label, "lost as heat");
  },
  async "energies below zero, which have no area, are noticed"() {
    // It ends lying on the table, with its centre of mass below it.
    const run = await runOf("frictionless&initial.psi_dot=0");
    assert.ok(isBelowTable(run) && Math.min(...run.columns.height_energy) < 0);
    assert.ok(!isBelowTable(await runOf("paper")));
  },
  "the cursor does not cross the titles of energy panels"() {
    const spans = EnergyAreas.prototype.cursorSpans.call({ runs: [1, 2], endsOf: EnergyAreas.prototype.endsOf }, 200);
    assert.deepEqual(spans, [[18, 96], [118, 196]]);
  },
  async "the start's spin about the axis is that of the picture"() {
    for (const preset of ["paper", "tippe-top", "drop"]) {
      const run = await runOf(preset);
      const [psi, phi] = ["psi_dot", "phi_dot"].map((name) => run.columns[name][0]);
      assert.ok(Math.abs(psi + phi * Math.cos(run.columns.theta[0]) - run.columns.axial_rate[0]) < 1e-9, preset);
    }
  },
  async "runs of a top have one scale of arrows"() {
    const runs = await Promise.all(["paper", "paper&friction.k=0.063", "full-coulomb&friction.k=0.02&initial.psi_dot=120"].map(runOf));
    for (const name of Object.keys(ARROWS)) {
      const scales = new Set([...runs.map((run) => arrowScale([run], name)), arrowScale(runs, name)]);
      assert.equal(scales.size, 1, name);
    }
  },
  async "no axis is filled by noise"() {
    for (const preset of ["frictionless", "paper", "tippe-top", "drop"]) {
      const run = await runOf(preset);
      for (const quantity of quantities(run)) {
        const values = run.columns[quantity.name];
        const scale = scaleOf(run, quantity);
        const envelope = { low: values, high: values };
        for (const isZoomed of [false, true]) {
          const [low, high] = axisRange([envelope], quantity, scale, isZoomed);
          assert.ok(high - low >= 0.01 * scale * (1 - 1e-12), `${preset} ${quantity.name}`);
        }
      }
    }
    const run = await runOf("frictionless");
    const energy = quantities(run).find(({ name }) => name === "mechanical");
    assert.equal(constantOf(run, energy).toFixed(4), "1.0932");
    assert.equal(constantOf(await runOf("paper"), energy), null);
  },
  async "sliders offer only valid values"() {
    for (const { name } of tables.presets) {
      for (const key of toprise.ask({ form: { preset: name, set: {} } })) {
        if (key.words || key.path === "sampling.period") continue;
        for (let place = 0; place <= 10; place++) {
          const text = validText(key, valueAt(key, place / 10));
          if (key.path === "top.center_distance" && Number(text) === 0) continue; // the only gap in a range
          const { set } = toprise.ask({ change: { scenario: { preset: name, set: {} }, key: key.path, value: text } });
          const { error } = toprise.ask({ start: { preset: name, set } });
          assert.equal(error, undefined, `${name} ${key.path} = ${text}, slider from ${sliderRange(key)}`);
        }
      }
    }
  },
  async "a slider's end is a short number within the range"() {
    const key = toprise.ask({ form: { preset: "paper", set: {} } }).find(({ path }) => path === "initial.theta");
    assert.equal(validText(key, key.range[0]), "0.0201");
    assert.equal(validText({ range: [0.1, 1.4499999999999997] }, 1.4499999999999997), "1.44");
    assert.equal(validText({ range: [-1, -0.020000000000000004] }, -0.020000000000000004), "-0.0201");
    assert.equal(validText({ range: [0, 1] }, 0), "0");
  },
  "constants are drawn on an axis with zero"() {
    const rangeOf = (value) => axisRange([{ low: [value], high: [value] }], {}, Math.abs(value), false, true);
    for (const value of [1.0856, -3, 2e-7]) {
      const [low, high] = rangeOf(value);
      assert.ok(low < Math.min(value, 0) && high > Math.max(value, 0), value);
      assert.ok(high - low < 1.2 * Math.abs(value), value);
    }
    assert.deepEqual(rangeOf(0), [-1, 1]);
  },
  "sentences have degrees next to radians and words for keys"() {
    const angle = (has_unit) => ({ number: { text: "0.5000", value: 0.5, unit: "rad", has_unit } });
    for (const [pieces, expected] of [
      [[{ text: "θ = " }, angle(true), { text: "." }], "θ = 0.5000\u00a0rad (28.65°)."],
      [[{ text: "from " }, angle(false), { text: " on" }], "from 0.5000 (28.65°) on"],
      [[{ time: { text: "2.5000", value: 2.5, unit: "s", has_unit: true } }], "2.5000\u00a0s"],
      [[{ count: { count: 1234, noun: "entry" } }], "1,234\u00a0entries"],
      [[{ key: "initial.psi_dot" }], "spin ψ̇"],
    ]) {
      assert.equal(sentenceText(pieces), expected);
    }
  },
  async "no text of the program is searched"() {
    for (const name of ["reading", "fit", "measured", "page", "worksheet", "worker"]) {
      const source = await readFile(new URL(`../${name}.mjs`, import.meta.url), "utf8");
      assert.doesNotMatch(source, /\.(?:replace|replaceAll|match|matchAll|split|search)\(\s*\//, name);
    }
  },
  "numbers are written as people write them"() {
    for (const [made, expected] of [
      [typed(4.4000000000000006e-5), "4.4e-5"],
      [typed(0.030000000000000002), "0.03"],
      [typed(-170), "-170"],
      [written(-4.4e-5), "−4.4 × 10⁻⁵"],
      [prefixed(0.005, "N"), "5 mN"],
      [prefixed(2e-5, "N m"), "20 µN m"],
      [fixed(-0.04, 1), "0.0"],
      [fixed(-6.806, 1), "−6.8"],
      [imagined(0.5, "rad"), "28.6°"],
      [imagined(170, "rad/s"), "27.1 rev/s"],
    ]) {
      assert.equal(made, expected);
    }
  },
  async "the spin's arc is perpendicular to the axis, in its sense, with its gap behind"() {
    const dot = (a, b) => a.reduce((sum, value, index) => sum + value * b[index], 0);
    for (const preset of ["full-coulomb", "tippe-top"]) {
      const { shape } = await runOf(preset);
      for (const theta of [0, 0.01, 0.5, 1.4, Math.PI / 2, 3.1, Math.PI]) {
        for (const azimuth of [-2, 0, 1.3]) {
          const axis = [Math.sin(theta), 0, Math.cos(theta)];
          const toward = [0.9 * Math.sin(azimuth), -0.9 * Math.cos(azimuth), Math.sqrt(0.19)];
          for (const sense of [1, -1]) {
            const { places, head } = spinRing(shape, axis, toward, sense);
            const heights = places.map((place) => dot(place, axis));
            assert.ok(Math.max(...heights) - Math.min(...heights) < 1e-12, `${preset} ${theta}`);
            const [[a, b, c], [x, y, z]] = [places[head - 1], places[head]];
            assert.ok(sense * dot([b * z - c * y, c * x - a * z, a * y - b * x], axis) > 0, `${preset} ${theta}`);
            const depths = places.map((place) => dot(place, toward));
            assert.ok(depths[head] >= Math.max(depths[0], depths.at(-1)) - 1e-12, `${preset} ${theta}`);
          }
        }
      }
    }
  },
  async "the body hides what is behind it"() {
    const ball = (await runOf("tippe-top")).shape;
    assert.ok(isHidden(ball, [0, 0, 1], [0, -1, 0], [0, ball.peg, 0]));
    assert.ok(!isHidden(ball, [0, 0, 1], [0, -1, 0], [0, -ball.peg, 0]));
    const disc = (await runOf("full-coulomb")).shape;
    const above = 0.93 * disc.tip;
    assert.ok(isHidden(disc, [0, 0, 1], [0, -1, 0], [0, 0.1 * disc.size, above])); // by the stem
    assert.ok(!isHidden(disc, [0, 0, 1], [0, -1, 0], [0, -0.1 * disc.size, above]));
    assert.ok(isHidden(disc, [0, 0, 1], [0, 0, -1], [0.1 * disc.size, 0, above])); // by the disc
  },
  async "nothing of a top is drawn below the table"() {
    const { shape, columns } = await runOf("full-coulomb&initial.theta=1.4&stop.duration=0.1");
    const faces = (theta, each = shape) => visibleFaces(each, [Math.cos(theta / 2), 0, Math.sin(theta / 2), 0], [0, 0, columns.peg_z[0]], (place) => place);
    for (const theta of [0.1, 1, 1.4]) {
      const { faces: drawn, isSunk } = faces(theta);
      assert.ok(drawn.every(({ corners }) => corners.every(([, , z]) => z >= -1e-12)), theta);
      assert.equal(isSunk, theta >= 1);
    }
  },
  "stripes never seem to turn backward"() {
    assert.equal(stripeContrast(170, 0), 1); // paused
    for (const rate of [-300, -50, 3, 20, 170, 300]) {
      for (const exposure of [1e-4, 1 / 144, 1 / 60, 1 / 30, 0.1]) {
        // Beyond a quarter of the distance between two stripes, none is drawn.
        const isSlow = Math.abs(rate) * exposure < Math.PI / 4;
        assert.equal(stripeContrast(rate, exposure) > 0, isSlow, `${rate} rad/s, ${exposure} s`);
      }
    }
  },
  "an orientation without spin has its axis, and no jump where the top is upright or inverted"() {
    for (const theta of [0, 1e-3, 1, 2, Math.PI - 1e-3, Math.PI]) {
      const at = (phi) => orientationOf([Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)]);
      assert.ok(Math.abs(turned(at(0.3), [0, 0, 1])[2] - Math.cos(theta)) < 1e-12);
      const [a, b] = [at(0), at(0.1)].map((q) => turned(q, [1, 0, 0]));
      assert.ok(Math.hypot(...a.map((value, index) => value - b[index])) < 0.1 * Math.sin(theta) * 2 + 1e-12, theta);
    }
  },
  "an axis has at least two numbers"() {
    for (const [low, high] of [[-14, 14], [0, 0.34], [0.99, 1.08], [-3, 0.5], [4e-6, 9e-6]]) {
      const marks = axisTicks(low, high, 2);
      assert.ok(marks.length >= 2 && marks.length <= 6 && marks.every((mark) => mark >= low && mark <= high), `${marks}`);
    }
  },
  async "names of A and B show what differs, and break between changes only"() {
    const [a, b] = [await runOf("full-coulomb"), await runOf("full-coulomb&friction.k=0.06&initial.psi_dot=100")];
    const c = await runOf("full-coulomb&friction.k=0.06");
    assert.deepEqual(nameParts(b, a.scenario), ["friction k = 0.06", "spin ψ̇ = 100\u00a0rad/s"]);
    assert.deepEqual(nameParts(b, c.scenario), ["spin ψ̇ = 100\u00a0rad/s", "friction k = 0.06"]);
    assert.deepEqual(nameParts(a, b.scenario), ["Full friction"]);
    const limited = await runOf("frictionless&stop.duration=25");
    assert.deepEqual(nameParts(limited, a.scenario), ["No friction"]);
    assert.deepEqual(nameParts(limited, { preset: "frictionless", set: {} }), ["time limit = 25\u00a0s"]);
    assert.deepEqual(nameParts(c, (await runOf("paper")).scenario), ["Full friction", "friction k = 0.06"]);
    assert.equal(runName(b), "Full friction, friction k = 0.06, spin ψ̇ = 100\u00a0rad/s");
    assert.equal(runName(await runOf("full-coulomb&friction.k=0.06&initial.psi_dot=100&initial.theta=0.6")), "Full friction, 3 values changed");
    // Its outcome says when it ends.
    assert.equal(runName(await runOf("frictionless&stop.duration=25")), "No friction");
    const off = await runOf("full-coulomb&friction.law=none&friction.k=&friction.dissipation=&stop.theta_risen=&stop.duration=5");
    assert.equal(runName(off), "Full friction, without friction, without stop theta risen");
    const parts = ["k = 0.06", "ψ̇ = 100\u00a0rad/s", "θ = 0.3\u00a0rad"];
    for (const [width, lines] of [
      [99, ["B: k = 0.06, ψ̇ = 100\u00a0rad/s, θ = 0.3\u00a0rad"]],
      [30, ["B: k = 0.06, ψ̇ = 100\u00a0rad/s,", "θ = 0.3\u00a0rad"]],
      [17, ["B: k = 0.06,", "ψ̇ = 100\u00a0rad/s, …"]],
    ]) {
      assert.deepEqual(nameLines("B", parts, { widthOf: ({ length }) => length, width }), lines, `${width} characters`);
    }
  },
  "links are read as they are written"() {
    const scenario = new Scenario(tables.presets, "paper", { "friction.k": "0.02" });
    const link = parseLink(`#${linkOf(scenario.request)}&vs=full-coulomb&lesson=3&at=1.5`);
    assert.deepEqual(link, { ours: "paper&friction.k=0.02", theirs: "full-coulomb", lesson: 3, moment: 1.5 });
    assert.deepEqual(parseLink("#lesson=2"), { ours: "", theirs: undefined, lesson: 2, moment: null });
    assert.deepEqual(parseLink(""), { ours: "", theirs: undefined, lesson: 0, moment: null });
  },
};

let failed = 0;
for (const [name, test] of Object.entries(tests)) {
  try {
    await test();
    console.log(`ok: ${name}`);
  } catch (error) {
    failed += 1;
    console.log(`FAILED: ${name}: ${error.stack}`);
  }
}
process.exit(failed ? 1 : 0);
