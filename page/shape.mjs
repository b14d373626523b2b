// The drawn shape of a top: rings about its axis, and the faces between them.

const SEGMENTS = 36;
const BALL_RINGS = 12;

/** Rotates a body vector into the world frame by a unit quaternion. */
export function turned([w, x, y, z], [a, b, c]) {
  const [u, v, t] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [a + w * u + y * t - z * v, b + w * v + z * u - x * t, c + w * t + x * v - y * u];
}

/** An orientation of a body whose axis has this direction, without turning about the axis: it changes as little as the axis does. */
export function orientationOf([x, y, z]) {
  // The shortest turn from the vertical; from the nearer of its two ends, because no turn to the other is the shortest.
  const turn = z >= 0 ? [1 + z, -y, x, 0] : [-y, 1 - z, 0, x];
  const length = Math.hypot(...turn);
  return turn.map((value) => value / length);
}

/** Two stripes turn past each other in half a turn. From this part of it between two pictures on, no stripes are drawn. */
const MAX_STEP = 0.25;

/**
 * The contrast of the stripes, from 1 to 0 = evenly mixed, as the eye sees a fast top. Stripes that move by more than
 * half their distance between two pictures would seem to turn backward; these are gone before, with a margin for late pictures.
 */
export function stripeContrast(rate, exposure) {
  const step = (Math.abs(rate) * exposure) / Math.PI;
  return Math.max(1 - (step / MAX_STEP) ** 2, 0);
}

/** The outward unit normal of a face. */
function normalOf([a, b, c, d]) {
  const [u, v] = [c.map((value, axis) => value - a[axis]), d.map((value, axis) => value - b[axis])];
  const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const length = Math.hypot(...normal) || 1;
  return normal.map((value) => value / length);
}

/** Rings of a sphere of radius `r` about the origin, from its bottom to a height: height, radius, paint. */
function sphere(r, height, paint) {
  const end = Math.acos(-height / r);
  return Array.from({ length: BALL_RINGS + 1 }, (_, i) => (end * i) / BALL_RINGS).map((angle) => [-r * Math.cos(angle), r * Math.sin(angle), paint]);
}

/** Rings of a top: height above the peg's centre, radius, and the paint of what follows upward. */
function ringsOf(shape) {
  const { peg, disc_height, disc_radius, thickness, stem_radius, shoulder, neck, cut, tip } = shape;
  if (shape.is_ball) {
    // As the toy: a painted cap where the ball is cut off, and a stem that reaches only as far as the sphere, because it
    // has no contact of its own. So it stands on its stem when it has turned over.
    const ball = sphere(peg, cut, "body").map(([height, radius]) => [height, radius, height > 0.2 * peg ? "cap" : "body"]);
    return [...ball, [cut, stem_radius, "stem"], [tip, stem_radius, "stem"], [tip, 0, "stem"]];
  }
  const pegTop = Math.sqrt(Math.max(peg * peg - neck * neck, 0));
  const below = Math.max(disc_height - thickness / 2, pegTop);
  const above = below + thickness;
  return [
    ...sphere(peg, pegTop, "peg").slice(0, -1),
    [pegTop, neck, "body"],
    [below, shoulder, "body"],
    [below, disc_radius, "rim"],
    [above, disc_radius, "body"],
    [above, shoulder, "body"],
    [above + 0.5 * (tip - above), 1.6 * stem_radius, "stem"],
    [tip, stem_radius, "stem"],
    [tip, 0, "stem"],
  ];
}

/** The part of a polygon above the table. */
function aboveTable(corners) {
  return corners.flatMap((corner, index) => {
    const next = corners[(index + 1) % corners.length];
    const own = corner[2] >= 0 ? [corner] : [];
    if (corner[2] >= 0 === next[2] >= 0) return own;
    const part = corner[2] / (corner[2] - next[2]);
    return [...own, corner.map((value, axis) => value + part * (next[axis] - value))];
  });
}

/** Depth below the table, in sizes of the top, up to which a part seems to touch it. */
const CONTACT = 0.02;

/**
 * The faces of a top whose outsides face the camera, farthest first: corners, brightness, paint; as far as they are above
 * the table. `seen` maps places to the camera. `isSunk`: a part that doesn't touch the table in the model is
 * below it; never of a ball, which is its own peg.
 */
export function visibleFaces(shape, q, peg, seen) {
  const rings = ringsOf(shape).map(([height, radius, paint]) => ({
    paint,
    corners: Array.from({ length: SEGMENTS }, (_, k) => {
      const angle = (2 * Math.PI * k) / SEGMENTS;
      const place = turned(q, [radius * Math.cos(angle), radius * Math.sin(angle), height]);
      return place.map((value, axis) => value + peg[axis]);
    }),
  }));
  const lowest = rings.reduce((least, { corners }) => corners.reduce((least, [, , z]) => Math.min(least, z), least), 0);
  const isSunk = !shape.is_ball && lowest < -CONTACT * shape.size;
  const faces = [];
  for (let ring = 0; ring + 1 < rings.length; ring++) {
    const [lower, upper] = [rings[ring].corners, rings[ring + 1].corners];
    for (let k = 0; k < SEGMENTS; k++) {
      const next = (k + 1) % SEGMENTS;
      const whole = [lower[k], lower[next], upper[next], upper[k]];
      const normal = normalOf(whole.map(seen));
      if (normal[2] <= 0) continue;
      const corners = (lowest < 0 ? aboveTable(whole) : whole).map(seen);
      if (corners.length < 3) continue;
      const depth = corners.reduce((sum, corner) => sum + corner[2], 0) / corners.length;
      // Two opposite stripes, of a ninth of a turn each, show the spin.
      const isStripe = k % (SEGMENTS / 2) < SEGMENTS / 9;
      faces.push({ corners, depth, light: brightness(normal), paint: rings[ring].paint, isStripe });
    }
  }
  return { faces: faces.sort((a, b) => a.depth - b.depth), isSunk };
}

/** Brightness of a face lit from the upper left behind the viewer. */
const brightness = ([x, y, z]) => 0.45 + 0.55 * Math.max(-0.4 * x + 0.65 * y + 0.65 * z, 0);

/** The outline of the shadow that a top casts on the table from straight above. */
export function shadowOf(shape, q, peg) {
  const [radius, height] = shape.is_ball ? [shape.peg, 0] : [shape.disc_radius, shape.disc_height];
  return Array.from({ length: SEGMENTS }, (_, k) => {
    const angle = (2 * Math.PI * k) / SEGMENTS;
    const place = turned(q, [radius * Math.cos(angle), radius * Math.sin(angle), height]);
    return [place[0] + peg[0], place[1] + peg[1], 0];
  });
}
