// The page's state: the edited scenario, its run, and a pinned run for comparison.

import { ARROWS, labelColor, momentumParts } from "./arrows.mjs";
import { Controls } from "./controls.mjs";
import { Curves } from "./curves.mjs";
import { at, element, typeset } from "./elements.mjs";
import { BELOW_TABLE, EnergyAreas, changesShown, isBelowTable } from "./energy.mjs";
import { Engine, compiled } from "./engine.mjs";
import { FitPanel } from "./fit.mjs";
import { Knobs } from "./knobs.mjs";
import { Lesson, STEPS_OF_LESSON } from "./lesson.mjs";
import { runName } from "./names.mjs";
import { EventList, showComparison, showExplanation } from "./reading.mjs";
import { Scenario, linkOf, parseLink, scenarioFrom } from "./scenario.mjs";
import { View } from "./top.mjs";
import { VerifyPanel, isRecording } from "./verify.mjs";
import { KEYS, showKeys } from "./keys.mjs";
import { showWorksheet } from "./worksheet.mjs";

/** The presets that have buttons. */
const BUTTONS = ["paper", "tippe-top", "frictionless", "drop"];
const HINTS = { paper: "V. Tanrıverdi, How does a heavy symmetric top rise? (arXiv:2204.14060)" };
/** The presets with models of that paper; the others go beyond it. */
const OF_PAPER = ["paper", "paper-precession-term-only", "paper-spin-term-only", "full-coulomb", "rise-by-loss-of-spin"];
const LEAST_PLAYBACK = 2; // s, of a run at the speed that nobody has chosen
const PAUSE_AT_END = 1.5; // s, before playback starts again
const DEFAULT = "paper";

if (window.isTooOld) throw new Error("too old"); // the page says so

const module = await compiled();
const runner = new Engine(module);
const helper = new Engine(module);
const tables = await runner.tables;

const state = {
  scenario: null,
  run: null,
  pinned: null,
  time: 0,
  window: null, // of time, if the curves are zoomed in
  speed: 1,
  isSpeedChosen: false, // by the person
  isPlaying: false,
  isHeld: false, // a person holds the time slider or a curve: playback waits
  guess: null, // in a step of the lesson whose outcome hasn't been played yet: `seen`, the latest time shown
  frictionBefore: null, // the keys of friction and stop conditions, while friction is off
};

/** The title of a preset. */
const titleOf = (preset) => tables.presets.find(({ name }) => name === preset)?.title ?? preset;

/** The scenario of a link. */
const scenarioOf = (text) => new Scenario(tables.presets, ...scenarioFrom(text));

/** The link of the state. */
function link() {
  const pinned = state.pinned ? `&vs=${linkOf(state.pinned.scenario)}` : "";
  const step = lesson.step ? `&lesson=${lesson.step}` : "";
  return `#${linkOf(state.scenario.request)}${pinned}${step}`;
}

/** Shows the state in the address, so that it can be copied and reloaded. */
const toLink = () => history.replaceState(null, "", link());

/** Simulates the edited scenario and shows its run. */
async function simulate() {
  toLink();
  const { scenario } = state;
  const slow = setTimeout(() => showComputing(), 300);
  const response = await runner.send({ simulate: { scenario: scenario.request, columns: tables.columns } });
  clearTimeout(slow);
  if (!response) return; // superseded
  at("error").textContent = response.error ?? "";
  document.body.classList.toggle("stale", Boolean(response.error));
  for (const button of document.querySelectorAll("#take button, #pin")) button.disabled = Boolean(response.error);
  if (response.error) {
    if (state.run) showSummary();
    else at("summary").textContent = "No run to show: correct the scenario first.";
    await showForm();
    return;
  }
  const end = state.run?.end;
  state.run = { ...response, flies: response.columns.flying.includes(1), end: response.columns.time.at(-1) };
  if (state.run.end !== end) {
    state.time = Math.min(state.time, state.run.end);
    state.window = null;
  }
  showControls(state.run.keys);
  setUsualSpeed();
  showSummary();
  at("command").textContent = scenario.command;
  at("digest").textContent = "";
  events.show(state.run.events);
  draw();
  ask();
}

/** Shows that what is on the page is not yet that of the edited scenario. */
function showComputing() {
  document.body.classList.add("stale");
  at("summary").textContent = "Computing …";
}

