// Numbers and units as people write them.

const PREFIXES = [[1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]];
const SUPERSCRIPTS = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

/** A number for an input field, which the program reads: `0.03`, `4.4e-5`. */
export function typed(value, digits = 4) {
  const short = Number(value.toPrecision(digits));
  const size = Math.abs(short);
  return size === 0 || (size >= 1e-3 && size < 1e6) ? String(short) : short.toExponential().replace("e+", "e");
}

/** A number for reading: `−0.03`, `4.4 × 10⁻⁵`. */
export function written(value, digits = 4) {
  const [mantissa, exponent] = typed(value, digits).replaceAll("-", "−").split("e");
  if (!exponent) return mantissa;
  const raised = [...exponent.replace("−", "-")].map((sign) => SUPERSCRIPTS[sign]).join("");
  return `${mantissa} × 10${raised}`;
}

/** A number with its unit, which a line never ends between. */
export const withUnit = (number, unit) => (unit ? `${number}\u00a0${unit}` : number);

/** The SI prefix that suits values of a size, with its factor. */
export const prefixFor = (size) => PREFIXES.find(([factor]) => size >= 0.9995 * factor) ?? (size === 0 ? PREFIXES[0] : PREFIXES.at(-1));

/** A quantity with an SI prefix: `5 mN`. */
export function prefixed(value, unit, digits = 3) {
  const [factor, prefix] = prefixFor(Math.abs(value));
  return `${written(value / factor, digits)} ${prefix}${unit}`;
}

/** A number with a fixed count of decimals and a true minus sign. */
export const fixed = (value, decimals) => value.toFixed(decimals).replace(/^-(?=.*[1-9])/, "−").replace("-", "");

export const degrees = (radians) => (radians * 180) / Math.PI;
export const revolutions = (rate) => rate / (2 * Math.PI);

/** The same value in the unit in which people picture it: degrees or turns per second; empty for other units. */
export function imagined(value, unit) {
  if (!Number.isFinite(value)) return "";
  if (unit === "rad") return `${fixed(degrees(value), 1)}°`;
  if (unit === "rad/s") return `${written(revolutions(value), 3)} rev/s`;
  return "";
}
