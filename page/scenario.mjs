// A scenario as the page changes it: a preset's values, and what is set in them.

const TEXTS = ["format", "name", "description"];
/** What a free peg needs, as `--set support.kind=free` says. */
const FOR_FREE_PEGS = { formulation: "body", "friction.dissipation": "full" };

export class Scenario {
  constructor(tables, preset, set = {}) {
    this.tables = tables;
    this.keys = tables.keys.filter(({ path }) => !TEXTS.includes(path));
    this.start(preset);
    for (const [path, value] of Object.entries(set)) this.put(path, value);
  }

  /** Starts from a preset; toprise says what is wrong with one that it doesn't know. */
  start(name) {
    this.preset = this.tables.presets.find((preset) => preset.name === name) ?? { name, values: {} };
    this.values = { ...this.preset.values };
  }

  put(path, value) {
    if (value === "") delete this.values[path];
    else this.values[path] = value;
  }

  /** Sets a key, and what other keys then need; those without a meaning go. */
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

  /** Whether a key has a meaning with the values of the others. */
  applies({ needs, of }) {
    if (!needs) return true;
    return of.length === 0 ? this.values[needs] !== undefined : of.includes(this.values[needs]);
  }

  /** A value to begin with: that of the first preset with this key, or one in the middle. */
  usual({ path, words, typical }) {
    const known = this.tables.presets.find((preset) => preset.values[path] !== undefined);
    return known?.values[path] ?? words?.[0] ?? String(typical[0] > 0 ? Math.sqrt(typical[0] * typical[1]) : typical[1] / 2);
  }

  /** What differs from the preset; empty for a key that it has and this one has not. */
  get set() {
    const paths = new Set([...this.keys.map(({ path }) => path), ...Object.keys(this.values)]);
    const changed = [...paths].filter((path) => this.values[path] !== this.preset.values[path]);
    return Object.fromEntries(changed.map((path) => [path, this.values[path] ?? ""]));
  }

  /** As toprise is asked for it. */
  get given() {
    return { preset: this.preset.name, set: this.set };
  }

  get command() {
    const words = Object.entries(this.set).map(([path, value]) => ` --set ${path}=${value}`);
    return `toprise run ${this.preset.name}${words.join("")}`;
  }
}
