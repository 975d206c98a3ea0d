// The wiring picture as SVG: bands, boxes, wires, circles.

import { CIRCLE } from "./wiring_routes.js";
import { span } from "./words.js";

const NS = "http://www.w3.org/2000/svg";
const BEND = 6;

function make(name, attributes, ...children) {
  const made = document.createElementNS(NS, name);
  for (const [key, worth] of Object.entries(attributes)) made.setAttribute(key, worth);
  made.append(...children);
  return made;
}

/** A path along `points` with round corners. */
function path(points) {
  let text = `M${points[0]}`;
  for (let index = 1; index < points.length - 1; index += 1) {
    const [before, at, after] = [points[index - 1], points[index], points[index + 1]];
    const reach = (other) => Math.min(BEND, Math.hypot(other[0] - at[0], other[1] - at[1]) / 2);
    const toward = (other) => {
      const length = Math.hypot(other[0] - at[0], other[1] - at[1]) || 1;
      return [at[0] + ((other[0] - at[0]) / length) * reach(other), at[1] + ((other[1] - at[1]) / length) * reach(other)];
    };
    text += `L${toward(before)}Q${at} ${toward(after)}`;
  }
  return `${text}L${points[points.length - 1]}`;
}

/** An arrow head at the last of `points`. */
function head(points) {
  const [[ax, ay], [bx, by]] = points.slice(-2);
  const angle = (Math.atan2(by - ay, bx - ax) * 180) / Math.PI;
  return make("path", { class: "head", d: "M0 0L-7 -3.5L-7 3.5Z", transform: `translate(${bx} ${by}) rotate(${angle})` });
}

function band({ layer, top, bottom }, picture) {
  const name = `${layer.level ?? ""} ${layer.name ?? ""}`;
  const group = make("g", { class: "band", "data-layer": layer.name ?? "", "data-level": layer.level ?? "" });
  group.append(
    make("rect", { x: picture.left, y: top, width: picture.right - picture.left, height: bottom - top, rx: 8 }),
    make("text", { class: "band-name", x: picture.left + 10, y: top + 16 }, `level ${name}`),
  );
  const process = layer.process ? `process ${layer.process}` : "";
  group.append(make("text", { class: "band-process", x: picture.right - 10, y: top + 16, "text-anchor": "end" }, process));
  return group;
}

function box(node) {
  if (node.kind !== "module") return bodyBox(node);
  const group = make("g", { class: "module", "data-module": node.name });
  const middle = node.x + node.width / 2;
  group.append(
    make("title", {}, `${node.name} (${node.type})`),
    make("rect", { x: node.x, y: node.y, width: node.width, height: node.height, rx: 4 }),
    make("text", { class: "name", x: middle, y: node.y + 14, "text-anchor": "middle" }, node.name),
  );
  for (const port of node.inputs) {
    group.append(make("text", { class: "port", x: node.x + 6, y: node.portAt("inputs", port) + 3 }, port));
  }
  for (const port of node.outputs) {
    const at = { class: "port", x: node.x + node.width - 6, y: node.portAt("outputs", port) + 3, "text-anchor": "end" };
    group.append(make("text", at, port));
  }
  return group;
}

function bodyBox(node) {
  const group = make("g", { class: `body ${node.kind}`, "data-body": node.name });
  group.append(
    make("title", {}, `${node.kind} ${node.name}`),
    make("rect", { x: node.x, y: node.y, width: node.width, height: node.height, rx: node.height / 2 }),
    make("text", { class: "name", x: node.x + node.width / 2, y: node.line + 4, "text-anchor": "middle" }, node.name),
  );
  return group;
}

function wire(net) {
  const group = make("g", { class: "net", "data-wire": net.wire, tabindex: 0, role: "button", "aria-label": `wire ${net.wire}` });
  const lines = net.branches.map(({ points, end }) => {
    const kind = end.tap ? "line tap-line" : "line";
    return make("path", { class: kind, d: path(points) });
  });
  const catches = net.branches.map(({ points }) => make("path", { class: "catch", d: path(points) }));
  const joints = net.joints.map(([cx, cy]) => make("circle", { class: "joint", cx, cy, r: 2.6 }));
  group.append(...catches, ...lines, ...net.branches.map(({ points }) => head(points)), ...joints);
  return group;
}

function circle(branch) {
  const { tap } = branch.end;
  const [cx, cy] = branch.circle;
  const letter = tap.kind === "inhibit" ? "I" : "S";
  const group = make("g", {
    class: `tap ${tap.kind}`, "data-tap": `${tap.from}>${tap.to}`, "data-kind": tap.kind, "data-holds": "false",
    tabindex: 0, role: "img",
  });
  const constant = span(tap.time_constant_ms);
  // A suppressor has its time left of where the tap comes from, an inhibitor on the other side: an
  // inhibitor and a suppressor on one wire stand so close that they would share the place.
  const fromBelow = branch.points[branch.points.length - 1][1] > cy;
  const [under, over] = [cy + CIRCLE + 10, cy - CIRCLE - 3];
  const beside = tap.kind === "inhibit"
    ? { x: cx, y: fromBelow ? over : under, "text-anchor": "middle" }
    : { x: cx - CIRCLE + 4, y: fromBelow ? under : over, "text-anchor": "end" };
  group.append(
    make("title", {}),
    make("circle", { class: "disc", cx, cy, r: CIRCLE }),
    make("circle", { class: "left", cx, cy, r: CIRCLE, pathLength: 100, transform: `rotate(-90 ${cx} ${cy})` }),
    make("text", { class: "letter", x: cx, y: cy + 4, "text-anchor": "middle" }, letter),
    make("text", { class: "constant", ...beside }, constant),
  );
  return group;
}

/** Draws a routed picture; returns the SVG, its wires by name and its taps by "from>to". */
export function draw(picture) {
  const svg = make("svg", {
    viewBox: `0 0 ${picture.width} ${picture.height}`, width: picture.width, height: picture.height,
    role: "group", "aria-label": "wiring, level 0 at the bottom",
  });
  const bands = picture.bands.map((each) => band(each, picture));
  const nets = new Map(picture.nets.map((net) => [net.wire, wire(net)]));
  const taps = new Map();
  for (const branch of picture.nets.flatMap((net) => net.branches)) {
    if (branch.end.tap) taps.set(`${branch.end.tap.from}>${branch.end.tap.to}`, { tap: branch.end.tap, group: circle(branch) });
  }
  svg.append(...bands, ...nets.values(), ...picture.nodes.map(box), ...[...taps.values()].map(({ group }) => group));
  return { svg, nets, taps };
}
