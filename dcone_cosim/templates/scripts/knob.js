// Values of a scene that may be moved in a page, and the worker that has the model.

const STEPS = 400;
const DIGITS = 3;

const rounded = (value) => Number(value.toPrecision(DIGITS));
/** A number as a command line takes it. */
const plain = (value) => String(value);

const bytesOf = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

/** A worker of the page's own script, which is given the model; an error where there is none. */
export function workerOf(which, { model, plan, line }, hear, fail) {
  const script = document.getElementById(`worker-${which}`).textContent;
  const worker = new Worker(URL.createObjectURL(new Blob([script], { type: "text/javascript" })));
  worker.onerror = (event) => fail(event.message || "the worker does not run");
  worker.onmessage = ({ data }) => hear(data);
  const { code, resources, ...rest } = model;
  const bytes = Object.fromEntries(Object.entries(resources).map(([name, text]) => [name, bytesOf(text)]));
  worker.postMessage({ model: { ...rest, code: bytesOf(code).buffer, resources: bytes }, plan, line });
  return worker;
}

/** A value that may be moved: a slider and a number, which follow one another. */
export class Knob {
  constructor(root, told, moved) {
    this.told = told;
    this.value = told.value;
    this.slider = root.querySelector("input[type=range]");
    this.number = root.querySelector("input[type=number]");
    Object.assign(this.slider, { min: 0, max: STEPS, step: 1 });
    this.number.step = "any";
    this.slider.addEventListener("input", () => { this.put(this.at(Number(this.slider.value)), false); moved(); });
    this.number.addEventListener("change", () => {
      const value = this.number.valueAsNumber;
      this.put(Number.isFinite(value) ? value : this.told.value);
      moved();
    });
    this.put(told.value);
  }

  get moved() { return this.value !== this.told.value; }

  /** The value at a place of the slider; the run's own near its place. */
  at(place) {
    if (place === this.place(this.told.value)) return this.told.value;
    const { low, high, log } = this.told, share = place / STEPS;
    return rounded(log ? low * Math.pow(high / low, share) : low + share * (high - low));
  }

  place(value) {
    const { low, high, log } = this.told;
    const share = log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
    return Math.round(STEPS * Math.min(Math.max(share || 0, 0), 1));
  }

  put(value, slide = true) {
    this.value = value;
    if (slide) this.slider.value = this.place(value);
    this.number.value = value;
    this.slider.setAttribute("aria-valuetext", `${plain(value)} ${this.told.unit}`);
    this.slider.closest(".knob").classList.toggle("moved", this.moved);
  }

  /** Show that the model refuses the value, or that it does not. */
  refuse(refused) {
    this.number.setAttribute("aria-invalid", String(refused));
  }

  /** What the model gets, by name. */
  get values() {
    const si = this.told.factor === 1 ? this.value : this.told.factor * this.value;
    return Object.fromEntries(Object.entries(this.told.sets).map(([name, [offset, slope]]) => [name, slope === 1 && offset === 0 ? si : offset + slope * si]));
  }

  /** The settings that make the same run in a shell. */
  get settings() {
    const { key, also, unit, shares } = this.told, end = unit ? ` ${unit}` : "";
    const one = (value) => `${plain(value)}${end}`;
    const text = shares.length ? `[${shares.map((share) => `'${one(Number((share * this.value).toPrecision(12)))}'`).join(", ")}]` : one(this.value);
    return [key, ...also].map((name) => `--set ${name}="${text}"`);
  }
}
