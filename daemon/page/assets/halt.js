// The halt banner and the two buttons.

import { press } from "./daemon.js";
import { listed, moment, say } from "./words.js";

const banner = document.getElementById("halt-state");
const word = document.getElementById("halt-word");
const causes = document.getElementById("halt-causes");
const answer = document.getElementById("answer");
const buttons = { halt: document.getElementById("halt"), reset: document.getElementById("reset") };

async function push(name) {
  answer.hidden = true;
  buttons[name].disabled = true;
  const refusal = await press(`/api/${name}`);
  buttons[name].disabled = false;
  if (refusal === null) return;
  say(answer, name === "reset" ? `Not reset: ${refusal}.` : `The halt was not delivered: ${refusal}.`);
  answer.hidden = false;
}

/** Makes the buttons work. */
export function listen() {
  buttons.halt.addEventListener("click", () => push("halt"));
  buttons.reset.addEventListener("click", () => push("reset"));
}

/** Shows whether the body is halted, and why. */
export function showHalt(halt) {
  const halted = halt?.halted;
  if (typeof halted !== "boolean") {
    delete banner.dataset.halted;
    delete banner.dataset.reflex;
    say(word, "Unknown whether halted");
    say(causes, "");
    return;
  }
  const since = typeof halt.since_s === "number" ? ` since ${moment(halt.since_s)}` : "";
  // A refusal stays in sight until the body's state has changed.
  if (banner.dataset.halted !== undefined && banner.dataset.halted !== String(halted)) answer.hidden = true;
  banner.dataset.halted = String(halted);
  // A reflex is everyday life: it lets go by itself within a moment.
  const reflex = halted && listed(halt.causes).every((cause) => cause === "reflex") && listed(halt.causes).length > 0;
  banner.dataset.reflex = String(reflex);
  say(word, !halted ? "Running" : reflex ? "Held back" : "HALTED");
  const reasons = listed(halt.causes).join(", ");
  const latched = halt.latched ? " – stays until reset" : "";
  say(causes, halted ? `${reasons || "no cause given"}${since}${latched}` : "");
}
