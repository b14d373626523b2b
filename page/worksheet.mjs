// The worksheet of the lesson.

import { element } from "./elements.mjs";
import { STEPS_OF_LESSON } from "./lesson.mjs";

/** Coefficients of friction and the times to rise of the preset full-coulomb, s. Checked in page/test/runs.mjs. */
export const RISE_TIMES = [[0.015, 49.5], [0.02, 37.1], [0.03, 24.7], [0.04, 18.5], [0.06, 12.4]];

/** Fills the worksheet: the questions of the lesson, and a table of rise times. */
export function showWorksheet(questions, table, solution) {
  const guesses = STEPS_OF_LESSON.map(({ title, question }) => element("li", {}, element("b", { textContent: title }), ` ${question}`));
  questions.replaceChildren(...guesses);
  const rows = RISE_TIMES.map(([k]) => {
    const link = element("a", { href: `#full-coulomb&friction.k=${k}`, textContent: k });
    return element("tr", {}, element("td", {}, link), element("td"), element("td"));
  });
  table.tBodies[0].replaceChildren(...rows);
  const times = RISE_TIMES.map(([k, time]) => `k = ${k}: ${time} s`).join("; ");
  solution.querySelector("p").textContent = `${times}. The product k × time is 0.742 s each time, so k = 0.01 takes about 74 s: longer than the 60 s after which the run stops.`;
}
