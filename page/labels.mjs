// Places for the names in the 3D view: where they cover neither texts nor lines, if there is room.

const LABEL_HEIGHT = 17; // px
const BASELINE = 13; // below the upper edge of a label
const LABEL_GAP = 5; // from the place that it names
const EDGE = 3; // from the edge of the picture

/** Side lengths of the common part of two boxes [left, top, right, bottom]; negative if they are apart. */
const commonSides = (a, b) => [Math.min(a[2], b[2]) - Math.max(a[0], b[0]), Math.min(a[3], b[3]) - Math.max(a[1], b[1])];

/** Area that two boxes have in common. */
export function commonArea(a, b) {
  const [across, down] = commonSides(a, b);
  return Math.max(across, 0) * Math.max(down, 0);
}

/** Length of the part of a line between two points that lies in a box. */
export function lengthInside([x0, y0], [x1, y1], [left, top, right, bottom]) {
  const [dx, dy] = [x1 - x0, y1 - y0];
  let [from, to] = [0, 1];
  for (const [step, room] of [[-dx, x0 - left], [dx, right - x0], [-dy, y0 - top], [dy, bottom - y0]]) {
    if (step === 0 && room < 0) return 0;
    if (step < 0) from = Math.max(from, room / step);
    if (step > 0) to = Math.min(to, room / step);
  }
  return to > from ? (to - from) * Math.hypot(dx, dy) : 0;
}

/** A box of a width beside a point, in a direction from it. */
function boxBeside([x, y], [ux, uy], wide, gap) {
  const distance = gap + (Math.abs(ux) * wide) / 2 + (Math.abs(uy) * LABEL_HEIGHT) / 2;
  const [cx, cy] = [x + distance * ux, y + distance * uy];
  return [cx - wide / 2, cy - LABEL_HEIGHT / 2, cx + wide / 2, cy + LABEL_HEIGHT / 2];
}

/** Where the name of an arrow may be, best first: beyond its end, beside its end and its middle, and farther away. */
export function besideArrow([x0, y0], [x1, y1]) {
  const length = Math.hypot(x1 - x0, y1 - y0) || 1;
  const ahead = [(x1 - x0) / length, (y1 - y0) / length];
  const sides = [[-ahead[1], ahead[0]], [ahead[1], -ahead[0]]];
  const [end, middle] = [[x1, y1], [(x0 + x1) / 2, (y0 + y1) / 2]];
  const places = [[end, ahead], ...sides.map((side) => [end, side]), ...sides.map((side) => [middle, side])];
  return [1, 4, 8].flatMap((far) => places.map(([point, direction]) => ({ point, direction, far })));
}

/** The names of a picture of a size. `kept` remembers their places from picture to picture, so that they don't jump. */
export class Labels {
  constructor(width, height, kept = {}) {
    Object.assign(this, { width, height, kept, boxes: [], lines: [], names: [] });
  }

  /** Keeps a box free. */
  cover(box) {
    this.boxes.push(box);
  }

  /** A line through points that names should not cover. */
  line(points) {
    points.slice(1).forEach((point, index) => this.lines.push([points[index], point]));
  }

  /** A name of a width, and where it may be, best first. */
  add(name) {
    this.names.push(name);
  }

  /** The least move that brings a box into the picture. */
  inside([left, top, right, bottom]) {
    const dx = Math.max(EDGE - left, 0) || Math.min(this.width - EDGE - right, 0);
    const dy = Math.max(EDGE - top, 0) || Math.min(this.height - EDGE - bottom, 0);
    return [left + dx, top + dy, right + dx, bottom + dy];
  }

  /** What a box covers: a text is worse than a line. */
  costOf(box) {
    const covered = this.boxes.reduce((sum, other) => sum + commonArea(box, other), 0);
    const crossed = this.lines.reduce((sum, [start, end]) => sum + lengthInside(start, end, box), 0);
    return 100 * covered + crossed;
  }

  /** The names with their places: left and baseline. */
  placed() {
    return this.names.map((name) => {
      const boxes = name.places.map(({ point, direction, far = 1 }) => this.inside(boxBeside(point, direction, name.wide, far * LABEL_GAP)));
      const before = boxes[this.kept[name.words]];
      let best = before && this.costOf(before) === 0 ? this.kept[name.words] : -1;
      if (best < 0) {
        const costs = boxes.map((box) => this.costOf(box));
        best = costs.indexOf(Math.min(...costs));
      }
      this.kept[name.words] = best;
      this.cover(boxes[best]);
      return { ...name, place: [boxes[best][0], boxes[best][1] + BASELINE] };
    });
  }
}
