// 3D view of the top at a time of the run.

import { indexAt } from "./curves.mjs";

const SEGMENTS = 24;
const TRAIL = 3; // s

/** The unit normal of a face, outward. */
function across([a, b, c, d]) {
  const [u, v] = [c.map((value, axis) => value - a[axis]), d.map((value, axis) => value - b[axis])];
  const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const length = Math.hypot(...normal) || 1;
  return normal.map((value) => value / length);
}

/** Brightness of a face lit from the upper left behind the viewer. */
const shine = ([x, y, z]) => 0.45 + 0.55 * Math.max(-0.4 * x + 0.65 * y + 0.65 * z, 0);

/** Rotates a body vector into the world frame by a unit quaternion. */
function turned([w, x, y, z], [a, b, c]) {
  const [u, v, t] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [a + w * u + y * t - z * v, b + w * v + z * u - x * t, c + w * t + x * v - y * u];
}

/** Profile of the top: heights along the axis and radii, m. */
function outline(run) {
  const [l, r] = [run.center_distance, run.peg_radius];
  const ball = (from, to) =>
    Array.from({ length: 9 }, (_, i) => from + ((to - from) * i) / 8).map((angle) => [-r * Math.cos(angle), r * Math.sin(angle)]);
  if (l < 0 || r > 0.6 * l) return ball(0, Math.PI);
  const body = [[0.55, 0.12], [0.9, 0.8], [1.05, 0.85], [1.2, 0.5], [1.3, 0.1], [1.75, 0.08], [1.78, 0]];
  return [...ball(0, 1.2), ...body.map(([height, radius]) => [height * l, radius && Math.max(radius * l, r / 2)])];
}

export const sizeOf = (run) => Math.max(2 * Math.abs(run.center_distance), 2.4 * run.peg_radius);

/** The pose at a time: sample index, orientation and peg position. */
function pose(run, time) {
  const c = run.columns;
  const i = indexAt(c.time, time);
  return { i, q: [c.qw[i], c.qx[i], c.qy[i], c.qz[i]], peg: [c.peg_x[i], c.peg_y[i], c.peg_z[i]] };
}

export class View {
  constructor(canvas, redraw) {
    this.canvas = canvas;
    this.azimuth = -0.6;
    this.elevation = 0.35;
    canvas.addEventListener("pointermove", (event) => {
      if (!event.buttons) return;
      this.azimuth -= event.movementX / 120;
      this.elevation = Math.min(Math.max(this.elevation + event.movementY / 150, -0.1), 1.5);
      redraw();
    });
  }

  /** Draws runs side by side, each with its colour. */
  draw(runs, time) {
    const { canvas } = this;
    const ratio = devicePixelRatio || 1;
    [canvas.width, canvas.height] = [canvas.clientWidth * ratio, canvas.clientHeight * ratio];
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    const width = canvas.clientWidth / runs.length;
    runs.forEach(({ run, color, name }, index) => {
      pen.save();
      pen.translate(index * width, 0);
      pen.beginPath();
      pen.rect(0, 0, width, canvas.clientHeight);
      pen.clip();
      this.one(pen, run, color, Math.min(time, run.columns.time.at(-1)), width, canvas.clientHeight);
      pen.fillStyle = color;
      pen.font = "600 13px system-ui";
      pen.fillText(name, 10, 20, width - 20);
      pen.restore();
    });
  }

