// Curves over time. Each pixel column shows the minimum and maximum of its samples, so no nutation is lost.

const LEFT = 64;
const RIGHT = 12;
const HEAD = 16; // above each panel, for its label and values
const FOOT = 30;
const TICKS = [1, 2, 5, 10];

/** Curves for fixed and free pegs: column, label, unit, index of its mean in a nutation cycle. */
const FIXED = [
  ["theta", "θ", "rad", 1],
  ["phi_dot", "φ̇", "rad/s", 2],
  ["theta_dot", "θ̇", "rad/s", 3],
  ["psi_dot", "ψ̇", "rad/s", 4],
  ["slip_speed", "slip", "m/s"],
  ["energy", "energy", "J"],
];
const FREE = [
  ["theta", "θ", "rad", 1],
  ["theta_dot", "θ̇", "rad/s", 3],
  ["axial_rate", "ω·n", "rad/s"],
  ["slip_speed", "slip", "m/s"],
  ["height", "height", "m"],
  ["energy", "energy", "J"],
];

export const quantities = (run) => (run.is_free ? FREE : FIXED).filter(([name]) => name !== "height" || run.flies);

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

/** About `wanted` round numbers between `low` and `high`. */
function ticks(low, high, wanted) {
  const rough = (high - low) / wanted;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = TICKS.find((tick) => tick * power >= rough) * power;
  const first = Math.ceil(low / step);
  const count = Math.floor(high / step) - first + 1;
  return Array.from({ length: Math.max(count, 0) }, (_, index) => Number(((first + index) * step).toPrecision(12)));
}

/** The minimum and maximum of a quantity in each pixel column of a time window. */
function envelope(run, name, [from, to], width) {
  const times = run.columns.time;
  const values = run.columns[name];
  const low = new Float64Array(width).fill(Infinity);
  const high = new Float64Array(width).fill(-Infinity);
  const first = Math.max(indexAt(times, from) - 1, 0);
  const last = Math.min(indexAt(times, to) + 1, times.length - 1);
  let before;
  for (let index = first; index <= last; index++) {
    const value = values[index];
    const pixel = Math.floor(((times[index] - from) / (to - from)) * width);
    // Interpolates linearly in pixel columns between two samples.
    for (let x = Math.max(before?.pixel ?? pixel, 0); x <= Math.min(pixel, width - 1); x++) {
      const span = pixel - (before?.pixel ?? pixel);
      const part = span > 1 ? (x - before.pixel) / span : 1;
      const at = part === 1 || !before ? value : before.value + part * (value - before.value);
      low[x] = Math.min(low[x], at);
      high[x] = Math.max(high[x], at);
    }
    before = { pixel, value };
  }
  return { low, high };
}

/** Euler rates, which have spikes where the axis passes the vertical. */
const SPIKY = ["phi_dot", "psi_dot"];

/** The y range of the envelopes with padding. For spiky quantities, rare spikes are ignored. */
function range(envelopes, isSpiky) {
  const lows = envelopes.flatMap(({ low }) => [...low].filter(Number.isFinite)).sort((a, b) => a - b);
  const highs = envelopes.flatMap(({ high }) => [...high].filter(Number.isFinite)).sort((a, b) => a - b);
  if (lows.length === 0) return [0, 1];
  const robust = (sorted, part, end) => {
    const usual = sorted[Math.round(part * (sorted.length - 1))];
    const spread = sorted[Math.round(0.98 * (sorted.length - 1))] - sorted[Math.round(0.02 * (sorted.length - 1))];
    return isSpiky && Math.abs(end - usual) > 3 * spread && spread > 0 ? usual : end;
  };
  const low = robust(lows, 0.02, lows[0]);
  const high = robust(highs, 0.98, highs.at(-1));
  const air = 0.06 * (high - low) || 0.05 * Math.abs(high) || 1;
  return [low - air, high + air];
}

