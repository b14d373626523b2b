// Curves over time. Each pixel column shows the minimum and maximum of its samples, so no nutation is lost.

import { axisRange, axisTicks, constantOf, indexAt, scaleOf, ticks } from "./axes.mjs";
import { gestures } from "./gestures.mjs";
import { degrees, fixed, imagined, written } from "./numbers.mjs";

const LEFT = 58;
const RIGHT = 12;
const LABEL = 12; // start of a panel's label
const GAP = 14; // between the values of runs
const HEAD = 18; // above each panel, for its label and values
const FOOT = 30;
const NUMBER_HEIGHT = 11;
const NO_CURVES = "The run ends at its start: there are no curves.";
const SMALL = "12px system-ui, sans-serif";

/**
 * The curves for fixed and free pegs: column, label, unit, index of its mean in a nutation cycle, the quantity by whose
 * size its changes are judged. Angles are drawn in degrees. Euler rates have spikes where the axis passes the vertical.
 */
const TILT = { name: "theta", label: "tilt θ", unit: "rad", mean: 1, ofAxis: degrees, axisUnit: "°" };
const PRECESSION = { name: "phi_dot", label: "precession φ̇", unit: "rad/s", mean: 2, isSpiky: true };
const NUTATION = { name: "theta_dot", label: "change of tilt θ̇", unit: "rad/s", inDegrees: true, mean: 3, like: { name: "phi_dot", part: 1 } };
const FREE_NUTATION = { ...NUTATION, like: { name: "axial_rate", part: 0.01 } };
const SPIN = { name: "psi_dot", label: "spin ψ̇", unit: "rad/s", mean: 4, isSpiky: true };
const AXIAL = { name: "axial_rate", label: "spin about the axis ω·n", unit: "rad/s" };
const SLIP = { name: "slip_speed", label: "slip speed", unit: "m/s" };
const HEIGHT = { name: "height", label: "height of the peg above the table", unit: "m" };
const ENERGY = { name: "mechanical", label: "energy, zero at the table", unit: "J" };
const FIXED = [TILT, PRECESSION, NUTATION, SPIN, SLIP, ENERGY];
const FREE = [TILT, FREE_NUTATION, AXIAL, SLIP, HEIGHT, ENERGY];

const panelLabel = ({ label, unit, axisUnit = unit }) => `${label} (${axisUnit})`;

export const quantities = (run) => (run.is_free ? FREE : FIXED).filter((quantity) => quantity !== HEIGHT || run.flies);

/** The minimum and maximum of a quantity in each pixel column of a time window. */
function envelope(run, name, [from, to], width) {
  const times = run.columns.time;
  const values = run.columns[name];
  const low = new Float64Array(width).fill(Infinity);
  const high = new Float64Array(width).fill(-Infinity);
  const first = Math.max(indexAt(times, from) - 1, 0);
  const last = Math.min(indexAt(times, to) + 1, times.length - 1);
  let before;
  for (let index = first; index <= last; index++) {
    const value = values[index];
    const pixel = Math.floor(((times[index] - from) / (to - from)) * width);
    // Interpolates linearly in pixel columns between two samples.
    for (let x = Math.max(before?.pixel ?? pixel, 0); x <= Math.min(pixel, width - 1); x++) {
      const span = pixel - (before?.pixel ?? pixel);
      const part = span > 1 ? (x - before.pixel) / span : 1;
      const at = part === 1 || !before ? value : before.value + part * (value - before.value);
      low[x] = Math.min(low[x], at);
      high[x] = Math.max(high[x], at);
    }
    before = { pixel, value };
  }
  return { low, high };
}

/** Whether there is nothing to draw over time: each run has a single sample. */
export const isMoment = (runs) => runs.every(({ run }) => run.columns.time.length < 2);

/** How much of a value is written: its number only where the rest would lie across the panel's label, which has the unit. */
const FORMS = ["whole", "short", "number"];

/** A value in its unit and, as a whole, in the one that people imagine; a constant has one digit more. */
function valueText(value, { unit, inDegrees }, form, isConstant) {
  const isShort = form !== "whole";
  if (form === "number") return unit === "rad" ? imagined(value, unit) : written(value, 3);
  const also = inDegrees ? `${written(degrees(value), 3)}°/s` : imagined(value, unit);
  if (unit === "rad") return `${isConstant ? "constant: " : ""}${also}${isShort ? "" : ` = ${fixed(value, 4)} rad`}`;
  return `${isConstant ? "constant: " : ""}${written(value, isConstant ? 5 : 4)} ${unit}${also && !isShort ? ` = ${also}` : ""}`;
}

