// The time line: halts, layer processes, taps that hold and overruns over the last minutes, scrolling with time.

import { get } from "./daemon.js";
import { listed, moment, say, span } from "./words.js";

const LANE = 22;
const AXIS = 20;
const NEAR = 7;
const PERIOD_MS = 1000;
const KEPT_S = 660;
const KINDS = ["halt", "overrun", "reflex", "layer", "tap"];
const canvas = document.getElementById("timeline");
const names = document.getElementById("timeline-lanes");
const readout = document.getElementById("timeline-value");
const choices = [...document.querySelectorAll("#timeline-span button")];
const hint = readout.textContent;
const colours = { halt: "bad", overrun: "hold", reflex: "quiet", layer: "accent", tap: "live" };
let minutes = 2;
let stretches = new Map();
let changes = 0;
let asked = -Infinity;
let asking = false;
let now = 0;
let drawn = [];
let pointed = null;
let pinned = null;

/** Forgets everything: another daemon answers. */
export function forgetTimeline() {
  stretches = new Map();
  changes = 0;
  asked = -Infinity;
  pinned = null;
}

/** Shows the time line as of a state; asks for what is new once a second. */
export function showTimeline(state) {
  now = state.time_s ?? now;
  if (!asking && performance.now() - asked > PERIOD_MS) update();
  redrawTimeline();
}

async function update() {
  [asking, asked] = [true, performance.now()];
  const after = changes;
  try {
    const news = await get(`/api/timeline?after=${after}`);
    if (news.changes < after || after !== changes) {
      forgetTimeline();
    } else {
      for (const stretch of listed(news.stretches)) stretches.set(stretch.number, stretch);
      changes = news.changes;
      for (const [number, { to_s: to }] of stretches) if (to !== null && to < now - KEPT_S) stretches.delete(number);
    }
  } catch {
    // The state says whether the daemon answers; what was heard stays in sight.
  } finally {
    asking = false;
  }
}

/** Stretches of each lane in sight, halts and overruns first; those two are there in any case. */
function lanes(begin) {
  const found = new Map([["halt ", []], ["overrun ", []]]);
  for (const stretch of stretches.values()) {
    if ((stretch.to_s ?? now) < begin || stretch.from_s > now) continue;
    const named = stretch.kind === "layer" || stretch.kind === "tap" ? stretch.name : "";
    const key = `${stretch.kind} ${named}`;
    if (!found.has(key)) found.set(key, []);
    found.get(key).push(stretch);
  }
  const place = (key) => KINDS.indexOf(key.split(" ")[0]);
  return [...found].sort(([a], [b]) => place(a) - place(b) || a.localeCompare(b));
}

/** A lane's name: a tap by the wire that holds and the port where it does. */
function title(key) {
  const [kind, name] = [key.slice(0, key.indexOf(" ")), key.slice(key.indexOf(" ") + 1)];
  if (kind === "halt") return "halts";
  if (kind === "overrun") return "overruns";
  if (kind === "reflex") return "reflexes";
  return kind === "layer" ? `layer ${name}` : name.replace(">", " → ");
}

/** Draws it; nothing while it is not in sight. */
export function redrawTimeline() {
  const wide = canvas.clientWidth;
  if (wide === 0) return;
  const begin = now - minutes * 60;
  const rows = lanes(begin);
  const high = rows.length * LANE + AXIS;
  label(rows);
  const dense = devicePixelRatio || 1;
  canvas.style.height = `${high}px`;
  const [across, down] = [Math.round(wide * dense), Math.round(high * dense)];
  if (canvas.width !== across || canvas.height !== down) [canvas.width, canvas.height] = [across, down];
  const style = getComputedStyle(document.documentElement);
  const pen = canvas.getContext("2d");
  const draw = { pen, wide, begin, colour: (name) => style.getPropertyValue(`--${name}`).trim() };
  pen.setTransform(dense, 0, 0, dense, 0, 0);
  pen.clearRect(0, 0, wide, high);
  drawAxis(draw, high);
  drawn = [];
  rows.forEach(([key, row], index) => drawLane(draw, key.split(" ")[0], row, index * LANE));
  tell();
}

