// The shot simulated in the page: the net itself opens, meets the target and closes, with its values moved.

import { spoken, unpack } from "dcone/bytes";
import { Panel } from "dcone/panel";
import { Replay } from "dcone/replay";

const LARGEST = 255;

export class ShotView extends Panel {
  /** `box` is what the run's own replay shows, `surface` its target, of which a part may `swing`. */
  constructor(root, told, colours, box, surface, swing) {
    super(root, told, "shot", ["button"]);
    this.button.addEventListener("click", () => this.shoot());
    this.over = null;
    [this.held, this.most, this.took, this.failed] = [0, 0, 0, ""];
    this.replay = new Replay(root.querySelector(".replay"), this.clip(box, surface, swing), colours);
    this.replay.grow(1, false);
    this.replay.go(0);
    this.tell();
    this.begin();
  }

  /** Room for every frame that the shot may have. */
  clip(box, surface, swing) {
    const { plan, bodies, ends, rim, most, floor } = this.told;
    const room = Math.ceil(plan.duration / plan.every) + 2;
    const places = (count) => ({ values: new Float32Array(3 * count * room), shape: [room, count, 3] });
    const found = { key: "shot", title: "Shot", clock: "since the shot", times: Float64Array.from({ length: room }, (_, n) => Math.min(n * plan.every, plan.duration)), marks: [], notes: [], box, surface, swing };
    for (const [name, count] of Object.entries(bodies)) found[name] = ["attitude", "angle"].includes(name) ? { values: new Float32Array(count * room) } : places(count / 3);
    found.net = { nodes: places(plan.nodes.length / 3), threads: unpack(ends), rim };
    if (plan.threads.length && most > 0) found.net.tensions = { codes: new Uint8Array(plan.threads.length * room), shape: [room, plan.threads.length], most, floor };
    if (found.attitude) for (let n = 0; n < room; n++) found.attitude.values[4 * n] = 1;
    return found;
  }

  ready() {
    this.button.disabled = false;
    this.tell();
  }

  fail(text) {
    super.fail(text);
    this.button.disabled = true;
  }

  /** The values have changed: what stands there is not of them. */
  change() {
    this.failed = "";
    this.tell();
  }

  shoot() {
    if (this.state !== "ready") return;
    this.number += 1;
    this.over = null;
    this.held = 0;
    this.most = 0;
    this.failed = "";
    this.took = 0;
    this.shot = this.moved.length;
    this.shotWith = this.settings.join(" ");
    this.replay.stop();
    this.root.dataset.done = "";
    this.worker.postMessage({ number: this.number, values: Object.assign({}, ...this.moved.map((knob) => knob.values)) });
    this.tell();
  }

  hear(told) {
    if (told.kind === "first") { this.held = 0; this.put(told.frame); this.held = 0; this.replay.go(0); return; }
    if (told.kind === "frames") {
      const first = this.held === 0;
      for (const frame of told.frames) this.put(frame);
      this.took = told.took;
      this.replay.grow(this.held, true);
      if (first && this.held) { this.replay.go(0); this.replay.toggle(); }
    } else {
      this.replay.grow(Math.max(this.held, 1), false);
      if (told.kind === "over") { this.over = told; this.took = told.took; } else this.failed = told.text;
      this.root.dataset.done = this.number;
    }
    this.tell();
  }

  /** One frame more of the clip. */
  put(frame) {
    const { bodies, net, times, clip } = { ...this.replay.bodies, times: this.replay.times, bodies: this.told.bodies, clip: this.replay.clip };
    const n = this.held, at = { bodies: 0 };
    times[n] = frame.time;
    for (const [name, count] of Object.entries(bodies)) {
      clip[name].values.set(frame.bodies.subarray(at.bodies, (at.bodies += count)), count * n);
    }
    clip.net.nodes.values.set(frame.nodes, frame.nodes.length * n);
    const tensions = clip.net.tensions;
    if (tensions) {
      const floor = Math.log(tensions.floor), codes = tensions.codes.subarray(frame.tensions.length * n, frame.tensions.length * (n + 1));
      frame.tensions.forEach((pull, i) => {
        const share = pull > 0 ? Math.log(pull / tensions.most) / floor : 2;
        codes[i] = share <= 1 ? Math.round(LARGEST - (LARGEST - 1) * Math.min(Math.max(share, 0), 1)) : 0;
      });
    }
    const mouth = this.told.plan.figures.indexOf("mouth.area");
    if (mouth >= 0) this.most = Math.max(this.most, frame.figures[mouth]);
    this.held += 1;
  }

  /** Strength over stress, less one, of a line that bore so much [N]; `none` where nothing is known of that. */
  margin({ output, breaksAt }, which, bore, none) {
    const cell = this.root.querySelector(`[data-figure="margin of ${output}"] [data-of="${which}"]`);
    const value = breaksAt / bore - 1, own = this.told.spreads[output] ?? 0;
    const known = breaksAt !== null && bore > 0;
    cell.textContent = breaksAt === null ? "strength not known" : known ? `${spoken(value, 4, value ? (own * (1 + value)) / Math.abs(value) : own)}${value < 0 ? ": breaks" : ""}` : none;
    cell.classList.toggle("bad", known && value < 0);
  }

  tell() {
    const { run, spreads } = this.told, over = this.over, settings = this.settings;
    const stale = this.held > 0 && this.shotWith !== undefined && this.shotWith !== settings.join(" ");
    for (const name of this.told.plan.figures) {
      const row = this.root.querySelector(`[data-figure="${name}"]`);
      const found = over ? (name === "mouth.area" ? this.most : over.figures[name]) : NaN;
      const shown = (value) => (Number.isFinite(value) && (name !== "t_capture" || value > 0) ? spoken(value, 4, spreads[name] ?? 0) : "–");
      row.querySelector('[data-of="run"]').textContent = shown(run[name]);
      row.querySelector('[data-of="moved"]').textContent = stale || this.failed ? "" : over ? shown(found) : this.held ? "…" : "";
    }
    for (const line of this.told.lines) {
      this.margin(line, "run", run[line.output], "");
      this.margin(line, "moved", over && !stale && !this.failed ? over.figures[line.output] : NaN, stale || this.failed || !this.held ? "" : over ? "–" : "…");
    }
    const here = this.held ? this.replay.times[this.held - 1] : 0;
    const same = over && !this.shot && this.told.plan.figures.filter((name) => name !== "mouth.area").every((name) => over.figures[name] === run[name]);
    const speed = this.took > 0 ? ` in ${spoken(this.took, 2)} s of computing, ${spoken(here / this.took, 2)} × real time` : "";
    this.refuse(this.failed);
    this.status.textContent = this.failed ? `The model refuses that, and nothing is shot: ${this.failed}.`
      : stale && over ? "The values have changed since the shot that is shown: shoot again."
      : over ? `${spoken(over.time, 3)} s simulated${speed}; the compiled FMU took ${spoken((this.told.native.cpu * over.time) / this.told.native.duration, 2)} s of CPU time for them. Outcome: ${(over.outcome || over.ended || "the end of its time").replaceAll("_", " ")}.${!over || this.shot ? "" : same ? " Unmoved it is the run again, bit for bit." : " Unmoved it is not the run to the bit: something is rounded otherwise here, and a net is chaotic, so that these are two samples."}`
        : this.held ? `${spoken(here, 3)} s simulated${speed} …`
          : this.state === "ready" ? "Nothing is shot yet." : "…";
    this.offer(this.failed ? [] : ["dcone run", this.told.folder, ...settings, ...(settings.length ? ["-o moved"] : [])]);
  }
}
