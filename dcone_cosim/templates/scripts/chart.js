// A chart to zoom into: drag over a stretch, or use the buttons and keys; nothing moves by itself.

import { spoken, unpack } from "dcone/bytes";
import { csvOf, keep } from "dcone/csv";
import { Cursor, before, nearest } from "dcone/cursor";

const SVG = "http://www.w3.org/2000/svg";
const MARGIN = { left: 62, right: 14, top: 10, bottom: 42 };
/** Of a digit on an axis, and of what else stands beside it [px]. */
const DIGIT = 6.4, BESIDE = 26;
/** Room over a chart that has letters there [px]. */
const OVER = 24;
/** Between two letters over the chart [px]. */
const APART = 11;
const DASHES = ["", "6 3", "2 3", "9 3 2 3", "12 4", "1 4"];

function node(name, attributes = {}, text = "") {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text) made.textContent = text;
  return made;
}

/** Steps of 1, 2 or 5 that divide a range into about `wanted`. */
export function ticks(low, high, wanted) {
  const raw = (high - low) / Math.max(1, wanted);
  if (!(raw > 0)) return [low];
  const power = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 5, 10].map((n) => n * power).find((one) => one >= raw);
  const found = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n++) found.push(n * step);
  return found;
}

function decades(low, high) {
  const found = [];
  const every = Math.ceil((Math.log10(high) - Math.log10(low)) / 7) || 1;
  for (let n = Math.ceil(Math.log10(low) - 1e-9); n <= Math.log10(high) + 1e-9; n += every) found.push(Math.pow(10, n));
  return found.length >= 2 ? found : ticks(low, high, 4);
}

/** Letters of marks: a to z, then aa. */
const lettered = (n) => (n < 26 ? String.fromCharCode(97 + n) : lettered(Math.floor(n / 26) - 1) + lettered(n % 26));

export class Chart {
  constructor(root, data) {
    this.root = root;
    this.data = data;
    this.log = data.log;
    this.cursor = new Cursor(this);
    this.marks = [...data.marks].sort((a, b) => a.time - b.time).map((mark, n) => ({ ...mark, letter: lettered(n) }));
    this.margin = { ...MARGIN, ...(this.marks.length ? { top: OVER } : {}) };
    this.take(data.series);
    this.furnish();
    new ResizeObserver(() => this.draw()).observe(this.plot);
    this.draw();
  }

  /** Have these series, and show all of them. */
  take(series) {
    this.series = series.map((row, i) => {
      const dash = row.hue === null ? DASHES[i % 6] : row.faint ? DASHES[1] : "";
      return { ...row, x: unpack(row.x), y: unpack(row.y), colour: `var(--s${((row.hue ?? i) % 6) + 1})`, dash };
    });
    const ends = this.series.flatMap((row) => (row.x.length ? [row.x[0], row.x[row.x.length - 1]] : []));
    this.all = ends.length ? [Math.min(...ends), Math.max(...ends)] : [0, 1];
    if (this.data.range) this.all = [...this.data.range];
    if (this.all[0] === this.all[1]) this.all[1] = this.all[0] + 1;
    this.shown = [...this.all];
    this.cursor.clear();
  }

  /** Other series in their place; the stretch in sight stays. */
  give(series) {
    const [low, high] = this.shown, whole = low === this.all[0] && high === this.all[1];
    this.take(series);
    this.legend.replaceChildren(...this.entries());
    if (whole) this.draw(); else this.show(low, high);
  }

