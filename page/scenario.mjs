// The edited scenario: a preset and its changed keys.

const TEXTS = ["format", "name", "description"];
/** Keys required by `support.kind = "free"`. */
const FOR_FREE_PEGS = { formulation: "body", "friction.dissipation": "full" };

export class Scenario {
  constructor(tables, preset, set = {}) {
    this.tables = tables;
    this.keys = tables.keys.filter(({ path }) => !TEXTS.includes(path));
    this.start(preset);
    for (const [path, value] of Object.entries(set)) this.put(path, value);
  }

  /** Starts from a preset. For an unknown name, toprise reports the error. */
  start(name) {
    this.preset = this.tables.presets.find((preset) => preset.name === name) ?? { name, values: {} };
    this.values = { ...this.preset.values };
  }

  put(path, value) {
    if (value === "") delete this.values[path];
    else this.values[path] = value;
  }

  /** Sets a key, adds the keys it requires, and removes those that no longer apply. */
  change(path, value) {
    this.put(path, value);
    if (path === "support.kind" && value === "free") {
      Object.assign(this.values, FOR_FREE_PEGS);
      this.values["stop.duration"] ??= "10";
    }
    for (const key of this.keys) {
      if (!this.applies(key)) delete this.values[key.path];
      else if (key.required && this.values[key.path] === undefined) this.values[key.path] = this.usual(key);
    }
  }

  /** Whether a key applies with the values of the other keys. */
  applies({ needs, of }) {
    if (!needs) return true;
    return of.length === 0 ? this.values[needs] !== undefined : of.includes(this.values[needs]);
  }

  /** Default value of a key: from the first preset that has it, or the middle of its range. */
  usual({ path, words, typical }) {
    const known = this.tables.presets.find((preset) => preset.values[path] !== undefined);
    return known?.values[path] ?? words?.[0] ?? String(typical[0] > 0 ? Math.sqrt(typical[0] * typical[1]) : typical[1] / 2);
  }

  /** The changed keys; an empty value marks a removed key. */
  get set() {
    const paths = new Set([...this.keys.map(({ path }) => path), ...Object.keys(this.values)]);
    const changed = [...paths].filter((path) => this.values[path] !== this.preset.values[path]);
    return Object.fromEntries(changed.map((path) => [path, this.values[path] ?? ""]));
  }

  /** The scenario as passed to toprise. */
  get given() {
    return { preset: this.preset.name, set: this.set };
  }

  get command() {
    const words = Object.entries(this.set).map(([path, value]) => ` --set ${path}=${value}`);
    return `toprise run ${this.preset.name}${words.join("")}`;
  }
}
