// A cursor on the curves of a chart, moved by keys; what stands there is said by whoever shows the chart.

/** Index of the first of ascending numbers that is not below a value. */
export function before(x, value) {
  let low = 0, high = x.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (x[middle] < value) low = middle + 1; else high = middle;
  }
  return low;
}

/** The nearest to a value of ascending numbers. */
export function nearest(x, value) {
  const i = Math.min(before(x, value), x.length - 1);
  return i > 0 && value - x[i - 1] < x[i] - value ? i - 1 : i;
}

export class Cursor {
  /** `chart` has series, shown and toX. */
  constructor(chart) {
    this.chart = chart;
    this.clear();
  }

  clear() { [this.curve, this.index] = [0, -1]; }

  get row() { return this.chart.series[this.curve]; }
  get on() { return this.index >= 0 && this.index < (this.row?.x.length ?? 0); }
  get time() { return this.row.x[this.index]; }
  get value() { return this.row.y[this.index]; }

  /** By so many places; a place is a tug, or the next row of a curve that is seen apart from this one. */
  walk(places) {
    const { row, chart } = this, way = Math.sign(places), last = (row?.x.length ?? 0) - 1;
    if (last < 0) return this.turn(1);
    if (!this.on) { this.index = Math.min(before(row.x, chart.shown[0]), last); return; }
    const pixel = (chart.shown[1] - chart.shown[0]) / chart.inner.width;
    for (let n = Math.abs(places); n > 0; n--) {
      const far = row.kind === "stems" ? 0 : pixel, from = row.x[this.index];
      let i = this.index + way;
      while (i > 0 && i < last && Math.abs(row.x[i] - from) < far) i += way;
      this.index = Math.min(Math.max(i, 0), last);
    }
  }

  /** To the first row, or the last. */
  end(last) {
    if (!this.row?.x.length) this.turn(1);
    if (this.row?.x.length) this.index = last ? this.row.x.length - 1 : 0;
  }

  /** To the next curve that has values, where it is at the same time. */
  turn(way) {
    const { series } = this.chart, time = this.on ? this.time : this.chart.shown[0], count = series.length;
    for (let n = 1; n <= count; n++) {
      const curve = (((this.curve + way * n) % count) + count) % count;
      if (!series[curve].x.length) continue;
      [this.curve, this.index] = [curve, nearest(series[curve].x, time)];
      return;
    }
  }
}