  furnish() {
    const bar = document.createElement("div");
    bar.className = "bar";
    const button = (text, title, act) => {
      const made = Object.assign(document.createElement("button"), { type: "button", textContent: text, title });
      made.setAttribute("aria-label", title);
      made.addEventListener("click", act);
      bar.append(made);
    };
    button("+", "Zoom in", () => this.zoom(0.5));
    button("−", "Zoom out", () => this.zoom(2));
    button("◀", "Earlier", () => this.pan(-0.25));
    button("▶", "Later", () => this.pan(0.25));
    button("all", "Show all", () => this.show(...this.all));
    if (this.data.log) {
      const label = document.createElement("label");
      const box = Object.assign(document.createElement("input"), { type: "checkbox", checked: true });
      box.addEventListener("change", () => { this.log = box.checked; this.draw(); });
      label.append(box, " logarithmic");
      bar.append(label);
    }
    button("CSV", `Values as CSV${this.data.thinned ? ": of each stretch the least and the largest" : ""}`, () => keep(csvOf(this), `${this.data.key}.csv`));
    this.readout = Object.assign(document.createElement("output"), { className: "readout" });
    this.readout.setAttribute("aria-live", "polite");
    this.readout.setAttribute("aria-atomic", "true");
    bar.append(this.readout);
    this.legend = document.createElement("div");
    this.legend.className = "legend";
    this.legend.append(...this.entries());
    this.key_of_marks = Object.assign(document.createElement("p"), { className: "legend marked" });
    this.key_of_marks.append(...this.marks.map(({ letter, what, time }) => {
      const item = document.createElement("span");
      item.append(Object.assign(document.createElement("b"), { textContent: letter }), ` ${what}, ${spoken(time)} ${this.data.xUnit}`);
      return item;
    }));
    this.plot = document.createElement("div");
    this.plot.className = "plot";
    this.plot.tabIndex = 0;
    this.plot.setAttribute("role", "application");
    this.plot.setAttribute("aria-roledescription", "chart");
    this.plot.setAttribute("aria-label", `${this.data.title} [${this.data.unit}] over ${this.data.clock}: left and right read its values, up and down go to another curve, plus and minus zoom, Home and End go to its ends, 0 shows all`);
    this.root.append(this.legend, this.plot, ...(this.marks.length ? [this.key_of_marks] : []), bar);
    this.plot.addEventListener("keydown", (event) => this.key(event));
    this.plot.addEventListener("pointerdown", (event) => this.grab(event));
    this.plot.addEventListener("pointermove", (event) => this.hover(event));
    this.plot.addEventListener("pointerleave", () => { this.readout.value = ""; this.point(); });
    this.plot.addEventListener("dblclick", () => this.show(...this.all));
    this.plot.addEventListener("wheel", (event) => {
      if (document.activeElement !== this.plot && !event.ctrlKey) return;
      event.preventDefault();
      this.zoom(event.deltaY > 0 ? 1.25 : 0.8, this.timeAt(event));
    }, { passive: false });
  }

  /** What the legend says. */
  entries() {
    return this.series.map((row) => {
      const item = document.createElement("span");
      const swatch = node("svg", { width: 26, height: 10, "aria-hidden": "true" });
      swatch.append(node("line", { x1: 0, x2: 26, y1: 5, y2: 5, style: `stroke:${row.colour}`, "stroke-width": 2, "stroke-dasharray": row.dash }));
      if (row.kind === "stems") swatch.append(node("circle", { cx: 13, cy: 5, r: 3.5, style: `fill:${row.faint ? "var(--paper)" : row.colour};stroke:${row.colour}` }));
      item.append(swatch, row.name);
      return item;
    });
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const { cursor } = this, far = event.shiftKey ? 10 : 1, about = () => (cursor.on ? cursor.time : undefined);
    const read = (act) => () => { act(); this.follow(); this.point(true); };
    const acts = {
      ArrowLeft: read(() => cursor.walk(-far)), ArrowRight: read(() => cursor.walk(far)),
      ArrowUp: read(() => cursor.turn(-1)), ArrowDown: read(() => cursor.turn(1)),
      Home: read(() => cursor.end(false)), End: read(() => cursor.end(true)),
      PageUp: () => this.pan(-0.5), PageDown: () => this.pan(0.5),
      "+": () => this.zoom(0.7, about()), "=": () => this.zoom(0.7, about()), "-": () => this.zoom(1.4, about()),
      0: () => this.show(...this.all),
    };
    if (acts[event.key]) { event.preventDefault(); acts[event.key](); }
  }

  /** Have the cursor in sight. */
  follow() {
    if (!this.cursor.on) return;
    const { time } = this.cursor, [low, high] = this.shown;
    if (time < low || time > high) this.show(time - 0.5 * (high - low), time + 0.5 * (high - low));
  }

  /** Draw the cursor, and say what stands there. */
  point(aloud = false) {
    this.cross?.remove();
    const { cursor } = this;
    if (!cursor.on || cursor.time < this.shown[0] || cursor.time > this.shown[1]) return;
    const { row, index, time, value } = cursor, x = this.toX(time), y = this.toY(value);
    this.cross = this.line(x);
    this.cross.append(node("circle", { cx: x, cy: y, r: 5, class: "here", style: `stroke:${row.colour}` }));
    this.svg.append(this.cross);
    if (!aloud) return;
    const which = row.kind === "stems" ? `, ${index + 1} of ${row.x.length}` : "";
    const at = this.marks.filter((mark) => Math.abs(this.toX(mark.time) - x) < 1).map((mark) => mark.what);
    this.readout.value = `${row.name}${which}: ${spoken(value)} ${this.data.unit} at ${spoken(time, 5)} ${this.data.xUnit}${at.length ? `; ${at.join(", ")}` : ""}`;
  }

