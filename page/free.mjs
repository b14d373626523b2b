// What a fit is asked for, and with which errors, in the words of the page.

import { WORDS, keyName } from "./names.mjs";
import { withUnit, written } from "./numbers.mjs";

/** Groups of keys that the program knows by these words. */
const GROUPS = { friction: "friction", start: "start", initial: "start" };

/** The keys that people find first, in the order of the sliders, by short names without symbols. */
const SHORT_NAMES = {
  k: "friction.k",
  spin: "initial.psi_dot",
  tilt: "initial.theta",
  precession: "initial.phi_dot",
  "change of tilt": "initial.theta_dot",
  "precession angle": "initial.phi",
  "spin angle": "initial.psi",
};

/** The keys on which a motion depends; other angles at the start only turn it. */
const DETERMINING = ["friction.k", "initial.theta", "initial.theta_dot", "initial.phi_dot", "initial.psi_dot"];

/** A name in one spelling: accents of symbols are characters of their own. */
const spelled = (text) => text.trim().replaceAll(/[\s._]+/g, " ").toLowerCase().normalize("NFD");

/** The Greek symbols and the long names of the sliders, such as ψ̇ and spin ψ̇. */
const longNames = Object.entries(WORDS).flatMap(([path, name]) => {
  const last = name.split(" ").at(-1);
  return [[name, path], ...(/\p{Script=Greek}/u.test(last) ? [[last, path]] : [])];
});
const LONG_NAMES = Object.fromEntries(longNames.map(([name, path]) => [spelled(name), path]));

/**
 * The free parameters of a text such as "k, spin": groups, and keys of these `keys`, the applicable ones. A name that is
 * none is an error in words.
 */
export function freeParameters(text, keys) {
  const paths = new Set(keys.map(({ path }) => path));
  const free = [];
  for (const word of text.split(/,|\band\b/i).filter((word) => word.trim() !== "")) {
    const name = spelled(word);
    const path = SHORT_NAMES[name] ?? LONG_NAMES[name] ?? [...paths].find((each) => spelled(each) === name);
    if (GROUPS[name]) free.push(GROUPS[name]);
    else if (paths.has(path)) free.push(path);
    else {
      const known = Object.entries(SHORT_NAMES).filter(([, each]) => paths.has(each));
      return { error: `“${word.trim()}” is nothing that can be found. Write friction, start, or some of ${known.map(([short]) => short).join(", ")}, with commas between them.` };
    }
  }
  return { free: free.join(",") };
}

/** The errors of angles in the form of the program; empty if they are unknown. */
export function angleError(text) {
  const sigma = text.trim().replace(/^(?:±|\+\/?[-−])\s*/, "").replace(",", ".");
  if (sigma === "") return { sigma };
  const [, number] = sigma.match(/^(\d+\.?\d*(?:e[+-]?\d+)?|\.\d+)\s*(?:[^\d\s.+-].*)?$/i) ?? [];
  if (Number(number) > 0) return { sigma };
  return { error: `“${text.trim()}” is no error of an angle: write a positive number of degrees, such as 0.3, or one with its unit, such as 5 mrad.` };
}

/** What a fit of these parameters held at the values of its scenario, in words; empty if nothing. */
export function heldText(names, { keys, values: texts }) {
  const applicable = DETERMINING.flatMap((path) => keys.find((key) => key.path === path) ?? []);
  const held = applicable.filter(({ path }) => !names.includes(path) && (texts[path] ?? "") !== "");
  const values = held.map(({ path, unit }) => `${keyName(path)} = ${withUnit(written(Number(texts[path]), 5), unit)}`);
  return values.length > 0 ? `Held at ${values.join(", ")}: the result holds only if ${values.length > 1 ? "these are" : "this is"} right.` : "";
}
