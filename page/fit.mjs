// A measured motion: a file that is dropped on the page, or chosen, is fitted and shown with its best fit.

import { at, element } from "./elements.mjs";
import { Engine } from "./engine.mjs";
import { angleError, freeParameters, heldText } from "./free.mjs";
import { drawMeasured, measuredName } from "./measured.mjs";
import { keyName } from "./names.mjs";
import { partElement, paragraph, sectionParts } from "./sections.mjs";
import { sentenceText } from "./sentence.mjs";

/** Phones give text tables types of their own, so names count, too. */
const TABLES = ".csv,.tsv,.txt,text/csv,text/plain,text/tab-separated-values,text/comma-separated-values,application/vnd.ms-excel";

/** The measured rise that is in the page: its name, and the preset of its top. */
const EXAMPLE = { name: "top.csv", preset: "full-coulomb" };

/** A word of a command line, in quotes if a shell would read it otherwise. */
export const quotedWord = (word) => (/^[\w./=,:+-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);

/** What the columns of the table of signals mean. */
const SIGNAL_NOTE =
  "σ is the size of the errors of measurement. RMS/σ is the size of the residuals (measured minus fitted) and should be near 1. Uncorrelated: the probability p that mere noise is at least as correlated in time; below 0.001 the model misses something.";

/** What the program says first of a fit that started from the preset with this title. Its law is named if it was chosen. */
function headlineParts({ words, report }, title, scenario) {
  const law = "friction.law" in scenario.set ? ` (${report.law})` : "";
  const held = heldText(report.parameters.map(({ name }) => name), scenario);
  return [
    element("p", { className: "verdict" }, element("b", { textContent: `${title}${law}: ${sentenceText(words.verdict)}` })),
    element("p", { className: "estimate", textContent: sentenceText(words.headline) }),
    ...(held ? [element("p", { className: "held", textContent: held })] : []),
  ];
}

/** What else it says. The first section is on the verdict, which is above: what was fitted comes last. */
function reportParts({ words: { sections: [{ note, parts }, ...others] } }) {
  const explanation = element("p", { textContent: SIGNAL_NOTE });
  return [...others.flatMap(sectionParts), explanation, ...parts.map(partElement), ...(note.length > 0 ? [paragraph(note)] : [])];
}

/** What the lines in the pictures are, and what the sliders can be set to: nothing, if the search ended without a minimum. */
function endOf({ report }) {
  if (!report.quality.is_converged) return { lines: "where the search ended", take: "" };
  const take = report.modes.length > 0 ? "Set the sliders to the best of these" : "Set the sliders to this fit";
  return { lines: "the best fit", take };
}

/** Whether several spins describe the data, each with its own friction. */
const hasManySpins = ({ report }) => report.modes.length > 0;

export class FitPanel {
  /**
   * `scenario` gives the scenario to start from, with its applicable keys and their values, `titleOf` the title of a
   * preset; `take` is called with a fitted scenario, `copy` with a command and a button; `startFrom` shows a preset.
   */
  constructor(module, { scenario, titleOf, take, copy, startFrom }) {
    Object.assign(this, { module, scenario, titleOf });
    this.input = element("input", { type: "file", accept: TABLES });
    this.input.onchange = () => this.read(this.input.files[0]);
    at("fit-choose").onclick = () => this.open();
    at("fit-file").onclick = () => this.input.click();
    at("fit-example").onclick = () => this.readExample(startFrom);
    at("fit-again").onclick = () => this.fit();
    at("fit-hold").onclick = () => this.holdSpin();
    at("fit-cancel").onclick = () => this.end("Stopped.");
    at("fit-take").onclick = () => take({ preset: this.started.preset, set: this.result.set });
    at("fit-copy").onclick = ({ target }) => copy(at("fit-command").textContent, target);
    at("fit-close").onclick = () => this.close();
    at("fit-options").onsubmit = (event) => {
      event.preventDefault();
      this.fit();
    };
    new ResizeObserver(() => this.draw()).observe(at("fit-plots"));
  }

  async read(file) {
    this.input.value = ""; // so that the same file can be chosen again
    if (!file) return;
    await this.take(file.name, await file.arrayBuffer());
  }

  /** Fits the measured rise that is in the page, from the preset of its top. */
  async readExample(startFrom) {
    await startFrom(EXAMPLE.preset);
    await this.take(EXAMPLE.name, new TextEncoder().encode(at("example").textContent));
  }

  /** Fits the content of a file. */
  async take(name, content) {
    this.file = { name, bytes: new Uint8Array(content) };
    at("fit-name").textContent = name;
    at("fit-free").value = "";
    at("fit-options").hidden = false;
    this.open();
    await this.fit();
  }

  /** Shows the panel, which says what a file must be like. */
  open() {
    at("fit").hidden = false;
    at("fit").scrollIntoView();
  }

  /** Fits the scenario on the screen to the file, in a worker of its own, which can be stopped. */
  async fit() {
    this.engine?.worker.terminate();
    this.show(null);
    this.started = this.scenario();
    const { preset, set, keys } = this.started;
    const [{ free, error }, { sigma, error: sigmaError }] = [freeParameters(at("fit-free").value, keys), angleError(at("fit-sigma").value)];
    if (error ?? sigmaError) return this.end(error ?? sigmaError, true);
    const status = at("fit-status");
    status.textContent = "Fitting …";
    at("fit-cancel").hidden = false;
    const engine = new Engine(this.module, (text) => (status.textContent = text));
    this.engine = engine;
    const { name, bytes } = this.file;
    const request = { fit: { scenario: { preset, set }, file: name, free, sigma } };
    const response = await engine.send({ request, file: bytes });
    if (engine !== this.engine) return;
    this.end(response.sentence ? sentenceText(response.sentence) : (response.error ?? ""), Boolean(response.error));
    if (!response.error) this.show(response);
  }

  /** Fits again with the spin of the slider. */
  holdSpin() {
    const names = this.result.report.parameters.map(({ name }) => name);
    at("fit-free").value = names.filter((name) => name !== "initial.psi_dot").map(keyName).join(", ");
    return this.fit();
  }

  /** Ends a fit with a message. */
  end(message, isError = false) {
    this.engine?.worker.terminate();
    this.engine = null;
    at("fit-cancel").hidden = true;
    at("fit-status").textContent = message;
    at("fit-status").classList.toggle("wrong", isError);
  }

  show(result) {
    this.result = result;
    at("fit-status").classList.remove("wrong");
    at("fit-result").hidden = !result;
    at("fit-headline").replaceChildren(...(result ? headlineParts(result, this.titleOf(this.started.preset), this.started) : []));
    at("fit-report").replaceChildren(...(result ? reportParts(result) : []));
    at("fit-plots").replaceChildren();
    if (!result) return;
    at("fit-loose").hidden = !hasManySpins(result);
    const { lines, take } = endOf(result);
    at("fit-lines").textContent = `Dots are measured, lines are ${lines}: of the whole time, and of its beginning.`;
    at("fit-take").hidden = take === "";
    at("fit-take").textContent = take;
    at("fit-command").textContent = ["toprise", ...result.arguments].map(quotedWord).join(" ");
    at("fit-plots").replaceChildren(
      ...result.signals.flatMap(({ path, windows }) =>
        windows.map(() => element("canvas", { role: "img", ariaLabel: `${measuredName(path)}: measured values, and ${lines}` })),
      ),
    );
    this.draw();
  }

  draw() {
    const pictures = this.result?.signals.flatMap((signal) => signal.windows.map((window) => ({ signal, window }))) ?? [];
    pictures.forEach(({ signal, window }, index) => drawMeasured(at("fit-plots").children[index], signal, window));
  }

  close() {
    if (this.engine) this.end("");
    this.show(null);
    at("fit").hidden = true;
  }
}
