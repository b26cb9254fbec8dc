"use strict";
const every = (selector, inside = document) => [...inside.querySelectorAll(selector)];

// What is folded is printed too, and unfolds where a link leads into it.
let folded = [];
addEventListener("beforeprint", () => { folded = every("details:not([open])"); for (const one of folded) one.open = true; });
addEventListener("afterprint", () => { for (const one of folded) one.open = false; });
function unfold() {
  const goal = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  for (let at = goal; at; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
  if (goal) goal.scrollIntoView();
}
addEventListener("hashchange", unfold);
unfold();

// Points of figures: the run behind each, in words and as a card.
const tip = document.createElement("div"), dialog = document.createElement("dialog");
tip.className = "tip";
tip.hidden = true;
dialog.setAttribute("aria-label", "Run");
document.body.append(tip, dialog);
function told(point) {
  const box = point.getBoundingClientRect();
  tip.textContent = point.getAttribute("aria-label");
  tip.hidden = false;
  tip.style.left = Math.max(4, Math.min(box.right, innerWidth - tip.offsetWidth - 8)) + "px";
  tip.style.top = Math.max(4, box.top - tip.offsetHeight - 2) + "px";
}
function card(event) {
  const found = document.getElementById(event.currentTarget.hash.slice(1));
  if (!found) return;
  event.preventDefault();
  tip.hidden = true;
  const copy = found.cloneNode(true), close = document.createElement("form"), title = document.createElement("h2");
  close.method = "dialog";
  close.innerHTML = "<button>Close</button>";
  title.textContent = copy.querySelector("summary").textContent;
  copy.querySelector("summary").remove();
  dialog.replaceChildren(close, title, ...copy.childNodes);
  dialog.showModal();
}
for (const figure of every("figure")) {
  const points = every(".point", figure);
  points.forEach((point, number) => {
    point.tabIndex = number ? -1 : 0;
    point.addEventListener("click", card);
    for (const kind of ["pointerenter", "focus"]) point.addEventListener(kind, () => told(point));
    for (const kind of ["pointerleave", "blur"]) point.addEventListener(kind, () => { tip.hidden = true; });
    point.addEventListener("keydown", event => {
      const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
      if (!step) return;
      event.preventDefault();
      const shown = points.filter(one => !one.classList.contains("off"));
      shown[(shown.indexOf(point) + step + shown.length) % shown.length].focus();
    });
  });
}

// Series of a figure, shown and hidden.
for (const figure of every("figure[data-series]")) {
  const names = JSON.parse(figure.dataset.series), row = document.createElement("p");
  row.className = "series";
  row.setAttribute("role", "group");
  row.setAttribute("aria-label", "Series of the figure");
  names.forEach((name, number) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = name;
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      const off = button.getAttribute("aria-pressed") === "true";
      button.setAttribute("aria-pressed", String(!off));
      for (const one of every(`[id*="-series-${number}-"], .point[data-series="${number}"]`, figure)) one.classList.toggle("off", off);
    });
    row.append(button);
  });
  figure.querySelector(".drawing").after(row);
}

// Tables: sorted by a click on a head, filtered by what is typed.
function value(text) {
  const plain = text.trim().replace("−", "-").replace(/^[<>±] ?/, ""), part = plain.match(/^(-?\d+)\/(\d+)$/);
  return plain === "∞" ? Infinity : part ? part[1] / part[2] : /^[-+.]?\d/.test(plain) ? parseFloat(plain) : NaN;
}
function compared(a, b) {
  const x = value(a), y = value(b);
  return isNaN(x) && isNaN(y) ? a.localeCompare(b) : isNaN(x) ? 1 : isNaN(y) ? -1 : x - y;
}
function sorted(table, head, heads) {
  const down = head.getAttribute("aria-sort") === "ascending", column = heads.indexOf(head);
  for (const one of heads) one.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", down ? "descending" : "ascending");
  for (const body of table.tBodies) {
    const rows = every("tr:not(.group)", body).sort((a, b) => compared(a.cells[column].textContent, b.cells[column].textContent));
    body.append(...(down ? rows.reverse() : rows));
  }
}
function filtered(table, rows, wanted, count) {
  for (const row of rows) {
    const group = row.parentElement.querySelector(".group");
    row.hidden = !(row.textContent + (group ? group.textContent : "")).toLowerCase().includes(wanted.toLowerCase());
  }
  for (const group of every(".group", table)) group.hidden = !every("tr:not(.group):not([hidden])", group.parentElement).length;
  count.textContent = `${rows.filter(row => !row.hidden).length} of ${rows.length} rows`;
}
for (const table of every("table")) {
  const rows = every("tbody tr:not(.group)", table), heads = every("thead th", table);
  if (rows.length > 3) for (const head of heads.filter(one => one.textContent)) {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    button.addEventListener("click", () => sorted(table, head, heads));
    head.append(button);
  }
  if (rows.length < 12) continue;
  const row = document.createElement("div"), input = document.createElement("input"), count = document.createElement("output");
  row.className = "filter";
  input.type = "search";
  input.placeholder = "Filter the rows";
  input.setAttribute("aria-label", `Filter the rows of: ${table.caption.firstChild.textContent.trim()}`);
  input.addEventListener("input", () => filtered(table, rows, input.value, count));
  row.append(input, count);
  table.before(row);
}
