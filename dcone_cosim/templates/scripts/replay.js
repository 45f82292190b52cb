// A clip that can be turned, scrubbed and played; it stands still until it is asked to move.

import * as THREE from "three";
import { spoken } from "dcone/bytes";
import { Bodies } from "dcone/bodies";
import { Camera } from "dcone/camera";
import { texture } from "dcone/lines";
import { ticks } from "dcone/chart";

const SPEEDS = [0.05, 0.1, 0.25, 0.5, 1, 2, 5, 10, 30, 60, 120, 300, 600, 1200, 3600, 7200, 36000, 86400];
const LONGEST = 25, LONGEST_AS_IT_IS = 90;
const VIEWS = { side: [0, 0.12], slanting: [0.65, 0.38], "from behind the chaser": [-Math.PI / 2, 0.12], "from above": [0, 1.5] };
const NEAR = "close to the target";

export class Replay {
  constructor(root, clip, colours) {
    this.root = root;
    this.clip = clip;
    this.stage = root.querySelector(".stage");
    this.renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.stage.prepend(this.renderer.domElement);
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(0x10151b);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x445566, 2.2));
    const sun = new THREE.DirectionalLight(0xffffff, 1.6);
    sun.position.set(3, 5, 4);
    this.scene.add(sun);
    this.bodies = new Bodies(clip, texture(colours), this.scene);
    this.times = this.bodies.times;
    this.camera = new Camera(this.stage, () => this.ask());
    this.frame = 0;
    this.playing = false;
    this.lay();
    this.furnish();
    new ResizeObserver(() => this.resize()).observe(this.stage);
    this.resize();
    this.look("slanting");
    this.go(this.beginning());
  }

  /** The last frame that there is; of a clip that is being made more come. */
  get end() { return (this.held ?? this.times.length) - 1; }

  /** So many frames are there, of those that the clip has room for; `growing`: more of them are to come. */
  grow(held, growing) {
    [this.held, this.growing] = [held, growing];
    this.parts.slider.max = String(Math.max(this.end, 0));
  }

  /** The frame that is shown first: where most is to be seen, before anything is asked. */
  beginning() {
    const marks = this.clip.marks.filter((mark) => mark.time <= this.times[this.end]);
    const at = marks.find((mark) => /widest/.test(mark.what)) ?? { time: this.times[0] };
    return this.nearest(at.time);
  }

  /** A grid under everything, with a mesh of 1, 2 or 5. */
  lay() {
    const { min, max } = this.bodies.box, middle = this.bodies.box.getCenter(new THREE.Vector3());
    const side = Math.max(max.x - min.x, max.z - min.z, 1);
    const steps = ticks(0, side, 8), mesh = steps[1] - steps[0], count = Math.ceil(side / mesh) + 2;
    const grid = new THREE.GridHelper(count * mesh, count, 0x46535f, 0x2b343d);
    grid.position.set(middle.x, min.y - 0.05 * side, middle.z);
    this.scene.add(grid);
    this.mesh = mesh;
  }

  furnish() {
    const find = (name) => this.root.querySelector(`[data-part="${name}"]`);
    this.parts = Object.fromEntries(["play", "slider", "time", "speed", "view", "told", "axes", "marks", "grid"].map((name) => [name, find(name)]));
    const { play, slider, speed, view, marks, grid } = this.parts;
    slider.max = String(this.end);
    slider.addEventListener("input", () => { this.stop(); this.go(Number(slider.value)); });
    play.addEventListener("click", () => this.toggle());
    find("first").addEventListener("click", () => { this.stop(); this.go(0); });
    find("last").addEventListener("click", () => { this.stop(); this.go(this.end); });
    const span = this.times[this.end] - this.times[0];
    const offered = SPEEDS.filter((one) => span / one >= 1 && span / one <= 600);
    const usual = span <= LONGEST_AS_IT_IS && span > 2 ? 1 : offered.find((one) => span / one <= LONGEST) ?? 1;
    speed.append(...(offered.length ? offered : [1]).map((one) => new Option(one === 1 ? "real time" : `${one.toLocaleString("en")} × real time`, String(one), one === usual, one === usual)));
    const names = [...Object.keys(VIEWS), ...(this.clip.surface ? [NEAR] : [])];
    view.append(...names.map((name) => new Option(name, name, name === "slanting", name === "slanting")));
    view.addEventListener("change", () => this.look(view.value));
    grid.textContent = `grid ${spoken(this.mesh)} m`;
    for (const mark of [...this.clip.marks].sort((a, b) => a.time - b.time)) {
      if (mark.time < this.times[0] || mark.time > this.times[this.end]) continue;
      const made = Object.assign(document.createElement("button"), { type: "button", textContent: `${mark.what} ${spoken(mark.time)} s` });
      made.addEventListener("click", () => { this.stop(); this.go(this.showing(mark.time)); });
      marks.append(made);
    }
    find("forces")?.addEventListener("change", (event) => { this.bodies.cells.visible = event.target.checked; this.ask(); });
    this.root.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    if (event.target instanceof HTMLSelectElement || (event.target instanceof HTMLButtonElement && event.key === " ")) return;
    const on = event.target === this.parts.slider;
    const step = event.shiftKey ? 10 : 1;
    const acts = {
      " ": () => this.toggle(), Home: () => { this.stop(); this.go(0); }, End: () => { this.stop(); this.go(this.end); },
      ArrowLeft: () => { this.stop(); this.go(this.frame - step); }, ArrowRight: () => { this.stop(); this.go(this.frame + step); },
      ...(on ? {} : {
        ArrowUp: () => this.camera.turn(0, 0.08), ArrowDown: () => this.camera.turn(0, -0.08), a: () => this.camera.turn(-0.08, 0), d: () => this.camera.turn(0.08, 0),
        "+": () => this.camera.near(1 / 1.15), "-": () => this.camera.near(1.15),
      }),
    };
    if (acts[event.key]) { event.preventDefault(); acts[event.key](); }
  }

  nearest(time) {
    let best = 0;
    for (let i = 1; i < this.times.length; i++) if (Math.abs(this.times[i] - time) < Math.abs(this.times[best] - time)) best = i;
    return best;
  }

  /** The frame that shows what was at an instant: of a tow, whose tether has the colour of the step behind it, the one at the end of that step. */
  showing(time) {
    if (!this.clip.tension) return this.nearest(time);
    let frame = 0;
    while (frame < this.end && this.times[frame] < time) frame++;
    return frame;
  }

  look(name) {
    if (name === NEAR) {
      const far = Math.max(...this.clip.surface.corners.map((corner) => Math.hypot(...corner)));
      this.camera.look(this.bodies.body.position, 1.7 * far, ...VIEWS.slanting);
      return;
    }
    const [turned, raised] = VIEWS[name];
    this.camera.look(this.bodies.box.getCenter(new THREE.Vector3()), 0.82 * this.bodies.reach(), turned, raised, this.bodies.far);
  }

  toggle() {
    if (this.playing) { this.stop(); return; }
    if (this.frame === this.end && !this.growing) this.go(0);
    this.playing = true;
    this.parts.play.textContent = "❚❚ pause";
    const began = performance.now(), from = this.times[this.frame];
    const step = (now) => {
      if (!this.playing) return;
      const time = from + ((now - began) / 1000) * Number(this.parts.speed.value);
      let next = this.frame;
      while (next < this.end && this.times[next + 1] <= time) next++;
      if (next !== this.frame) this.go(next);
      if (next === this.end && !this.growing) this.stop(); else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  stop() {
    this.playing = false;
    this.parts.play.textContent = "▶ play";
  }

  go(frame) {
    this.frame = Math.min(Math.max(frame, 0), this.end);
    this.bodies.show(this.frame);
    const { slider, time, told } = this.parts;
    slider.value = String(this.frame);
    time.value = `${spoken(this.times[this.frame], 6)} s ${this.clip.clock}`;
    slider.setAttribute("aria-valuetext", time.value);
    const now = this.bodies.told(this.frame);
    if (now && this.bodies.tensions) told.textContent = `tautest thread now ${spoken(now.most, 2)} N; ${now.taut.toLocaleString("en")} of ${now.count.toLocaleString("en")} threads taut`;
    else if (now) told.textContent = now.taut ? `tether bears up to ${spoken(now.most, 3)} N in the step up to here` : "tether slack in the step up to here";
    this.ask();
  }

  resize() {
    const width = this.stage.clientWidth, height = this.stage.clientHeight;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.eye.aspect = width / height;
    this.camera.eye.updateProjectionMatrix();
    this.bodies.ribbons.forEach((one) => one.size.set(width, height));
    this.look(this.parts.view.value || "slanting");
  }

  /** Draw once, at the next chance. */
  ask() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => { this.asked = false; this.draw(); });
  }

  draw() {
    this.camera.place();
    this.renderer.render(this.scene, this.camera.eye);
    const turn = this.camera.eye.matrixWorldInverse.elements;
    for (const [name, at] of [["along-track", 0], ["radial", 1], ["cross-track", 2]]) {
      const sign = at === 2 ? -1 : 1, x = 34 * sign * turn[4 * at], y = -34 * sign * turn[4 * at + 1];
      const line = this.parts.axes.querySelector(`line[data-axis="${name}"]`), text = this.parts.axes.querySelector(`text[data-axis="${name}"]`);
      line.setAttribute("x2", x); line.setAttribute("y2", y);
      const long = Math.hypot(x, y), out = 1.15;
      text.setAttribute("visibility", long < 10 ? "hidden" : "visible");  // it points at the reader, and would lie on another
      text.style.textAnchor = x > 6 ? "start" : x < -6 ? "end" : "middle";
      text.setAttribute("x", out * x); text.setAttribute("y", out * y + 4);
    }
  }
}
