// The nest builder at work: its floor from above, and the tree of its releasing mechanisms with the active ones lit.
//
// Panels are made only for creatures that have them; nothing here touches what other parts show.

import { listed } from "./words.js";

const NS = "http://www.w3.org/2000/svg";
const main = document.querySelector("main");
const scheme = matchMedia("(prefers-color-scheme: dark)");
let trees = [];
let floor = null;
let latest = null;
let colours = null;

function make(tag, attributes, ...children) {
  const element = document.createElement(tag);
  for (const [name, worth] of Object.entries(attributes)) element.setAttribute(name, worth);
  element.append(...children);
  return element;
}

function panel(id, title, note, ...children) {
  const head = make("div", { class: "head" }, make("h2", { id: `${id}-title` }, title), note);
  return make("section", { id, "aria-labelledby": `${id}-title`, class: "nest" }, head, ...children);
}

/** Takes the hierarchies of a plan. */
export function setNest(plan) {
  for (const tree of trees) tree.panel.remove();
  trees = listed(plan.hierarchies).map(planted).filter((tree) => tree !== null);
  const behind = document.getElementById("wiring-panel");
  for (const tree of trees) main.insertBefore(tree.panel, behind);
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
export function showNest(state) {
  const wires = new Map(listed(state.wires).map((wire) => [wire.wire, wire.value]));
  for (const tree of trees) light(tree, wires);
  const nest = state.nest ?? null;
  if (nest !== null && floor === null) lay();
  if (floor === null) return;
  floor.panel.hidden = nest === null;
  document.getElementById("world-panel").hidden = nest !== null;
  latest = nest === null ? null : { nest, halted: state.halt?.halted === true };
  draw();
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

/** Puts up the panel of the floor. */
function lay() {
  const canvas = make("canvas", { id: "nest", role: "img", "aria-label": "The floor from above with robot, objects, obstacles, gas stations and nest" });
  const note = make("span", { class: "quiet", role: "status", id: "nest-note" });
  const legend = make("ul", { class: "legend nest-legend", "aria-hidden": "true" });
  for (const [kind, word] of [["object", "object"], ["station", "gas station"], ["site", "nest site"], ["obstacle", "obstacle"], ["walker", "person"], ["eyes", "in view"]]) {
    legend.append(make("li", { class: `k-${kind}` }, word));
  }
  floor = { canvas, note, panel: panel("nest-panel", "Nest building", note, canvas, legend) };
  main.prepend(floor.panel);
}

scheme.addEventListener("change", () => { colours = null; draw(); });
addEventListener("resize", draw);

function palette() {
  const style = getComputedStyle(document.documentElement);
  const names = ["floor", "wall", "box", "box-line", "quiet", "ink", "robot", "robot-ink", "sonar", "walker", "attacker", "object", "station", "site"];
  return Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

function draw() {
  if (latest === null || floor === null) return;
  colours ??= palette();
  const { nest, halted } = latest;
  const [width, depth] = nest.floor_m;
  const { canvas } = floor;
  canvas.style.aspectRatio = `${width} / ${depth}`;
  const dense = devicePixelRatio || 1;
  const wide = Math.round(canvas.clientWidth * dense);
  const high = Math.round(canvas.clientHeight * dense);
  if (wide === 0 || high === 0) return;
  if (canvas.width !== wide || canvas.height !== high) [canvas.width, canvas.height] = [wide, high];
  const pen = canvas.getContext("2d");
  const scale = Math.min(wide / width, high / depth);
  pen.setTransform(scale, 0, 0, -scale, (wide - scale * width) / 2, (high + scale * depth) / 2);
  const pixel = dense / scale;
  pen.fillStyle = colours.floor;
  pen.fillRect(0, 0, width, depth);
  pen.strokeStyle = colours.wall;
  pen.lineWidth = 3 * pixel;
  pen.strokeRect(0, 0, width, depth);
  drawEyes(pen, nest);
  for (const site of listed(nest.sites)) drawSite(pen, pixel, site, nest);
  for (const station of listed(nest.stations)) drawStation(pen, station.place, pixel);
  for (const disc of listed(nest.obstacles)) round(pen, disc.place, disc.radius_m, colours.box, colours["box-line"], pixel);
  for (const object of listed(nest.objects)) drawObject(pen, object.place, pixel);
  for (const person of listed(nest.persons)) drawPerson(pen, person, pixel);
  drawRobot(pen, pixel, nest, halted);
  say(nest);
}

function say(nest) {
  const held = nest.robot.held === null ? "hand empty" : "carries an object";
  const words = `${nest.built} of ${nest.wanted} objects, fuel ${Math.round(nest.robot.fuel * 100)} %, ${held}`;
  if (floor.note.textContent !== words) floor.note.textContent = words;
}

function round(pen, place, radius, fill, line, pixel) {
  pen.beginPath();
  pen.arc(place.x_m, place.y_m, radius, 0, 2 * Math.PI);
  pen.fillStyle = fill;
  pen.fill();
  pen.strokeStyle = line;
  pen.lineWidth = 1.5 * pixel;
  pen.stroke();
}

function drawEyes(pen, nest) {
  const { place, heading_rad: heading } = nest.robot;
  const [range, side] = nest.eyes;
  pen.save();
  pen.beginPath();
  pen.rect(0, 0, ...nest.floor_m);
  pen.clip();
  pen.globalAlpha = 0.1;
  pen.fillStyle = colours.sonar;
  pen.beginPath();
  pen.moveTo(place.x_m, place.y_m);
  pen.arc(place.x_m, place.y_m, range, heading - side, heading + side);
  pen.fill();
  pen.restore();
}

function drawSite(pen, pixel, site, nest) {
  pen.setLineDash([5 * pixel, 4 * pixel]);
  pen.globalAlpha = site.proper ? 1 : 0.4;
  round(pen, site.place, nest.nest_m, "transparent", colours.site, pixel);
  pen.globalAlpha = site.id === nest.robot.site ? 0.14 : 0;
  pen.setLineDash([]);
  round(pen, site.place, nest.nest_m, colours.site, "transparent", pixel);
  pen.globalAlpha = 1;
}

function drawStation(pen, place, pixel) {
  pen.fillStyle = colours.station;
  pen.strokeStyle = colours.station;
  pen.lineWidth = 2 * pixel;
  pen.fillRect(place.x_m - 0.16, place.y_m - 0.22, 0.26, 0.44);
  pen.beginPath();
  pen.moveTo(place.x_m + 0.1, place.y_m + 0.12);
  pen.lineTo(place.x_m + 0.22, place.y_m + 0.06);
  pen.lineTo(place.x_m + 0.22, place.y_m - 0.14);
  pen.stroke();
}

function drawObject(pen, place, pixel) {
  const size = Math.max(0.16, 6 * pixel);
  pen.fillStyle = colours.object;
  pen.strokeStyle = colours.ink;
  pen.lineWidth = pixel;
  pen.beginPath();
  pen.rect(place.x_m - size / 2, place.y_m - size / 2, size, size);
  pen.fill();
  pen.stroke();
}

function drawPerson(pen, person, pixel) {
  round(pen, person.place, person.radius_m, colours.walker, "transparent", pixel);
  if (person.carries) drawObject(pen, person.place, pixel);
}

function drawRobot(pen, pixel, nest, halted) {
  const { robot, hand } = nest;
  const radius = 0.25;
  pen.strokeStyle = colours.ink;
  pen.lineWidth = 3.5 * pixel;
  pen.lineCap = "round";
  pen.beginPath();
  pen.moveTo(robot.place.x_m, robot.place.y_m);
  pen.lineTo(hand.x_m, hand.y_m);
  pen.stroke();
  round(pen, robot.place, radius, halted ? colours.attacker : colours.robot, colours["robot-ink"], pixel);
  pen.save();
  pen.translate(robot.place.x_m, robot.place.y_m);
  pen.rotate(robot.heading_rad);
  pen.fillStyle = colours["robot-ink"];
  pen.beginPath();
  pen.moveTo(radius * 0.75, 0);
  pen.lineTo(-radius * 0.35, radius * 0.5);
  pen.lineTo(-radius * 0.1, 0);
  pen.lineTo(-radius * 0.35, -radius * 0.5);
  pen.fill();
  // The steering wheel, in front of the axle.
  pen.translate(radius * 0.8, 0);
  pen.rotate(robot.steering_rad);
  pen.strokeStyle = colours.ink;
  pen.lineWidth = 3 * pixel;
  pen.beginPath();
  pen.moveTo(-0.08, 0);
  pen.lineTo(0.08, 0);
  pen.stroke();
  pen.restore();
  // An open hand is a ring; one that holds something shows the object in it.
  if (robot.held === null) round(pen, hand, 0.05, "transparent", colours.ink, pixel);
  else drawObject(pen, hand, pixel);
}