function label(rows) {
  const titles = rows.map(([key]) => title(key));
  if (names.dataset.shown === JSON.stringify(titles)) return;
  names.dataset.shown = JSON.stringify(titles);
  names.replaceChildren(...rows.map(([key]) => {
    const item = document.createElement("li");
    item.dataset.lane = key;
    item.title = title(key);
    item.textContent = title(key);
    return item;
  }));
}

/** Upright lines at round times. */
function drawAxis({ pen, wide, begin, colour }, high) {
  const steps = [5, 10, 15, 30, 60, 120, 300];
  const step = steps.find((step) => (step / (minutes * 60)) * wide >= 64) ?? 600;
  pen.font = "10px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.fillStyle = colour("quiet");
  pen.strokeStyle = colour("line");
  pen.lineWidth = 1;
  for (let at = Math.max(0, Math.ceil(begin / step) * step); at <= now; at += step) {
    const x = Math.round(((at - begin) / (now - begin)) * wide) + 0.5;
    pen.beginPath();
    pen.moveTo(x, 0);
    pen.lineTo(x, high - AXIS + 3);
    pen.stroke();
    if (x > 24 && x < wide - 24) pen.fillText(moment(at).replace(/\.\d$/, ""), x, high - 6);
  }
}

function drawLane({ pen, wide, begin, colour }, kind, row, top) {
  pen.strokeStyle = colour("line");
  pen.beginPath();
  pen.moveTo(0, top + LANE - 0.5);
  pen.lineTo(wide, top + LANE - 0.5);
  pen.stroke();
  for (const stretch of row) {
    const x = (at) => ((at - begin) / (now - begin)) * wide;
    const left = Math.max(0, x(stretch.from_s));
    const right = Math.min(wide, x(Math.min(now, stretch.to_s ?? now)));
    const chosen = stretch.number === (pointed ?? pinned);
    pen.fillStyle = colour(chosen ? "ink" : colours[kind]);
    // A moment is as wide as can be seen.
    const shown = Math.max(2.5, right - left);
    pen.fillRect(Math.min(left, wide - shown), top + 4, shown, LANE - 9);
    drawn.push({ stretch, left, right: left + shown, top });
  }
}

/** The stretch under a point, or nearest to it within a finger's reach. */
function at(event) {
  const box = canvas.getBoundingClientRect();
  const [x, y] = [event.clientX - box.left, event.clientY - box.top];
  const far = ({ left, right }) => Math.max(0, left - x, x - right);
  const near = drawn.filter((one) => y >= one.top && y < one.top + LANE && far(one) <= NEAR);
  return near.sort((a, b) => far(a) - far(b))[0]?.stretch.number ?? null;
}

function words({ kind, name, text, from_s: from, to_s: to }) {
  const open = to === null || to > now;
  const when = open ? `since ${moment(from)}` : to === from ? `at ${moment(from)}` : `${moment(from)} to ${moment(to)}`;
  const long = to === from ? "" : ` (${span(((open ? now : to) - from) * 1000)})`;
  if (kind === "halt" || kind === "reflex") return `${text}: ${name}, ${when}${long}`;
  if (kind === "tap") return `${name.replace(">", ` ${text} `)}, ${when}${long}`;
  if (kind === "layer") return `layer ${name} attached ${when}${long}: ${text}`;
  return `${text}, ${when}${long}`;
}

function tell() {
  const chosen = stretches.get(pointed ?? pinned);
  readout.classList.toggle("reading", chosen !== undefined);
  say(readout, chosen ? words(chosen) : hint);
}

function zoom(choice) {
  minutes = Number(choice.dataset.minutes);
  for (const other of choices) other.setAttribute("aria-pressed", String(other === choice));
  redrawTimeline();
}

canvas.addEventListener("pointermove", (event) => { pointed = at(event); redrawTimeline(); });
canvas.addEventListener("pointerleave", () => { pointed = null; redrawTimeline(); });
canvas.addEventListener("click", (event) => { pinned = at(event); redrawTimeline(); });
for (const choice of choices) choice.addEventListener("click", () => zoom(choice));
addEventListener("resize", redrawTimeline);