/** Shows how the run ends, unless that is to be guessed first. */
function showSummary() {
  document.body.classList.toggle("guessing", state.guess !== null);
  if (!state.run) return;
  const text = state.guess ? sentenceOfGuess() : sentenceOfRuns();
  // Screen readers say a text that is set again.
  if (at("summary").textContent !== text) at("summary").textContent = text;
}

/** What to do in a step of the lesson whose outcome hasn't been played yet. */
const sentenceOfGuess = () => (state.isPlaying || state.guess.seen > 0 ? "Watch: does your guess come true?" : "Guess first. Then press Play.");

/** How the run ends, and the pinned one. */
function sentenceOfRuns() {
  const [b, a] = [state.run, state.pinned].map((run) => run && `${runName(run)}: ${run.outcome}`);
  return a ? `A: ${a}. B: ${b}.` : b;
}

/** Slows the playback of short runs, so that they can be followed, unless a person has chosen its speed. */
function setUsualSpeed() {
  if (state.isSpeedChosen) return;
  const speeds = [...at("speed").options].map(({ value }) => Number(value));
  const isSlowEnough = (speed) => latest() / speed >= LEAST_PLAYBACK;
  state.speed = speeds.findLast((speed) => speed <= 1 && isSlowEnough(speed)) ?? speeds[0];
  at("speed").value = state.speed;
}

/** Shows the outcome that was to be guessed. */
function reveal() {
  if (!state.guess) return;
  state.guess = null;
  showSummary();
  draw();
}

/** Shows the keys of a scenario that can't be run; those of its preset if its values can't be read either. */
async function showForm() {
  const { scenario } = state;
  for (const request of [scenario.request, { preset: scenario.preset.name, set: {} }]) {
    const keys = await helper.request({ form: request });
    if (!keys.error) return showControls(keys);
  }
  return undefined;
}

function showControls(keys) {
  const { scenario } = state;
  controls.show(scenario, keys);
  knobs.show(scenario, keys);
  at("preset").value = scenario.preset.name;
  const isChanged = Object.keys(scenario.set).length > 0;
  at("description").replaceChildren(...typeset(`${isChanged ? "Before the changes: " : ""}${scenario.preset.description ?? ""}`));
  at("source-of").textContent = OF_PAPER.includes(scenario.preset.name) ? "The paper:" : "Beyond the paper:";
  at("reset").disabled = !isChanged;
  for (const button of at("presets").children) button.setAttribute("aria-pressed", button.value === scenario.preset.name);
}

/** Dims a text of other runs than those that are shown, until its own has come. */
const setBusy = (id, isBusy) => at(id).setAttribute("aria-busy", isBusy);

/** Requests the explanation and the comparison once input has paused. */
let waiting;
function ask() {
  clearTimeout(waiting);
  const { run, pinned } = state;
  const isPair = Boolean(pinned) && pinned.digest !== run.digest;
  setBusy("why", true);
  setBusy("compared", isPair);
  if (pinned && !isPair) showComparison(at("comparison"), { error: "This run is kept as A. Change a value to compare it with B." });
  // A table of earlier runs stays, dimmed, so that what is below it doesn't jump; a note about them would be wrong.
  else if (pinned && !at("comparison").querySelector("table")) showComparison(at("comparison"), { error: "Comparing …" });
  waiting = setTimeout(() => answer(run, pinned, isPair), 300);
}

/** Shows the explanation of a run, and its comparison with the pinned one, unless others have been chosen meanwhile. */
async function answer(run, pinned, isPair) {
  const isShown = () => run === state.run && pinned === state.pinned;
  const explanation = await helper.request({ explain: run.scenario });
  if (!isShown()) return;
  showExplanation(at("story"), at("explanation"), explanation);
  setBusy("why", false);
  if (!isPair) return;
  const comparison = await helper.request({ compare: { a: pinned.scenario, b: run.scenario } });
  if (!isShown()) return;
  showComparison(at("comparison"), comparison);
  setBusy("compared", false);
}

/** The runs to draw: the pinned run, if any, and the edited one. */
function shown() {
  const { run, pinned } = state;
  const style = getComputedStyle(document.body);
  const edited = { run, color: style.getPropertyValue("--b"), letter: "B" };
  return pinned ? [{ run: pinned, color: style.getPropertyValue("--a"), letter: "A" }, edited] : [edited];
}

