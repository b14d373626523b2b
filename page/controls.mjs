// Form controls for the scenario keys, generated from the program's key table.

const STEPS = 1000;
const SECTIONS = [
  ["Friction", ["friction"], true],
  ["Start", ["initial"], true],
  ["Top", ["top", "gravity"]],
  ["Support", ["support"]],
  ["Other losses", ["rolling", "drilling", "air"]],
  ["Stop conditions and integrator", ["stop", "sampling", "integrator", "formulation"]],
];

export function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

/** Formats a number for an input field. */
const typed = (value) => String(Number(value.toPrecision(4)));

/** Convert between a value and its slider position (0 to 1). */
const placeOf = ({ typical: [low, high], logarithmic }, value) =>
  logarithmic ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
const valueAt = ({ typical: [low, high], logarithmic }, place) =>
  logarithmic ? low * (high / low) ** place : low + place * (high - low);

/** The label of a key: its symbol (or its name, for a number without a symbol) and a short description. */
function label({ path, symbol, meaning, typical }) {
  const [letter, index] = (symbol ?? "").split("_");
  const name = typical ? [`${path.split(".").at(-1).replaceAll("_", " ")} `] : [];
  const sign = symbol ? [element("i", { textContent: letter }), element("sub", { textContent: index ?? "" }), " "] : name;
  const words = meaning.split(/[;:(]/)[0].split(" ").filter((word) => word !== symbol).join(" ");
  return element("span", { className: "label", title: `${path}: ${meaning}` }, ...sign, element("small", { textContent: words }));
}

function choice(scenario, key, changed) {
  const options = key.words.map((word) => element("option", { textContent: word }));
  if (!key.required) options.unshift(element("option", { value: "", textContent: "default" }));
  const select = element("select", { onchange: () => changed(key.path, select.value, true) }, ...options);
  select.value = scenario.values[key.path] ?? "";
  return [select];
}

function number(scenario, key, changed) {
  const value = () => scenario.values[key.path];
  const slider = element("input", { type: "range", min: 0, max: STEPS, ariaLabel: key.path });
  const box = element("input", { type: "text", inputMode: "decimal", value: value() ?? "", placeholder: "none", ariaLabel: `${key.path}, ${key.unit || "a number"}`, title: key.range });
  const move = () => (slider.value = value() === undefined ? 0 : STEPS * placeOf(key, Number(value())));
  move();
  slider.oninput = () => {
    box.value = typed(valueAt(key, slider.value / STEPS));
    changed(key.path, box.value);
  };
  box.oninput = () => {
    changed(key.path, box.value.trim());
    move();
  };
  return [slider, box, element("small", { textContent: key.unit })];
}

/** Renders the controls of a scenario into `place`. `changed(path, value, follows)` is called on input; `follows` is true if other keys may change too. */
export function controls(place, scenario, changed) {
  const open = new Map([...place.querySelectorAll("details")].map((section) => [section.dataset.name, section.open]));
  const sections = SECTIONS.map(([name, prefixes, isOpen]) => {
    const keys = scenario.keys.filter((key) => prefixes.includes(key.path.split(".")[0]) && scenario.applies(key));
    const rows = keys.map((key) => {
      const parts = key.words ? choice(scenario, key, changed) : number(scenario, key, changed);
      const row = element("label", { className: "key" }, label(key), ...parts);
      row.dataset.path = key.path;
      return row;
    });
    const section = element("details", { open: open.get(name) ?? Boolean(isOpen) }, element("summary", { textContent: name }), ...rows);
    section.dataset.name = name;
    return section;
  });
  place.replaceChildren(...sections);
}