export class Curves {
  /** Draws on a canvas; `choose` is called with a time, `zoom` with a window of time. */
  constructor(canvas, { choose, zoom }) {
    this.canvas = canvas;
    this.window = [0, 1];
    const timeAt = (event) => {
      const { left, width } = canvas.getBoundingClientRect();
      const part = (event.clientX - left - LEFT) / (width - LEFT - RIGHT);
      return this.window[0] + Math.min(Math.max(part, 0), 1) * (this.window[1] - this.window[0]);
    };
    const scale = (event) => {
      if (!event.ctrlKey && !event.metaKey) return; // let the page scroll; a pinch gesture sets ctrlKey
      event.preventDefault();
      const at = timeAt(event);
      const factor = Math.exp(event.deltaY / 400);
      zoom(this.window.map((end) => at + (end - at) * factor));
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      choose(timeAt(event));
    });
    canvas.addEventListener("pointermove", (event) => event.buttons && choose(timeAt(event)));
    canvas.addEventListener("wheel", scale, { passive: false });
    canvas.addEventListener("dblclick", () => zoom(null));
  }

  /** Draws the curves of runs, each in its colour, the last on top, with a cursor at `time`. */
  draw(runs, window, time) {
    const { canvas } = this;
    const ratio = devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const key = JSON.stringify([width, height, ratio, window, runs.map(({ run, color }) => [run.digest, color])]);
    this.window = window;
    if (key !== this.key) {
      this.key = key;
      this.image = document.createElement("canvas");
      [this.image.width, this.image.height] = [width * ratio, height * ratio];
      const pen = this.image.getContext("2d");
      pen.scale(ratio, ratio);
      this.panels(pen, runs, width, height);
    }
    [canvas.width, canvas.height] = [width * ratio, height * ratio];
    const pen = canvas.getContext("2d");
    pen.drawImage(this.image, 0, 0);
    pen.scale(ratio, ratio);
    const x = LEFT + ((time - window[0]) / (window[1] - window[0])) * (width - LEFT - RIGHT);
    pen.fillStyle = getComputedStyle(canvas).color;
    if (x >= LEFT && x <= width - RIGHT) pen.fillRect(x - 0.5, 0, 1, height - FOOT);
    this.values(pen, runs, time, width, height);
  }

  /** The values at the cursor, in the upper right corner of each panel. */
  values(pen, runs, time, width, height) {
    const shown = quantities(runs.at(-1).run);
    const each = (height - FOOT) / shown.length;
    pen.font = "12px system-ui";
    pen.textAlign = "right";
    shown.forEach(([name], panel) => {
      runs.forEach(({ run, color }, index) => {
        const column = run.columns[name];
        const end = run.columns.time.at(-1);
        if (!column || time > end) return;
        pen.fillStyle = color;
        const value = column[indexAt(run.columns.time, time)];
        pen.fillText(Number(value.toPrecision(5)), width - RIGHT - 84 * (runs.length - 1 - index), panel * each + HEAD - 4);
      });
    });
  }

  panels(pen, runs, width, height) {
    const style = getComputedStyle(this.canvas);
    const shown = quantities(runs.at(-1).run);
    const each = (height - FOOT) / shown.length;
    const across = Math.max(Math.round(width - LEFT - RIGHT), 1);
    const x = (time) => LEFT + ((time - this.window[0]) / (this.window[1] - this.window[0])) * across;
    pen.font = "12px system-ui";
    const grid = style.getPropertyValue("--line");
    const times = ticks(...this.window, Math.max(width / 110, 2));
    shown.forEach(([name, label, unit, mean], panel) => {
      const [top, bottom] = [panel * each + HEAD, (panel + 1) * each - 4];
      const drawn = runs.filter(({ run }) => run.columns[name]);
      const envelopes = drawn.map(({ run }) => envelope(run, name, this.window, across));
      const [low, high] = range(envelopes, SPIKY.includes(name));
      const y = (value) => bottom - ((value - low) / (high - low)) * (bottom - top);
      pen.fillStyle = grid;
      for (const time of times) pen.fillRect(x(time), top, 1, bottom - top);
      for (const value of ticks(low, high, 3)) {
        pen.fillStyle = grid;
        pen.fillRect(LEFT, y(value), across, 1);
        pen.fillStyle = style.color;
        pen.textAlign = "right";
        pen.fillText(value, LEFT - 6, y(value) + 4, LEFT - 8);
      }
      pen.save();
      pen.beginPath();
      pen.rect(LEFT, top, across, bottom - top);
      pen.clip();
      drawn.forEach(({ run, color }, index) => {
        const { low: lows, high: highs } = envelopes[index];
        const means = mean && run.cycles.length > 3 ? run.cycles : [];
        pen.fillStyle = color;
        pen.globalAlpha = means.length > 0 ? 0.45 : 1;
        lows.forEach((least, pixel) => {
          const [upper, lower] = [y(highs[pixel]), y(least)];
          if (lower >= upper) pen.fillRect(LEFT + pixel, upper - 0.6, 1, lower - upper + 1.2);
        });
        pen.globalAlpha = 1;
        pen.strokeStyle = color;
        pen.lineWidth = 1.6;
        pen.beginPath();
        for (const cycle of means) pen.lineTo(x(cycle[0]), y(cycle[mean]));
        pen.stroke();
      });
      pen.restore();
      pen.fillStyle = style.color;
      pen.textAlign = "left";
      pen.fillText(`${label} (${unit})`, LEFT, top - 4);
    });
    pen.textAlign = "center";
    for (const time of times) pen.fillText(time, x(time), height - FOOT + 4);
    pen.fillText("time (s)", LEFT + across / 2, height - 6);
  }
}
