// The texts about a run: its events, its explanation, and the comparison of A and B.

import { element, typeset } from "./elements.mjs";
import { sentenceText } from "./sentence.mjs";

/** Groups items in order of their first appearance. */
function grouped(items, keyOf) {
  const groups = new Map();
  for (const item of items) {
    const group = groups.get(keyOf(item)) ?? [];
    groups.set(keyOf(item), [...group, item]);
  }
  return groups;
}

/** The list of events, which follows the time. Consecutive events of frequent kinds are grouped. */
export class EventList {
  constructor(place, choose) {
    this.place = place;
    this.choose = choose;
    this.events = [];
    place.onkeydown = (event) => {
      const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
      const next = step && this.events[this.last + step];
      if (next) choose(next.time);
      if (step) event.preventDefault();
    };
  }

  show(events) {
    this.events = events;
    const counts = new Map([...grouped(events, ({ kind }) => kind)].map(([kind, { length }]) => [kind, length]));
    const isFrequent = (event) => event && counts.get(event.kind) > 2;
    const groups = [];
    this.items = events.map((event, index) => {
      if (isFrequent(event) && isFrequent(events[index - 1])) groups.at(-1).push(index);
      else groups.push([index]);
      const time = element("b", { textContent: `${event.time.toFixed(4)} s` });
      return element("li", { onclick: () => this.choose(event.time) }, time, ` ${sentenceText(event.text)}`);
    });
    this.place.replaceChildren(...groups.flatMap((group) => this.entries(group)));
  }

  /** The list entries of a group: its events if there are fewer than five, otherwise one collapsible entry. */
  entries(group) {
    const own = group.map((index) => this.items[index]);
    if (own.length < 5) return own;
    const events = group.map((index) => this.events[index]);
    const span = `${events[0].time.toFixed(4)} to ${events.at(-1).time.toFixed(4)} s`;
    const counts = [...grouped(events, ({ plural }) => plural)].filter(([plural]) => plural).map(([plural, { length }]) => ` ${length} ${plural}`);
    const heading = element("summary", {}, element("b", { textContent: span }), counts.join());
    return [element("li", {}, element("details", {}, heading, element("ol", {}, ...own)))];
  }

  /** Marks the last event at a time. */
  mark(time) {
    this.last = this.events.findLastIndex((event) => event.time <= time + 1e-9);
    const last = this.items[this.last];
    const item = last?.closest("details:not([open])") ?? last;
    if (item === this.marked) return;
    this.marked?.classList.remove("now");
    this.marked = item;
    item?.classList.add("now");
    if (item) this.place.scrollTop = item.offsetTop - this.place.clientHeight / 2;
  }
}

/** Shows the causal paragraph and the chapters of the program's explanation. */
export function showExplanation(story, place, { error, story: paragraph, chapters }) {
  story.textContent = error ?? sentenceText(paragraph ?? []); // what remains of a damaged run may have no reason
  place.replaceChildren(
    ...(chapters ?? []).flatMap(({ title, parts }) => [
      element("h3", { textContent: sentenceText(title) }),
      element("p", {}, ...typeset(parts.map(({ line }) => sentenceText(line)).join(" "))),
    ]),
  );
}

/** The row of a finding: what is compared, A, B and B − A, with degrees beside A's and B's angles. */
function findingRows(cells) {
  const [name, ...numbers] = cells.map(sentenceText);
  return [
    element("tr", {}, element("th", { colSpan: 3, scope: "row", textContent: name })),
    element("tr", {}, ...numbers.map((textContent) => element("td", { textContent }))),
  ];
}

/** A table of findings, whose last column has this name; nothing if there are none. */
function findingTable(findings, last) {
  if (findings.length === 0) return [];
  const head = element("tr", {}, ...["A", "B", last].map((textContent) => element("th", { textContent })));
  return [element("table", {}, head, ...findings.flatMap(findingRows))];
}

/** Shows the program's comparison of A and B, or a note instead: the differences first, equal numbers at the end. */
export function showComparison(place, { error, headline, agreement, losses = [], findings = [], remarks = [], equal = [] }) {
  const paragraphs = (sentences) => sentences.map((textContent) => element("p", { textContent }));
  const lead = error ? [error] : [headline, agreement].filter(Boolean).map(sentenceText).map((text) => (text.endsWith(".") ? text : `${text}.`));
  place.replaceChildren(
    ...paragraphs(lead),
    ...paragraphs(losses),
    ...findingTable(findings, "B − A"),
    ...paragraphs(remarks.map(sentenceText)),
    ...findingTable(equal, "equal within"),
  );
}
