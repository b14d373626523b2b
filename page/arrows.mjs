// The arrows of the 3D view and their scales.

import { indexAt, roundedUp } from "./axes.mjs";
import { fixed, prefixFor } from "./numbers.mjs";

/** Longest and shortest drawn length of the largest value in a run, in sizes of the top. */
const LONGEST = 1.2;
const SHORTEST = 0.05;

/**
 * The quantities that can be drawn: columns, unit, what the program calls it, and `natural`, the value that is drawn
 * `length` sizes long. It depends on the top alone, so that all runs of a top have one scale.
 */
export const ARROWS = {
  slip: {
    label: "slip velocity",
    symbol: "v",
    columns: ["slip_x", "slip_y"],
    unit: "m/s",
    color: "#3a7de8",
    length: 0.8,
    natural: ({ top, shape }) => Math.sqrt(2 * top.gravity * shape.size),
  },
  force: {
    label: "friction force",
    symbol: "F",
    columns: ["friction_x", "friction_y"],
    unit: "N",
    color: "#e8833a",
    length: 0.9,
    natural: ({ top }) => 0.1 * top.weight,
  },
  torque: {
    label: "friction torque",
    symbol: "τ",
    columns: ["torque_x", "torque_y", "torque_z"],
    unit: "N m",
    color: "#d6336c",
    length: 1,
    natural: ({ top }) => 0.1 * top.weight * top.peg_radius,
  },
  momentum: {
    label: "angular momentum",
    symbol: "L",
    columns: ["momentum_x", "momentum_y", "momentum_z"],
    unit: "N m s",
    color: "#2b9348",
    length: 1.1,
    natural: ({ top, shape }) => 10 * top.axial_moment * Math.sqrt(top.gravity / shape.size),
  },
};

/** The colour of an arrow's label: mixed with that of text, because the arrows' own are too light to read. */
export const labelColor = (color, ink) => `color-mix(in srgb, ${color} 60%, ${ink})`;

/** A vector of a run at a sample, in the world. */
export function vectorAt({ columns }, { columns: [x, y, z] }, index) {
  return [columns[x][index], columns[y][index], z ? columns[z][index] : 0];
}

/** The largest magnitude of a vector in a run. */
function boundOf(run, name) {
  run.bounds ??= {};
  run.bounds[name] ??= run.columns.time.reduce((most, _, index) => Math.max(most, Math.hypot(...vectorAt(run, ARROWS[name], index))), 0);
  return run.bounds[name];
}

/**
 * The value per metre of arrow, a round number, common to the runs that are drawn. It changes only if an arrow would
 * leave the picture, or be too short to be seen.
 */
export function arrowScale(runs, name) {
  const { length, natural } = ARROWS[name];
  const size = Math.max(...runs.map(({ shape }) => shape.size));
  const bound = Math.max(...runs.map((run) => boundOf(run, name)));
  // Divided by the middle between two round numbers, so that the nearest is taken.
  let scale = roundedUp(Math.max(...runs.map(natural)) / (1.5 * length * size));
  while (bound > LONGEST * size * scale) scale = roundedUp(1.5 * scale);
  while (bound > 0 && bound < SHORTEST * size * scale) scale /= 10;
  return scale;
}

/** The angular momentum of a run at a time, in the unit of its largest value: `horizontal 5.90, vertical 10.95 mN m s`. */
export function momentumParts(run, time) {
  const { momentum } = ARROWS;
  const [x, y, z] = vectorAt(run, momentum, indexAt(run.columns.time, Math.min(time, run.end)));
  const [factor, prefix] = prefixFor(boundOf(run, "momentum"));
  const [flat, upright] = [Math.hypot(x, y), z].map((part) => fixed(part / factor, 2));
  return `horizontal ${flat}, vertical ${upright} ${prefix}${momentum.unit}`;
}

/** The power of ten of a metre that suits a scale bar beside the runs. */
export const barLength = (runs) => 10 ** Math.round(Math.log10(Math.max(...runs.map(({ shape }) => shape.size)) / 5));