/** The end of the longest run that is shown, s. */
const latest = () => Math.max(state.run.end, state.pinned?.end ?? 0);

let isDrawing = false;
function draw() {
  if (isDrawing || !state.run) return;
  isDrawing = true;
  requestAnimationFrame(() => {
    isDrawing = false;
    const { time } = state;
    const runs = shown();
    const window = state.window ?? [0, latest()];
    const seen = state.guess?.seen;
    curves.draw(runs, window, state.window !== null, time, seen);
    energy.draw(runs, window, time, seen);
    view.draw(runs, time, state.isPlaying ? (frame / 1000) * state.speed : 0);
    showArrows(runs, time);
    showEnergy(runs, time);
    at("time").max = latest();
    at("time").value = time;
    at("clock").textContent = `${time.toFixed(3)} s`;
    events.mark(time);
  });
}

/** The scales beside the checkboxes of the arrows, and the parts of L below them. */
function showArrows(runs, time) {
  const parts = runs.map(({ run, letter }) => `L${runs.length > 1 ? ` of ${letter}` : ""}: ${momentumParts(run, time)}`);
  at("momentum-parts").textContent = view.shown.momentum ? parts.join("; ") : "";
  for (const name of Object.keys(ARROWS)) {
    const legend = view.legend(runs.map(({ run }) => run), name);
    const small = at(`scale-${name}`);
    const text = legend ? `(${legend})` : "";
    if (small.textContent !== text) small.textContent = text;
  }
}

/** The changes of energy of the edited run, below the areas. */
function showEnergy(runs, time) {
  const { run, letter } = runs.at(-1);
  const of = runs.length > 1 ? ` of ${letter}` : "";
  const numbers = changesShown(run, time).map(({ label, color, text }) => {
    const square = element("i");
    square.style.background = color;
    return element("span", {}, square, `${label} `, element("b", { textContent: text }));
  });
  at("energy-numbers").replaceChildren(element("small", { textContent: `Changes${of} since the start${time > run.end ? ", until its end" : ""}${isBelowTable(run) ? BELOW_TABLE : ""}:` }), ...numbers);
}

function choose(when) {
  if (!state.run) return;
  state.time = Math.min(Math.max(when, 0), latest());
  if (state.guess) state.guess.seen = Math.max(state.guess.seen, state.time);
  if (state.guess && state.time >= latest()) reveal();
  else if (state.guess) showSummary();
  draw();
}

/** Chooses a time as a person does: a run that is shown at its end stays there. */
function seek(when) {
  choose(when);
  if (state.isPlaying && state.run && state.time >= latest()) play(false);
}

/** Lets playback wait while a person holds this element. */
function holdPlayback(place) {
  place.addEventListener("pointerdown", () => (state.isHeld = true));
  for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => (state.isHeld = false));
}

/** Shows a window of time; the whole run for null. */
function zoom(wanted) {
  const [from, to] = wanted ?? [0, latest()];
  const width = Math.max(to - from, 1e-3); // s
  const start = Math.min(Math.max(from, 0), Math.max(latest() - width, 0));
  state.window = width >= latest() ? null : [start, start + width];
  draw();
}

const USUAL_FRAME = 1000 / 60; // ms
const MAX_FRAME = 200; // ms; a longer pause is no frame of playback

let before = 0;
let frame = USUAL_FRAME; // ms between pictures: the longest of late, so that late pictures don't make the stripes flicker
let pausedUntil = 0;
function play(wanted = !state.isPlaying) {
  state.isPlaying = wanted;
  at("play").textContent = wanted ? "Pause" : "Play";
  if (state.guess) showSummary();
  if (wanted && state.run && state.time >= latest()) state.time = 0;
  before = performance.now();
  if (wanted) requestAnimationFrame(step);
  draw();
}

/** Advances playback; at the end of the run it starts again. */
function step(now) {
  if (!state.isPlaying) return;
  frame = Math.min(Math.max(now - before, 0.95 * frame, USUAL_FRAME), MAX_FRAME);
  if (state.run && now >= pausedUntil && !state.isHeld) {
    if (state.time >= latest()) choose(0);
    else choose(state.time + (Math.max(now - before, 0) / 1000) * state.speed);
    if (state.time >= latest()) pausedUntil = now + 1000 * PAUSE_AT_END;
  }
  before = now;
  requestAnimationFrame(step);
}

