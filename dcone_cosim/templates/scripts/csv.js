// What a chart shows as a table in CSV: a column of times, one for each curve, empty where a curve has no value there.

/** A number in the fewest digits that give it back: of single precision where it is one. */
function plain(value, single) {
  if (!Number.isFinite(value)) return "";
  for (let digits = 6; single && digits < 9; digits++) {
    const short = Number(value.toPrecision(digits));
    if (Math.fround(short) === value) return String(short);
  }
  return String(single ? Number(value.toPrecision(9)) : value);
}

const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

/** The text; `chart` as Chart has it. */
export function csvOf({ data, series }) {
  const rows = new Map();
  series.forEach((row, n) => row.x.forEach((x, i) => {
    let again = 0;  // a jump has two rows of one time
    while (row.x[i - 1 - again] === x) again++;
    const key = `${x} ${again}`;
    if (!rows.has(key)) rows.set(key, { x, again, told: new Array(series.length).fill("") });
    rows.get(key).told[n] = plain(row.y[i], row.y instanceof Float32Array);
  }));
  const head = [`${data.clock} [${data.xUnit}]`, ...series.map((row) => `${row.name} [${data.unit}]`)].map(quoted).join(",");
  const sorted = [...rows.values()].sort((a, b) => a.x - b.x || a.again - b.again);
  const lines = sorted.map(({ x, told }) => [plain(x, false), ...told].join(","));
  return [head, ...lines, ""].join("\n");
}

/** Have the browser keep a text as a file. */
export function keep(text, name) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(new Blob([text], { type: "text/csv" })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
