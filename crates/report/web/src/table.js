// Tables of data, with a page of rows at a time.

import { element } from "./element.js";
import { number } from "./format.js";

const ROWS = 50;

/**
 * A table. `columns` are `{ title, of(row), text?(value), words? }`: the value of a row index, and whether it is a word.
 * The head of a column sorts by it.
 */
export function dataTable(caption, columns, rowCount, options = {}) {
  let page = 0;
  let order = null;
  let sorted = { column: -1, up: true };
  const body = element("tbody");
  const status = element("span", { role: "status" });
  const heads = columns.map((column, c) =>
    element("th", { scope: "col", class: column.words ? "" : "number" },
      element("button", { type: "button", class: "head", onclick: () => sort(c) }, column.title)));
  const table = element("table", {}, element("caption", {}, caption), element("thead", {}, element("tr", {}, heads)), body);
  const pages = () => Math.max(1, Math.ceil(rowCount / ROWS));
  const turn = (by) => { page = Math.min(Math.max(page + by, 0), pages() - 1); fill(); };
  const before = element("button", { type: "button", onclick: () => turn(-1) }, "Previous rows");
  const after = element("button", { type: "button", onclick: () => turn(1) }, "Next rows");

  function sort(c) {
    sorted = { column: c, up: sorted.column === c ? !sorted.up : true };
    const values = Array.from({ length: rowCount }, (_, row) => columns[c].of(row));
    const weigh = (value) => (value === null || value === undefined || Number.isNaN(value) ? Infinity : value);
    const by = columns[c].words
      ? (a, b) => String(values[a] ?? "").localeCompare(String(values[b] ?? ""), "en", { numeric: true })
      : (a, b) => (weigh(values[a]) < weigh(values[b]) ? -1 : weigh(values[a]) > weigh(values[b]) ? 1 : a - b);
    order = Uint32Array.from({ length: rowCount }, (_, i) => i).sort(by);
    if (!sorted.up) order.reverse();
    heads.forEach((head, i) => {
      if (i === c) head.setAttribute("aria-sort", sorted.up ? "ascending" : "descending");
      else head.removeAttribute("aria-sort");
    });
    page = 0;
    fill();
  }

  function fill() {
    const from = page * ROWS;
    const to = Math.min(from + ROWS, rowCount);
    body.replaceChildren(...Array.from({ length: to - from }, (_, i) => {
      const row = order ? order[from + i] : from + i;
      const cells = columns.map((column, c) => {
        const value = column.of(row);
        const text = column.text ? column.text(value) : column.words ? String(value ?? "") : number(value);
        return c === 0 ? element("th", { scope: "row", class: column.words ? "" : "number" }, text)
          : element("td", { class: column.words ? "" : "number" }, text);
      });
      const line = element("tr", {}, cells);
      if (options.onrow) line.addEventListener("click", () => options.onrow(row));
      return line;
    }));
    status.textContent = `Rows ${number(from + 1)} to ${number(to)} of ${number(rowCount)}`;
    before.disabled = page === 0;
    after.disabled = page >= pages() - 1;
  }

  fill();
  const scroller = element("div", { class: "scroller", tabindex: "0", role: "region", "aria-label": caption }, table);
  return element("div", { class: "data" }, scroller,
    rowCount > ROWS ? element("div", { class: "pages" }, before, after, status) : null);
}

/** A table that is made when it is opened: the data behind a picture. */
export function behind(title, make) {
  const details = element("details", { class: "behind" }, element("summary", {}, title));
  details.addEventListener("toggle", () => {
    if (details.open && details.children.length === 1) details.append(make());
  });
  return details;
}

/** A small table of facts: pairs of a name and a text. */
export function facts(caption, pairs, kind = "number") {
  const rows = pairs.map(([name, text]) => element("tr", {}, element("th", { scope: "row" }, name), element("td", { class: kind }, text)));
  return element("table", { class: "facts" }, element("caption", {}, caption), element("tbody", {}, rows));
}
