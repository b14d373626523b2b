// Recordings that are dropped on the page, or chosen: verified, explained, and compared with the one before.

import { at, element } from "./elements.mjs";
import { Engine } from "./engine.mjs";
import { showComparison, showExplanation } from "./reading.mjs";
import { sectionParts } from "./sections.mjs";

/** The first bytes of MCAP files. */
const MAGIC = [0x89, ...new TextEncoder().encode("MCAP0\r\n")];

/** Whether a file is one of MCAP, by its name or its content. */
export const isRecording = (name, bytes) => name.endsWith(".mcap") || MAGIC.every((byte, index) => bytes[index] === byte);

/** The class of each verdict. */
const TONES = { verified: "good", incomplete: "weak", different: "wrong" };

export class VerifyPanel {
  /** `start` shows the run of a scenario on the page. */
  constructor(module, { start }) {
    this.module = module;
    this.input = element("input", { type: "file", accept: ".mcap" });
    this.input.onchange = () => this.read(this.input.files[0]);
    for (const id of ["verify-choose", "verify-file"]) at(id).onclick = () => this.input.click();
    at("verify-close").onclick = () => this.close();
    at("verify-show").onclick = () => start(this.result.request);
  }

  async read(file) {
    this.input.value = ""; // so that the same file can be chosen again
    if (!file) return;
    try {
      await this.take(file.name, new Uint8Array(await file.arrayBuffer()));
    } catch (error) {
      this.fail(file.name, `cannot be read (${error.message})`);
    }
  }

  /** Verifies the content of a file. The worker keeps it until the next one has been compared with it. */
  async take(name, bytes) {
    this.open();
    const turn = (this.turn = (this.turn ?? 0) + 1);
    at("verify-status").textContent = `${name}: verifying`;
    this.engine ??= new Engine(this.module, (text) => (at("verify-status").textContent = text));
    const response = await this.engine.send({ request: { verify: { file: name } }, file: bytes });
    if (turn !== this.turn) return;
    at("verify-status").textContent = "";
    if (response.error) this.fail(name, response.error);
    else this.show(response);
  }

  /** Shows the panel without a result. */
  open() {
    at("verify").hidden = false;
    at("verify").scrollIntoView();
    at("verify-status").classList.remove("wrong");
    this.show(null);
  }

  /** Says why there is no result. */
  fail(name, reason) {
    this.open();
    at("verify-status").textContent = `${name}: ${reason}`;
    at("verify-status").classList.add("wrong");
  }

  show(result) {
    this.result = result;
    at("verify-result").hidden = !result;
    if (!result) return;
    const { report, section, digest, scenario, request, explanation, comparison } = result;
    const [verdict, ...facts] = sectionParts(section);
    verdict.className = TONES[report.verdict];
    const digestLine = digest ? [element("p", { id: "verify-digest", textContent: `content digest (SHA-256): ${digest}` })] : [];
    at("verify-report").replaceChildren(verdict, ...facts, ...digestLine);
    at("verify-scenario").textContent = scenario ?? "";
    at("verify-scenario").parentElement.hidden = !scenario;
    at("verify-show").hidden = !request;
    showExplanation(at("verify-story"), at("verify-explanation"), explanation);
    at("verify-why").hidden = at("verify-story").textContent === "" && at("verify-explanation").children.length === 0;
    at("verify-compared").hidden = !comparison;
    at("verify-before").textContent = comparison ? `A: ${comparison.file}, which was here before. B: this one.` : "";
    if (comparison) showComparison(at("verify-comparison"), comparison.report);
  }

  close() {
    this.engine?.worker.terminate();
    this.engine = null;
    this.turn = (this.turn ?? 0) + 1;
    this.show(null);
    at("verify-status").textContent = "";
    at("verify").hidden = true;
  }
}
