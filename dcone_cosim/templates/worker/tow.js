// The tow in a page: its FMU stepped over the phase, every tug gathered once, and the diameter that its line needs.

const FIELDS = ["time", "peak", "speed"];
const FINER = 4, SHORTEST = 1e-3;
const ROWS = 4000;

/** Names of the ring of the latest tugs, newest first. */
function ringOf(references) {
  const names = [];
  for (let i = 1; references[`tug[${i}].${FIELDS[0]}`]; i++) for (const field of FIELDS) names.push(`tug[${i}].${field}`);
  return names;
}

/**
 * The tow with these values in place of the run's.
 *
 * plan     start, step, duration [s]; outputs (names of what is drawn); largest (name of the tension that is largest)
 *
 * Of our tows the tugs have the same bits whatever the step: where more fall into one than the ring holds, the tow is
 * begun anew with a shorter one.
 */
function tow(fmu, plan, values) {
  for (let step = plan.step; ; step /= FINER) {
    const found = towBy(fmu, plan, values, step, step > SHORTEST);
    if (found) return found;
  }
}

function towBy(fmu, plan, values, size, strict) {
  const ring = ringOf(fmu.references), most = ring.length / FIELDS.length;
  fmu.reset();
  fmu.begin(values, plan.start);
  const rows = Math.max(1, Math.ceil(plan.duration / size - 1e-9)), every = Math.ceil(rows / ROWS);
  const read = (fmu.readers ??= {}).row ??= fmu.reader([plan.largest, ...plan.outputs]);
  const newest = most ? (fmu.readers.ring ??= fmu.reader(ring)) : null;
  const tugs = [], drawn = { time: [], ...Object.fromEntries(plan.outputs.map((name) => [name, []])) };
  let largest = 0, largestAt = 0, count = 0, ended = "", time = 0;
  const look = (keep) => {
    const row = read();
    if (row[0] > largest) [largest, largestAt] = [row[0], time];
    if (keep) {
      drawn.time.push(time);
      plan.outputs.forEach((name, k) => drawn[name].push(row[k + 1]));
    }
    if (!newest) return true;
    const now = fmu.get("tether.tug_count");
    if (strict && now - count > most) return false;
    const held = newest();
    for (let n = Math.max(1, count, now - most + 1); n <= now; n++) {
      const at = FIELDS.length * (now - n);
      tugs[n - 1] = [held[at], held[at + 1], held[at + 2]];
    }
    count = now;
    return true;
  };
  if (!look(true)) return null;
  for (let i = 0; i < rows; i++) {
    const begun = plan.start + i * size, end = i === rows - 1 ? plan.duration : (i + 1) * size;
    if (!fmu.step(begun, plan.start + end - begun)) {
      ended = fmu.said.at(-1) || "the model has come to its own end";
      break;
    }
    time = end;
    if (!look((i + 1) % every === 0 || i === rows - 1)) return null;
  }
  let governing = 0;
  tugs.forEach(([at, peak], n) => {
    if (peak >= (1 - 1e-9) * largest && (!governing || peak > tugs[governing - 1][1])) [largest, governing] = [Math.max(largest, peak), n + 1];
  });
  return { tugs, drawn, largest, largestAt, governing, ended, time };
}

/**
 * The least diameter at which `factor` times the largest tension of a line of that diameter is its strength: a fixed
 * point, since a thicker line snaps harder. Sought in logarithms between a line that is too thin and one that is thick
 * enough; what is told is the thick end.
 *
 * strength   [Pa];  factor   of safety [1];  begin, peak   a diameter [m] and its largest tension [N]
 * close      share to which it is found
 * peakOf     largest tension at a diameter, or null where it is not wanted any more (a promise)
 *
 * Returns {diameter, peak, jumps}, or null; an error where there is none between the ends of `range` [m].
 */
async function requiredDiameter(strength, factor, begin, peak, peakOf, { close = 0.005, range = [1e-6, 0.2], rounds = 24 } = {}) {
  const surplus = (d, t) => Math.log((strength * Math.PI * d * d) / 4 / (factor * t));
  let thin = null, thick = null, thickPeak = NaN, at = begin, pull = peak;
  for (let n = 0; n < rounds; n++) {
    if (!(pull > 0)) throw new Error("the tether bears nothing");
    const over = surplus(at, pull);
    if (over >= 0) [thick, thickPeak] = [[at, over], pull];
    else thin = [at, over];
    if (thin && thick && thick[0] / thin[0] < 1 + close) {
      return { diameter: thick[0], peak: thickPeak, jumps: thick[1] > 0.02 };
    }
    if (!thin) at = thick[0] * Math.exp(-thick[1]) / (1 + 0.5 * close) / (1 + 0.2 * n);
    else if (!thick) at = thin[0] * Math.exp(-thin[1]) * (1 + 0.5 * close) * (1 + 0.2 * n);
    else {
      const width = Math.log(thick[0] / thin[0]), share = -thin[1] / (thick[1] - thin[1]), beyond = (0.3 * close) / width;
      const wanted = n > 6 ? 0.5 : share + (thick[1] < -thin[1] ? -beyond : beyond);
      at = thin[0] * Math.exp(width * Math.min(Math.max(wanted, 0.02), 0.98));
    }
    if (at < range[0]) throw new Error(`a tether of ${range[0] * 1e6} µm bears it too`);
    if (at > range[1]) throw new Error(`even a tether of ${range[1] * 1e2} cm does not bear it`);
    pull = await peakOf(at);
    if (pull === null) return null;
  }
  throw new Error("no diameter was found: the peak jumps with it");
}