/** Sets a number on which no other key depends. */
function put(key, value) {
  at("also").textContent = "";
  state.scenario.put(key.path, value);
  simulate();
}

/** Sets a key on which others depend, and what else the program changes with it. */
async function change(key, value) {
  const { scenario } = state;
  const earlier = { ...scenario.set };
  const { set, error } = await runner.request({ change: { scenario: scenario.request, key: key.path, value } });
  if (error) {
    at("error").textContent = error;
    return;
  }
  scenario.set = set;
  const also = Object.entries(set).filter(([other, value]) => other !== key.path && value !== earlier[other]);
  at("also").textContent = also.length > 0 ? `This also sets ${also.map(([other, value]) => `${other} = ${value || "none"}`).join(", ")}.` : "";
  await simulate();
}

/** Switches friction off, or on as it was. */
async function toggleFriction(isOn) {
  const { scenario } = state;
  if (!isOn) {
    state.frictionBefore = scenario.section("friction.");
    await change({ path: "friction.law" }, "none");
    return;
  }
  const usual = scenarioOf("full-coulomb");
  const values = state.frictionBefore ?? { ...usual.section("friction."), ...usual.section("stop.") };
  for (const [path, value] of Object.entries(values)) scenario.put(path, value);
  at("also").textContent = "";
  await simulate();
}

/** Starts from the scenario of a link. */
function start(text) {
  at("also").textContent = "";
  state.scenario = scenarioOf(text);
  state.frictionBefore = null;
  state.time = 0;
  return simulate();
}

/** Starts from a fitted scenario. */
function takeFit({ preset, set }) {
  reveal();
  at("first").scrollIntoView();
  return start(linkOf({ preset, set }));
}

/** Starts from a preset that was chosen on the page. */
function startPreset(name) {
  reveal();
  return start(name);
}

/** Keeps the run that is shown as A, or removes A. */
function pin(wanted = !state.pinned) {
  state.pinned = wanted ? state.run : null;
  state.window = null;
  showPinned();
  showSummary();
  toLink();
  draw();
  ask();
}

function showPinned() {
  const { pinned } = state;
  at("pin").textContent = pinned ? "Remove A" : "Keep as A";
  at("pin-note").textContent = pinned
    ? `A (grey) is ${runName(pinned)}. Change something: B (red) is the changed run.`
    : "Keep this run as A, then change something: B is drawn beside it.";
  at("compared").hidden = !pinned;
  at("comparison").replaceChildren();
}

async function save() {
  const { run } = state;
  at("digest").textContent = "recording …";
  const { bytes, digest, error } = await helper.request({ record: { scenario: run.scenario, encoding: at("encoding").value } });
  at("digest").textContent = error ?? `content digest (SHA-256): ${digest}`;
  if (error) return;
  const file = URL.createObjectURL(new Blob([bytes], { type: "application/octet-stream" }));
  element("a", { href: file, download: `${run.file}.mcap` }).click();
  setTimeout(() => URL.revokeObjectURL(file), 60_000);
}

async function copy(text, button) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    prompt("Copy this:", text);
  }
  const label = button.textContent;
  button.textContent = "Copied";
  setTimeout(() => (button.textContent = label), 1000);
}

/** Opens the address: a scenario, a pair, or a step of the lesson. An address that is followed meanwhile replaces it. */
let opened = 0;
async function open() {
  if (location.hash === "#teacher") return;
  const turn = ++opened;
  const wanted = parseLink(location.hash);
  const step = STEPS_OF_LESSON[wanted.lesson - 1];
  // A step as it was opened, not one in which something has been changed.
  const isWholeStep = Boolean(step) && (!wanted.ours || (wanted.ours === step.ours && wanted.theirs === step.theirs));
  state.guess = isWholeStep && wanted.moment === null ? { seen: 0 } : null;
  if (state.guess) play(false);
  lesson.show(wanted.lesson);
  if (isWholeStep) showOnly(step.arrows);
  const theirs = isWholeStep ? step.theirs : wanted.theirs;
  state.pinned = null;
  showPinned();
  if (theirs) {
    await start(theirs);
    if (turn !== opened) return;
    if (state.run) pin(true);
  }
  await start((isWholeStep ? step.ours : wanted.ours) || DEFAULT);
  if (turn !== opened) return;
  if (state.run && wanted.moment !== null) choose(wanted.moment);
  document.body.classList.add("ready");
}

