// The wiring picture while it works: wires flash, taps light up, a wire shows what it carries.
//
// The picture itself comes with the plan, drawn by the library that also draws files; nothing is laid out here.

import { layPulses, runPulses } from "./pulses.js";
import { addressOf } from "./views.js";
import { listed, number, say, span, value } from "./words.js";

const NS = "http://www.w3.org/2000/svg";
const place = document.getElementById("wiring");
const readout = document.getElementById("wire-value");
const link = document.getElementById("wire-link");
const size = document.getElementById("wiring-size");
const hint = readout.textContent;
let nets = new Map();
let taps = new Map();
let counted = new Map();
let carried = new Map();
let pointed = null;
let pinned = null;

size.addEventListener("click", () => {
  const large = !place.classList.contains("large");
  place.classList.toggle("large", large);
  size.setAttribute("aria-pressed", String(large));
  say(size, large ? "Fit" : "Enlarge");
});

/** The ports that a wire leads to in the picture. */
export function branchesOf(name) {
  const branches = nets.get(name)?.querySelectorAll(".branch") ?? [];
  return [...branches].map((branch) => branch.dataset.to).filter((to) => to);
}

/** Shows the picture of a graph. */
export function setWiring(graph) {
  nets = new Map();
  taps = new Map();
  counted = new Map();
  pointed = null;
  const read = new DOMParser().parseFromString(String(graph.svg ?? ""), "image/svg+xml").documentElement;
  if (read.namespaceURI !== NS || read.querySelector("parsererror")) return place.replaceChildren();
  const svg = document.importNode(read, true);
  for (const group of svg.querySelectorAll(".net")) {
    nets.set(group.dataset.wire, group);
    enliven(group.dataset.wire, group);
  }
  for (const group of svg.querySelectorAll(".tap")) {
    taps.set(group.dataset.tap, group);
    arm(group);
  }
  if (!nets.has(pinned)) pinned = null;
  place.replaceChildren(svg);
  return mark();
}

/** Makes a wire one that can be pointed at and pinned. */
function enliven(name, group) {
  group.setAttribute("tabindex", "0");
  group.setAttribute("role", "button");
  group.setAttribute("aria-label", `wire ${name}`);
  // The value is the tooltip of the whole wire.
  for (const title of group.querySelectorAll(".branch > title")) title.remove();
  for (const line of group.querySelectorAll(".line")) {
    const wide = line.cloneNode();
    wide.setAttribute("class", "catch");
    line.before(wide);
  }
  layPulses(group);
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

/** Gives a tap the ring that shows how much of its time is left. */
function arm(group) {
  group.setAttribute("tabindex", "0");
  group.setAttribute("role", "img");
  group.dataset.holds = "false";
  group.dataset.constant = group.querySelector(".constant").textContent;
  const disc = group.querySelector(".disc");
  const left = disc.cloneNode();
  left.setAttribute("class", "left");
  left.setAttribute("pathLength", "100");
  left.setAttribute("stroke-dasharray", "0 100");
  left.setAttribute("transform", `rotate(-90 ${disc.getAttribute("cx")} ${disc.getAttribute("cy")})`);
  disc.after(left);
}

function mark() {
  const chosen = pointed ?? pinned;
  for (const [name, group] of nets) {
    group.classList.toggle("chosen", name === chosen);
    group.setAttribute("aria-pressed", String(name === pinned));
  }
  read();
}

/** What a wire carries, in words. */
function words(name) {
  const wire = carried.get(name);
  if (!wire) return `${name}: nothing known yet`;
  const kind = wire.type ? ` (${wire.type})` : "";
  const rate = typeof wire.rate_hz === "number" ? `, ${number(wire.rate_hz)} Hz` : "";
  return `${name}${kind} = ${value(wire.value)} · ${span(wire.age_ms)} old${rate}`;
}

function read() {
  const chosen = pointed ?? pinned;
  readout.classList.toggle("reading", chosen !== null);
  say(readout, chosen === null ? hint : words(chosen));
  link.hidden = chosen === null;
  if (chosen !== null) link.href = addressOf(chosen);
  if (pointed !== null) say(nets.get(pointed).querySelector("title"), words(pointed));
}

/** Shows the wires and taps of a state. */
export function showWiring(state) {
  carried = new Map(listed(state.wires).filter((wire) => wire?.wire).map((wire) => [wire.wire, wire]));
  for (const [name, group] of nets) {
    const messages = carried.get(name)?.messages;
    const live = counted.has(name) && messages !== undefined && counted.get(name) !== messages;
    group.classList.toggle("live", live);
    if (live) runPulses(group);
    if (messages !== undefined) counted.set(name, messages);
  }
  const states = new Map(listed(state.taps).map((tap) => [`${tap.from}>${tap.to}`, tap]));
  for (const [key, group] of taps) {
    if (states.has(key)) showTap(group, states.get(key));
  }
  read();
}

function showTap(group, tap) {
  const holds = tap.holds === true;
  const left = holds && tap.remaining_ms >= 0 ? tap.remaining_ms : null;
  group.dataset.holds = String(holds);
  const whole = tap.time_constant_ms || left || 1;
  const share = left === null ? (holds ? 100 : 0) : Math.min(100, (left / whole) * 100);
  group.querySelector(".left").setAttribute("stroke-dasharray", `${share} 100`);
  const text = left === null ? group.dataset.constant : `${(left / 1000).toFixed(1)} s`;
  say(group.querySelector(".constant"), text);
  const verb = tap.kind === "inhibit" ? "inhibits" : "suppresses";
  const counts = `; delivered ${number(tap.delivered)}, rejected ${number(tap.rejected)}`;
  const idle = tap.joined === false ? `, waits for layer ${tap.at}` : ", does not hold";
  const doing = holds ? `, holds${left === null ? "" : `, ${text} left`}` : idle;
  group.dataset.waits = String(tap.joined === false);
  const said = `${tap.from} ${verb} ${tap.to} for ${group.dataset.constant}${doing}${counts}`;
  say(group.querySelector("title"), said);
  group.setAttribute("aria-label", said);
}
