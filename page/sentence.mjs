// Sentences of the program: lists of typed pieces, written for readers of the page.

import { fieldName } from "./measured.mjs";
import { keyName } from "./names.mjs";
import { degrees, fixed, withUnit } from "./numbers.mjs";

const NO_BREAK = "\u00a0";

/** Radians in degrees, with the digits that a text of the radians has: the second decimal of degrees is the fourth of radians. */
function inDegrees(radians, text) {
  const decimals = text.split(".")[1]?.length ?? 0;
  return `${fixed(degrees(radians), Math.max(decimals - 2, 1))}°`;
}

/** A number with its unit, and in degrees where it is an angle. */
function numberText({ text, value, unit, has_unit: hasUnit }) {
  const own = hasUnit ? withUnit(text, unit) : text;
  return unit === "rad" && Number.isFinite(value) ? `${own} (${inDegrees(value, text)})` : own;
}

/** A value with its error, in one line. */
const withError = (value, error) => `${value}${NO_BREAK}±${NO_BREAK}${error}`;

/** A value with its error and unit, and in degrees where it is an angle. */
function estimateText({ text, error_text: errorText, value, error, unit, has_unit: hasUnit }) {
  const own = withError(text, hasUnit ? withUnit(errorText, unit) : errorText);
  return unit === "rad" ? `${own} (${withError(inDegrees(value, text), inDegrees(error, errorText))})` : own;
}

/** The title that a column needs for a signal such as "theta=tilt (deg)": `theta (deg)`. */
function columnTitle(signal) {
  const [field, column] = signal.split("=");
  const unit = column.includes("(") ? ` ${column.slice(column.indexOf("("))}` : "";
  return `${field}${unit}`;
}

/** What the page has for a signal: titles of columns in the file, and one field for the errors of all angles. */
function signalText(signal) {
  if (!signal) return "the line that names the columns";
  const error = signal.match(/=.*:([^\s:]+)$/);
  if (error) return `“angles are right to ± ${error[1]}”`;
  return signal.includes("=") ? columnTitle(signal) : "a table with the columns t and theta";
}

/** What the page has for arguments of the program. */
const ARGUMENTS = {
  signal: signalText,
  time: (value) => value ?? "the title t",
  start: (value) => (value ? `a file that starts at ${withUnit(value, "s")}` : "the first row"),
  until: (value) => (value ? `a file that ends at ${withUnit(value, "s")}` : "the last row"),
  delimiter: () => "commas, semicolons or tabs between the cells",
  decimal: (value) => (value === "," ? "semicolons or tabs between the cells" : "numbers with decimal points"),
  free: () => "the parameters to find",
  set: () => "the sliders",
  bound: () => "the program's option --bound",
  loss: (value) => `the program's option --loss ${value}`,
  all: () => "the program's option --all",
};

/** How the page writes each kind of piece. */
const WRITTEN = {
  text: (text) => text,
  number: numberText,
  time: numberText,
  estimate: estimateText,
  count: ({ count, noun }) => withUnit(count.toLocaleString("en"), count === 1 ? noun : plural(noun)),
  key: keyName,
  field: fieldName,
  argument: ({ name, values }) => ARGUMENTS[name](values[0]),
};

/** A noun after a number other than 1, as the program forms it. */
const plural = (noun) => (noun.endsWith("y") ? `${noun.slice(0, -1)}ies` : `${noun}s`);

/** A sentence as text. */
export function sentenceText(pieces) {
  return pieces.map((piece) => Object.entries(piece).map(([kind, content]) => WRITTEN[kind](content)).join("")).join("");
}