  one(pen, run, color, time, width, height) {
    const size = sizeOf(run);
    const { i, q, peg } = pose(run, time);
    const focus = run.is_free ? [peg[0], peg[1], 0] : [0, 0, 0];
    const [ca, sa, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
    const zoom = Math.min(width, height) / (1.5 * size);
    /** World to camera coordinates: right, up, towards the camera. */
    const seen = (place) => {
      const [x, y, z] = place.map((value, axis) => value - focus[axis]);
      const [right, away] = [ca * x + sa * y, -sa * x + ca * y];
      return [right, ce * z + se * away, se * z - ce * away];
    };
    const onScreen = ([right, up]) => [width / 2 + zoom * right, 0.78 * height - zoom * up];
    const project = (place) => onScreen(seen(place));
    const style = getComputedStyle(this.canvas);
    const line = (points, stroke, thickness) => {
      pen.strokeStyle = stroke;
      pen.lineWidth = thickness;
      pen.beginPath();
      for (const point of points) pen.lineTo(...project(point));
      pen.stroke();
    };
    this.floor(line, focus, size, style.getPropertyValue("--line"));
    this.trail(line, run, i, size, color);
    this.body(pen, run, seen, onScreen, q, peg, color);
    this.arrows(pen, line, project, run, i, size);
  }

  floor(line, focus, size, stroke) {
    const step = size / 4;
    for (let k = -4; k <= 4; k++) {
      const [x, y] = [0, 1].map((axis) => (Math.round(focus[axis] / step) + k) * step);
      line([[x, focus[1] - size, 0], [x, focus[1] + size, 0]], stroke, 1);
      line([[focus[0] - size, y, 0], [focus[0] + size, y, 0]], stroke, 1);
    }
  }

  /** The path of the axis's end, or of a free peg on the table. */
  trail(line, run, last, size, color) {
    const c = run.columns;
    const first = indexAt(c.time, c.time[last] - TRAIL);
    const step = Math.max(Math.floor((last - first) / 800), 1);
    const points = [];
    for (let i = first; i <= last; i += step) {
      const axis = turned([c.qw[i], c.qx[i], c.qy[i], c.qz[i]], [0, 0, 0.9 * size]);
      points.push(run.is_free ? [c.peg_x[i], c.peg_y[i], 0] : [c.peg_x[i] + axis[0], c.peg_y[i] + axis[1], c.peg_z[i] + axis[2]]);
    }
    line(points, color, 1.5);
  }

  /** Draws the visible faces, back to front. */
  body(pen, run, seen, onScreen, q, peg, color) {
    const rings = outline(run).map(([height, radius]) =>
      Array.from({ length: SEGMENTS }, (_, k) => {
        const angle = (2 * Math.PI * k) / SEGMENTS;
        const place = turned(q, [radius * Math.cos(angle), radius * Math.sin(angle), height]);
        return seen(place.map((value, axis) => value + peg[axis]));
      }),
    );
    const faces = [];
    for (let ring = 0; ring + 1 < rings.length; ring++) {
      for (let k = 0; k < SEGMENTS; k++) {
        const next = (k + 1) % SEGMENTS;
        const corners = [rings[ring][k], rings[ring][next], rings[ring + 1][next], rings[ring + 1][k]];
        const normal = across(corners);
        if (normal[2] <= 0) continue;
        const depth = corners.reduce((sum, corner) => sum + corner[2], 0);
        faces.push({ corners, depth, light: shine(normal), isStripe: k % (SEGMENTS / 2) < 2 || ring === rings.length - 2 });
      }
    }
    faces.sort((a, b) => a.depth - b.depth);
    for (const { corners, light, isStripe } of faces) {
      const fill = isStripe ? "#f4f1e6" : color;
      pen.fillStyle = pen.strokeStyle = `color-mix(in srgb, ${fill} ${Math.round(100 * light)}%, black)`;
      pen.lineWidth = 0.6;
      pen.beginPath();
      for (const corner of corners) pen.lineTo(...onScreen(corner));
      pen.closePath();
      pen.fill();
      pen.stroke();
    }
  }

  /** Slip velocity and friction force at the point of contact. */
  arrows(pen, line, project, run, i, size) {
    const c = run.columns;
    if (c.regime[i] === 2) return;
    const foot = [c.peg_x[i], c.peg_y[i], 0];
    const arrow = (x, y, stroke) => {
      const tip = [foot[0] + x, foot[1] + y, 0];
      line([foot, tip], stroke, 3);
      const [px, py] = project(tip);
      pen.fillStyle = stroke;
      pen.beginPath();
      pen.arc(px, py, 4, 0, 7);
      pen.fill();
    };
    const slip = (0.5 * size) / run.greatest_slip;
    const force = (0.5 * size) / run.force;
    arrow(slip * c.slip_x[i], slip * c.slip_y[i], "#3a7de8");
    arrow(force * c.friction_x[i], force * c.friction_y[i], "#e8833a");
  }
}