/** A canvas whose picture is kept until its content changes, and whose horizontal axis is time. `cursorSpans` of a subclass are the vertical spans that its cursor crosses. */
export class TimeCanvas {
  /** `choose` is called with a time, `zoom` with a window of time. */
  constructor(canvas, { choose, zoom }) {
    this.canvas = canvas;
    this.window = [0, 1];
    gestures(canvas, {
      press: (event) => event.shiftKey || choose(this.timeAt(event)),
      drag: (event, dx) => (event.shiftKey ? this.move(1, 0, dx, zoom) : choose(this.timeAt(event))),
      pinch: ({ factor, x, dx }) => this.move(factor, x, dx, zoom),
    });
    canvas.addEventListener("dblclick", () => zoom(null));
  }

  get across() {
    return Math.max(Math.round(this.canvas.clientWidth - LEFT - RIGHT), 1);
  }

  timeAt(event) {
    const part = (event.clientX - this.canvas.getBoundingClientRect().left - LEFT) / this.across;
    return this.window[0] + Math.min(Math.max(part, 0), 1) * (this.window[1] - this.window[0]);
  }

  xOf(time) {
    return LEFT + ((time - this.window[0]) / (this.window[1] - this.window[0])) * this.across;
  }

  /** Zooms by a factor about a place, and pans. */
  move(factor, x, dx, zoom) {
    const width = this.window[1] - this.window[0];
    const place = Math.min(Math.max((x - LEFT) / this.across, 0), 1);
    const from = this.window[0] + place * width * (1 - 1 / factor) - (dx / this.across) * (width / factor);
    zoom([from, from + width / factor]);
  }

  /** Covers what comes after a time, in a panel. */
  cover(pen, time, [top, bottom]) {
    const x = Math.max(this.xOf(time) + 1, LEFT);
    pen.fillStyle = getComputedStyle(this.canvas).getPropertyValue("--card");
    if (x < LEFT + this.across) pen.fillRect(x, top - 1, LEFT + this.across + 1 - x, bottom - top + 2);
  }

  /** Draws `paint(pen)` if `key` has changed, the cursor at `time`, and `over(pen)`. */
  show(key, time, paint, over) {
    const { canvas } = this;
    const ratio = devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const whole = JSON.stringify([width, height, ratio, this.window, key]);
    if (whole !== this.key) {
      this.key = whole;
      this.image = document.createElement("canvas");
      [this.image.width, this.image.height] = [Math.max(width * ratio, 1), Math.max(height * ratio, 1)];
      const pen = this.image.getContext("2d");
      pen.scale(ratio, ratio);
      pen.font = SMALL;
      paint(pen, width, height);
    }
    [canvas.width, canvas.height] = [width * ratio, height * ratio];
    const pen = canvas.getContext("2d");
    pen.drawImage(this.image, 0, 0);
    pen.scale(ratio, ratio);
    pen.font = SMALL;
    const x = this.xOf(time);
    pen.fillStyle = getComputedStyle(canvas).color;
    const isInside = this.window[1] > this.window[0] && x >= LEFT - 0.5 && x <= width - RIGHT + 0.5;
    for (const [top, bottom] of isInside ? this.cursorSpans(height) : []) pen.fillRect(x - 0.5, top, 1, bottom - top);
    over(pen, width, height);
  }
}

export class Curves extends TimeCanvas {
  runs = [];

  /** The panels, without their labels. */
  cursorSpans(height) {
    return isMoment(this.runs) ? [] : this.panelsOf(this.runs, height).map(({ ends }) => ends);
  }

  /** Draws the curves of runs, each in its colour, the last on top, with a cursor at `time`; nothing after `seen`. */
  draw(runs, window, isZoomed, time, seen = Infinity) {
    this.runs = runs;
    this.window = window;
    this.isZoomed = isZoomed;
    this.canvas.setAttribute("aria-label", isMoment(runs) ? NO_CURVES : "Curves over time");
    const key = runs.map(({ run, color }) => [run.digest, color]);
    this.show(
      key,
      time,
      (pen, width, height) => this.panels(pen, runs, width, height),
      (pen, width, height) => {
        this.panelsOf(runs, height).forEach(({ ends }) => this.cover(pen, seen, ends));
        this.values(pen, runs, time, seen, width, height);
      },
    );
  }

