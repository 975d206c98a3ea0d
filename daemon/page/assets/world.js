// The world's panel: the canvas, its legend, and whichever picture is registered for the body's kind.
//
// Knows no world: `worlds.js` says who draws which.

import { say } from "./words.js";
import { pictureFor } from "./worlds.js";

const panel = document.getElementById("world-panel");
const canvas = document.getElementById("world");
const legend = document.getElementById("world-legend");
const note = document.getElementById("world-note");
const scheme = matchMedia("(prefers-color-scheme: dark)");
let picture = null;
let seen = false;
let colours = new Map();

/** Takes the floor of a plan. */
export function setWorld(plan) {
  picture = pictureFor(plan);
  seen = false;
  document.getElementById("no-world").hidden = picture !== null;
  panel.classList.toggle("empty", picture === null);
  if (picture === null) return;
  canvas.style.aspectRatio = String(picture.take(plan));
  canvas.setAttribute("aria-label", picture.label);
  legend.replaceChildren(...picture.legend.map(([name, shape, words]) => {
    const item = document.createElement("li");
    item.className = shape;
    item.style.setProperty("--swatch", `var(--${name})`);
    item.textContent = words;
    return item;
  }));
}

/** The colour that the style sheet calls `--name`. */
function colour(name) {
  if (!colours.has(name)) {
    colours.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
  }
  return colours.get(name);
}

scheme.addEventListener("change", () => { colours = new Map(); redraw(); });
addEventListener("resize", redraw);

/** Shows a state. */
export function showWorld(state) {
  if (picture === null) return;
  picture.see(state);
  say(note, picture.note?.(state) ?? "");
  seen = true;
  redraw();
}

/** Draws the newest state again: the canvas has another size, or the page other colours. */
export function redraw() {
  if (picture === null || !seen) return;
  const dense = devicePixelRatio || 1;
  const wide = Math.round(canvas.clientWidth * dense);
  const high = Math.round(canvas.clientHeight * dense);
  if (wide === 0 || high === 0) return;
  if (canvas.width !== wide || canvas.height !== high) [canvas.width, canvas.height] = [wide, high];
  const pen = canvas.getContext("2d");
  pen.setTransform(1, 0, 0, 1, 0, 0);
  pen.clearRect(0, 0, wide, high);
  picture.draw({ pen, wide, high, dense, colour });
}
