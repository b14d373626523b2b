// Page state: the edited scenario, its run, and a pinned run for comparison.

import { controls, element } from "./controls.mjs";
import { Curves } from "./curves.mjs";
import { Scenario } from "./scenario.mjs";
import { View } from "./top.mjs";

const LONGEST = 25; // maximum playback time of a run, s
const at = (id) => document.getElementById(id);

/** A web worker that handles requests to toprise. A newer simulation supersedes an older one. */
class Asker {
  constructor(module) {
    this.worker = new Worker(URL.createObjectURL(new Blob([at("worker").textContent], { type: "text/javascript" })));
    this.answers = new Map();
    this.id = 0;
    this.worker.onmessage = ({ data }) => {
      this.answers.get(data.id)?.(data.answer);
      this.answers.delete(data.id);
    };
    this.tables = this.send({ module });
  }

  send(message) {
    const id = ++this.id;
    return new Promise((resolve) => {
      this.answers.set(id, resolve);
      this.worker.postMessage({ id, ...message });
    });
  }
}

/** The WebAssembly in this file. */
async function compiled() {
  const packed = Uint8Array.from(atob(at("wasm").textContent.trim()), (letter) => letter.charCodeAt(0));
  const bytes = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(bytes).arrayBuffer());
}

const module = await compiled();
const runner = new Asker(module);
const helper = new Asker(module);
const tables = await runner.tables;

let scenario;
let run = null;
let items = []; // of the list of events
let pinned = null;
let time = 0;
let window_ = null;
let speed = 1;
let isPlaying = false;

/** URL-decodes a part of a link; returns it unchanged if it is malformed. */
function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** Parses a link: `#paper&friction.k=0.02`, followed by `&vs=` and the pinned scenario, and `&at=` and the time in seconds. */
function fromLink() {
  const [scenarios, moment] = location.hash.slice(1).split("&at=");
  const [ours, theirs] = scenarios.split("&vs=").map(decoded);
  const read = (text) => {
    const [preset, ...set] = text.split("&");
    return new Scenario(tables, preset, Object.fromEntries(set.map((change) => [change.split("=")[0], change.slice(change.indexOf("=") + 1)])));
  };
  return { ours: read(ours || "paper"), theirs: theirs && read(theirs), moment: Number(moment) || 0 };
}

const link = ({ preset, set }) => [preset, ...Object.entries(set).map(([path, value]) => `${path}=${value}`)].join("&");

function toLink() {
  const hash = `#${link(scenario.given)}${pinned ? `&vs=${link(pinned.scenario)}` : ""}`;
  history.replaceState(null, "", hash);
}

/** A run with quantities derived from its columns. */
function completed(answer) {
  const { columns } = answer;
  columns.height = columns.peg_z.map((z) => z - answer.peg_radius);
  const greatest = columns.slip_speed.reduce((most, speed) => Math.max(most, speed), 1e-9);
  const power = 10 ** Math.floor(Math.log10(greatest));
  return { ...answer, flies: columns.regime.includes(2), greatest_slip: [1, 2, 5, 10].find((step) => step * power >= greatest) * power, end: columns.time.at(-1) };
}

async function simulate() {
  toLink();
  const slow = setTimeout(() => document.body.classList.add("stale"), 200);
  const answer = await runner.send({ question: { simulate: scenario.given }, columns: tables.columns });
  clearTimeout(slow);
  if (!answer) return; // overtaken
  at("error").textContent = answer.error ?? "";
  if (answer.error && !run) at("summary").textContent = "No run to show: correct the scenario first.";
  document.body.classList.toggle("stale", Boolean(answer.error));
  for (const button of document.querySelectorAll("#take button, #pin")) button.disabled = Boolean(answer.error);
  if (answer.error) return;
  const end = run?.end;
  run = completed(answer);
  if (run.end !== end) {
    time = Math.min(time, run.end);
    window_ = null;
    setSpeed();
  }
  at("summary").textContent = run.sentence;
  at("command").textContent = scenario.command;
  at("digest").textContent = "";
  listEvents();
  draw();
  ask();
}

