// 3D view of the top at a time of the run.

import { ARROWS, arrowScale, barLength, labelColor, vectorAt } from "./arrows.mjs";
import { indexAt } from "./axes.mjs";
import { gestures } from "./gestures.mjs";
import { Labels, besideArrow } from "./labels.mjs";
import { nameLines, nameParts } from "./names.mjs";
import { degrees, fixed, prefixed, revolutions, written } from "./numbers.mjs";
import { isHidden, spinRing } from "./ring.mjs";
import { orientationOf, shadowOf, stripeContrast, turned, visibleFaces } from "./shape.mjs";

const TRAIL = 3; // s, shown of the axis's path
const MAX_TRAIL = 3000; // samples of it; fewer would draw a fast axis's circles as polygons
const FAINT = 0.25; // opacity of what is behind the body
const STRIPED = 2 / 9; // part of a turn that the stripes cover
const START = { azimuth: -0.6, elevation: 0.35, closeness: 1 };
const NARROW = 420; // px, width of a picture without room for radians
const MIN_WORDS = 250; // px, width of a picture with words beside symbols
const FONT = "system-ui, sans-serif";
const TITLE_FONT = `600 13px ${FONT}`;
const NAME_FONT = `600 14px ${FONT}`;
const BUTTON = [100, 30]; // px, of the button that resets the view
const LOW = 320; // px, height of a picture whose top the lines of its title would reach
const TITLE_LINE = 18; // px

/** The pose at a time: sample index, orientation, direction of the axis and position of the peg's centre. */
function pose(run, time) {
  const c = run.columns;
  const i = indexAt(c.time, time);
  const q = [c.qw[i], c.qx[i], c.qy[i], c.qz[i]];
  return { i, q, axis: turned(q, [0, 0, 1]), peg: [c.peg_x[i], c.peg_y[i], c.peg_z[i]] };
}

const along = (place, direction, length) => place.map((value, axis) => value + length * direction[axis]);

/** A camera that looks at the top: `project` maps places of the world to the canvas. */
class Camera {
  constructor({ azimuth, elevation, closeness }, focus, size, width, height) {
    this.focus = focus;
    const [ca, sa, ce, se] = [Math.cos(azimuth), Math.sin(azimuth), Math.cos(elevation), Math.sin(elevation)];
    /** World to camera coordinates: right, up, towards the camera. */
    this.seen = (place) => {
      const [x, y, z] = place.map((value, axis) => value - focus[axis]);
      const [right, away] = [ca * x + sa * y, -sa * x + ca * y];
      return [right, ce * z + se * away, se * z - ce * away];
    };
    const fitted = Math.min(width / (width > height ? 2.4 : 2), height / 1.75);
    this.zoom = (closeness * fitted) / size;
    /** The direction towards the camera, in the world. */
    this.toward = [ce * sa, -ce * ca, se];
    this.onScreen = ([right, up]) => [width / 2 + this.zoom * right, height / 2 + 0.49 * fitted - this.zoom * up];
    this.project = (place) => this.onScreen(this.seen(place));
  }
}

export class View {
  /** Draws on a canvas; `redraw` is called when the view is turned. `shown` names the arrows that are drawn. */
  constructor(canvas, redraw) {
    this.canvas = canvas;
    this.shown = { slip: true, force: true, torque: false, momentum: false };
    this.look = { ...START };
    this.keptPlaces = [{}, {}];
    this.redraw = redraw;
    gestures(canvas, {
      drag: (_, dx, dy) => this.turn(-dx / 120, dy / 150),
      pinch: ({ factor }) => this.approach(factor),
    });
  }

  turn(azimuth, elevation) {
    this.look.azimuth += azimuth;
    this.look.elevation = Math.min(Math.max(this.look.elevation + elevation, 0.02), 1.5);
    this.redraw();
  }

  approach(factor) {
    this.look.closeness = Math.min(Math.max(this.look.closeness * factor, 0.3), 5);
    this.redraw();
  }

  reset() {
    this.look = { ...START };
    // Names stay where they fit; the first picture has them at their best places.
    this.keptPlaces = [{}, {}];
    this.redraw();
  }

