// The arc about the axis that shows the sense of the spin. Places are relative to the peg's centre.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const minus = (a, b, factor) => a.map((value, index) => value - factor * b[index]);

const RING_PARTS = 48;
const HALF_ARC = 0.75 * Math.PI; // the gap is a quarter of a turn
const HEAD_ANGLE = 0.25 * Math.PI; // from the nearest place: the arrowhead is on the near half

/** The unit vector across the axis that points most towards the camera. */
function nearest(axis, toward) {
  const across = minus(toward, axis, dot(toward, axis));
  const length = Math.hypot(...across);
  if (length > 1e-6) return across.map((value) => value / length);
  // The camera looks along the axis: every direction is as near.
  return nearest(axis, Math.abs(axis[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0]);
}

/**
 * The places of the arc, in the sense of the spin, and the index of the one where the arrowhead is. The arc lies in a
 * plane perpendicular to the axis; its gap is on the side away from the camera. `sense` is 1 or -1.
 */
export function spinRing({ tip, size, is_ball: isBall }, axis, toward, sense) {
  const near = nearest(axis, toward);
  const ahead = cross(axis, near);
  const [height, radius] = isBall ? [0, 1.08 * tip] : [0.93 * tip, 0.16 * size];
  const places = Array.from({ length: RING_PARTS + 1 }, (_, k) => {
    const angle = sense * HALF_ARC * ((2 * k) / RING_PARTS - 1);
    return axis.map((value, index) => height * value + radius * (Math.cos(angle) * near[index] + Math.sin(angle) * ahead[index]));
  });
  return { places, head: Math.round((RING_PARTS / 2) * (1 + HEAD_ANGLE / HALF_ARC)) };
}

/** Whether the ball, or the disc or the stem of another top, lies between a place and the camera. */
export function isHidden(shape, axis, toward, place) {
  if (shape.is_ball) {
    const depth = dot(place, toward);
    return depth < 0 && dot(place, place) - depth ** 2 < shape.peg ** 2;
  }
  return isBehindDisc(shape, axis, toward, place) || isBehindStem(shape, axis, toward, place);
}

function isBehindDisc({ disc_height, disc_radius }, axis, toward, place) {
  const rise = dot(toward, axis);
  if (Math.abs(rise) < 1e-9) return false; // seen from the side
  const distance = (disc_height - dot(place, axis)) / rise;
  const hit = minus(place, toward, -distance);
  return distance > 0 && Math.hypot(...minus(hit, axis, dot(hit, axis))) < disc_radius;
}

function isBehindStem({ disc_height, stem_radius, tip }, axis, toward, place) {
  const [across, ray] = [place, toward].map((vector) => minus(vector, axis, dot(vector, axis)));
  const speed = dot(ray, ray);
  if (speed < 1e-12) return false; // seen along the axis
  const distance = -dot(across, ray) / speed; // to the point of the ray that is nearest to the axis
  const height = dot(place, axis) + distance * dot(toward, axis);
  return distance > 0 && Math.hypot(...minus(across, ray, -distance)) < stem_radius && height > disc_height && height < tip;
}
