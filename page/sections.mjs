// Sections of the program's reports: titles, tables, sentences.

import { element } from "./elements.mjs";
import { sentenceText } from "./sentence.mjs";

/** The head of a row: a key or field with its unit, in the words of the page; the pointer shows its name in the program. */
function rowHead(cell) {
  const title = cell.map(({ key, field }) => key ?? field ?? "").join("");
  return element("th", { scope: "row", title, textContent: sentenceText(cell) });
}

/** The head of a column. A fraction stays in one line. */
const columnHead = (text) => element("th", { textContent: text.replaceAll("/", "\u2060/\u2060") });

/** A table of a report. Narrow screens show each row as a block with the names of its cells. */
function tableElement({ header, rows }) {
  const names = header.map(sentenceText);
  const isTitled = !names[0]; // a table of facts has no header
  const head = element("tr", {}, ...names.map(columnHead));
  const body = rows.map((row) => {
    const cells = row.map((cell, index) => {
      if (index === 0 && isTitled) return rowHead(cell);
      const made = element("td", { textContent: sentenceText(cell) });
      made.dataset.name = names[index] ?? "";
      return made;
    });
    return element("tr", {}, ...cells);
  });
  return element("table", { className: "stacking" }, element("thead", {}, head), element("tbody", {}, ...body));
}

export const paragraph = (pieces) => element("p", { textContent: sentenceText(pieces) });
/** A part of a section: a table or a sentence. */
export const partElement = ({ table, line }) => (table ? tableElement(table) : paragraph(line));

/** A section of a report: its title, the note to it, and its tables and sentences. */
export function sectionParts({ title, note, parts }) {
  const heading = element("h3", { textContent: sentenceText(title) });
  return [heading, ...(note.length > 0 ? [paragraph(note)] : []), ...parts.map(partElement)];
}