  /** The values at the cursor, in the upper right corner of each panel. */
  values(pen, runs, time, seen, width, height) {
    if (isMoment(runs)) return;
    pen.textAlign = "right";
    this.panelsOf(runs, height).forEach(({ quantity, ends: [top] }) => {
      const shown = [...runs].reverse().flatMap(({ run, color }) => {
        const constant = seen < run.end ? null : constantOf(run, quantity);
        if (time > run.end && constant === null) return [];
        const value = constant ?? run.columns[quantity.name][indexAt(run.columns.time, time)];
        return [{ color, text: (form) => valueText(value, quantity, form, constant !== null) }];
      });
      const room = width - RIGHT - LABEL - pen.measureText(panelLabel(quantity)).width;
      const widthIn = (form) => shown.reduce((sum, { text }) => sum + pen.measureText(text(form)).width + GAP, 0);
      const forms = runs.length > 1 ? FORMS.slice(1) : FORMS;
      const form = forms.find((form) => widthIn(form) <= room) ?? FORMS.at(-1);
      let x = width - RIGHT;
      for (const { color, text } of shown) {
        pen.fillStyle = color;
        pen.fillText(text(form), x, top - 5);
        x -= pen.measureText(text(form)).width + GAP;
      }
    });
  }

  /** The quantities of the edited run, each with the upper and lower end of its panel. */
  panelsOf(runs, height) {
    const shown = quantities(runs.at(-1).run);
    const each = (height - FOOT) / shown.length;
    return shown.map((quantity, panel) => ({ quantity, ends: [panel * each + HEAD, (panel + 1) * each - 5] }));
  }

  panels(pen, runs, width, height) {
    const style = getComputedStyle(this.canvas);
    if (isMoment(runs)) {
      pen.fillStyle = style.color;
      pen.textAlign = "left";
      pen.fillText(NO_CURVES, 8, HEAD);
      return;
    }
    const times = ticks(...this.window, Math.max(width / 90, 2));
    for (const { quantity, ends } of this.panelsOf(runs, height)) this.panel(pen, runs, quantity, ends, times, style);
    pen.textAlign = "center";
    pen.fillStyle = style.color;
    for (const time of times) pen.fillText(written(time), this.xOf(time), height - FOOT + 8);
    pen.fillText("time (s)", LEFT + this.across / 2, height - 6);
  }

  panel(pen, runs, quantity, [top, bottom], times, style) {
    const { name, ofAxis = (value) => value } = quantity;
    const { across } = this;
    const envelopes = runs.map(({ run }) => envelope(run, name, this.window, across));
    const scale = Math.max(...runs.map(({ run }) => scaleOf(run, quantity)));
    const isConstant = runs.every(({ run }) => constantOf(run, quantity) !== null);
    const [low, high] = axisRange(envelopes, quantity, scale, this.isZoomed, isConstant);
    const y = (value) => bottom - ((value - low) / (high - low)) * (bottom - top);
    const yOfAxis = (value) => bottom - ((value - ofAxis(low)) / (ofAxis(high) - ofAxis(low))) * (bottom - top);
    pen.fillStyle = style.getPropertyValue("--line");
    for (const time of times) pen.fillRect(this.xOf(time), top, 1, bottom - top);
    // A quantity that stays zero has no size for other ticks.
    const marks = isConstant && low === -high ? [0] : axisTicks(ofAxis(low), ofAxis(high), Math.max((bottom - top) / 22, 2.5));
    let free = Infinity; // below the numbers that have been written
    for (const value of marks) {
      pen.fillStyle = style.getPropertyValue("--line");
      pen.fillRect(LEFT, yOfAxis(value), across, 1);
      // A number at the upper end stays below the panel's title.
      const baseline = Math.max(yOfAxis(value) + 4, top + 8);
      if (baseline > free) continue;
      free = baseline - NUMBER_HEIGHT;
      pen.fillStyle = style.color;
      pen.textAlign = "right";
      pen.fillText(written(value), LEFT - 6, baseline, LEFT - 8);
    }
    pen.save();
    pen.beginPath();
    pen.rect(LEFT, top, across, bottom - top);
    pen.clip();
    runs.forEach(({ run, color }, index) => this.curve(pen, run, color, quantity.mean, envelopes[index], y));
    pen.restore();
    pen.fillStyle = style.color;
    pen.textAlign = "left";
    pen.fillText(panelLabel(quantity), LABEL, top - 5);
  }

  /** A band of the samples' values, and a line of the averages over nutations. */
  curve(pen, run, color, mean, { low, high }, y) {
    const means = mean && run.cycles.length > 3 ? run.cycles : [];
    pen.fillStyle = color;
    pen.globalAlpha = means.length > 0 ? 0.4 : 1;
    low.forEach((least, pixel) => {
      const [upper, lower] = [y(high[pixel]), y(least)];
      if (lower >= upper) pen.fillRect(LEFT + pixel, upper - 0.8, 1, lower - upper + 1.6);
    });
    pen.globalAlpha = 1;
    pen.strokeStyle = color;
    pen.lineWidth = 1.8;
    pen.beginPath();
    for (const cycle of means) pen.lineTo(this.xOf(cycle[0]), y(cycle[mean]));
    pen.stroke();
  }
}

export const CURVE_MARGINS = { left: LEFT, right: RIGHT, head: HEAD };
