// All keys of a scenario as controls, made from the program's list of the keys that apply.

import { element } from "./elements.mjs";
import { imagined, typed, written } from "./numbers.mjs";

const SLIDER_STEPS = 1000;
const SECTIONS = [
  ["Friction", ["friction"]],
  ["Start", ["initial"]],
  ["Top", ["top", "gravity"]],
  ["Support", ["support"]],
  ["Other losses", ["rolling", "drilling", "air"]],
  ["Stop conditions and integrator", ["stop", "sampling", "integrator", "formulation"]],
];

/** The positions of a slider: the usual values of a key, as far as they are valid. */
export function sliderRange({ typical, range }) {
  const [low, high] = typical;
  if (!range) return [low, high];
  const valid = [Math.max(low, range[0]), Math.min(high, range[1])];
  return valid[0] < valid[1] ? valid : range;
}

/** Whether a slider's positions are spaced by factors. */
const isLogarithmic = (key) => key.is_logarithmic && sliderRange(key)[0] > 0;

/** The position of a value on a slider, from 0 to 1, and the value at a position. */
export function placeOf(key, value) {
  const [low, high] = sliderRange(key);
  return isLogarithmic(key) ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
}
export function valueAt(key, place) {
  const [low, high] = sliderRange(key);
  return isLogarithmic(key) ? low * (high / low) ** place : low + place * (high - low);
}

/** Whether a number is in the range of a key. */
const isValid = ({ range }, value) => !range || (value >= range[0] && value <= range[1]);

/** A short number within the valid range: the range's ends may have many digits (the next number above 0.02), so it is rounded inward. */
export function validText(key, value) {
  for (const digits of [3, 5, 8]) {
    const unit = 10 ** (Math.floor(Math.log10(Math.abs(value) || 1)) + 1 - digits);
    const texts = [value, value + unit, value - unit].map((each) => typed(each, digits));
    const valid = texts.find((text) => isValid(key, Number(text)));
    if (valid !== undefined) return valid;
  }
  return String(value);
}

/**
 * The shortest number that is nearer to a slider's position than to its neighbours, so that every round value has a
 * position: `0.04` instead of `0.0399`.
 */
export function roundText(key, place, step) {
  const value = valueAt(key, place);
  const [low, high] = [place - step / 2, place + step / 2].map((each) => valueAt(key, each));
  const texts = [1, 2, 3, 4, 5].map((digits) => typed(value, digits));
  const isNear = (number) => number >= low && number < high && isValid(key, number);
  return texts.find((text) => isNear(Number(text))) ?? validText(key, value);
}

/** The name of a choice: its key without the dot. */
const choiceName = (path) => path.replace(".", " ").replaceAll("_", " ").replace(/ kind$/, "");

/** The label of a key: its symbol (or its name, for a number without a symbol) and a short description. */
function labelOf({ path, symbol, meaning, label, words: choices }) {
  const [letter, index] = (symbol ?? "").split("_");
  const name = path.split(".").at(-1).replaceAll("_", " ");
  // A choice shows its words itself; a label that begins with the name says it already.
  if (choices) return element("span", { className: "label", title: `${path}: ${meaning}` }, element("small", { textContent: choiceName(path) }));
  const isNamed = label.startsWith(name);
  const sign = symbol ? [element("i", { textContent: letter }), element("sub", { textContent: index ?? "" }), " "] : isNamed ? [] : [`${name} `];
  return element("span", { className: "label", title: `${path}: ${meaning}` }, ...sign, element("small", { textContent: label }));
}

function choice(scenario, key, changed) {
  const options = key.words.map((word) => element("option", { textContent: word }));
  if (!key.is_required) options.unshift(element("option", { value: "", textContent: key.default ? `default (${key.default})` : "not set" }));
  const select = element("select", { onchange: () => changed(key, select.value) }, ...options);
  select.value = scenario.value(key.path) ?? "";
  return [select];
}

/** A number's text in its field: exact, unless it has more digits than people write. */
const fieldText = (value) => (value && value.length > 8 && Number.isFinite(Number(value)) ? typed(Number(value), 5) : (value ?? ""));

