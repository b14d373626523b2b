// The large sliders: friction, spin and tilt; and friction's switch.

import { placeOf, roundText, sliderRange } from "./controls.mjs";
import { element } from "./elements.mjs";
import { degrees, fixed, revolutions, written } from "./numbers.mjs";

/** Not more than a slider has pixels: each position must be in a mouse's reach. */
export const KNOB_STEPS = 250;

const KNOBS = [
  {
    path: "friction.k",
    name: "Friction",
    symbol: "k",
    ends: ["slippery", "rough"],
    range: [0.003, 0.3],
    text: (value) => [written(value), ""],
  },
  {
    path: "initial.psi_dot",
    name: "Spin",
    symbol: "ψ̇",
    ends: ["slow", "fast"],
    range: [0, 300],
    text: (value) => [`${fixed(revolutions(value), 1)} rev/s`, `${written(value)} rad/s`],
    // The picture shows the spin about the axis, which contains a part of the precession.
    note: (scenario) => {
      const [psi, phi, theta] = ["psi_dot", "phi_dot", "theta"].map((name) => scenario.number(`initial.${name}`));
      const rate = psi + phi * Math.cos(theta);
      return Number.isFinite(rate) ? `ω·n = ψ̇ + φ̇ cos θ = ${fixed(revolutions(rate), 1)} rev/s` : "";
    },
  },
  {
    path: "initial.theta",
    name: "Tilt",
    symbol: "θ",
    ends: ["nearly upright", "lying"],
    // Below, it has risen before anything can be seen.
    range: [0.06, 1.45],
    text: (value) => [`${fixed(degrees(value), 1)}°`, `${written(value)} rad`],
  },
];

/** The usual values of a knob, widened so that they contain the present one. */
function spanOf({ range }, value) {
  const [low, high] = range;
  return Number.isFinite(value) ? [Math.min(low, value), Math.max(high, value)] : range;
}

export class Knobs {
  /** `changed(key, value)` is called on input; `toggled(isOn)` when friction is switched on or off. */
  constructor(place, { changed, toggled }) {
    this.knobs = KNOBS.map((knob) => this.make(knob, changed));
    this.friction = element("input", { type: "checkbox", id: "friction", onchange: () => toggled(this.friction.checked) });
    const label = element("label", { className: "switch", title: "Friction on or off" }, this.friction, "on");
    this.knobs[0].row.querySelector(".name").append(label);
    place.replaceChildren(...this.knobs.map(({ row }) => row));
  }

  make(knob, changed) {
    const id = `knob-${knob.path.split(".").at(-1)}`;
    const value = element("output", { htmlFor: id });
    const slider = element("input", { type: "range", id, min: 0, max: KNOB_STEPS, ariaLabel: knob.name });
    const name = element("span", { className: "name" }, element("label", { htmlFor: id }, `${knob.name} `, element("i", { textContent: knob.symbol })));
    const note = element("small", { title: "Spin about the axis at the start, as in the picture" });
    const [low, high] = knob.ends.map((textContent) => element("small", { textContent }));
    const ends = element("span", { className: "ends" }, low, note, high);
    const row = element("div", { className: "knob" }, name, value, slider, ends);
    row.dataset.knob = knob.path;
    const made = { ...knob, row, slider, value, noted: note, key: null, sent: null };
    slider.oninput = () => {
      const text = roundText(made.key, slider.value / KNOB_STEPS, 1 / KNOB_STEPS);
      made.sent = Number(text);
      this.print(made, made.sent);
      changed(made.key, text);
    };
    return made;
  }

  print({ value, text, slider }, number) {
    const [main, also] = Number.isFinite(number) ? text(number) : ["none", ""];
    value.replaceChildren(element("b", { textContent: main }), also ? ` ${also}` : "");
    slider.setAttribute("aria-valuetext", `${main} ${also}`);
  }

  show(scenario, keys) {
    this.friction.checked = scenario.value("friction.law") !== "none";
    for (const knob of this.knobs) {
      const key = keys.find(({ path }) => path === knob.path);
      const value = scenario.number(knob.path);
      knob.key = key && { ...key, typical: spanOf(knob, value) };
      knob.slider.disabled = !key;
      this.print(knob, value);
      knob.noted.textContent = knob.note?.(scenario) ?? "";
      // A slider that is being moved stays where the finger is: its text is rounded.
      if (key && value !== knob.sent) knob.slider.value = KNOB_STEPS * placeOf(knob.key, value);
      knob.sent = value;
      knob.slider.title = key ? `${sliderRange(knob.key).map((end) => knob.text(end)[0]).join(" to ")}` : "";
    }
  }
}
