// Dark or light: as the reader's system has it, unless the switch says otherwise.

(() => {
  const root = document.documentElement, names = ["auto", "light", "dark"];
  const kept = () => { try { return localStorage.getItem("dcone-theme") || "auto"; } catch { return "auto"; } };
  const set = (name) => {
    if (name === "auto") delete root.dataset.theme; else root.dataset.theme = name;
    try { localStorage.setItem("dcone-theme", name); } catch { /* a page from disk may have nowhere to keep it */ }
    const button = document.getElementById("theme");
    if (button) button.textContent = `theme: ${name}`;
  };
  let now = kept();
  set(now);
  addEventListener("beforeprint", () => { for (const one of document.querySelectorAll("details.given")) one.open = true; });
  addEventListener("DOMContentLoaded", () => {
    set(now);
    document.getElementById("theme").addEventListener("click", () => { now = names[(names.indexOf(now) + 1) % names.length]; set(now); });
    for (const button of document.querySelectorAll("[data-copy]")) {
      button.addEventListener("click", () => {
        const text = document.getElementById(button.dataset.copy).textContent;
        navigator.clipboard?.writeText(text).then(() => { button.textContent = "copied"; }, () => { button.textContent = "select and copy"; });
      });
    }
  });
})();
