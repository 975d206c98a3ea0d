// Views: which part of the page the address names. Every view has one, so it can be kept, reloaded and gone back to.
//
//   #/  all parts      #/world  #/wiring  #/timeline  #/latency  #/wires  #/events  one part      #/wires/NAME  one wire

const links = [...document.querySelectorAll("#views a")];
const unknown = document.getElementById("no-view");
const listeners = [];
let creature = "subsumed";

/** The address of a wire's view. */
export function addressOf(wire) {
  return `#/wires/${encodeURIComponent(wire)}`;
}

/** What the address names: a view, and the wire if it is one's. */
export function current() {
  const [view = "", ...rest] = location.hash.replace(/^#\/?/, "").split("/");
  let wire = null;
  try {
    wire = view === "wires" && rest.join("/") !== "" ? decodeURIComponent(rest.join("/")) : null;
  } catch {
    return { view: "nowhere", wire: null };
  }
  return { view: wire === null ? view : "wire", wire };
}

/** Has `listener` called with the view now, and whenever it changes. */
export function onView(listener) {
  listeners.push(listener);
  listener(current());
}

/** Takes the name that the title begins with. */
export function nameTitle(name) {
  creature = name;
  entitle(current());
}

function entitle({ view, wire }) {
  const shown = wire ?? links.find((link) => link.dataset.view === view)?.textContent;
  document.title = view === "" || !shown ? `${creature} – subsumed` : `${shown} – ${creature}`;
}

/** Shows what the address names. A panel that was put up since is shown or hidden with the others by its `data-view`. */
export function turn() {
  const now = current();
  const sections = [...document.querySelectorAll("main > section")];
  const known = now.view === "" || sections.some((section) => section.dataset.view === now.view);
  const view = known ? now.view : "";
  unknown.hidden = known;
  document.body.dataset.view = view === "" ? "all" : view;
  for (const section of sections) {
    section.hidden = view === "" ? section.dataset.view === "wire" : section.dataset.view !== view;
  }
  for (const link of links) {
    const here = link.dataset.view === (view === "wire" ? "wires" : view);
    if (here) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
  entitle({ view, wire: now.wire });
  for (const listener of listeners) listener(now);
}

addEventListener("hashchange", () => {
  turn();
  scrollTo(0, 0);
});
turn();
