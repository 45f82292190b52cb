// The net in a page: its FMU stepped from the shot to the instant of its capture, a frame at every so many steps.

const AT = 1e-9;

/** A shot that is under way. */
class Shot {
  /**
   * plan    start, step, duration, every [s]; bodies (names of outputs that every frame has); nodes, threads (references
   *         of positions and tensions); stop (the Boolean output with which it ends, "" for none); figures (names told
   *         of each frame); after (how long it goes on once captured [s], null for as long as there is time)
   */
  constructor(fmu, plan, values) {
    this.fmu = fmu;
    this.plan = plan;
    fmu.reset();
    fmu.begin(values, plan.start);
    this.read = fmu.shotReader ??= fmu.reader([...plan.bodies, ...plan.figures, ...plan.nodes, ...plan.threads]);
    this.last = plan.duration;
    this.done = 0;
    this.time = 0;
    this.following = 0;
    this.over = false;
    this.outcome = 0;
  }

  /** The next frame: time, bodies, figures, nodes, tensions; null once the shot is over. */
  next() {
    const { plan, fmu } = this;
    while (!this.over) {
      const due = this.time >= this.following * plan.every - AT, last = this.time >= this.last || this.ended;
      if (due || last) {
        this.following = Math.floor((this.time + AT) / plan.every) + 1;
        const frame = this.frame();
        if (last) this.over = true; else this.advance();
        return frame;
      }
      this.advance();
    }
    return null;
  }

  advance() {
    const { plan, fmu } = this, begin = this.time;
    const located = plan.stop === "captured" && fmu.references.t_capture;
    this.done += 1;
    this.time = Math.min(this.done * plan.step, this.last);
    if (located) fmu.save();
    this.step(begin, this.time);
    if (plan.stop && !this.ended && fmu.get(plan.stop)) {
      const there = located ? fmu.get("t_capture") : this.time;
      if (begin < there && there < this.time) {
        fmu.restore();
        this.time = there;
        this.step(begin, there);
      }
      this.ended ??= plan.stop;
    }
    if (!plan.stop && plan.after !== null && this.last === plan.duration && fmu.get("captured")) {
      const at = fmu.references.t_capture ? fmu.get("t_capture") : this.time;
      this.last = Math.min(plan.duration, Math.max(at + plan.after, this.time));
    }
    if (fmu.references.outcome) this.outcome = fmu.get("outcome");
    if (plan.failed.includes(this.outcome)) this.ended ??= plan.outcomes[this.outcome];
  }

  /** Between two times since the shot. */
  step(begin, end) {
    const { plan, fmu } = this, from = plan.start + begin;
    if (!fmu.step(from, plan.start + end - from)) this.ended = fmu.said.at(-1) || "the model has come to its own end";
  }

  frame() {
    const { plan } = this, all = this.read();
    const cuts = [plan.bodies.length, plan.figures.length, plan.nodes.length, plan.threads.length];
    let at = 0;
    const [bodies, figures, nodes, tensions] = cuts.map((count) => Float32Array.from(all.subarray(at, (at += count))));
    return { time: this.time, bodies, figures, nodes, tensions };
  }
}