function number(scenario, key, changed) {
  const value = () => scenario.value(key.path);
  const slider = element("input", { type: "range", min: 0, max: SLIDER_STEPS, ariaLabel: key.path });
  const label = `${key.path}, ${key.unit || "a number"}`;
  const box = element("input", { type: "text", inputMode: "decimal", value: fieldText(value()), placeholder: "none", ariaLabel: label, title: value() ?? "" });
  const unit = element("small");
  const update = () => {
    slider.value = value() === undefined ? 0 : SLIDER_STEPS * placeOf(key, Number(value()));
    const also = value() === undefined ? "" : imagined(Number(value()), key.unit);
    unit.replaceChildren(key.unit, ...(also ? [element("br"), also] : []));
  };
  update();
  slider.oninput = () => {
    box.value = validText(key, valueAt(key, slider.value / SLIDER_STEPS));
    changed(key, box.value);
    update();
  };
  box.oninput = () => {
    changed(key, box.value.trim());
    update();
  };
  return { parts: [slider, box, unit], update, box };
}

/** The picture of μ(v), as large as its values. */
function curvePicture(curve) {
  const largest = Math.max(...curve.map(([, value]) => value), Number.MIN_VALUE);
  const end = curve.at(-1)[0];
  const points = curve.map(([speed, value]) => `${(100 * speed) / end},${40 - (38 * value) / largest}`).join(" ");
  return `<svg viewBox="0 0 100 40" role="img" aria-label="μ from v = 0 to ${written(end, 2)} m/s, up to ${written(largest, 2)}"><polyline points="${points}" /></svg>`;
}

/** The field of a formula, with its curve. */
function formula(scenario, key, changed) {
  const box = element("input", { type: "text", value: scenario.value(key.path) ?? "", ariaLabel: "μ(v) =", spellcheck: false });
  const picture = element("span", { className: "curve" });
  const update = () => {
    box.title = scenario.value(key.path) ?? "";
    picture.innerHTML = key.curve ? curvePicture(key.curve) : "";
  };
  update();
  box.oninput = () => changed(key, box.value.trim());
  return { parts: [box, picture], update, box };
}

/** The controls of a scenario in `place`. `changed(key, value)` is called on input. */
export class Controls {
  constructor(place, changed) {
    this.place = place;
    this.changed = changed;
  }

  /** Shows the keys that apply. Controls that are there already only get their new ranges and values. */
  show(scenario, keys) {
    const shape = JSON.stringify(keys.map(({ path, words }) => [path, words, words && scenario.value(path)]));
    if (this.scenario === scenario && this.shape === shape) {
      for (const key of keys) Object.assign(this.keys.get(key.path), key);
    } else {
      this.scenario = scenario;
      this.shape = shape;
      this.keys = new Map(keys.map((key) => [key.path, { ...key }]));
      this.build();
    }
    this.update();
  }

  build() {
    const active = document.activeElement;
    const focused = active?.closest?.(".key")?.dataset.path;
    const open = new Set([...this.place.querySelectorAll("details[open]")].map((section) => section.dataset.name));
    this.numbers = new Map();
    const sections = SECTIONS.map(([name, prefixes]) => {
      const keys = [...this.keys.values()].filter(({ path }) => prefixes.includes(path.split(".")[0]));
      const rows = keys.map((key) => this.row(key));
      const section = element("details", { open: open.has(name) }, element("summary", { textContent: name }), ...rows);
      section.dataset.name = name;
      return section;
    });
    this.place.replaceChildren(...sections);
    const again = focused && this.place.querySelector(`[data-path="${focused}"] :is(select, input)`);
    again?.focus();
    // A formula is still being typed when the first of its parameters appear.
    if (again?.type === "text" && again !== active) {
      again.value = active.value;
      again.setSelectionRange(active.selectionStart, active.selectionEnd);
    }
  }

  row(key) {
    const row = element("label", { className: "key" }, labelOf(key));
    row.dataset.path = key.path;
    if (key.words) row.append(...choice(this.scenario, key, this.changed));
    else {
      const made = (key.range ? number : formula)(this.scenario, key, this.changed);
      row.append(...made.parts);
      this.numbers.set(key.path, made);
    }
    return row;
  }

  /** Takes over values that were changed elsewhere, and marks the keys that differ from the preset. */
  update() {
    for (const row of this.place.querySelectorAll(".key")) row.classList.toggle("changed", row.dataset.path in this.scenario.set);
    for (const [path, { box, update }] of this.numbers) {
      update();
      if (box !== document.activeElement) box.value = fieldText(this.scenario.value(path));
    }
  }
}