function leaveLesson(number) {
  lesson.show(number);
  reveal();
  toLink();
  draw();
}

/** Checks the boxes of the arrows with these names. */
function showOnly(names) {
  for (const name of Object.keys(ARROWS)) {
    view.shown[name] = names.includes(name);
    at(`show-${name}`).checked = view.shown[name];
  }
}

const curves = new Curves(at("curves"), { choose: seek, zoom });
const energy = new EnergyAreas(at("energy"), { choose: seek, zoom });
const view = new View(at("top"), draw);
const events = new EventList(at("events"), seek);
const lesson = new Lesson(at("lesson"), { open: leaveLesson, answered: reveal });
const knobs = new Knobs(at("knobs"), { changed: put, toggled: toggleFriction });
/** The scenario on the screen, with its applicable keys and their values. */
const describedScenario = () => ({
  ...state.scenario.request,
  keys: state.run?.keys ?? [],
  values: { ...state.scenario.preset.values, ...state.scenario.set },
});
/** Shows a run of a recording. */
function showRecorded({ preset, set }) {
  reveal();
  at("first").scrollIntoView();
  return start(linkOf({ preset, set }));
}
const verifyPanel = new VerifyPanel(module, { start: showRecorded });
const fitPanel = new FitPanel(module, { scenario: describedScenario, titleOf, take: takeFit, copy, startFrom: startPreset });
/** Whether other keys may have to change with a key: it is a choice or a formula, or is set or removed. */
const hasFollowers = (key, value) => !key.range || value === "" || state.scenario.value(key.path) === undefined;
const controls = new Controls(at("controls"), (key, value) => (hasFollowers(key, value) ? change(key, value) : put(key, value)));

at("presets").replaceChildren(
  ...BUTTONS.map((value) => element("button", { type: "button", value, textContent: titleOf(value), title: HINTS[value] ?? "", onclick: () => startPreset(value) })),
);
at("preset").replaceChildren(
  ...tables.presets.map(({ name, title, description }) => element("option", { value: name, textContent: title, title: description })),
);
at("arrows").replaceChildren(
  ...Object.entries(ARROWS).map(([name, { label, symbol, color }]) => {
    const box = element("input", { type: "checkbox", id: `show-${name}`, checked: view.shown[name] });
    box.onchange = () => {
      view.shown[name] = box.checked;
      draw();
    };
    const sign = element("b", { textContent: symbol });
    sign.style.color = labelColor(color, "var(--ink)");
    return element("label", {}, box, `${label} `, sign, " ", element("small", { id: `scale-${name}` }));
  }),
);
at("preset").onchange = () => startPreset(at("preset").value);
at("play").onclick = () => play();
at("time").oninput = () => seek(Number(at("time").value));
for (const id of ["time", "curves", "energy"]) holdPlayback(at(id));
at("speed").onchange = () => {
  state.speed = Number(at("speed").value);
  state.isSpeedChosen = true;
};
at("pin").onclick = () => pin();
at("save").onclick = save;
at("copy-command").onclick = ({ target }) => copy(state.scenario.command, target);
at("copy-link").onclick = ({ target }) => copy(`${location.href.split("#")[0]}${link()}&at=${state.time.toFixed(3)}`, target);
at("reset").onclick = () => start(state.scenario.preset.name);
at("reset-view").onclick = () => view.reset();
for (const details of at("form").querySelectorAll("details")) {
  details.ontoggle = () => details.open && details.scrollIntoView({ block: "nearest" });
}
at("help").onclick = () => at("keys").showModal();
at("address").textContent = placeOfPage();
at("print").onclick = () => print();
at("version").textContent = tables.version;
showWorksheet(at("guesses"), at("worksheet"), at("worksheet-answers"));
showKeys(at("keys").querySelector("dl"));

