// The page: asks for the state ten times a second and shows it.

import { get, TokenWanted } from "./daemon.js";
import { showEvents } from "./events.js";
import { listen, showHalt } from "./halt.js";
import { setHierarchies, showHierarchies } from "./hierarchy.js";
import { showHolders } from "./holders.js";
import { nameTitle, onView } from "./views.js";
import { showLatency } from "./latency.js";
import { forgetTimeline, redrawTimeline, showTimeline } from "./timeline.js";
import { showWire } from "./wire.js";
import { setOotland, showOotland } from "./ootland.js";
import { showWires } from "./wires.js";
import { showWiring, setWiring } from "./wiring.js";
import { redraw, setWorld, showWorld } from "./world.js";
import { listed, moment, say, span } from "./words.js";

const PERIOD_MS = 100;
const lost = document.getElementById("lost");
let plan = null;
let version;
let heard = null;
let pid;

function showHead(state) {
  const mode = document.getElementById("mode");
  mode.hidden = !state.mode;
  mode.classList.toggle("good", state.mode === "real time");
  say(mode, state.mode ?? "");
  say(document.getElementById("clock"), moment(state.time_s));
  const notes = document.getElementById("notes");
  const texts = listed(state.notes).map(String);
  notes.hidden = texts.length === 0;
  if (notes.dataset.shown !== JSON.stringify(texts)) {
    notes.dataset.shown = JSON.stringify(texts);
    notes.replaceChildren(...texts.map((text) => {
      const item = document.createElement("li");
      item.textContent = text;
      return item;
    }));
  }
  const contacts = state.contacts;
  say(document.getElementById("contacts"), contacts ? `${contacts.all ?? 0} contacts, ${contacts.caused ?? 0} caused by the robot` : "");
}

function setPlan(fresh) {
  plan = fresh;
  const name = fresh.creature ?? "subsumed";
  say(document.getElementById("creature"), name);
  nameTitle(name);
  setWorld(fresh);
  setOotland(fresh);
  setWiring(fresh.graph ?? {});
  setHierarchies(fresh);
}

/** Shows one part; a part that cannot make sense of what it got leaves the others alone. */
function show(part, worth) {
  try {
    part(worth);
  } catch (fault) {
    console.error(fault);
  }
}

function connected() {
  heard = performance.now();
  document.body.dataset.connected = "true";
  lost.hidden = true;
}

function disconnected(fault) {
  if (lost.hidden) console.error(fault);
  document.body.dataset.connected = "false";
  const seconds = heard === null ? 0 : Math.round((performance.now() - heard) / 1000);
  say(document.getElementById("lost-age"), seconds > 0 ? `What you see is ${span(seconds * 1000)} old.` : "");
  lost.hidden = fault instanceof TokenWanted;
  // Whether the body is halted is not known any longer, whatever was heard last.
  showHalt(undefined);
}

async function beat() {
  try {
    const state = await get("/api/state");
    if (plan === null || state.graph_version !== version) {
      setPlan(await get("/api/plan"));
      version = state.graph_version;
    }
    connected();
    if (state.pid !== pid) forgetTimeline();
    pid = state.pid;
    show(showHalt, state.halt);
    show(showHead, state);
    show(showWorld, state);
    show(showHierarchies, state);
    show(showOotland, state);
    show(showWiring, state);
    show(showHolders, state);
    show(showTimeline, state);
    show(showWire, state);
    show(showWires, state.wires);
    show(showLatency, state.layers);
    show(showEvents, state.events);
  } catch (fault) {
    disconnected(fault);
  }
}

async function run() {
  const begun = performance.now();
  await beat();
  const rest = document.body.dataset.connected === "true" ? PERIOD_MS : 5 * PERIOD_MS;
  setTimeout(run, Math.max(10, rest - (performance.now() - begun)));
}

listen();
onView(() => {
  show(redraw);
  show(redrawTimeline);
});
run();
