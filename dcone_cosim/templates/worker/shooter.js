// The worker of the shot: it holds the model, and sends frames of the net as they are simulated.

const AT_ONCE = 4;
let fmu = null, plan = null, latest = 0;

const breathe = () => new Promise((done) => { const channel = new MessageChannel(); channel.port1.onmessage = done; channel.port2.postMessage(0); });

async function shoot({ number, values }) {
  latest = number;
  await breathe();
  if (number !== latest) return;
  try {
    let took = 0;
    const timed = (what) => { const began = performance.now(), given = what(); took += (performance.now() - began) / 1000; return given; };
    const shot = timed(() => new Shot(fmu, plan, values));
    for (let more = true; more; ) {
      const frames = timed(() => {
        const some = [];
        for (let n = 0; n < AT_ONCE; n++) {
          const one = shot.next();
          if (one) some.push(one);
        }
        return some;
      });
      more = frames.length === AT_ONCE;
      postMessage({ number, kind: "frames", frames, took });
      await breathe();
      if (number !== latest) return;
    }
    const figures = Object.fromEntries(plan.figures.map((name) => [name, fmu.get(name)]));
    postMessage({ number, kind: "over", took, time: shot.time, ended: shot.ended ?? "", figures, outcome: plan.outcomes[shot.outcome] ?? "" });
  } catch (error) {
    if (number === latest) postMessage({ number, kind: "failed", text: String(error.message || error) });
  }
}

onmessage = async ({ data }) => {
  if (!data.model) return shoot(data);
  plan = data.plan;
  try {
    const { code, ...rest } = data.model;
    fmu = new Fmu({ ...rest, module: await WebAssembly.compile(code) });
    postMessage({ kind: "ready" });
    postMessage({ number: 0, kind: "first", frame: new Shot(fmu, plan, {}).next() });
  } catch (error) {
    postMessage({ kind: "broken", text: String(error.message || error) });
  }
};
