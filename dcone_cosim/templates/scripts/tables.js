// Tables that do not fit: on a narrow screen each row becomes a card, on a wide one the table slides and says so.

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

  function fit(box, table, cue) {
    if (!box.clientWidth) return;
    table.classList.remove("stacked");
    const over = table.offsetWidth > box.clientWidth + 1, stacked = over && NARROW.matches, slides = over && !stacked;
    table.classList.toggle("stacked", stacked);
    box.classList.toggle("slides", slides);
    cue.hidden = !slides;
    if (slides) {
      const hidden = [...table.querySelectorAll("thead th")].filter((head) => head.offsetLeft + head.offsetWidth > box.clientWidth + 1).length;
      cue.textContent = `→ ${hidden} more column${hidden === 1 ? "" : "s"}: scroll sideways, or with the arrow keys`;
      box.tabIndex = 0;
      box.setAttribute("role", "region");
      box.setAttribute("aria-label", "Table, to scroll sideways");
    } else for (const name of ["tabindex", "role", "aria-label"]) box.removeAttribute(name);
  }

  addEventListener("DOMContentLoaded", () => {
    for (const box of document.querySelectorAll(".wide")) {
      const table = box.querySelector("table"), cue = Object.assign(document.createElement("p"), { className: "cue", hidden: true });
      let width = 0;
      label(table);
      box.before(cue);
      new ResizeObserver(() => {
        if (box.clientWidth === width) return;
        width = box.clientWidth;
        fit(box, table, cue);
      }).observe(box);
      fit(box, table, cue);
    }
  });
})();