  /** A line from top to foot, in a group. */
  line(x) {
    const group = node("g", { class: "cross" });
    group.append(node("line", { x1: x, x2: x, y1: this.margin.top, y2: this.margin.top + this.inner.height }));
    return group;
  }

  show(low, high) {
    const least = (this.all[1] - this.all[0]) * 1e-6;
    const width = Math.min(Math.max(high - low, least), this.all[1] - this.all[0]);
    const begin = Math.min(Math.max(low, this.all[0]), this.all[1] - width);
    this.shown = [begin, begin + width];
    this.draw();
  }

  zoom(by, about = 0.5 * (this.shown[0] + this.shown[1])) {
    this.show(about - by * (about - this.shown[0]), about + by * (this.shown[1] - about));
  }

  pan(share) {
    const way = share * (this.shown[1] - this.shown[0]);
    this.show(this.shown[0] + way, this.shown[1] + way);
  }

  /** Range of the values that are shown. */
  range() {
    let low = Infinity, high = -Infinity, least = Infinity;
    for (const row of this.series) {
      for (let i = Math.max(before(row.x, this.shown[0]) - 1, 0); i < row.x.length && (i === 0 || row.x[i - 1] <= this.shown[1]); i++) {
        const value = row.y[i];
        if (value < low) low = value;
        if (value > high) high = value;
        if (value > 0 && value < least) least = value;
      }
    }
    if (!Number.isFinite(low)) return [0, 1];
    if (this.log && high > 0) return [Math.max(least, high * 1e-8) * 0.7, high * 1.5];
    if (low > 0 && low < 0.5 * high) low = 0;
    const pad = (high - low || Math.abs(high) || 1) * 0.06;
    return [low === 0 ? 0 : low - pad, high + pad];
  }

