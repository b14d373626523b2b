// Sentences of the program: lists of typed pieces, written for readers of the page.

import { keyName } from "./names.mjs";
import { imagined, withUnit } from "./numbers.mjs";

/** A number with its unit, and in degrees where it is an angle. */
function numberText({ text, value, unit, has_unit: hasUnit }) {
  const own = hasUnit ? withUnit(text, unit) : text;
  return unit === "rad" ? `${own} (${imagined(value, unit)})` : own;
}

/** How the page writes each kind of piece. */
const WRITTEN = {
  text: (text) => text,
  number: numberText,
  time: numberText,
  estimate: ({ text, error_text: error, unit }) => withUnit(`${text} ± ${error}`, unit),
  count: ({ count, noun }) => withUnit(count.toLocaleString("en"), count === 1 ? noun : plural(noun)),
  key: keyName,
  field: (path) => path,
  argument: ({ name, value }) => value ?? name,
};

/** A noun after a number other than 1, as the program forms it. */
const plural = (noun) => (noun.endsWith("y") ? `${noun.slice(0, -1)}ies` : `${noun}s`);

/** A sentence as text. */
export function sentenceText(pieces) {
  return pieces.map((piece) => Object.entries(piece).map(([kind, content]) => WRITTEN[kind](content)).join("")).join("");
}
