// Mouse, touch and pen on a canvas: drags with one finger, pinches and pans with two, the wheel.

/**
 * Calls `press(event)` and `drag(event, dx, dy)` for one pointer, and `pinch({ factor, x, dx })` for two fingers or
 * the wheel: distance now to before, place of their middle in the canvas, and its move, in CSS pixels. Only Ctrl + wheel
 * zooms, so that the page can be scrolled over a canvas; a touchpad's pinch sets ctrlKey by itself.
 */
export function gestures(canvas, { press = () => {}, drag = () => {}, pinch = () => {} }) {
  const pointers = new Map();
  const place = ({ clientX, clientY }) => ({ x: clientX, y: clientY });
  const left = () => canvas.getBoundingClientRect().left;

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, place(event));
    if (pointers.size === 1) press(event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = place(event);
    const other = [...pointers.keys()].find((id) => id !== event.pointerId);
    if (other === undefined) drag(event, now.x - before.x, now.y - before.y);
    else {
      const { x, y } = pointers.get(other);
      const distance = (point) => Math.max(Math.hypot(point.x - x, point.y - y), 10);
      pinch({ factor: distance(now) / distance(before), x: (now.x + x) / 2 - left(), dx: (now.x - before.x) / 2 });
    }
    pointers.set(event.pointerId, now);
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
    canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  }
  const turnWheel = (event) => {
    const isPan = Math.abs(event.deltaX) > Math.abs(event.deltaY);
    if (!event.ctrlKey && !event.metaKey && !isPan) return;
    event.preventDefault();
    const factor = isPan ? 1 : Math.exp(-event.deltaY / 300);
    pinch({ factor, x: event.clientX - left(), dx: isPan ? -event.deltaX : 0 });
  };
  canvas.addEventListener("wheel", turnWheel, { passive: false });
}
