// Arrays of the page: what dcone_cosim/reports/packing.py has written, read back.

const KINDS = { f4: Float32Array, f8: Float64Array, u1: Uint8Array, u2: Uint16Array, u4: Uint32Array };

/** The numbers of a packed array, flat; codes where it is one of codes. An array that is none is given back. */
export function unpack(packed) {
  if (ArrayBuffer.isView(packed)) return packed;
  const text = atob(packed.data);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return new KINDS[packed.type](bytes.buffer);
}

/** Positions: `at(frame)` fills a Float32Array with those of a frame, as (x, y, z) of the scene. */
export class Places {
  constructor(packed) {
    this.values = unpack(packed.values ?? packed);
    this.count = packed.shape.length === 3 ? packed.shape[1] : 1;
    this.low = packed.low || [0, 0, 0];
    this.step = packed.step || [1, 1, 1];
    this.own = new Float32Array(3 * this.count);
  }

  /** Component `axis` (radial, along-track, cross-track) of point `i` of a frame [m]. */
  told(frame, i, axis) {
    return this.low[axis] + this.step[axis] * this.values[3 * (frame * this.count + i) + axis];
  }

  at(frame) {
    for (let i = 0; i < this.count; i++) {
      this.own[3 * i] = this.told(frame, i, 1);
      this.own[3 * i + 1] = this.told(frame, i, 0);
      this.own[3 * i + 2] = -this.told(frame, i, 2);
    }
    return this.own;
  }
}

/** Tensions as codes of a logarithmic scale: 0 is slack, 255 the largest. */
export class Tensions {
  constructor(packed) {
    this.codes = unpack(packed.codes ?? packed);
    this.count = packed.shape.length === 2 ? packed.shape[1] : 1;
    this.most = packed.most;
    this.floor = packed.floor;
  }

  code(frame, i = 0) {
    return this.codes[frame * this.count + i];
  }

  /** [N] */
  newtons(code) {
    return code === 0 ? 0 : this.most * Math.pow(this.floor, (255 - code) / 254);
  }
}

const RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/**
 * A number as every page has it: so many digits, or fewer where fewer hold, and then with ~ before it. `spoken` of
 * dcone_cosim/findings.py says the same.
 *
 * spread    standard deviation over mean of one sample of many, 0 for any other
 */
export function spoken(value, digits = 4, spread = 0) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value), mark = !spread ? "" : value > 0 ? "~" : "~\u00a0";
  const leading = Number(size.toExponential(digits - 1).split("e")[1]);
  let place = leading - digits + 1;
  if (spread) place = Math.max(place, Math.min(Math.floor(Math.log10(2 * spread * size)), leading));
  const bare = (text) => (spread || !text.includes(".") ? text : text.replace(/\.?0+$/, ""));
  if (leading < -4 || leading >= 6) {
    const raised = String(leading).replace("-", "⁻").replace(/\d/g, (digit) => RAISED[digit]);
    return `${mark}${bare((value / Math.pow(10, leading)).toFixed(leading - place))} · 10${raised}`;
  }
  const unit = Math.pow(10, Math.max(place, 0)), rounded = place > 0 ? Math.round(value / unit) * unit : value;
  const [whole, ...part] = bare(rounded.toFixed(Math.max(-place, 0))).split(".");
  const parted = leading >= 4 ? whole.replace(/\B(?=(\d{3})+$)/g, ",") : whole;
  return mark + [parted, ...part].join(".");
}