  /** Draws runs side by side, each with its colour. `exposure` is the time of the run between two pictures, 0 if playback is paused. */
  draw(runs, time, exposure) {
    const { canvas } = this;
    const ratio = devicePixelRatio || 1;
    const [wide, height] = [canvas.clientWidth, canvas.clientHeight];
    [canvas.width, canvas.height] = [wide * ratio, height * ratio];
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    const style = getComputedStyle(canvas);
    this.colors = Object.fromEntries(["line", "ink", "soft", "table", "card"].map((name) => [name, style.getPropertyValue(`--${name}`)]));
    const width = wide / runs.length;
    const all = runs.map(({ run }) => run);
    const names = Object.keys(ARROWS).filter((name) => this.shown[name]);
    this.scales = Object.fromEntries(names.map((name) => [name, arrowScale(all, name)]));
    const size = Math.max(...all.map(({ shape }) => shape.size));
    runs.forEach(({ run, color, letter }, index) => {
      pen.save();
      pen.translate(index * width, 0);
      pen.beginPath();
      pen.rect(0, 0, width, height);
      pen.clip();
      this.labels = new Labels(width, height, this.keptPlaces[index]);
      if (index === 0) this.labels.cover([0, height - BUTTON[1], BUTTON[0], height]);
      this.one(pen, run, color, Math.min(time, run.end), exposure, { size, width, height });
      const parts = runs.length > 1 ? nameParts(run, all[1 - index].scenario) : [];
      this.title(run, color, { letter, parts }, time, width, height);
      if (this.isSunk) this.note(sunkNote(width < NARROW), height);
      if (index === runs.length - 1) this.bar(pen, all, width, height);
      for (const { words, place, paint, font } of this.labels.placed()) this.text(words, place, paint, font);
      pen.restore();
    });
  }

  one(pen, run, color, time, exposure, { size, width, height }) {
    const { i, q, axis, peg } = pose(run, time);
    const focus = run.is_free ? [peg[0], peg[1], 0] : [0, 0, 0];
    const camera = new Camera(this.look, focus, size, width, height);
    Object.assign(this, { pen, camera, width });
    this.table(focus, size);
    this.fill(shadowOf(run.shape, q, peg), "#0000001c");
    this.path(run, i, color);
    const contrast = stripeContrast(run.columns.axial_rate[i], exposure);
    // The facets would strobe as the stripes do: a body without stripes is drawn without its spin.
    this.isSunk = this.body(run, contrast > 0 ? q : orientationOf(axis), peg, color, contrast);
    this.angle(run, axis, peg);
    this.spin(run, i, axis, peg);
    if (this.shown.momentum) this.momentum(run, i, peg);
    const foot = [peg[0], peg[1], 0];
    if (!run.columns.flying[i]) {
      for (const name of ["slip", "force"]) if (this.shown[name]) this.arrow(name, foot, vectorAt(run, ARROWS[name], i));
    }
    // The torque changes the angular momentum: it is drawn at the end of the horizontal part of that, which it shortens.
    const from = this.shown.momentum ? this.flatTip(run, i, peg) : peg;
    if (this.shown.torque) this.arrow("torque", from, vectorAt(run, ARROWS.torque, i), { offset: this.shown.momentum ? 8 : 0 });
  }

  line(places, stroke, thickness, dash = []) {
    const { pen, camera } = this;
    pen.strokeStyle = stroke;
    pen.lineWidth = thickness;
    pen.setLineDash(dash);
    pen.beginPath();
    for (const place of places) pen.lineTo(...camera.project(place));
    pen.stroke();
    pen.setLineDash([]);
  }

  fill(places, color) {
    const { pen, camera } = this;
    pen.fillStyle = color;
    pen.beginPath();
    for (const place of places) pen.lineTo(...camera.project(place));
    pen.closePath();
    pen.fill();
  }

  widthOf(words, font) {
    this.pen.font = font;
    return this.pen.measureText(words).width;
  }

  /** Text with a halo, so that it can be read on everything. */
  text(words, [x, y], color, font = TITLE_FONT, align = "left") {
    const { pen, colors } = this;
    const wide = this.widthOf(words, font);
    pen.textAlign = "left";
    const start = x - { left: 0, center: wide / 2, right: wide }[align];
    // Labels of long arrows stay in the picture.
    const left = Math.max(Math.min(start, this.width - wide - 3), 3);
    pen.lineJoin = "round";
    pen.lineWidth = 4;
    pen.strokeStyle = colors.card;
    pen.strokeText(words, left, y);
    pen.fillStyle = color;
    pen.fillText(words, left, y);
  }

