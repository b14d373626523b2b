// Ranges and ticks of axes.

const TICKS = [1, 2, 5, 10];

/** A value that varies by less than this part of its scale looks constant in all digits that the page shows. */
const CONSTANT = 1e-6;

/** The least span of an axis, in parts of the quantity's scale: in the whole run, and when zoomed in. */
const LEAST_SPAN = { whole: 0.2, zoomed: 0.01 };

/** The first index whose time is not before `time`. */
export function indexAt(times, time) {
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < time) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The least of 1, 2 and 5 times a power of ten that is not below `value`. */
export function roundedUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  const digit = TICKS.find((tick) => tick * power >= value * (1 - 1e-9));
  return Number((digit * power).toPrecision(1));
}

/** About `wanted` round numbers between `low` and `high`. */
export function ticks(low, high, wanted) {
  const step = roundedUp((high - low) / wanted);
  const first = Math.ceil(low / step);
  const count = Math.floor(high / step) - first + 1;
  return Array.from({ length: Math.max(count, 0) }, (_, index) => Number(((first + index) * step).toPrecision(12)));
}

/** Round numbers between `low` and `high`: about `wanted`, but at least two, because a single one shows no scale. */
export function axisTicks(low, high, wanted) {
  let marks = ticks(low, high, wanted);
  for (let more = wanted + 1; marks.length < 2 && high > low; more++) marks = ticks(low, high, more);
  return marks;
}

/** So many samples suffice for the usual size of a quantity; all of them take longer than drawing. */
const USUAL_SAMPLES = 2000;

/** The largest magnitude of a column; for spiky ones, without the rare spikes. */
function magnitude(run, name, isSpiky) {
  const column = run.columns[name];
  if (!isSpiky) return column.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  const stride = Math.ceil(column.length / USUAL_SAMPLES);
  const sizes = Float64Array.from({ length: Math.ceil(column.length / stride) }, (_, index) => Math.abs(column[index * stride])).sort();
  return sizes[Math.round(0.98 * (sizes.length - 1))];
}

/**
 * The size of a quantity in a run, by which to judge its changes. A rate that is near zero by nature (θ̇) is judged
 * by a part of another, `like`.
 */
export function scaleOf(run, { name, like, isSpiky }) {
  run.scales ??= {};
  run.scales[name] ??= Math.max(magnitude(run, name, isSpiky), like ? like.part * magnitude(run, like.name, true) : 0);
  return run.scales[name];
}

/** The value of a quantity that doesn't change in a run; null if it does. */
export function constantOf(run, quantity) {
  run.constants ??= {};
  run.constants[quantity.name] ??= (() => {
    const values = run.columns[quantity.name];
    const low = values.reduce((least, value) => Math.min(least, value), Infinity);
    const high = values.reduce((most, value) => Math.max(most, value), -Infinity);
    return { value: high - low <= CONSTANT * scaleOf(run, quantity) ? (low + high) / 2 : null };
  })();
  return run.constants[quantity.name].value;
}

/** The lowest and highest value of envelopes, without rare spikes of spiky quantities. */
function extent(envelopes, isSpiky) {
  const lows = envelopes.flatMap(({ low }) => [...low].filter(Number.isFinite)).sort((a, b) => a - b);
  const highs = envelopes.flatMap(({ high }) => [...high].filter(Number.isFinite)).sort((a, b) => a - b);
  if (lows.length === 0) return [0, 0];
  const robust = (sorted, part, end) => {
    const [usual, bottom, top] = [part, 0.02, 0.98].map((each) => sorted[Math.round(each * (sorted.length - 1))]);
    return isSpiky && top > bottom && Math.abs(end - usual) > 3 * (top - bottom) ? usual : end;
  };
  return [robust(lows, 0.02, lows[0]), robust(highs, 0.98, highs.at(-1))];
}

/** The range of an axis: the envelopes with padding, but never so narrow that noise fills it. Constants are shown with zero, to which their size compares. */
export function axisRange(envelopes, { isSpiky }, scale, isZoomed, isConstant = false) {
  const [low, high] = extent(envelopes, isSpiky);
  if (isConstant && !isZoomed) {
    const [least, most] = [Math.min(low, 0), Math.max(high, 0)];
    const room = 0.06 * (most - least) || 1;
    return most > least ? [least - room, most + room] : [-room, room];
  }
  const least = (isZoomed ? LEAST_SPAN.zoomed : LEAST_SPAN.whole) * scale || 1;
  const span = Math.max(1.12 * (high - low), least);
  const middle = (low + high) / 2;
  return [middle - span / 2, middle + span / 2];
}
