// Who drives: for every port that is tapped just now, in words, whose messages it hears.

import { listed, say } from "./words.js";

const line = document.getElementById("holders");

/** Of taps on one port that hold, the one of the highest level has it. */
function byPort(taps) {
  const holders = new Map();
  for (const tap of taps.filter((tap) => tap.holds === true)) {
    const before = holders.get(tap.to);
    if (before === undefined || before.level <= tap.level) holders.set(tap.to, tap);
  }
  return [...holders.values()];
}

function words(tap) {
  const whose = `${tap.from} of ${tap.layer} (level ${tap.level})`;
  return tap.kind === "inhibit" ? `${tap.to} is silenced by ${whose}` : `${tap.to} hears ${whose}`;
}

/** Shows the taps of a state. */
export function showHolders(state) {
  const taps = listed(state.taps);
  line.hidden = taps.length === 0;
  const held = byPort(taps).map(words);
  say(line, held.length === 0 ? "No tap holds: every wire carries its own messages." : `${held.join("; ")}.`);
}
