// Keys of the keyboard, and gestures.

import { element } from "./elements.mjs";

/** Keys, what they do, and the element that must have the focus, if any. */
export const KEYS = [
  { keys: [" "], action: "play", name: "Space", text: "play or pause" },
  { keys: ["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"], action: "turn", place: "top", name: "Arrow keys on the picture", text: "turn the view" },
  { keys: ["ArrowRight"], action: "later", name: "→", text: "10 ms later" },
  { keys: ["ArrowLeft"], action: "earlier", name: "←", text: "10 ms earlier" },
  { keys: ["Home"], action: "start", name: "Home", text: "to the start" },
  { keys: ["End"], action: "end", name: "End", text: "to the end" },
  { keys: ["+", "="], action: "closer", name: "+", text: "zoom in on the curves about this moment" },
  { keys: ["-", "0"], action: "whole", name: "−", text: "show the whole run" },
  { keys: ["a", "A"], action: "keep", name: "A", text: "keep this run as A, or remove A" },
  { keys: ["?"], action: "help", name: "?", text: "this list" },
];

const GESTURES = [
  ["Drag the picture", "turn the view; pinch, or Ctrl + wheel, to come closer"],
  ["Click or drag the curves", "go to that time"],
  ["Pinch, or Ctrl + wheel, on the curves", "zoom; two fingers, or Shift + drag, move along"],
  ["Double-click the curves", "show the whole run"],
  ["↑ ↓ in the list of events", "the event before or after"],
];

export function showKeys(list) {
  const rows = [...KEYS.map(({ name, text }) => [name, text]), ...GESTURES];
  list.replaceChildren(...rows.flatMap(([name, text]) => [element("dt", { textContent: name }), element("dd", { textContent: text })]));
}