  /** A round table below the top, with a grid that stays where it is. */
  table(focus, size) {
    const radius = 1.3 * size;
    const rim = Array.from({ length: 61 }, (_, k) => {
      const angle = (k * Math.PI) / 30;
      return [focus[0] + radius * Math.cos(angle), focus[1] + radius * Math.sin(angle), 0];
    });
    this.fill(rim, this.colors.table);
    const step = size / 4;
    for (let k = -6; k <= 6; k++) {
      const [x, y] = [0, 1].map((axis) => (Math.round(focus[axis] / step) + k) * step);
      const across = Math.sqrt(Math.max(radius ** 2 - (x - focus[0]) ** 2, 0));
      const ahead = Math.sqrt(Math.max(radius ** 2 - (y - focus[1]) ** 2, 0));
      this.line([[x, focus[1] - across, 0], [x, focus[1] + across, 0]], this.colors.line, 1);
      this.line([[focus[0] - ahead, y, 0], [focus[0] + ahead, y, 0]], this.colors.line, 1);
    }
    this.line(rim, this.colors.line, 2);
  }

  /** The path of the axis's tip in the last seconds, which fades; and that of a free peg on the table. */
  path(run, last, color) {
    const c = run.columns;
    const first = indexAt(c.time, c.time[last] - TRAIL);
    const step = Math.max(Math.floor((last - first) / MAX_TRAIL), 1);
    const tips = [];
    const feet = [];
    for (let i = last; i >= first; i -= step) {
      const peg = [c.peg_x[i], c.peg_y[i], c.peg_z[i]];
      tips.push(along(peg, turned([c.qw[i], c.qx[i], c.qy[i], c.qz[i]], [0, 0, 1]), run.shape.tip));
      feet.push([peg[0], peg[1], 0]);
    }
    this.fading(tips, color, 2);
    if (run.is_free) this.fading(feet, color, 1.5);
  }

  /** A line from its newest place to its oldest, in steps of opacity. */
  fading(places, color, thickness) {
    const PARTS = 12;
    const each = Math.ceil(places.length / PARTS);
    for (let part = PARTS - 1; part >= 0; part--) {
      this.pen.globalAlpha = 0.75 * (1 - part / PARTS);
      this.line(places.slice(part * each, (part + 1) * each + 1), color, thickness);
    }
    this.pen.globalAlpha = 1;
  }

  /** Draws the body as far as it is above the table. Returns whether a part of it is below. */
  body(run, q, peg, color, contrast) {
    const { pen, camera } = this;
    const paints = { body: color, rim: color, cap: "#f2c14e", stem: "#6b4f3a", peg: "#8d99ae" };
    const [onStripe, beside] = [STRIPED + (1 - STRIPED) * contrast, STRIPED * (1 - contrast)].map((share) => (100 * share).toFixed(0));
    const { faces, isSunk } = visibleFaces(run.shape, q, peg, camera.seen);
    for (const { corners, light, paint, isStripe } of faces) {
      const plain = paints[paint];
      const isStriped = paint === "body" || paint === "rim" || paint === "cap";
      const fill = isStriped ? `color-mix(in srgb, #fffaf0 ${isStripe ? onStripe : beside}%, ${plain})` : plain;
      pen.fillStyle = pen.strokeStyle = `color-mix(in srgb, ${fill} ${Math.round(100 * light)}%, black)`;
      pen.lineWidth = 0.6;
      pen.beginPath();
      for (const corner of corners) pen.lineTo(...camera.onScreen(corner));
      pen.closePath();
      pen.fill();
      pen.stroke();
    }
    return isSunk;
  }

  /** The vertical, the axis and the arc of θ between them. */
  angle(run, axis, peg) {
    const { tip } = run.shape;
    const { soft, ink } = this.colors;
    const radius = 1.12 * tip;
    for (const places of [[peg, along(peg, [0, 0, 1], 1.3 * tip)], [along(peg, axis, tip), along(peg, axis, 1.2 * tip)]]) {
      this.line(places, soft, 1.5, [5, 4]);
      this.labels.line(places.map(this.camera.project));
    }
    const theta = Math.acos(Math.min(Math.max(axis[2], -1), 1));
    const flat = Math.hypot(axis[0], axis[1]) || 1;
    const arc = Array.from({ length: 25 }, (_, k) => {
      const angle = (theta * k) / 24;
      return along(peg, [(axis[0] / flat) * Math.sin(angle), (axis[1] / flat) * Math.sin(angle), Math.cos(angle)], radius);
    });
    // A sector, unlike the ring of the spin.
    this.fill([peg, ...arc], `color-mix(in srgb, ${soft} 12%, transparent)`);
    this.line(arc, ink, 2);
    const points = arc.map(this.camera.project);
    this.labels.line(points);
    const font = `italic 600 16px ${FONT}`;
    const places = [[points[12], [0, -1]], [points[0], [1, 0]], [points[0], [-1, 0]], [points[12], [0, 1]], [points[24], [0, -1]]];
    // Small pictures have no room beside the arc.
    const near = [1, 3].flatMap((far) => places.map(([point, direction]) => ({ point, direction, far })));
    this.labels.add({ words: "θ", wide: this.widthOf("θ", font), font, paint: ink, places: near });
  }

