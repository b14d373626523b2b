// The lesson: five steps, each with a question, what to watch, and an answer to open.

import { element } from "./elements.mjs";

/**
 * The steps. `ours` is the scenario that is edited (B), `theirs` the pinned one (A), `arrows` those that are shown,
 * `watches` the graphs that a small screen shows before the sliders.
 * The numbers in the answers are checked against the runs in page/test/runs.mjs.
 */
export const STEPS_OF_LESSON = [
  {
    title: "Does it rise without friction?",
    // A runs as long.
    ours: "frictionless&stop.duration=25",
    theirs: "full-coulomb",
    arrows: ["slip", "force"],
    question: "A slips on the table with friction, B without. Guess first: which of them rises?",
    watches: "curves",
    watch: "the tilt θ, in the two pictures and in the uppermost curve.",
    answer:
      "Only A. Without friction the tilt stays at 28.6°, to a hundredth of a degree, for as long as you like: the top only goes round. With friction it rises from 28.6° to 1.1° in 24.7 s.",
  },
  {
    title: "How can friction lift it?",
    ours: "full-coulomb",
    arrows: ["torque", "momentum"],
    question: "Friction acts on the peg, along the table. How can it turn the axis upright?",
    watch: "the angular momentum L (green), its horizontal part, and the friction torque τ, drawn at the tip of the horizontal part. The size of both parts of L is below the picture.",
    answer:
      "The friction torque is horizontal and points against the horizontal part of L. So it shortens that part, from 5.90 to 0.22 mN m s, and leaves the vertical part at 10.95 mN m s (1 mN m s = 0.001 kg m²/s). L becomes vertical; a fast top's axis stays near L, so the axis becomes vertical too. Gravity only turns L about the vertical.",
  },
  {
    title: "Where does the energy come from?",
    ours: "full-coulomb",
    arrows: ["slip", "force"],
    question: "The centre of mass rises, although friction takes energy away. What pays for it?",
    watches: "energy",
    watch: "the energy areas: spin (blue) becomes heat. The height (green) changes too little to be seen there; the numbers below show it.",
    answer:
      "The spin. It loses 239.7 mJ: 2.6 mJ of them lift the top, 237.1 mJ become heat. The spin ω·n falls from 27.3 to 24.0 rev/s. To rise by 2.4 mm is cheap, to do it by slipping is not.",
  },
  {
    title: "What makes it rise faster?",
    ours: "full-coulomb&friction.k=0.06",
    theirs: "full-coulomb",
    arrows: ["slip", "force"],
    question: "B has twice the friction of A. How long does it take? Then give B less spin: does it take longer?",
    watch: "when each becomes upright. Move the sliders of friction and spin.",
    answer:
      "12.4 s instead of 24.7 s: the time is inversely proportional to k. With less spin there is less angular momentum to turn: at k = 0.06 and 100 rad/s (15.9 rev/s) B is upright after 7.0 s. With too little it falls: at 30 rad/s (4.8 rev/s), after 2.7 s.",
  },
  {
    title: "Why does a tippe top turn over?",
    ours: "tippe-top",
    arrows: ["slip", "force"],
    question: "Its centre of mass lies below the middle of the ball, and still it rises. What makes it turn over? And which way does it spin then?",
    watch: "the spin about its own axis, ω·n, and the sense in which it turns seen from above.",
    answer:
      "It slips. Friction at the contact point takes energy, but can't change Jellett's integral: the angular momentum along the line from the centre of mass to the contact point, times its length. Turned over, the line is longer (26 instead of 14 mm), so less spin is enough: 2.93 instead of 10.24 mJ of motion. Of the rest, 2.35 mJ lift the centre of mass by 12.0 mm, and 4.96 mJ become heat. Seen from above it spins as before; about its own axis therefore the other way, at −6.8 instead of 12.7 rev/s.",
  },
];

/** The way from a step to those beside it; the last one leads out of the lesson. */
function stepLinks(number, leave) {
  const back = number > 1 ? [element("a", { href: `#lesson=${number - 1}`, textContent: "Back" })] : [];
  const next = STEPS_OF_LESSON[number];
  const onward = next
    ? element("a", { href: `#lesson=${number + 1}`, textContent: `Next: ${next.title}`, className: "onward" })
    : element("button", { type: "button", textContent: "Try your own", className: "onward", onclick: leave });
  return element("p", { className: "steps" }, ...back, onward);
}

/** The strip with the step of the lesson. `open(step)` is called with a number from 1, or 0 to leave the lesson; `answered()` when the answer is opened. */
export class Lesson {
  constructor(place, { open, answered }) {
    this.place = place;
    this.open = open;
    this.answered = answered;
    this.step = 0;
  }

  show(number) {
    this.step = STEPS_OF_LESSON[number - 1] ? number : 0;
    this.place.hidden = this.step === 0;
    document.body.classList.toggle("in-lesson", this.step > 0);
    document.body.dataset.watches = STEPS_OF_LESSON[this.step - 1]?.watches ?? "";
    if (this.step === 0) return;
    const { title, question, watch, answer } = STEPS_OF_LESSON[this.step - 1];
    const steps = STEPS_OF_LESSON.map(({ title }, index) =>
      element("a", { href: `#lesson=${index + 1}`, textContent: index + 1, title, ariaCurrent: index + 1 === this.step ? "step" : null }),
    );
    this.place.replaceChildren(
      element("nav", { ariaLabel: "Steps of the lesson" }, "Lesson ", ...steps, element("button", { type: "button", textContent: "Leave", onclick: () => this.open(0) })),
      element("div", {}, element("h2", { textContent: `${this.step}. ${title}` }), element("p", { textContent: question }), element("p", { className: "watch" }, element("b", { textContent: "Watch " }), watch)),
      element("details", { ontoggle: ({ target }) => target.open && this.answered() }, element("summary", { textContent: "Answer" }), element("p", { textContent: answer }), stepLinks(this.step, () => this.open(0))),
    );
  }
}
