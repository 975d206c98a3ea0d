// Hierarchies of releasing mechanisms: a panel for each module that has one, with the active mechanisms lit.
//
// Panels are made only for creatures that have them; nothing here touches what other parts show.

import { turn } from "./views.js";
import { listed } from "./words.js";

const NS = "http://www.w3.org/2000/svg";
let trees = [];

function make(tag, attributes, ...children) {
  const element = document.createElement(tag);
  for (const [name, worth] of Object.entries(attributes)) element.setAttribute(name, worth);
  element.append(...children);
  return element;
}

function panel(id, title, note, ...children) {
  const head = make("div", { class: "head" }, make("h2", { id: `${id}-title` }, title), note);
  return make("section", { id, "aria-labelledby": `${id}-title`, class: "tree", "data-view": "wiring" }, head, ...children);
}

/** Takes the hierarchies of a plan. */
export function setHierarchies(plan) {
  for (const tree of trees) tree.panel.remove();
  trees = listed(plan.hierarchies).map(planted).filter((tree) => tree !== null);
  document.getElementById("wiring-panel").after(...trees.map((tree) => tree.panel));
  turn();
}

/** The panel of a hierarchy, with its lamps in the order of their numbers. */
function planted(hierarchy) {
  const read = new DOMParser().parseFromString(String(hierarchy.svg ?? ""), "image/svg+xml").documentElement;
  if (read.namespaceURI !== NS || read.querySelector("parsererror")) return null;
  const svg = document.importNode(read, true);
  for (const dress of svg.querySelectorAll("style")) dress.remove();
  svg.setAttribute("class", "hierarchy");
  const lamps = [];
  for (const box of svg.querySelectorAll("[data-rm]")) lamps[Number(box.dataset.rm)] = box;
  const path = make("span", { class: "quiet", role: "status" });
  const names = listed(hierarchy.names).map(String);
  const scroll = make("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": "Releasing mechanisms, the active ones lit" }, svg);
  return { module: String(hierarchy.module), lamps, names, path, panel: panel(`tree-${hierarchy.module}`, `Releasing mechanisms: ${hierarchy.module}`, path, scroll) };
}

/** Shows a state. */
export function showHierarchies(state) {
  const wires = new Map(listed(state.wires).map((wire) => [wire.wire, wire.value]));
  for (const tree of trees) light(tree, wires);
}

/** Which of so many lamps the words of a message light. */
function lit(words, count) {
  const bits = listed(words);
  return Array.from({ length: count }, (_, number) => Math.floor((bits[Math.floor(number / 48)] ?? 0) / 2 ** (number % 48)) % 2 === 1);
}

function light(tree, wires) {
  const active = lit(wires.get(`${tree.module}.active`), tree.lamps.length);
  const listening = lit(wires.get(`${tree.module}.listening`), tree.lamps.length);
  tree.lamps.forEach((box, number) => {
    box.dataset.lit = active[number] ? "active" : listening[number] ? "listening" : "deaf";
  });
  const words = tree.names.filter((_, number) => active[number]).join(" › ");
  if (tree.path.textContent !== words) tree.path.textContent = words;
}