  /** An arc about the axis with an arrowhead, in the sense of the spin; faint where the body or the table hides it. */
  spin(run, i, axis, peg) {
    const rate = run.columns.axial_rate[i];
    if (rate === 0) return;
    const { pen, camera, colors } = this;
    const { places, head } = spinRing(run.shape, axis, camera.toward, Math.sign(rate));
    const isCovered = (place) => isHidden(run.shape, axis, camera.toward, place) || place[2] + peg[2] < 0;
    const moved = (place) => along(place, peg, 1);
    this.labels.line(places.map((place) => camera.project(moved(place))));
    for (let k = 0; k + 1 < places.length; k++) {
      pen.globalAlpha = isCovered(places[k]) || isCovered(places[k + 1]) ? FAINT : 1;
      this.line([places[k], places[k + 1]].map(moved), colors.ink, 2);
    }
    pen.globalAlpha = isCovered(places[head]) ? FAINT : 1;
    this.head(camera.project(moved(places[head - 1])), camera.project(moved(places[head])), colors.ink, 9);
    pen.globalAlpha = 1;
  }

  /** An arrowhead at the end of a line on the canvas. */
  head(start, end, color, size) {
    const { pen } = this;
    const length = Math.hypot(end[0] - start[0], end[1] - start[1]) || 1;
    const [ux, uy] = [(end[0] - start[0]) / length, (end[1] - start[1]) / length];
    pen.fillStyle = color;
    pen.beginPath();
    pen.moveTo(end[0] + 0.3 * size * ux, end[1] + 0.3 * size * uy);
    pen.lineTo(end[0] - 0.7 * size * ux + 0.5 * size * uy, end[1] - 0.7 * size * uy - 0.5 * size * ux);
    pen.lineTo(end[0] - 0.7 * size * ux - 0.5 * size * uy, end[1] - 0.7 * size * uy + 0.5 * size * ux);
    pen.fill();
  }

  /** The end of the horizontal part of the angular momentum, drawn from the peg's centre. */
  flatTip(run, i, peg) {
    const [x, y] = vectorAt(run, ARROWS.momentum, i);
    return along(peg, [x, y, 0], 1 / this.scales.momentum);
  }

  /** The angular momentum with its horizontal part, and a dashed line from one to the other. */
  momentum(run, i, peg) {
    const [x, y, z] = vectorAt(run, ARROWS.momentum, i);
    const tip = along(peg, [x, y, z], 1 / this.scales.momentum);
    this.line([tip, this.flatTip(run, i, peg)], ARROWS.momentum.color, 1.5, [3, 4]);
    this.arrow("momentum", peg, [x, y, 0], { label: "horizontal part of L", thickness: 3 });
    this.arrow("momentum", peg, [x, y, z]);
  }

  /** An arrow from a place; `offset` moves it sideways on the canvas, in pixels, beside another. */
  arrow(name, from, vector, { label = ARROWS[name].symbol, thickness = 4, offset = 0 } = {}) {
    const { pen, camera } = this;
    const { color } = ARROWS[name];
    const [[x0, y0], [x1, y1]] = [from, along(from, vector, 1 / this.scales[name])].map(camera.project);
    const length = Math.hypot(x1 - x0, y1 - y0);
    if (length < 1) return;
    const [ux, uy] = [(x1 - x0) / length, (y1 - y0) / length];
    const below = ux < 0 ? -offset : offset;
    const [start, end] = [[x0 - below * uy, y0 + below * ux], [x1 - below * uy, y1 + below * ux]];
    const head = Math.min(12, length);
    pen.strokeStyle = color;
    pen.lineWidth = thickness;
    pen.beginPath();
    pen.moveTo(...start);
    pen.lineTo(end[0] - 0.8 * head * ux, end[1] - 0.8 * head * uy);
    pen.stroke();
    this.head(start, [end[0] - 0.3 * head * ux, end[1] - 0.3 * head * uy], color, head);
    this.labels.line([start, end]);
    this.labels.add({ words: label, wide: this.widthOf(label, NAME_FONT), font: NAME_FONT, paint: labelColor(color, this.colors.ink), places: besideArrow(start, end) });
  }

