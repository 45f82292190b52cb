// The tow simulated anew in the page as its values are moved: the model itself, in a worker.

import { spoken, unpack } from "dcone/bytes";
import { Chart } from "dcone/chart";
import { Panel } from "dcone/panel";

/** How far two numbers are apart, as a share of the larger. */
const apart = (one, other) => (one === other ? 0 : Math.abs(one - other) / Math.max(Math.abs(one), Math.abs(other)));

/** A figure in two columns, of the run and with the reader's values, and which spread it has. A tether that is taut from the start counts that as no tug. */
const FIGURES = {
  tugs: [(told) => told.tugs.length - told.taut, "tugs"],
  first: [(told) => told.tugs[told.taut]?.[0], "first"],
  peak: [(told) => told.tugs[told.taut]?.[1], "peak"],
  largest: [(told) => told.largest, "largest"],
  stress: [(told) => told.stress / 1e6, "largest"],
  margin: [(told) => told.margin, "margin"],
  required: [(told) => told.required, "largest"],
};
/** How long an answer may take before what is drawn of the values before is taken away [ms]. */
const PATIENCE = 300;

export class Live extends Panel {
  constructor(root, data) {
    super(root, data, "tow", ["factor"]);
    this.results = { run: null, moved: null };
    this.recorded = unpack(data.tugs);
    this.factor.value = data.line.factor;
    this.factor.addEventListener("change", () => { this.factor.value = Math.max(Number(this.factor.value) || 1, 1); this.results.run = null; this.change(); });
    const { phase, clock, unit } = data;
    this.chart = new Chart(this.part("chart"), { key: `${phase}-live`, title: "Tension of the tether", clock, unit: "N", xUnit: unit, log: true, range: [0, data.plan.duration / data.divisor], marks: [], series: this.series() });
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
    found.push({ name: "tugs with your values", kind: "stems", faint: false, hue: 1, x: Float64Array.from(tugs, ([t]) => t / per), y: Float64Array.from(tugs, ([, p]) => p) });
    found.push({ name: "tension with your values", kind: "line", faint: false, hue: 1, x: Float64Array.from(drawn.time, (t) => t / per), y: Float64Array.from(drawn["tether.tension"] ?? []) });
    return found;
  }

  ready() { this.post(); }

  change() {
    if (this.state === "broken") return;
    [this.failed, this.results.moved] = ["", null];  // they were of other values
    clearTimeout(this.later);
    this.later = setTimeout(() => { if (!this.results.moved) this.chart.give(this.series()); }, PATIENCE);
    this.tell();
    this.post();
  }

  /** A value as it stands, SI; 0 for one that cannot be moved. */
  si(name, moved = this.moved) {
    const knob = this.knobs.find((one) => one.told.sets[name]);
    return knob ? knob.told.factor * (moved.includes(knob) ? knob.value : knob.told.value) : 0;
  }

  /** Standard deviation over mean of a figure that is one sample of many, 0 of any other; of a margin, by that of its load. */
  spread(name, value) {
    const own = this.told.spreads[name === "margin" ? "largest" : name] ?? 0;
    return name === "margin" && value ? (own * (1 + value)) / Math.abs(value) : own;
  }

  /** Have the latest values simulated; while the worker is busy they wait, and only the last of them are. */
  post() {
    if (this.busy || this.state !== "ready") { this.waiting = true; return; }
    this.waiting = false;
    this.busy = true;
    const moved = this.results.run ? this.moved : [];
    const values = Object.assign({}, ...moved.map((knob) => knob.values));
    this.column = this.results.run && moved.length ? "moved" : "run";
    [this.diameter, this.damping] = ["tether.diameter", "tether.damping_ratio"].map((name) => this.si(name, moved));
    this.number += 1;
    this.root.dataset.number = this.number;
    this.send({ values, diameter: this.diameter });
  }

  send(asked) { this.worker.postMessage({ number: this.number, factor: Math.max(Number(this.factor.value) || 1, 1), ...asked }); }

  /** Go on with the least diameter of the run, whose search other values have broken off. */
  resume() {
    const { run } = this.results;
    if (!run?.sought || this.column === "run" || this.busy || this.waiting) return;
    this.column = "run";
    this.send({ values: {}, diameter: this.si("tether.diameter", []), peak: run.largest });
  }

