// What makes a page of what it holds: a replay for each clip, a chart for each history.

import { Chart } from "dcone/chart";

import { Live } from "dcone/live";

const data = JSON.parse(document.getElementById("data").textContent);

/** For whoever looks from outside: the parts of the page, as they stand. */
window.dcone = { charts: {}, replays: {}, live: null, shot: null, faults: [], ready: 0 };
const ready = () => {
  window.dcone.ready = performance.now();
  document.documentElement.dataset.ready = "true";
};

for (const chart of data.charts) window.dcone.charts[chart.key] = new Chart(document.getElementById(`chart-${chart.key}`), chart);

if (data.live) window.dcone.live = new Live(document.getElementById("live-tow"), data.live);

if (data.clips.length) {
  const fall = (error) => {
    window.dcone.faults.push(String(error));
    document.documentElement.classList.add("flat");
  };
  import("dcone/replay").then(({ Replay }) => {
    for (const clip of data.clips) {
      try {
        window.dcone.replays[clip.key] = new Replay(document.getElementById(`replay-${clip.key}`), clip, data.colours);
      } catch (error) { fall(error); }
    }
    ready();
    if (data.shot) return import("dcone/shot").then(({ ShotView }) => {
      const own = window.dcone.replays[data.shot.phase], clip = data.clips.find((one) => one.key === data.shot.phase);
      try {
        if (own) window.dcone.shot = new ShotView(document.getElementById("live-shot"), data.shot, data.colours, own.bodies.box, clip.surface);
      } catch (error) { fall(error); }
    });
    return null;
  }, (error) => { fall(error); ready(); });
} else ready();
