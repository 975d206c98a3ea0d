// The table of wires: what each carries now.

import { addressOf } from "./views.js";
import { listed, number, say, span, value } from "./words.js";

const table = document.getElementById("wires");
const filter = document.getElementById("wires-filter");
const rows = new Map();

function row(name) {
  const line = document.createElement("tr");
  line.dataset.wire = name;
  const head = document.createElement("th");
  head.scope = "row";
  const kind = document.createElement("small");
  const link = document.createElement("a");
  link.href = addressOf(name);
  link.textContent = name;
  head.append(link, " ", kind);
  const cells = ["value", "number", "number", "number"].map((style) => {
    const cell = document.createElement("td");
    cell.className = style;
    return cell;
  });
  line.append(head, ...cells);
  table.tBodies[0].append(line);
  return { line, kind, cells, messages: null };
}

function sift() {
  const wanted = filter.value.trim().toLowerCase();
  for (const [name, { line, kind }] of rows) {
    line.hidden = !`${name} ${kind.textContent}`.toLowerCase().includes(wanted);
  }
}

filter.addEventListener("input", sift);

/** Shows the wires of a state. */
export function showWires(wires) {
  const seen = new Set();
  let fresh = false;
  for (const wire of listed(wires)) {
    if (typeof wire?.wire !== "string") continue;
    seen.add(wire.wire);
    if (!rows.has(wire.wire)) {
      rows.set(wire.wire, row(wire.wire));
      fresh = true;
    }
    const { line, kind, cells, messages } = rows.get(wire.wire);
    say(kind, wire.type ?? "");
    const text = value(wire.value);
    say(cells[0], text);
    cells[0].title = text;
    say(cells[1], span(wire.age_ms));
    say(cells[2], typeof wire.rate_hz === "number" ? `${number(wire.rate_hz)} Hz` : "–");
    say(cells[3], number(wire.messages));
    line.classList.toggle("live", messages !== null && messages !== wire.messages);
    rows.get(wire.wire).messages = wire.messages ?? null;
  }
  for (const [name, { line }] of rows) {
    if (seen.has(name)) continue;
    line.remove();
    rows.delete(name);
  }
  if (fresh) sift();
}
