// Names of runs: the preset and the keys that differ from it.

import { written } from "./numbers.mjs";

/** A number as it is read, other values as they are. */
const writtenValue = (value) => (value !== "" && Number.isFinite(Number(value)) ? written(Number(value), 5) : value);

/** A changed key: `k = 0.06`, `ψ̇ = 100 rad/s`, `without friction.viscous_speed`. */
function changeText(path, value, keys) {
  const key = keys.find((key) => key.path === path);
  const name = key?.symbol ?? path.split(".").at(-1).replaceAll("_", " ");
  if (value === "") return `without ${name}`;
  return `${name} = ${writtenValue(value)}${key?.unit ? ` ${key.unit}` : ""}`;
}

/**
 * The parts of a run's name, those that distinguish it from `other` first. The preset is left out where it doesn't: if
 * both have the same and the run has changes.
 */
export function nameParts({ scenario: { preset, set }, keys }, other) {
  const changes = Object.entries(set);
  const isNew = ([path, value]) => other.set[path] !== value;
  const inOrder = [...changes.filter(isNew), ...changes.filter((change) => !isNew(change))];
  const isUnnamed = preset === other.preset && changes.length > 0;
  return [...(isUnnamed ? [] : [preset]), ...inOrder.map(([path, value]) => changeText(path, value, keys))];
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
