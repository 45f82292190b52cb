// The worker of the tow: it holds the model, and simulates the tow for the latest values that it is given.

const DIAMETER = "tether.diameter";
let fmu = null, plan = null, line = null, latest = 0;

/** Let messages that have come meanwhile be taken in. */
const breathe = () => new Promise((done) => { const channel = new MessageChannel(); channel.port1.onmessage = done; channel.port2.postMessage(0); });

const said = (error) => String(error.message || error);

/** `peak` is the largest tension where it is known, and the least diameter alone is wanted. */
async function take({ number, values, factor, diameter, peak }) {
  latest = number;
  await breathe();
  if (number !== latest) return;
  try {
    if (!peak) {
      const began = performance.now();
      const found = tow(fmu, plan, values);
      const sought = Boolean(line.strength && diameter && found.largest > 0 && !found.ended);
      postMessage({ number, kind: "tow", took: (performance.now() - began) / 1000, sought, ...found });
      if (!sought) return;
      peak = found.largest;
    }
    const peakOf = async (at) => {
      await breathe();
      if (number !== latest) return null;
      const tried = tow(fmu, plan, { ...values, [DIAMETER]: at });
      if (tried.ended) throw new Error(tried.ended);
      return tried.largest;
    };
    const unsought = (error) => ({ why: said(error) });
    const needed = await requiredDiameter(line.strength, factor, diameter, peak, peakOf).catch(unsought);
    if (needed) postMessage({ number, kind: "required", ...needed });
  } catch (error) {
    if (number === latest) postMessage({ number, kind: "failed", text: said(error) });
  }
}

onmessage = async ({ data }) => {
  if (!data.model) return take(data);
  ({ plan, line } = data);
  try {
    const { code, ...rest } = data.model;
    fmu = new Fmu({ ...rest, module: await WebAssembly.compile(code) });
    postMessage({ kind: "ready" });
  } catch (error) {
    postMessage({ kind: "broken", text: said(error) });
  }
};