/** Where the page is: its address, or the name of its file. */
function placeOfPage() {
  const address = location.href.split("#")[0];
  return location.protocol === "file:" ? `the file ${decodeURIComponent(address.split("/").at(-1))}` : address;
}

/** Follows a link in the page, and shows the top, from which the link may be far away. */
function follow() {
  if (location.hash === "#teacher") return undefined;
  at("worksheet-answers").open = false;
  at("first").scrollIntoView();
  return open();
}
addEventListener("hashchange", follow);
addEventListener("click", ({ target }) => {
  // A link to the address that is open already changes nothing in it, so there is no event.
  if (target.closest?.("a")?.getAttribute("href") === location.hash && location.hash) follow();
});
/** Reads files that are dropped, one after the other: recordings are verified, tables are fitted. */
let reading = Promise.resolve();
function takeDropped(files) {
  for (const file of files) reading = reading.then(() => takeFile(file));
}

async function takeFile(file) {
  try {
    const content = await file.arrayBuffer();
    // What comes of it is not waited for: it can be stopped, and then never comes.
    if (isRecording(file.name, new Uint8Array(content))) verifyPanel.take(file.name, new Uint8Array(content));
    else fitPanel.take(file.name, content);
  } catch (error) {
    verifyPanel.fail(file.name, `cannot be read (${error.message})`);
  }
}

function markDrop(event, isOver) {
  if (!event.dataTransfer?.types.includes("Files")) return;
  event.preventDefault();
  document.body.classList.toggle("dropping", isOver);
}
addEventListener("dragover", (event) => markDrop(event, true));
addEventListener("dragleave", (event) => event.relatedTarget || markDrop(event, false));
addEventListener("drop", (event) => {
  markDrop(event, false);
  if (event.dataTransfer?.files.length > 0) takeDropped([...event.dataTransfer.files]);
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  draw();
  fitPanel.draw();
});
new ResizeObserver(draw).observe(at("first"));
for (const id of ["top", "curves", "energy"]) new ResizeObserver(draw).observe(at(id));

/** What the keys of KEYS do. */
const ACTIONS = {
  play: () => play(),
  later: () => seek(state.time + 0.01),
  earlier: () => choose(state.time - 0.01),
  start: () => choose(0),
  end: () => seek(Infinity),
  closer: () => zoom((state.window ?? [0, latest()]).map((end) => state.time + (end - state.time) / 2)),
  whole: () => zoom(null),
  keep: () => at("pin").click(),
  help: () => at("help").click(),
  turn: (event) => view.turn(...{ ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key]),
};
const TEXT_FIELDS = "input:not([type=range], [type=checkbox]), textarea";

/**
 * Whether the focused element uses a key itself. Space and A are the page's everywhere but in text fields; after Tab, also
 * a box or a list keeps Space, because nothing else operates it. (Enter operates buttons.)
 */
function isOwnKey({ target, key }) {
  if (target.closest(TEXT_FIELDS) || target.closest("select:focus-visible")) return true;
  if (key === " ") return target.matches("[type=checkbox]:focus-visible");
  if (key === "Enter") return target.closest("button, summary, a") !== null;
  return target.closest("input, select") !== null && !["a", "A", "?"].includes(key);
}
// Firefox clicks a button when Space is released.
addEventListener("keyup", (event) => {
  if (event.key === " " && event.target.closest("button, summary, input") && !isOwnKey(event) && !at("keys").open) event.preventDefault();
});
addEventListener("keydown", (event) => {
  if (isOwnKey(event) || event.ctrlKey || event.metaKey || event.altKey || at("keys").open) return;
  const place = event.target.id === "top" ? "top" : "";
  const key = KEYS.find((each) => each.keys.includes(event.key) && (each.place === place || (!each.place && !place))) ?? KEYS.find((each) => !each.place && each.keys.includes(event.key));
  if (!key || (event.target.id === "events" && event.key.startsWith("Arrow"))) return;
  event.preventDefault();
  ACTIONS[key.action](event);
});

const isCalm = matchMedia("(prefers-reduced-motion: reduce)").matches;
const isAtMoment = parseLink(location.hash).moment !== null;
await open();
if (!document.body.classList.contains("ready")) {
  await start(DEFAULT); // opened at the teacher's notes
  document.body.classList.add("ready");
}
if (!isCalm && !isAtMoment && !state.guess) play(true);