  /**
   * The tilt and the spin at this moment, in the upper left corner, where lines fade behind them; after the end of the
   * run, those at its end.
   */
  title(run, color, { letter, parts }, time, width, height) {
    const i = indexAt(run.columns.time, Math.min(time, run.end));
    const { ink, soft } = this.colors;
    const { theta, axial_rate: rate, flying } = run.columns;
    const isNarrow = width < NARROW;
    const widthOf = (words) => this.widthOf(words, TITLE_FONT);
    const names = parts.length > 0 ? nameLines(letter, parts, { widthOf, width: width - 16, most: width < MIN_WORDS ? 1 : 2 }) : [];
    const [tilt, spin] = [`${fixed(degrees(theta[i]), 1)}°`, `${fixed(revolutions(rate[i]), 1)} rev/s`];
    // Two pictures on a phone are low, too.
    const values =
      width < MIN_WORDS
        ? [`θ ${tilt}, ω·n ${spin}`]
        : isNarrow && height < LOW
          ? [`tilt θ ${tilt}, spin ω·n ${spin}`]
          : [`tilt θ ${tilt}${isNarrow ? "" : ` (${fixed(theta[i], 3)} rad)`}`, `spin ω·n ${spin}${isNarrow ? "" : ` (${fixed(rate[i], 1)} rad/s)`}`];
    const lines = [
      ...names.map((words) => [words, color]),
      ...values.map((words) => [words, ink]),
      [flying[i] ? "in the air" : "", soft],
      [time > run.end ? `ended at ${fixed(run.end, 2)} s` : "", soft],
    ].filter(([words]) => words);
    const box = [0, 0, 16 + Math.max(...lines.map(([words]) => widthOf(words))), TITLE_LINE * lines.length + 8];
    this.labels.cover(box);
    const { pen, colors } = this;
    pen.globalAlpha = 0.8;
    pen.fillStyle = colors.card;
    pen.fillRect(...box);
    pen.globalAlpha = 1;
    lines.forEach(([words, paint], row) => this.text(words, [8, TITLE_LINE * (row + 1)], paint, TITLE_FONT));
  }

  /** A note above the button, where the table is. */
  note(lines, height) {
    const bottom = height - BUTTON[1] - 8;
    const top = bottom - TITLE_LINE * lines.length;
    this.labels.cover([0, top, 16 + Math.max(...lines.map((words) => this.widthOf(words, TITLE_FONT))), bottom]);
    lines.forEach((words, row) => this.text(words, [8, top + TITLE_LINE * (row + 0.8)], this.colors.soft));
  }

  /** A scale bar, to which the arrows' scales refer. */
  bar(pen, runs, width, height) {
    const length = barLength(runs);
    const pixels = length * this.camera.zoom;
    const [x, y] = [width - pixels - 14, height - 14];
    pen.strokeStyle = this.colors.soft;
    pen.lineWidth = 1.5;
    pen.beginPath();
    for (const [dx, dy] of [[0, -4], [0, 0], [pixels, 0], [pixels, -4]]) pen.lineTo(x + dx, y + dy);
    pen.stroke();
    this.text(lengthName(length), [x + pixels / 2, y - 6], this.colors.soft, `12px ${FONT}`, "center");
    this.labels.cover([x - 12, y - 20, width, height]);
  }

  /** The scale of an arrow as text, e.g. `1 cm = 5 mN`; empty if it isn't drawn. */
  legend(runs, name) {
    if (!this.scales?.[name]) return "";
    const length = barLength(runs);
    const value = this.scales[name] * length;
    const { unit } = ARROWS[name];
    return `${lengthName(length)} = ${unit === "m/s" ? `${written(value)} m/s` : prefixed(value, unit)}`;
  }
}

/** The lines of the note on a body that reaches below the table. */
const sunkNote = (isNarrow) => (isNarrow ? ["only the peg touches", "the table in this model"] : ["only the peg touches the table in this model"]);

/** A power of ten of a metre: `1 cm`. */
function lengthName(length) {
  const centimetres = Math.round(length * 1e6) / 1e4;
  if (length >= 0.9999) return `${written(length)} m`;
  return centimetres >= 0.9999 ? `${written(centimetres)} cm` : `${written(centimetres * 10)} mm`;
}
