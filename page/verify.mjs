// Recordings that are dropped on the page, or chosen: verified, explained, and compared with the one before.

import { at, element } from "./elements.mjs";
import { Engine } from "./engine.mjs";
import { showComparison, showExplanation } from "./reading.mjs";
import { sectionParts } from "./sections.mjs";

/** The first bytes of MCAP files. */
const MAGIC = [0x89, ...new TextEncoder().encode("MCAP0\r\n")];

/** Whether bytes begin as an MCAP file does. */
export const isRecording = (bytes) => MAGIC.every((byte, index) => bytes[index] === byte);

/** Where a report has its difference, its missing parts or its agreement. */
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
    if (file) await this.take(file.name, new Uint8Array(await file.arrayBuffer()));
  }

  /** Verifies the content of a file. The worker keeps it until the next one has been compared with it. */
  async take(name, bytes) {
    at("verify").hidden = false;
    at("verify").scrollIntoView();
    this.show(null);
    const turn = (this.turn = (this.turn ?? 0) + 1);
    at("verify-status").textContent = `${name}: verifying`;
    this.engine ??= new Engine(this.module, (text) => (at("verify-status").textContent = text));
    const response = await this.engine.send({ request: { verify: { file: name } }, file: bytes });
    if (turn !== this.turn) return;
    at("verify-status").textContent = response.error ? `${name}: ${response.error}` : "";
    at("verify-status").classList.toggle("wrong", Boolean(response.error));
    if (!response.error) this.show(response);
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
