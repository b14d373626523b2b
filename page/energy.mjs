// Where the energy is: stacked areas over time, and the changes since the start in numbers.

import { axisTicks, indexAt } from "./axes.mjs";
import { CURVE_MARGINS, TimeCanvas, isMoment } from "./curves.mjs";
import { fixed, written } from "./numbers.mjs";

/** The parts of the energy, from the bottom of the stack: height above the table, spin, other motion, heat. */
export const PARTS = [
  { name: "height", label: "height", color: "#2b8a3e", at: (c, i) => c.height_energy[i] },
  { name: "spin", label: "spin", color: "#4c6ef5", at: (c, i) => c.spin_energy[i] },
  { name: "other", label: "other motion", color: "#f2c14e", at: (c, i) => c.kinetic[i] - c.spin_energy[i] },
  { name: "lost", label: "lost as heat", color: "#adb5bd", at: (c, i) => c.energy[0] - c.energy[i] },
];

/** Whether the centre of mass is below the table at some time: its energy of height is negative then, and has no area. */
export function isBelowTable(run) {
  run.isBelowTable ??= run.columns.height_energy.some((energy) => energy < 0);
  return run.isBelowTable;
}

/** What the areas don't show then. */
export const BELOW_TABLE = " (the areas reach above the total where the centre of mass is below the table, and its height counts negative)";

/** The changes of the parts since the start of the run, J. */
export function energyChanges({ columns, end }, time) {
  const index = indexAt(columns.time, Math.min(time, end));
  return PARTS.map(({ at }) => at(columns, index) - at(columns, 0));
}

/** Terms of friction without a torque can feed energy in, as no real friction does. */
const FED_IN = "energy fed in";

/** The changes of the parts at a time: label, colour, and text in one unit for the whole run, such as `−239.67 mJ`. */
export function changesShown(run, time) {
  const most = Math.max(...energyChanges(run, run.end).map(Math.abs));
  const [factor, unit] = [[1, "J"], [1e-3, "mJ"], [1e-6, "µJ"]].find(([factor]) => most >= factor) ?? [1e-3, "mJ"];
  const decimals = most / factor < 10 ? 3 : 2;
  return energyChanges(run, time).map((change, index) => {
    const { name, label, color } = PARTS[index];
    const isFedIn = name === "lost" && Number(fixed(change / factor, decimals).replace("−", "-")) < 0;
    const text = fixed((isFedIn ? -change : change) / factor, decimals);
    const sign = Number(text.replace("−", "-")) > 0 ? "+" : "";
    return { label: isFedIn ? FED_IN : label, color, text: `${sign}${text} ${unit}` };
  });
}

export class EnergyAreas extends TimeCanvas {
  runs = [];

  /** The panels, without their labels. */
  cursorSpans(height) {
    return this.endsOf(this.runs, height);
  }

  /** Draws a panel for each run: the edited run, below a pinned one; nothing after `seen`. */
  draw(runs, window, time, seen = Infinity) {
    this.runs = runs;
    this.window = window;
    const key = runs.map(({ run }) => run.digest);
    this.show(
      key,
      time,
      (pen, width, height) => isMoment(runs) || this.endsOf(runs, height).forEach((ends, index) => this.panel(pen, runs[index], ends, runs.length > 1)),
      (pen, width, height) => this.endsOf(runs, height).forEach((ends) => this.cover(pen, seen, ends)),
    );
  }

  /** The upper and lower end of each run's panel. */
  endsOf(runs, height) {
    const each = height / runs.length;
    return runs.map((_, index) => [index * each + CURVE_MARGINS.head, (index + 1) * each - 4]);
  }

  panel(pen, { run, letter }, [top, bottom], isNamed) {
    const style = getComputedStyle(this.canvas);
    const { across } = this;
    const { columns } = run;
    const { left } = CURVE_MARGINS;
    const indices = Array.from({ length: across }, (_, x) => this.indexOf(run, x / across)).filter((index) => index !== null);
    const stack = (i) => PARTS.map(({ at }) => Math.max(at(columns, i), 0));
    const highest = indices.reduce((most, i) => Math.max(most, stack(i).reduce((sum, part) => sum + part, 0)), 1e-12);
    const y = (value) => bottom - (value / (1.05 * highest)) * (bottom - top);
    for (const value of axisTicks(0, 1.05 * highest, Math.max((bottom - top) / 30, 2))) {
      pen.fillStyle = style.color;
      pen.textAlign = "right";
      pen.fillText(written(value), left - 6, Math.max(y(value) + 4, top + 8), left - 8);
    }
    indices.forEach((index, x) => {
      let sum = 0;
      stack(index).forEach((part, order) => {
        pen.fillStyle = PARTS[order].color;
        pen.fillRect(left + x, y(sum + part), 1.05, y(sum) - y(sum + part));
        sum += part;
      });
    });
    pen.fillStyle = style.color;
    pen.textAlign = "left";
    pen.fillText(`${isNamed ? `${letter}: ` : ""}where the energy is, zero at the table (J)`, left - 46, top - 5);
  }

  /** The sample at a part of the window; null after the end of the run. */
  indexOf(run, part) {
    const time = this.window[0] + part * (this.window[1] - this.window[0]);
    return time <= run.end ? indexAt(run.columns.time, time) : null;
  }
}
