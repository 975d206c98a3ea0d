// How late the beats of each layer were, on one logarithmic axis for all: a histogram, and over it the share of beats
// that were later still; under it the latest of each of the last sixty seconds.

import { listed, say, span } from "./words.js";

const NS = "http://www.w3.org/2000/svg";
const WIDTH = 400;
const HEIGHT = 54;
const AXIS = 15;
const SHARES = [0.1, 0.01, 0.001, 0.0001, 0.00001];
const TRAIL = 26;
const place = document.getElementById("latency");
const figures = new Map();

function element(name, attributes, text) {
  const made = document.createElementNS(NS, name);
  for (const [key, worth] of Object.entries(attributes)) made.setAttribute(key, worth);
  if (text !== undefined) made.textContent = text;
  return made;
}

function figure(name) {
  const outer = document.createElement("figure");
  outer.dataset.latency = name;
  const caption = document.createElement("figcaption");
  const title = document.createElement("b");
  const detail = document.createElement("span");
  const words = {};
  for (const part of ["p50", "p99", "max", "period", "overruns"]) {
    words[part] = document.createElement("i");
    words[part].className = part;
    detail.append(words[part]);
  }
  caption.append(title, detail);
  const picture = element("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT + AXIS}`, role: "img" });
  outer.append(caption, picture);
  const trail = element("svg", { viewBox: `0 0 ${WIDTH} ${TRAIL}`, role: "img", class: "trail" });
  const apart = document.createElement("p");
  apart.className = "quiet";
  apart.textContent = "A process of its own: it measures itself.";
  outer.append(trail, apart);
  return { outer, title, words, picture, trail, apart, drawn: "" };
}

/** Powers of ten that hold everything worth showing. */
function decades(layers) {
  let low = Infinity;
  let high = 0;
  for (const layer of layers) {
    for (const [bound, count] of listed(layer.histogram)) {
      if (!(count > 0) || !(bound > 0)) continue;
      low = Math.min(low, bound);
      high = Math.max(high, bound);
    }
    high = Math.max(high, layer.latency_us?.max || 0);
  }
  if (high <= 0) return [0, 3];
  const from = Math.floor(Math.log10(Math.max(0.1, Math.min(low, high)) / 2));
  return [from, Math.max(from + 1, Math.ceil(Math.log10(high * 1.05)))];
}

function draw(picture, layer, [from, to]) {
  const x = (us) => ((Math.log10(Math.max(us, 1e-3)) - from) / (to - from)) * WIDTH;
  const bars = listed(layer.histogram).filter(([bound]) => bound > 0);
  const most = Math.max(1, ...bars.map(([, count]) => count || 0));
  const parts = [];
  for (let decade = from; decade <= to; decade += 1) {
    const at = x(10 ** decade);
    const anchor = decade === from ? "start" : decade === to ? "end" : "middle";
    parts.push(element("line", { class: "grid", x1: at, x2: at, y1: 0, y2: HEIGHT }));
    parts.push(element("text", { class: "tick", x: at, y: HEIGHT + 12, "text-anchor": anchor }, span(10 ** decade / 1000)));
  }
  bars.forEach(([bound, count], index) => {
    if (!(count > 0)) return;
    const left = Math.max(0, index > 0 ? x(bars[index - 1][0]) : x(bound / 1.3));
    const tall = Math.max(2, (Math.log1p(count) / Math.log1p(most)) * (HEIGHT - 6));
    const wide = Math.max(1, x(bound) - left - 0.8);
    parts.push(element("rect", { class: "bar", x: left, y: HEIGHT - tall, width: wide, height: tall }));
  });
  parts.push(...curve(bars, x));
  parts.push(element("line", { class: "base", x1: 0, x2: WIDTH, y1: HEIGHT, y2: HEIGHT }));
  for (const name of ["p50", "p99", "max"]) {
    const us = layer.latency_us?.[name];
    if (!(us > 0)) continue;
    parts.push(element("line", { class: `mark ${name}`, x1: x(us), x2: x(us), y1: 0, y2: HEIGHT }));
  }
  picture.replaceChildren(...parts);
}

/** The share of beats later than each bound: 1 at the top, and a fifth of the height for each power of ten. */
function curve(bars, x) {
  const all = bars.reduce((sum, [, count]) => sum + (count || 0), 0);
  if (all === 0) return [];
  const y = (share) => Math.min(HEIGHT, (-Math.log10(share) / SHARES.length) * HEIGHT);
  const parts = SHARES.slice(0, -1).map((share) => {
    const words = share >= 0.01 ? `${share * 100} %` : `${share * 1e6} ppm`;
    return element("text", { class: "tick share", x: WIDTH - 2, y: y(share) + 3, "text-anchor": "end" }, words);
  });
  let later = all;
  const steps = [];
  for (const [bound, count] of bars) {
    later -= count || 0;
    const at = Math.max(0, x(bound));
    if (later > 0) steps.push(`${at.toFixed(1)} ${y(later / all).toFixed(1)}`);
    else if (count > 0) steps.push(`${at.toFixed(1)} ${HEIGHT}`);
  }
  return [...parts, element("polyline", { class: "curve", points: `0 0 ${steps.join(" ")}` })];
}

/** The latest beat of each second, newest at the right, on the powers of ten of the histogram. */
function drawTrail(picture, trail, [from, to]) {
  const y = (us) => TRAIL - 2 - Math.max(0, Math.min(1, (Math.log10(Math.max(us, 1e-3)) - from) / (to - from))) * (TRAIL - 4);
  const x = (index) => WIDTH - (trail.length - 1 - index) * (WIDTH / 60);
  const points = trail.map((us, index) => `${x(index).toFixed(1)} ${y(us).toFixed(1)}`).join(" ");
  picture.replaceChildren(
    element("line", { class: "base", x1: 0, x2: WIDTH, y1: TRAIL - 1, y2: TRAIL - 1 }),
    element("polyline", { class: "latest", points }),
  );
}

/** Shows the latency of every layer, highest level first. */
export function showLatency(layers) {
  const sorted = listed(layers).filter((layer) => typeof layer?.name === "string");
  sorted.sort((a, b) => (b.level ?? 0) - (a.level ?? 0));
  const axis = decades(sorted);
  for (const [name, { outer }] of figures) {
    if (sorted.some((layer) => layer.name === name)) continue;
    outer.remove();
    figures.delete(name);
  }
  sorted.forEach((layer, index) => {
    if (!figures.has(layer.name)) figures.set(layer.name, figure(layer.name));
    const shown = figures.get(layer.name);
    if (place.children[index] !== shown.outer) place.insertBefore(shown.outer, place.children[index] ?? null);
    const us = layer.latency_us ?? {};
    const marks = ["p50", "p99", "max"].map((name) => `${name} ${span(us[name] / 1000)}`).join("  ");
    say(shown.title, `${layer.level ?? ""} ${layer.name}`);
    for (const name of ["p50", "p99", "max"]) say(shown.words[name], `${name} ${span(us[name] / 1000)}`);
    say(shown.words.period, `every ${span(layer.period_ms)}`);
    say(shown.words.overruns, layer.overruns > 0 ? `${layer.overruns} overrun${layer.overruns === 1 ? "" : "s"}` : "");
    shown.outer.classList.toggle("apart", layer.attached === true);
    shown.apart.hidden = layer.attached !== true;
    const now = JSON.stringify([axis, layer.histogram, us, layer.trail_us]);
    if (now === shown.drawn) return;
    shown.drawn = now;
    shown.picture.setAttribute("aria-label", `latency of layer ${layer.name}: ${marks}`);
    draw(shown.picture, layer, axis);
    shown.trail.setAttribute("aria-label", `latest beat of layer ${layer.name} in each of the last seconds`);
    drawTrail(shown.trail, listed(layer.trail_us), axis);
  });
}
