// The wiring picture while it works: wires flash, taps light up, a wire shows what it carries.

import { arrange } from "./wiring_columns.js";
import { draw } from "./wiring_draw.js";
import { route } from "./wiring_routes.js";
import { listed, number, say, span, value } from "./words.js";

const place = document.getElementById("wiring");
const readout = document.getElementById("wire-value");
const hint = readout.textContent;
let drawn = null;
let counted = new Map();
let carried = new Map();
let pointed = null;
let pinned = null;

/** Draws the wiring of a graph. */
export function setWiring(graph) {
  drawn = draw(route(arrange(graph)));
  counted = new Map();
  if (!drawn.nets.has(pinned)) pinned = null;
  pointed = null;
  for (const [name, group] of drawn.nets) listen(name, group);
  place.replaceChildren(drawn.svg);
  mark();
}

function listen(name, group) {
  const point = () => { pointed = name; mark(); };
  const leave = () => { pointed = null; mark(); };
  const pin = () => { pinned = pinned === name ? null : name; mark(); };
  group.addEventListener("pointerenter", point);
  group.addEventListener("focus", point);
  group.addEventListener("pointerleave", leave);
  group.addEventListener("blur", leave);
  group.addEventListener("click", pin);
  group.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    pin();
  });
}

function mark() {
  const chosen = pointed ?? pinned;
  for (const [name, group] of drawn.nets) {
    group.classList.toggle("chosen", name === chosen);
    group.setAttribute("aria-pressed", String(name === pinned));
  }
  read();
}

function read() {
  const chosen = pointed ?? pinned;
  readout.classList.toggle("reading", chosen !== null);
  if (chosen === null) return say(readout, hint);
  const wire = carried.get(chosen);
  if (!wire) return say(readout, `${chosen}: nothing known yet`);
  const kind = wire.type ? ` (${wire.type})` : "";
  const rate = typeof wire.rate_hz === "number" ? `, ${number(wire.rate_hz)} Hz` : "";
  return say(readout, `${chosen}${kind} = ${value(wire.value)} · ${span(wire.age_ms)} old${rate}`);
}

/** Shows the wires, taps and layers of a state. */
export function showWiring(state) {
  if (drawn === null) return;
  carried = new Map(listed(state.wires).filter((wire) => wire?.wire).map((wire) => [wire.wire, wire]));
  for (const [name, group] of drawn.nets) {
    const messages = carried.get(name)?.messages;
    group.classList.toggle("live", counted.has(name) && counted.get(name) !== messages);
    if (messages !== undefined) counted.set(name, messages);
  }
  const states = new Map(listed(state.taps).map((tap) => [`${tap.from}>${tap.to}`, tap]));
  for (const [key, { tap, group }] of drawn.taps) showTap(group, tap, states.get(key));
  read();
}

function showTap(group, tap, now) {
  const holds = now?.holds === true;
  const left = holds && now.remaining_ms >= 0 ? now.remaining_ms : null;
  group.dataset.holds = String(holds);
  const whole = tap.time_constant_ms || 1;
  const share = left === null ? (holds ? 100 : 0) : Math.min(100, (left / whole) * 100);
  group.querySelector(".left").setAttribute("stroke-dasharray", `${share} 100`);
  const text = left === null ? span(tap.time_constant_ms) : `${(left / 1000).toFixed(1)} s`;
  say(group.querySelector(".constant"), text);
  const verb = tap.kind === "inhibit" ? "inhibits" : "suppresses";
  const counts = now ? `; delivered ${number(now.delivered)}, rejected ${number(now.rejected)}` : "";
  const doing = holds ? `, holds${left === null ? "" : `, ${text} left`}` : ", does not hold";
  const words = `${tap.from} ${verb} ${tap.to} for ${span(tap.time_constant_ms)}${doing}${counts}`;
  say(group.querySelector("title"), words);
  group.setAttribute("aria-label", words);
}
