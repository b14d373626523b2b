// The edited scenario: a preset and its changed keys. The program decides which keys apply, and their ranges.

export class Scenario {
  constructor(presets, name, set = {}) {
    // For an unknown preset, toprise reports the error.
    this.preset = presets.find((preset) => preset.name === name) ?? { name, values: {} };
    this.set = { ...set };
  }

  /** The value of a key as text; undefined if it isn't set. */
  value(path) {
    const value = this.set[path] ?? this.preset.values[path];
    return value === "" ? undefined : value;
  }

  number(path) {
    return Number(this.value(path));
  }

  /** Sets a key; an empty text removes it. */
  put(path, value) {
    if (value === (this.preset.values[path] ?? "")) delete this.set[path];
    else this.set[path] = value;
  }

  /** The keys in a section that are set, with their values. */
  section(prefix) {
    const paths = new Set([...Object.keys(this.preset.values), ...Object.keys(this.set)]);
    const own = [...paths].filter((path) => path.startsWith(prefix) && this.value(path) !== undefined);
    return Object.fromEntries(own.map((path) => [path, this.value(path)]));
  }

  /** The scenario as a request to toprise. */
  get request() {
    return { preset: this.preset.name, set: { ...this.set } };
  }

  get command() {
    // A shell takes a formula apart unless it is quoted.
    const quoted = (text) => (/^[\w.,=:+-]*$/.test(text) ? text : `'${text}'`);
    const words = Object.entries(this.set).map(([path, value]) => ` --set ${quoted(`${path}=${value}`)}`);
    return `toprise run ${this.preset.name}${words.join("")}`;
  }
}

/** Link of a scenario: `paper&friction.k=0.02`. */
export const linkOf = ({ preset, set }) => [preset, ...Object.entries(set).map(([path, value]) => `${path}=${value}`)].join("&");

/** URL-decodes a part of a link; returns it unchanged if it is malformed. */
function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** The preset and keys of a scenario's link. */
export function scenarioFrom(link) {
  const [preset, ...set] = link.split("&");
  return [preset, Object.fromEntries(set.map((change) => [change.split("=")[0], change.slice(change.indexOf("=") + 1)]))];
}

/**
 * Parses a link: `#paper&friction.k=0.02`, followed by `&vs=` and the pinned scenario, `&lesson=` and the number of a
 * step, `&at=` and the time in seconds. `#lesson=2` alone stands for the scenarios of that step.
 */
export function parseLink(hash) {
  const [before, moment] = hash.replace(/^#/, "").split("&at=");
  const [scenarios, lesson] = before.split(/&?lesson=/);
  const [ours, theirs] = scenarios.split("&vs=").map(decoded);
  return { ours, theirs, lesson: Number(lesson) || 0, moment: moment === undefined ? null : Number(moment) || 0 };
}
