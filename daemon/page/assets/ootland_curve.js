// The capital of every truck over the game.

import { paint, picture, shape } from "./ootland_shape.js";
import { listed } from "./words.js";

const WIDE = 640;
const HIGH = 170;
const LEFT = 62;
const BOTTOM = 20;
const TOP = 8;
let drawn = "";

/** Round numbers from below `low` to above `high`, about five of them. */
function ticks(low, high) {
  const rough = Math.max(1, (high - low) / 4);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((candidate) => candidate >= rough);
  const first = Math.floor(low / step) * step;
  const last = Math.ceil(high / step) * step;
  return Array.from({ length: Math.round((last - first) / step) + 1 }, (_, index) => first + index * step);
}

/** Draws the curve of a game into `box`, if it has changed. */
export function drawCurve(box, game) {
  const slots = listed(game.curve?.slots);
  const lines = listed(game.curve?.cents);
  if (slots.length === 0) return;
  const key = `${slots.length} ${slots[slots.length - 1]} ${lines.length}`;
  if (key === drawn && box.childElementCount > 0) return;
  drawn = key;
  const all = lines.flat().map((cents) => cents / 100);
  const scale = ticks(Math.min(...all), Math.max(...all));
  const [low, high] = [scale[0], scale[scale.length - 1]];
  const end = Math.max(10, slots[slots.length - 1]);
  const x = (slot) => LEFT + (slot / end) * (WIDE - LEFT - 10);
  const y = (dollars) => TOP + ((high - dollars) / (high - low || 1)) * (HIGH - TOP - BOTTOM);
  const plot = picture(WIDE, HIGH, "Capital of every truck over the game, in dollars, by slot");
  for (const dollars of scale) {
    shape("line", { x1: LEFT, x2: WIDE - 10, y1: y(dollars), y2: y(dollars), class: "grid" }, plot);
    shape("text", { x: LEFT - 6, y: y(dollars) + 3.5, class: "tick end" }, plot, `$${dollars.toLocaleString("en")}`);
  }
  for (const slot of ticks(0, end).filter((slot) => slot <= end)) {
    shape("text", { x: x(slot), y: HIGH - 5, class: "tick middle" }, plot, String(slot));
  }
  lines.forEach((line, seat) => {
    const points = listed(line).map((cents, index) => `${x(slots[index]).toFixed(1)},${y(cents / 100).toFixed(1)}`);
    paint(shape("polyline", { points: points.join(" "), class: "capital" }, plot), seat);
  });
  box.replaceChildren(plot);
}
