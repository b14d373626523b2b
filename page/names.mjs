// Names of runs: the preset and the keys that differ from it.

import { withUnit, written } from "./numbers.mjs";

/** What people call the keys of the sliders and their like. */
export const WORDS = {
  "friction.k": "friction k",
  "initial.theta": "tilt θ",
  "initial.phi": "precession angle φ",
  "initial.psi": "spin angle ψ",
  "initial.theta_dot": "change of tilt θ̇",
  "initial.phi_dot": "precession φ̇",
  "initial.psi_dot": "spin ψ̇",
  "initial.height": "height of the peg",
  "initial.peg_x": "place of the peg along x",
  "initial.peg_y": "place of the peg along y",
  "initial.peg_x_dot": "velocity of the peg along x",
  "initial.peg_y_dot": "velocity of the peg along y",
  "initial.peg_z_dot": "velocity of the peg upward",
  "initial.center_x": "place of the centre along x",
  "initial.center_y": "place of the centre along y",
  "initial.center_x_dot": "velocity of the centre along x",
  "initial.center_y_dot": "velocity of the centre along y",
  "stop.duration": "time limit",
};

/** A key in words: `spin ψ̇`, `friction viscous speed`. */
export const keyName = (path) => WORDS[path] ?? path.replaceAll(/[._]/g, " ");

/** A number as it is read, other values as they are. */
const writtenValue = (value) => (value !== "" && Number.isFinite(Number(value)) ? written(Number(value), 5) : value);

/** A changed key: `friction k = 0.06`, `spin ψ̇ = 100 rad/s`, `without friction viscous speed`. */
function changeText(path, value, keys) {
  if (value === "") return `without ${keyName(path)}`;
  const unit = keys.find((key) => key.path === path)?.unit;
  return `${keyName(path)} = ${withUnit(writtenValue(value), unit)}`;
}

/** Changed keys in words, with their paths and values. Friction that is off is one change: its other keys went with it. */
function namedChanges({ set }, keys) {
  const isOff = set["friction.law"] === "none";
  const others = Object.entries(set)
    .filter(([path]) => !isOff || !path.startsWith("friction."))
    .map(([path, value]) => ({ path, value, text: changeText(path, value, keys) }));
  return isOff ? [{ path: "friction.law", value: "none", text: "without friction" }, ...others] : others;
}

/**
 * The parts of a run's name, those that distinguish it from `other` first. The preset is left out where it doesn't: if
 * both have the same and the run has changes.
 */
export function nameParts(run, other) {
  const { scenario, keys } = run;
  // A time limit is no property of the top, and only shortens its name where there is little room.
  const changes = namedChanges(scenario, keys).filter(({ path }) => !path.startsWith("stop.") || scenario.preset === other.preset);
  const isNew = ({ path, value }) => other.set[path] !== value;
  const inOrder = [...changes.filter(isNew), ...changes.filter((change) => !isNew(change))];
  const isUnnamed = scenario.preset === other.preset && changes.length > 0;
  return [...(isUnnamed ? [] : [run.title]), ...inOrder.map(({ text }) => text)];
}

/** More changes than these are counted in a run's name. */
const MAX_NAMED = 2;

/** Many changes, counted. A law of friction is named: a preset without friction would seem to have none. */
function countedChanges(changes) {
  const law = changes.find(({ path }) => path === "friction.law");
  return law ? [law.text, `${changes.length - 1} more values changed`] : [`${changes.length} values changed`];
}

/** The name of a run in a sentence: its preset's title, and what differs from the preset. Its outcome says when it ends. */
export function runName(run) {
  const changes = namedChanges(run.scenario, run.keys).filter(({ path }) => path !== "stop.duration");
  const named = changes.length > MAX_NAMED ? countedChanges(changes) : changes.map(({ text }) => text);
  return [run.title, ...named].join(", ");
}

/**
 * A name in at most `most` lines that are no wider than `width`, broken between parts only; an ellipsis stands for parts
 * that don't fit. A single part may be wider.
 */
export function nameLines(letter, parts, { widthOf, width, most = 2 }) {
  const lines = [`${letter}: ${parts[0]}`];
  for (const [index, part] of parts.entries()) {
    if (index === 0) continue;
    const isLast = index === parts.length - 1;
    const joined = `${lines.at(-1)}, ${part}`;
    if (widthOf(joined) <= width && (isLast || lines.length < most || widthOf(`${joined}, …`) <= width)) lines[lines.length - 1] = joined;
    else if (lines.length < most) {
      lines[lines.length - 1] += ",";
      lines.push(part);
    } else {
      lines[lines.length - 1] += ", …";
      break;
    }
  }
  return lines;
}
