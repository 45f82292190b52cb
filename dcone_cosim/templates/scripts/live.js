// The tow simulated anew in the page as its values are moved: the model itself, in a worker.

import { spoken, unpack } from "dcone/bytes";
import { Chart } from "dcone/chart";
import { Knob, workerOf } from "dcone/knob";

/** How far two numbers are apart, as a share of the larger. */
const apart = (one, other) => (one === other ? 0 : Math.abs(one - other) / Math.max(Math.abs(one), Math.abs(other)));

/** A figure in two columns: of the run, and as moved. */
const FIGURES = {
  tugs: (told) => told.tugs.length,
  first: (told) => told.tugs[0]?.[0],
  peak: (told) => told.tugs[0]?.[1],
  largest: (told) => told.largest,
  stress: (told) => told.stress / 1e6,
  margin: (told) => told.margin,
  required: (told) => told.required,
};

export class Live {
  constructor(root, data) {
    this.root = root;
    this.told = data;
    this.number = 0;
    this.results = { run: null, moved: null };
    this.recorded = unpack(data.tugs);
    const part = (name) => root.querySelector(`[data-part="${name}"]`);
    this.status = part("status");
    this.command = part("command");
    this.factor = part("factor");
    this.factor.value = data.line.factor;
    this.note = part("note");
    this.knobs = data.knobs.map((told, i) => new Knob(root.querySelector(`[data-knob="${i}"]`), told, () => this.ask()));
    part("reset").addEventListener("click", () => { for (const knob of this.knobs) knob.put(knob.told.value); this.ask(); });
    this.factor.addEventListener("change", () => { this.results.run = null; this.ask(); });
    const { phase, clock, unit } = data;
    this.chart = new Chart(part("chart"), { key: `${phase}-live`, title: "Tension of the line", clock, unit: "N", xUnit: unit, log: true, range: [0, data.plan.duration / data.divisor], marks: [], series: this.series() });
    this.tell();
    this.begin();
  }

  /** The run's tugs, and over them what has come of the values as moved. */
  series() {
    const per = this.told.divisor, moved = this.moved.length ? this.results.moved : null, rows = this.recorded;
    const every = (k, by) => Float64Array.from({ length: rows.length / 3 }, (_, n) => rows[3 * n + k] / by);
    const found = [{ name: "tugs of the run", kind: "stems", faint: Boolean(moved), hue: 0, x: every(0, per), y: every(1, 1) }];
    if (!moved) return found;
    const { tugs, drawn } = moved;
    found.push({ name: "tugs as moved", kind: "stems", faint: false, hue: 1, x: Float64Array.from(tugs, ([t]) => t / per), y: Float64Array.from(tugs, ([, p]) => p) });
    found.push({ name: "tension as moved", kind: "line", faint: false, hue: 1, x: Float64Array.from(drawn.time, (t) => t / per), y: Float64Array.from(drawn["tether.tension"] ?? []) });
    return found;
  }

  begin() {
    try {
      this.worker = workerOf("tow", this.told, (told) => this.hear(told), (text) => this.fail(text));
    } catch (error) {
      this.fail(`this browser gives the page no worker: ${error.message}`);
    }
  }

  fail(text) {
    this.status.textContent = `Nothing can be simulated here: ${text}.`;
    this.root.classList.add("off");
    this.state = "broken";
  }

  get moved() { return this.knobs.filter((knob) => knob.moved); }

  ask() {
    if (this.state === "broken") return;
    this.tell();
    this.post();
  }

  /** Have the latest values simulated; while the worker is busy they wait, and only the last of them are. */
  post() {
    if (this.busy || this.state !== "ready") { this.waiting = true; return; }
    this.waiting = false;
    this.busy = true;
    const moved = this.results.run ? this.moved : [];
    const values = Object.assign({}, ...moved.map((knob) => knob.values));
    this.which = this.results.run && moved.length ? "moved" : "run";
    const si = (name) => {
      const knob = this.knobs.find((one) => one.told.sets[name]);
      return knob ? knob.told.factor * (moved.includes(knob) ? knob.value : knob.told.value) : 0;
    };
    [this.diameter, this.damping] = [si("tether.diameter"), si("tether.damping_ratio")];
    this.number += 1;
    this.root.dataset.number = this.number;
    const factor = Math.max(Number(this.factor.value) || 1, 1);
    this.worker.postMessage({ number: this.number, values, factor, diameter: this.diameter });
  }

