// Measured values over their best fit.

import { axisTicks, ticks } from "./axes.mjs";
import { degrees, written } from "./numbers.mjs";

const FIT_EDGES = { left: 52, right: 10, head: 20, foot: 30 };
/** Radius of a measured value, px: where there are many, they must not hide the best fit. */
const DOT_SIZES = { few: 2.2, many: 1 };
const MANY_DOTS = 200;

/** What fields are called; others by their paths. */
const MEASURED_NAMES = { theta: "tilt θ", phi: "precession angle φ", psi: "spin angle ψ", "omega_body.z": "spin about the axis ω·n" };
export const measuredName = (path) => MEASURED_NAMES[path] ?? path;

/** What a field is called with its topic. */
export const fieldName = (path) => measuredName(path.replace("/top/state.", ""));

/** The part of the values that sets the range of the axis: the others may be outliers. */
const USUAL_PART = 0.98;

/** The range of an axis: that of the best fit, and of the usual values. */
export function measuredRange(curve, values) {
  const sorted = [...values].sort((a, b) => a - b);
  const cut = Math.floor(((1 - USUAL_PART) / 2) * sorted.length);
  const [low, high] = [Math.min(...curve, sorted[cut]), Math.max(...curve, sorted.at(-1 - cut))];
  const room = 0.08 * (high - low) || 0.05 * Math.abs(high) || 1;
  return [low - room, high + room];
}

/** Draws the values of a signal in a window of time, dots, over the best fit, a line. Angles are drawn in degrees. */
export function drawMeasured(canvas, { path, unit, points }, { from, until, curve }) {
  const isAngle = unit === "rad";
  const shown = isAngle ? degrees : (value) => value;
  const within = points.filter(([time]) => time >= from && time <= until).map(([time, value]) => [time, shown(value)]);
  const line = curve.value.map(shown);
  const [low, high] = measuredRange(line, within.map(([, value]) => value));
  const { left, right, head, foot } = FIT_EDGES;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const ratio = devicePixelRatio || 1;
  [canvas.width, canvas.height] = [Math.max(width * ratio, 1), Math.max(height * ratio, 1)];
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  pen.font = "12px system-ui, sans-serif";
  const style = getComputedStyle(canvas);
  const [across, bottom] = [Math.max(width - left - right, 1), height - foot];
  const x = (time) => left + ((time - from) / (until - from)) * across;
  const y = (value) => bottom - ((value - low) / (high - low)) * (bottom - head);

  pen.textAlign = "right";
  for (const value of axisTicks(low, high, Math.max((bottom - head) / 30, 2))) {
    pen.fillStyle = style.getPropertyValue("--line");
    pen.fillRect(left, y(value), across, 1);
    pen.fillStyle = style.color;
    pen.fillText(written(value), left - 6, y(value) + 4);
  }
  pen.textAlign = "center";
  for (const time of ticks(from, until, Math.max(across / 90, 2))) {
    pen.fillStyle = style.getPropertyValue("--line");
    pen.fillRect(x(time), head, 1, bottom - head);
    pen.fillStyle = style.color;
    pen.fillText(written(time), x(time), bottom + 14);
  }
  pen.fillText("time since the start (s)", left + across / 2, height - 3);
  const outside = within.filter(([, value]) => value < low || value > high).length;
  pen.textAlign = "left";
  pen.fillText(`${measuredName(path)} (${isAngle ? "°" : unit})${outside > 0 ? `, ${outside} values are outside` : ""}`, 4, 12);

  pen.beginPath();
  pen.rect(left, head, across, bottom - head);
  pen.clip();
  pen.strokeStyle = style.getPropertyValue("--b");
  pen.lineWidth = 1.5;
  pen.beginPath();
  curve.time.forEach((time, index) => pen.lineTo(x(time), y(line[index])));
  pen.stroke();
  pen.fillStyle = style.color;
  pen.globalAlpha = 0.6;
  const dot = within.length > MANY_DOTS ? DOT_SIZES.many : DOT_SIZES.few;
  for (const [time, value] of within) {
    pen.beginPath();
    pen.arc(x(time), y(value), dot, 0, 2 * Math.PI);
    pen.fill();
  }
}