  draw() {
    const width = Math.max(this.plot.clientWidth, 260), height = Math.min(320, Math.max(220, width * 0.42));
    const [low, high] = this.range();
    this.log_now = this.log && low > 0;
    const levels = (this.log_now ? decades(low, high) : ticks(low, high, 5)).map((value) => [value, spoken(value)]);
    this.margin.left = Math.max(MARGIN.left, BESIDE + DIGIT * Math.max(...levels.map(([, text]) => text.length)));
    this.inner = { width: width - this.margin.left - this.margin.right, height: height - this.margin.top - this.margin.bottom };
    this.toX = (x) => this.margin.left + ((x - this.shown[0]) / (this.shown[1] - this.shown[0])) * this.inner.width;
    const lift = this.log_now ? (y) => Math.log(Math.max(y, low)) : (y) => y;
    this.toY = (y) => this.margin.top + (1 - (lift(y) - lift(low)) / (lift(high) - lift(low))) * this.inner.height;
    const svg = node("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": `${this.data.title} over ${this.data.clock}` });
    const clip = `clip-${this.data.key}`;
    const defs = node("defs");
    const area = node("clipPath", { id: clip });
    area.append(node("rect", { x: this.margin.left, y: 0, width: this.inner.width, height: this.margin.top + this.inner.height }));
    defs.append(area);
    svg.append(defs, this.axes(levels));
    const body = node("g", { "clip-path": `url(#${clip})` });
    for (const row of this.series) body.append(row.kind === "stems" ? this.stems(row) : this.curve(row));
    svg.append(body, ...this.marked());
    this.svg = svg;
    this.plot.replaceChildren(svg);
    this.point();
  }

  axes(levels) {
    const group = node("g", { class: "axes" });
    const right = this.margin.left + this.inner.width, foot = this.margin.top + this.inner.height;
    for (const [value, text] of levels) {
      const y = this.toY(value);
      group.append(node("line", { x1: this.margin.left, x2: right, y1: y, y2: y, class: "grid" }));
      group.append(node("text", { x: this.margin.left - 6, y: y + 4, "text-anchor": "end" }, text));
    }
    for (const value of ticks(...this.shown, this.inner.width / 90)) {
      const x = this.toX(value);
      group.append(node("line", { x1: x, x2: x, y1: this.margin.top, y2: foot, class: "grid" }));
      group.append(node("text", { x, y: foot + 16, "text-anchor": "middle" }, spoken(value, 6)));
    }
    group.append(node("line", { x1: this.margin.left, x2: right, y1: foot, y2: foot }));
    group.append(node("text", { x: this.margin.left + this.inner.width / 2, y: foot + 34, "text-anchor": "middle" }, `${this.data.clock} [${this.data.xUnit}]`));
    group.append(node("text", { x: 12, y: this.margin.top + this.inner.height / 2, "text-anchor": "middle", transform: `rotate(-90 12 ${this.margin.top + this.inner.height / 2})` }, `${this.data.title.split(",")[0]} [${this.data.unit}]`));
    return group;
  }

  /** One path: of each column of pixels the least and the largest value. */
  curve(row) {
    const parts = [];
    const first = Math.max(before(row.x, this.shown[0]) - 1, 0);
    let column = NaN, low = 0, high = 0, pen = false;
    const flush = () => {
      if (!Number.isNaN(column)) parts.push(`${parts.length && pen ? "L" : "M"}${column} ${low}`, ...(high !== low ? [`L${column} ${high}`] : []));
      pen = true;
    };
    for (let i = first; i < row.x.length; i++) {
      const hidden = this.log_now && row.y[i] <= 0;
      const x = Math.round(this.toX(row.x[i]) * 2) / 2, y = Math.round(this.toY(row.y[i]) * 10) / 10;
      if (hidden) { flush(); column = NaN; pen = false; continue; }
      if (x === column) { low = Math.min(low, y); high = Math.max(high, y); } else { flush(); if (Number.isNaN(column)) pen = false; column = x; low = high = y; }
      if (row.x[i] > this.shown[1]) break;
    }
    flush();
    return node("path", { d: parts.join("") || "M0 0", class: "curve", style: `stroke:${row.colour}`, "stroke-dasharray": row.dash });
  }

  stems(row) {
    const group = node("g", { class: row.faint ? "stems faint" : "stems", style: `stroke:${row.colour};fill:${row.faint ? "var(--paper)" : row.colour}` });
    const foot = this.margin.top + this.inner.height;
    for (let i = before(row.x, this.shown[0]); i < row.x.length && row.x[i] <= this.shown[1]; i++) {
      const x = this.toX(row.x[i]), y = this.toY(row.y[i]);
      group.append(node("line", { x1: x, x2: x, y1: foot, y2: y }), node("circle", { cx: x, cy: y, r: 3 }));
    }
    return group;
  }

  /** Marks in sight: a line each, and over the chart the letter that the key below has, aside where they are many. */
  marked() {
    const seen = this.marks.filter(({ time }) => time >= this.shown[0] && time <= this.shown[1]);
    const places = [], right = this.margin.left + this.inner.width + this.margin.right - 5;
    for (const { time } of seen) places.push(Math.max(this.toX(time), (places.at(-1) ?? -Infinity) + APART));
    for (let n = places.length - 1, most = right; n >= 0; n--, most -= APART) places[n] = Math.min(places[n], most);
    return seen.map(({ time, letter }, n) => {
      const x = this.toX(time), group = node("g", { class: "mark" });
      group.append(node("path", { d: `M${places[n]} 14 L${x} ${this.margin.top} V${this.margin.top + this.inner.height}` }));
      group.append(node("text", { x: places[n], y: 11, "text-anchor": "middle" }, letter));
      return group;
    });
  }

  timeAt(event) {
    const x = event.clientX - this.svg.getBoundingClientRect().left - this.margin.left;
    return this.shown[0] + (Math.min(Math.max(x, 0), this.inner.width) / this.inner.width) * (this.shown[1] - this.shown[0]);
  }

  hover(event) {
    const time = this.timeAt(event);
    const told = [];
    for (const row of this.series) {
      if (!row.x.length) continue;
      const i = nearest(row.x, time);
      if (row.kind === "stems" && Math.abs(this.toX(row.x[i]) - this.toX(time)) > 8) continue;
      told.push(`${row.name} ${spoken(row.y[i])} ${this.data.unit}` + (row.kind === "stems" ? ` at ${spoken(row.x[i], 6)} ${this.data.xUnit}` : ""));
    }
    this.readout.value = `${spoken(time, 5)} ${this.data.xUnit}: ${told.join("; ")}`;
    this.cross?.remove();
    this.cross = this.line(this.toX(time));
    this.svg.append(this.cross);
  }

  /** A drag with the mouse or pen shows the stretch that it goes over. */
  grab(event) {
    if (event.pointerType === "touch" || event.button !== 0) return;
    const begin = this.timeAt(event), box = node("rect", { y: this.margin.top, height: this.inner.height, class: "brush" });
    const move = (e) => {
      const [a, b] = [this.toX(begin), this.toX(this.timeAt(e))].sort((p, q) => p - q);
      box.setAttribute("x", a); box.setAttribute("width", b - a);
      if (!box.parentNode) this.svg.append(box);
    };
    const drop = (e) => {
      removeEventListener("pointermove", move);
      removeEventListener("pointerup", drop);
      box.remove();
      const [low, high] = [begin, this.timeAt(e)].sort((a, b) => a - b);
      if (this.toX(high) - this.toX(low) > 6) this.show(low, high);
    };
    addEventListener("pointermove", move);
    addEventListener("pointerup", drop);
  }
}