  hear(told) {
    if (told.kind === "ready") { this.state = "ready"; this.post(); return; }
    if (told.kind === "broken") { this.fail(told.text); return; }
    if (told.number !== this.number) return;
    if (told.kind === "tow") {
      this.busy = false;
      const area = (Math.PI * this.diameter * this.diameter) / 4, strength = this.told.line.strength;
      told.stress = area ? told.largest / area : NaN;
      told.margin = strength && told.stress ? strength / told.stress - 1 : NaN;
      told.required = NaN;
      told.damping = this.damping;
      if (this.which === "run") { this.results = { run: told, moved: null }; this.hold(told); } else this.results.moved = told;
      this.failed = "";
    } else if (told.kind === "required") {
      Object.assign(this.results[this.which], { sought: false, required: told.diameter * 1e3, jumps: told.jumps, why: told.why });
    } else {
      this.busy = false;
      this.failed = told.text;
    }
    this.tell();
    if (told.kind !== "required") this.chart.give(this.series());
    if (told.kind === "tow" && (this.waiting || (this.which === "run" && this.moved.length))) this.post();
    else if (this.waiting) this.post();
  }

  /** Whether the run's own tugs come out again, to the bit. */
  hold(told) {
    const { plan } = this.told, rows = this.recorded, n = rows.length / 3;
    if (plan.duration < plan.whole) { this.same = ""; return; }
    let off = told.tugs.length === n ? 0 : NaN;
    for (let i = 0; i < n && off === off; i++) for (let k = 0; k < 3; k++) off = Math.max(off, apart(told.tugs[i][k], rows[3 * i + k]));
    this.off = off;
    const all = n === 1 ? "one tug" : `${n} tugs`;
    this.same = off === 0 ? `Unmoved it gives the run's ${all} again, bit for bit.`
      : off === off ? `Unmoved it gives the run's ${all} again, within ${off.toExponential(0)} of each figure.`
        : `Unmoved it gives ${told.tugs.length} tugs, where the run has ${n}.`;
  }

  tell() {
    const { run, moved } = this.results, now = this.moved;
    if (!now.length) this.results.moved = null;
    const governing = (told) => {
      if (!told) return "";
      const load = told.damping >= this.told.line.dashpot ? "dashpot" : "snap";
      if (told.governing) return `${load}: tug ${told.governing} of ${told.tugs.length}, at ${spoken(told.tugs[told.governing - 1][0], 6)} s`;
      return told.largest > 0 ? `steady load, at ${spoken(told.largestAt, 6)} s` : "nothing: the line stays slack";
    };
    for (const which of ["run", "moved"]) {
      const told = which === "run" ? run : now.length ? moved : null;
      for (const [name, of] of Object.entries(FIGURES)) {
        const cell = this.root.querySelector(`[data-figure="${name}"] [data-of="${which}"]`);
        if (!cell) continue;
        const value = told ? of(told) : NaN;
        cell.textContent = Number.isFinite(value) ? spoken(value) : told ? (name === "required" && told.sought ? "…" : "–") : "";
      }
      const cell = this.root.querySelector(`[data-figure="governing"] [data-of="${which}"]`);
      cell.textContent = governing(told);
    }
    const told = now.length ? moved : run;
    const shown = told && told.number === this.number;
    this.status.textContent = this.failed ? `The model refuses that: ${this.failed}.` : !told ? "…"
      : `${spoken(told.time / 3600)} h simulated in ${spoken(told.took, 2)} s, in this page; native code took ${spoken((this.told.native.wall * told.time) / this.told.native.duration, 2)} s for them. ${this.same ?? ""}` + (told.ended ? ` It ended early: ${told.ended}.` : "");
    this.root.classList.toggle("waits", !shown && !this.failed);
    this.root.dataset.done = shown && !this.waiting && !this.busy ? this.number : "";
    const again = now.some((knob) => knob.told.again);
    const settings = now.flatMap((knob) => knob.settings);
    const from = this.told.handed && !again ? ` --from ${this.told.phase}` : "";
    this.command.textContent = now.length ? ["dcone run", this.told.folder + from, ...settings, "-o moved"].join(" ") : `dcone run ${this.told.folder}`;
    const notes = now.filter((knob) => knob.told.estimate).map((knob) => `${knob.told.label}: ${knob.told.estimate}`);
    if (again && !notes.length) notes.push("the shell shoots the net anew; here it is as it was handed over");
    if (told?.jumps) notes.push("required diameter: the peak jumps there");
    if (told?.why) notes.push(`required diameter: ${told.why}`);
    this.note.textContent = notes.length ? `${notes.join("; ")}.` : "";
  }
}