  hear(told) {
    if (told.kind === "tow") {
      this.busy = false;
      const area = (Math.PI * this.diameter * this.diameter) / 4, strength = this.told.line.strength;
      told.stress = area ? told.largest / area : NaN;
      told.margin = strength && told.stress ? strength / told.stress - 1 : NaN;
      told.required = NaN;
      told.damping = this.damping;
      told.taut = told.drawn["tether.tension"]?.[0] > 0 ? Math.min(told.tugs.length, 1) : 0;
      if (this.column === "run") { this.results = { run: told, moved: null }; this.hold(told); } else this.results.moved = told;
      this.failed = "";
    } else if (told.kind === "required") {
      if (this.results[this.column]) Object.assign(this.results[this.column], { sought: false, required: told.diameter * 1e3, jumps: told.jumps, why: told.why });
    } else {
      this.busy = false;
      if (!this.waiting) this.failed = told.text.replace(" 1 is out", " is out");  // a pure number has no unit to tell
    }
    this.tell();
    if (told.kind !== "required" && !this.waiting) this.chart.give(this.series());
    if (told.kind === "tow" && (this.waiting || (this.column === "run" && this.moved.length))) this.post();
    else if (this.waiting) this.post();
    if (told.kind !== "tow" || !told.sought) this.resume();
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
      : off === off ? `Unmoved it gives the run's ${all} again, within ${off.toExponential(0)} of each figure: sine, exponential and their like have other last digits in a page than in the library of the FMU.`
        : `Unmoved it gives ${told.tugs.length} tugs, where the run has ${n}.`;
  }

  tell() {
    const { run, moved } = this.results, now = this.moved;
    if (!now.length) this.results.moved = null;
    const governing = (told) => {
      if (!told) return "";
      const load = told.damping >= this.told.line.dashpot ? "dashpot" : "snap";
      if (told.taut && told.governing === 1) return "the stretch it has at 0 s: it is taut from the start";
      if (told.governing) return `${load}: tug ${told.governing - told.taut} of ${told.tugs.length - told.taut}, at ${spoken(told.tugs[told.governing - 1][0])} s`;
      if (this.told.line.nodes && told.largest > 0) return `the largest along it, in the step up to ${spoken(told.largestAt)} s`;
      return told.largest > 0 ? `steady load, at ${spoken(told.largestAt)} s` : "none: the tether stays slack";
    };
    for (const which of ["run", "moved"]) {
      const told = which === "run" ? run : now.length ? moved : null;
      const waits = which === "moved" && now.length > 0 && !this.failed && !told;
      for (const [name, [of, spread]] of Object.entries(FIGURES)) {
        const cell = this.root.querySelector(`[data-figure="${name}"] [data-of="${which}"]`);
        if (!cell) continue;
        const value = told ? of(told) : NaN;
        cell.textContent = Number.isFinite(value) ? (Number.isInteger(value) && value < 1000 ? `${this.spread(spread, value) ? "~" : ""}${value}` : spoken(value, 4, this.spread(spread, value))) : told ? (name === "required" && told.sought ? "…" : "–") : waits ? "…" : "";
        if (name === "margin") {
          cell.classList.toggle("bad", value < 0);
          if (value < 0) cell.textContent += ": breaks";
        }
      }
      const cell = this.root.querySelector(`[data-figure="governing"] [data-of="${which}"]`);
      cell.textContent = waits ? "…" : governing(told);
    }
    const told = now.length ? moved : run;
    const shown = told && told.number === this.number;
    this.refuse(this.failed);
    this.status.textContent = this.failed ? `The model refuses that, and nothing is computed: ${this.failed}.` : !told ? "computing …"
      : `${spoken(told.time / 3600)} h simulated in ${spoken(told.took, 2)} s, in this page; the compiled FMU took ${spoken((this.told.native.cpu * told.time) / this.told.native.duration, 2)} s of CPU time for them. ${this.same ?? ""}` + (told.ended ? ` It ended early: ${told.ended}.` : "");
    this.root.classList.toggle("waits", !shown && !this.failed);
    this.root.dataset.done = shown && !this.waiting && !this.busy ? this.number : "";
    const again = now.some((knob) => knob.told.again);
    const from = this.told.handed && !again ? ` --from ${this.told.phase}` : "";
    const offered = !now.length || Boolean(moved && !this.failed);
    this.offer(!offered ? [] : now.length ? ["dcone run", this.told.folder + from, ...this.settings, "-o moved"] : ["dcone run", this.told.folder]);
    const notes = now.filter((knob) => knob.told.estimate).map((knob) => `${knob.told.label}: ${knob.told.estimate}`);
    if (again && !notes.length && !this.failed) notes.push("the command shoots the net anew; here the tow begins with the net as it was handed over");
    const length = this.si("tether.rest_length"), { reach } = this.told.line;
    if (now.length && reach && length && length < reach) notes.push(`a tether of ${spoken(length)} m is shorter than the ${spoken(reach)} m that it has to span at the start: it is stretched from 0 s on, and that tension is of the stretch, not of a tug`);
    if (told?.jumps) notes.push("least diameter: the peak jumps there");
    if (told && told.largest > 0 && !told.sought && !told.why && Number.isNaN(told.required)) {
      const reason = !this.told.line.strength ? "nothing tells its strength" : !this.si("tether.diameter") ? "its diameter cannot be moved" : "the tow ends early";
      notes.push(`least diameter of the tether: not sought, since ${reason}`);
    }
    if (told?.why) notes.push(`least diameter: ${told.why}`);
    this.note.textContent = notes.length ? `${notes.join("; ")}.` : "";
  }
}
