// What makes a page of what it holds: a replay for each clip, a chart for each history.

import { Chart } from "dcone/chart";

import { Live } from "dcone/live";

const data = JSON.parse(document.getElementById("data").textContent);

/** For whoever looks from outside: the parts of the page, as they stand. */
window.dcone = { charts: {}, replays: {}, live: null, shot: null, faults: [], ready: 0 };
/** Do it once a part of the page comes near to what is seen; where it cannot be done the part says so. */
function whenNear(part, act) {
  const watch = new IntersectionObserver((seen) => {
    if (!seen.some((one) => one.isIntersecting)) return;
    watch.disconnect();
    act().catch((error) => {
      window.dcone.faults.push(String(error));
      part.classList.add("off");
      part.querySelector('[data-part="status"]').textContent = `Nothing can be simulated here: ${error.message}.`;
    });
  }, { rootMargin: "300px" });
  watch.observe(part);
}

/** The shot, seen as the run's own replay of it is. */
async function shoot() {
  const { ShotView } = await import("dcone/shot");
  const own = window.dcone.replays[data.shot.phase], clip = data.clips.find((one) => one.key === data.shot.phase);
  if (!own) throw new Error("it needs WebGL, and the replay has none");
  window.dcone.shot = new ShotView(document.getElementById("live-shot"), data.shot, data.colours, own.bodies.box, clip.surface, clip.swing);
}

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
    if (data.shot) whenNear(document.getElementById("live-shot"), shoot);
  }, (error) => { fall(error); ready(); });
} else ready();
