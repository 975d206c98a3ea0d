// The event log, newest first.

import { listed, moment } from "./words.js";

const list = document.getElementById("events");
let shown = "";

/** Shows the events when they have changed. */
export function showEvents(events) {
  const now = JSON.stringify(listed(events));
  if (now === shown) return;
  shown = now;
  const items = listed(events).slice().reverse().map((event) => {
    const item = document.createElement("li");
    const time = document.createElement("time");
    time.textContent = moment(event?.time_s);
    item.append(time, String(event?.text ?? ""));
    return item;
  });
  list.replaceChildren(...items);
}
