// One wire: what it carried over the last minute, who writes it, where it leads and which taps act with it.

import { current, onView } from "./views.js";
import { branchesOf } from "./wiring.js";
import { listed, number, say, span, value } from "./words.js";

const KEPT_S = 60;
const TALL = 160;
const INKS = ["accent", "hold", "live", "bad", "walker"];
const canvas = document.getElementById("wire-chart");
const heading = document.getElementById("wire-title");
const facts = document.getElementById("wire-facts");
let name = null;
let points = [];
let seen = null;
let now = 0;

onView(() => {
  if (current().wire === name) return;
  name = current().wire;
  points = [];
  seen = null;
  say(heading, `Wire ${name ?? ""}`);
  facts.replaceChildren();
});

/** What of a value can be drawn: its first five numbers. */
function numbers(carried) {
  const parts = Array.isArray(carried) ? carried : [carried];
  const drawable = parts.map((part) => (typeof part === "boolean" ? Number(part) : part));
  return drawable.filter((part) => typeof part === "number" && Number.isFinite(part)).slice(0, INKS.length);
}

/** Shows the wire that the address names. */
export function showWire(state) {
  if (name === null) return;
  now = state.time_s ?? now;
  const wire = listed(state.wires).find((wire) => wire?.wire === name);
  if (wire && typeof wire.age_ms === "number" && wire.messages !== seen) {
    seen = wire.messages;
    points.push({ time: now - wire.age_ms / 1000, values: numbers(wire.value) });
  }
  points = points.filter((point) => now - point.time <= KEPT_S);
  tell(wire, state);
  draw();
}

function tell(wire, state) {
  const taps = listed(state.taps);
  const acts = taps.filter((tap) => tap.from === name);
  const met = taps.filter((tap) => tap.from !== name).filter((tap) => tap.to === name || branchesOf(name).includes(tap.to));
  const one = (tap) => `${tap.from} ${tap.kind === "inhibit" ? "inhibits" : "suppresses"} ${tap.to}` +
    (tap.holds ? ` (holds, ${span(tap.remaining_ms)} left)` : "");
  const lines = wire ? [
    ["carries", `${wire.type ?? ""}${wire.unit ? `, ${wire.unit}` : ""}`],
    ["value", value(wire.value)],
    ["age", span(wire.age_ms)],
    ["messages", `${number(wire.messages)}, ${number(wire.rate_hz)} Hz`],
    ["leads to", branchesOf(name).join(", ") || "nobody in the picture"],
    ["acts as a tap", acts.map(one).join("; ") || "no"],
    ["is tapped", met.map(one).join("; ") || "no"],
  ] : [["", `No wire of this name is there now; it shows up when its layer attaches.`]];
  if (facts.children.length !== lines.length * 2) {
    facts.replaceChildren(...lines.flatMap(() => [document.createElement("dt"), document.createElement("dd")]));
  }
  lines.forEach(([term, text], index) => {
    say(facts.children[2 * index], term);
    say(facts.children[2 * index + 1], text);
  });
}

function draw() {
  const wide = canvas.clientWidth;
  if (wide === 0) return;
  const dense = devicePixelRatio || 1;
  const [across, down] = [Math.round(wide * dense), Math.round(TALL * dense)];
  if (canvas.width !== across || canvas.height !== down) [canvas.width, canvas.height] = [across, down];
  const style = getComputedStyle(document.documentElement);
  const colour = (ink) => style.getPropertyValue(`--${ink}`).trim();
  const pen = canvas.getContext("2d");
  pen.setTransform(dense, 0, 0, dense, 0, 0);
  pen.clearRect(0, 0, wide, TALL);
  const all = points.flatMap((point) => point.values);
  const [low, high] = all.length > 0 ? [Math.min(...all), Math.max(...all)] : [0, 1];
  const reach = high - low || 1;
  const x = (time) => wide - ((now - time) / KEPT_S) * wide;
  const y = (worth) => TALL - 20 - ((worth - low) / reach) * (TALL - 36);
  pen.font = "10px system-ui, sans-serif";
  pen.fillStyle = colour("quiet");
  pen.fillText(all.length > 0 ? number(high) : "", 4, 11);
  pen.fillText(all.length > 0 ? number(low) : "", 4, TALL - 8);
  pen.textAlign = "right";
  pen.fillText("now", wide - 4, TALL - 8);
  pen.textAlign = "center";
  pen.fillText("30 s ago", wide / 2, TALL - 8);
  pen.textAlign = "left";
  // A message stands until the next: steps, not slopes.
  INKS.forEach((ink, part) => {
    pen.strokeStyle = colour(ink);
    pen.lineWidth = 1.5;
    pen.beginPath();
    let last = null;
    for (const { time, values } of points) {
      if (part >= values.length) continue;
      if (last === null) pen.moveTo(x(time), y(values[part]));
      else pen.lineTo(x(time), y(last));
      pen.lineTo(x(time), y(values[part]));
      last = values[part];
    }
    if (last !== null) pen.lineTo(wide, y(last));
    pen.stroke();
  });
}
