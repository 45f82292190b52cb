// Tables that do not fit: on a narrow screen each row becomes a card, on a wide one the table slides and says so. A
// picture slides on a narrow screen, where its words would be too small.

(() => {
  const NARROW = matchMedia("(max-width: 600px)");
  const ROLES = { table: "table", thead: "rowgroup", tbody: "rowgroup", tr: "row", td: "cell", th: "columnheader" };

  /** Roles that a table keeps however it is laid out, and in each cell the head of its column. */
  function label(table) {
    for (const [tag, role] of Object.entries(ROLES)) {
      for (const part of [table, ...table.querySelectorAll(tag)]) if (part.localName === tag) part.setAttribute("role", role);
    }
    const heads = [...table.querySelectorAll("thead th")].map((head) => head.innerText.replace(/\s+/g, " ").trim());
    for (const row of table.querySelectorAll("tbody tr")) {
      [...row.cells].forEach((cell, n) => {
        cell.dataset.head = heads[n] ?? "";
        if (cell.childNodes.length < 2 && !cell.firstElementChild) return;
        const whole = document.createElement("span");
        whole.append(...cell.childNodes);
        cell.append(whole);
      });
    }
  }

  function fit(box, what, cue) {
    if (!box.clientWidth) return;
    const table = what.localName === "table";
    what.classList.remove("stacked");
    box.classList.remove("slides");
    const over = what.offsetWidth > box.clientWidth + 1, stacked = over && table && NARROW.matches, slides = over && !stacked;
    what.classList.toggle("stacked", stacked);
    box.classList.toggle("slides", slides);
    cue.hidden = !slides;
    if (slides) {
      const hidden = [...what.querySelectorAll("thead th")].filter((head) => head.offsetLeft + head.offsetWidth > box.clientWidth + 1).length;
      const more = table ? `${hidden} more column${hidden === 1 ? "" : "s"}` : "the picture goes on";
      cue.textContent = `→ ${more}: scroll sideways, or with the arrow keys`;
      box.tabIndex = 0;
      box.setAttribute("role", "region");
      box.setAttribute("aria-label", `${table ? "Table" : "Picture"}, to scroll sideways`);
    } else for (const name of ["tabindex", "role", "aria-label"]) box.removeAttribute(name);
  }

  addEventListener("DOMContentLoaded", () => {
    for (const box of document.querySelectorAll(".wide")) {
      const what = box.querySelector("table, img"), cue = Object.assign(document.createElement("p"), { className: "cue", hidden: true });
      let width = 0;
      if (what.localName === "table") label(what);
      box.before(cue);
      new ResizeObserver(() => {
        if (box.clientWidth === width) return;
        width = box.clientWidth;
        fit(box, what, cue);
      }).observe(box);
      fit(box, what, cue);
    }
  });
})();