/** Requests the explanation and comparison once input has paused. */
let waiting;
function ask() {
  clearTimeout(waiting);
  waiting = setTimeout(async () => {
    const answer = await helper.send({ question: { explain: run.scenario } });
    if (answer.error) at("explanation").replaceChildren(element("p", { textContent: answer.error }));
    else
      at("explanation").replaceChildren(
        ...answer.flatMap(({ heading, sentences }) => [element("h3", { textContent: heading }), element("p", { textContent: sentences.join(" ") })]),
      );
    if (!pinned) return;
    if (pinned.digest === run.digest) compare({ error: "This run is pinned as A. Change a value to compare it with B." });
    else compare(await helper.send({ question: { compare: { a: pinned.scenario, b: run.scenario } } }));
  }, 300);
}

function compare({ error, verdict, findings }) {
  const head = element("tr", {}, ...["A", "B", "B − A"].map((text) => element("th", { textContent: text })));
  const rows = (findings ?? []).flatMap(([what, ...numbers]) => [
    element("tr", {}, element("th", { colSpan: 3, scope: "row", textContent: what })),
    element("tr", {}, ...numbers.map((text) => element("td", { textContent: text }))),
  ]);
  const table = rows.length > 0 ? element("table", {}, head, ...rows) : element("p", { textContent: error ?? `${verdict}: no differences in averages, events or energy.` });
  at("comparison").replaceChildren(element("h2", { textContent: "A and B" }), table);
}

/** Lists the events. Consecutive events of frequent kinds are grouped. */
function listEvents() {
  const kinds = Map.groupBy(run.events, ({ kind }) => kind);
  const isOften = (event) => event && kinds.get(event.kind).length > 2;
  const groups = [];
  items = run.events.map((event, index) => {
    const text = [element("b", { textContent: `${event.time.toFixed(4)} s` }), ` ${event.text}`];
    if (isOften(event) && isOften(run.events[index - 1])) groups.at(-1).push(index);
    else groups.push([index]);
    return element("li", { onclick: () => choose(event.time) }, ...text);
  });
  at("events").replaceChildren(...groups.flatMap(entries));
}

/** The list entries of a group: its events if there are fewer than five, otherwise one collapsible entry. */
function entries(group) {
  const own = group.map((index) => items[index]);
  if (own.length < 5) return own;
  const events = group.map((index) => run.events[index]);
  const kinds = [...Map.groupBy(events, ({ plural }) => plural)].filter(([plural]) => plural);
  const span = `${events[0].time.toFixed(4)} to ${events.at(-1).time.toFixed(4)} s`;
  const counts = kinds.map(([plural, { length }]) => ` ${length} ${plural}`);
  const heading = element("summary", {}, element("b", { textContent: span }), counts.join());
  return element("li", {}, element("details", {}, heading, element("ol", {}, ...own)));
}

/** The runs to draw: the pinned run, if any, and the edited one. */
function shown() {
  const style = getComputedStyle(document.body);
  const changed = { run, color: style.getPropertyValue("--b"), name: `${pinned ? "B: " : ""}${run.title}` };
  return pinned ? [{ run: pinned, color: style.getPropertyValue("--a"), name: `A: ${pinned.title}` }, changed] : [changed];
}

const curves = new Curves(at("curves"), { choose, zoom });
const view = new View(at("top"), draw);

let isDrawing = false;
function draw() {
  if (isDrawing || !run) return;
  isDrawing = true;
  requestAnimationFrame(() => {
    isDrawing = false;
    const runs = shown();
    curves.draw(runs, window_ ?? [0, latest()], time);
    view.draw(runs, time);
    at("time").max = latest();
    at("time").value = time;
    at("clock").textContent = `${time.toFixed(3)} s`;
    const last = items[lastEvent()];
    const item = last?.closest("details:not([open])") ?? last;
    for (const other of at("events").querySelectorAll(".now")) other.classList.remove("now");
    item?.classList.add("now");
    if (item) at("events").scrollTop = item.offsetTop - at("events").clientHeight / 2;
  });
}

const lastEvent = () => run.events.findLastIndex((event) => event.time <= time + 1e-9);

/** The end of the longest run that is shown, s. */
const latest = () => Math.max(run.end, pinned?.end ?? 0);

function choose(when) {
  time = Math.min(Math.max(when, 0), latest());
  draw();
}

function zoom(wanted) {
  const [from, to] = wanted ?? [0, latest()];
  const width = Math.max(to - from, 1e-3); // s
  window_ = width >= latest() ? null : [Math.max(from, 0), Math.min(Math.max(from, 0) + width, latest())];
  draw();
}

function setSpeed() {
  const wanted = Math.max(run.end / LONGEST, 0.01);
  const speeds = [...at("speed").options].map((option) => Number(option.value));
  speed = speeds.find((each) => each >= wanted) ?? speeds.at(-1);
  at("speed").value = String(speed);
}

