// A panel of the page in which a model is simulated anew: the values that may be moved, and the worker that has it.

import { Knob, workerOf } from "dcone/knob";

/** `hear(told)` takes the worker's answers, `change()` is called when a value was moved. */
export class Panel {
  /** `which` names the worker, `parts` the elements that the panel keeps by name. */
  constructor(root, told, which, parts) {
    this.root = root;
    this.told = told;
    this.which = which;
    this.number = 0;
    for (const name of ["status", "command", "note", ...parts]) this[name] = this.part(name);
    this.knobs = told.knobs.map((one, i) => new Knob(root.querySelector(`[data-knob="${i}"]`), one, () => this.change()));
    this.part("reset").addEventListener("click", () => { for (const knob of this.knobs) knob.put(knob.told.value); this.change(); });
  }

  part(name) { return this.root.querySelector(`[data-part="${name}"]`); }

  begin() {
    try {
      this.worker = workerOf(this.which, this.told, (told) => this.answer(told), (text) => this.fail(text));
    } catch (error) {
      this.fail(`this browser gives the page no worker: ${error.message}`);
    }
  }

  answer(told) {
    if (told.kind === "ready") { this.state = "ready"; this.ready(); }
    else if (told.kind === "broken") this.fail(told.text);
    else if (told.number === this.number) this.hear(told);
  }

  fail(text) {
    this.status.textContent = `Nothing can be simulated here: ${text}.`;
    this.root.classList.add("off");
    this.state = "broken";
  }

  get moved() { return this.knobs.filter((knob) => knob.moved); }

  /** The settings that make the same run in a shell. */
  get settings() { return this.moved.flatMap((knob) => knob.settings); }

  /** Mark the values that the model refuses by its words; "" for none. */
  refuse(words) {
    this.status.classList.toggle("refused", Boolean(words));
    for (const knob of this.knobs) knob.refuse(Boolean(words) && Object.keys(knob.told.sets).some((name) => words.includes(name)));
  }

  /** Offer the command that makes the same run, or none. */
  offer(words) {
    this.command.parentElement.classList.toggle("gone", !words.length);
    this.command.textContent = words.join(" ");
  }
}