let before = 0;
function play(wanted = !isPlaying) {
  isPlaying = wanted;
  at("play").textContent = isPlaying ? "Pause" : "Play";
  if (isPlaying && time >= latest()) time = 0;
  before = performance.now();
  if (isPlaying) requestAnimationFrame(step);
}

function step(now) {
  if (!isPlaying) return;
  choose(time + ((now - before) / 1000) * speed);
  before = now;
  if (time >= latest()) play(false);
  else requestAnimationFrame(step);
}

function changed(path, value, follows) {
  at("also").textContent = "";
  if (follows || value === "" || path === "drilling.k") {
    const before = scenario.set;
    scenario.change(path, value);
    const also = Object.entries(scenario.set).filter(([other, value]) => other !== path && value !== before[other]);
    if (also.length > 0) at("also").textContent = `This also sets ${also.map(([other, value]) => `${other} = ${value || "none"}`).join(", ")}.`;
    showControls();
  } else scenario.put(path, value);
  mark();
  simulate();
}

/** Marks the keys that differ from the preset. */
function mark() {
  for (const row of document.querySelectorAll(".key")) row.classList.toggle("changed", row.dataset.path in scenario.set);
}

function showControls() {
  const focused = document.activeElement?.closest?.(".key")?.dataset.path;
  controls(at("controls"), scenario, changed);
  at("preset").value = scenario.preset.name;
  at("description").textContent = scenario.preset.values.description ?? "";
  mark();
  if (focused) document.querySelector(`[data-path="${focused}"] :is(select, input)`)?.focus();
}

function pin() {
  pinned = pinned ? null : run;
  at("pin").textContent = pinned ? "Unpin A" : "Pin as A";
  at("comparison").replaceChildren();
  toLink();
  draw();
  ask();
}

async function save() {
  const encoding = at("encoding").value;
  at("digest").textContent = "recording …";
  const { bytes, digest, error } = await helper.send({ question: { record: { scenario: run.scenario, encoding } } });
  at("digest").textContent = error ?? `content digest (SHA-256): ${digest}`;
  if (error) return;
  const file = URL.createObjectURL(new Blob([bytes], { type: "application/octet-stream" }));
  element("a", { href: file, download: `${run.scenario.preset}.mcap` }).click();
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

const KEYS = {
  " ": () => play(),
  ArrowRight: () => choose(time + 0.01),
  ArrowLeft: () => choose(time - 0.01),
  Home: () => choose(0),
  End: () => choose(Infinity),
  "+": () => zoom([time - 0.25, 0.25 + time].map((end) => time + (end - time) * 2)),
  "-": () => zoom(null),
  p: () => at("pin").click(),
};

async function begin() {
  const { ours, theirs, moment } = fromLink();
  pinned = null;
  scenario = theirs || ours;
  if (theirs) {
    showControls();
    await simulate();
    if (run) pin();
    scenario = ours;
  }
  showControls();
  await simulate();
  if (run) choose(moment);
  document.body.classList.add("ready");
}

at("preset").replaceChildren(...tables.presets.map(({ name }) => element("option", { textContent: name })));
at("preset").onchange = () => {
  at("also").textContent = "";
  scenario.start(at("preset").value);
  showControls();
  time = 0;
  simulate();
};
at("play").onclick = () => play();
at("time").oninput = () => choose(Number(at("time").value));
at("speed").onchange = () => (speed = Number(at("speed").value));
at("pin").onclick = pin;
at("save").onclick = save;
at("copy-command").onclick = ({ target }) => copy(scenario.command, target);
at("copy-link").onclick = ({ target }) => copy(`${location.href}&at=${time.toFixed(3)}`, target);
at("reset").onclick = () => at("preset").onchange();
at("version").textContent = tables.version;
at("events").onkeydown = (event) => {
  const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
  const next = step && run.events[lastEvent() + step];
  if (next) choose(next.time);
  if (step) event.preventDefault();
};
addEventListener("resize", draw);
addEventListener("hashchange", begin);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
addEventListener("keydown", (event) => {
  if (event.target.closest("input, select, button, summary") && event.key !== "p") return;
  if (event.target.closest("input") || !KEYS[event.key] || event.ctrlKey || event.metaKey) return;
  event.preventDefault();
  KEYS[event.key]();
});
await begin();
