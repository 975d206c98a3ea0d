// A game of Truckin' to watch: the country with its dealers, the trucks with their layers and plans, capital over
// time, and the pace. Only there when the body is in OOTland; nothing of it is loaded before.

import { press } from "./daemon.js";
import { drawCurve } from "./ootland_curve.js";
import { drawMap } from "./ootland_map.js";
import { turn } from "./views.js";
import { listed, say } from "./words.js";

const PACES = [["slow", "Slow"], ["normal", "Normal"], ["fast", "Fast"], ["pause", "Pause"], ["step", "Step"]];
const SLOTS = ["gas", "capital", "trading", "information"];
const DIRECTIONS = ["north", "east", "south", "west"];
const VERB = 1e10;
let panel = null;
let slots = [];

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

/** Cents as dollars. */
export function dollars(cents) {
  const text = (Math.abs(cents) / 100).toLocaleString("en", { minimumFractionDigits: 2, maximumFractionDigits: 2 });
  return `${cents < 0 ? "−" : ""}$${text}`;
}

function build() {
  document.head.append(element("link", { rel: "stylesheet", href: "/ootland.css" }));
  const buttons = PACES.map(([word, label]) => {
    const button = element("button", { type: "button", textContent: label });
    button.dataset.pace = word;
    button.addEventListener("click", async () => {
      const refusal = await press(`/api/pace/${word}`);
      say(panel.refusal, refusal === null ? "" : `The pace stays: ${refusal}.`);
    });
    return button;
  });
  const section = element("section", { id: "ootland-panel" });
  section.setAttribute("aria-labelledby", "ootland-title");
  section.dataset.view = "world";
  panel = {
    section,
    buttons,
    time: element("span", { id: "ootland-time", className: "quiet" }),
    refusal: element("span", { className: "refusal" }),
    map: element("div", { id: "ootland-map" }),
    trucks: element("div", { id: "ootland-trucks" }),
    curve: element("div", { id: "ootland-curve" }),
    dealers: element("tbody"),
  };
  panel.refusal.setAttribute("role", "alert");
  const group = element("div", { className: "paces" }, ...buttons);
  group.setAttribute("role", "group");
  group.setAttribute("aria-label", "pace of the game");
  const heads = ["dealer", "corner", "buys at", "sells at", "stock", "wants", "capital"].map((text) => {
    return element("th", { scope: "col", textContent: text });
  });
  const table = element("table", { id: "ootland-dealers" }, element("thead", {}, element("tr", {}, ...heads)), panel.dealers);
  const scroll = element("div", { className: "scroll", tabIndex: 0 }, table);
  scroll.setAttribute("role", "group");
  scroll.setAttribute("aria-label", "table of dealers");
  section.append(
    element("div", { className: "head" },
      element("h2", { id: "ootland-title", textContent: "OOTland" }), panel.time, panel.refusal, group),
    element("div", { className: "country" },
      element("div", { className: "left" }, panel.map, element("h3", { textContent: "Capital" }), panel.curve),
      element("div", { className: "right" }, element("h3", { textContent: "Trucks" }), panel.trucks,
        element("h3", { textContent: "Dealers" }), scroll)),
  );
  document.querySelector("main").prepend(section);
}

/** Takes what a plan says about the slots of a truck and the micro-strategies that fit them. */
export function setOotland(plan) {
  const country = plan.floor?.ootland;
  document.body.toggleAttribute("data-country", country !== undefined);
  if (country === undefined) return;
  slots = listed(country.slots);
  if (panel !== null) return;
  build();
  turn();
}

/** Shows a state. */
export function showOotland(state) {
  const game = state.ootland;
  if (panel === null || !game) return;
  const minutes = game.slot * 10;
  const two = (part) => String(part).padStart(2, "0");
  const clock = `day ${Math.floor(minutes / 1440) + 1}, ${two(Math.floor(minutes / 60) % 24)}:${two(minutes % 60)}`;
  const over = game.slot >= game.slots ? " – the game is over" : "";
  say(panel.time, `slot ${game.slot} of ${game.slots}, ${clock}${over}`);
  for (const button of panel.buttons) button.setAttribute("aria-pressed", String(button.dataset.pace === game.pace));
  panel.section.dataset.pace = game.pace;
  const trucks = listed(game.trucks).map((truck) => (truck.wired ? { ...truck, ...wired(listed(state.wires), game) } : truck));
  drawMap(panel.map, game, trucks);
  showTrucks(trucks, game);
  showDealers(listed(game.dealers));
  drawCurve(panel.curve, game);
}

/** What the wires say about the truck whose layers are in a layer of the creature. */
function wired(wires, game) {
  const carried = (port) => {
    const wire = wires.find(({ wire }) => wire?.endsWith(`.${port}`));
    return wire === undefined ? null : numbers(wire.value);
  };
  const genes = carried("genes")?.[0];
  const chromosome = genes === undefined ? null : String(genes).padStart(4, "0");
  const holder = carried("selected")?.[0];
  const layers = SLOTS.map((port, rank) => {
    const words = carried(port) ?? [];
    return {
      slot: slots[rank]?.name ?? port,
      strategy: slots[rank]?.alleles[Number(chromosome?.[rank])]?.name ?? "",
      inhibited: words[0] === 1,
      plan: words.slice(2, 2 + (words[1] ?? 0)).map((word) => action(word, game)),
    };
  });
  return { chromosome, layers, holder: holder >= 0 ? holder : null };
}

/** The numbers of a value, whatever its kind. */
function numbers(value) {
  if (typeof value === "number") return [value];
  if (Array.isArray(value)) return value;
  return value && typeof value === "object" ? Object.values(value).flat() : [];
}

/** An action from its word: see truckin::wired::order. */
function action(word, game) {
  const verb = Math.floor(word / VERB);
  const operand = word - verb * VERB;
  if (verb === 1) return `${DIRECTIONS[Math.floor(operand / 1000)]} ${operand % 1000}`;
  if (verb === 4) return phone(operand, game);
  return `${verb === 2 ? "buy" : "sell"} ${operand}`;
}

/** The actions of a plan in words; corners by avenue and street. */
function words(plan, game) {
  return listed(plan).map((step) => step.replace(/^phone (\d+)$/, (_, corner) => phone(Number(corner), game))).join(", ");
}

function phone(corner, game) {
  return `phone ${corner % game.avenues},${Math.floor(corner / game.avenues)}`;
}

function card(seat) {
  const layers = SLOTS.map(() => {
    const name = element("span", { className: "slot" });
    const strategy = element("span", { className: "strategy" });
    const plan = element("span", { className: "plan" });
    return { line: element("li", {}, name, strategy, plan), name, strategy, plan };
  });
  const made = {
    seat, layers,
    name: element("strong"), capital: element("b"), rest: element("span", { className: "quiet" }),
    list: element("ol", {}, ...layers.map(({ line }) => line)),
  };
  const badge = element("i", { className: "badge", textContent: String(seat + 1) });
  made.box = element("article", {}, element("p", {}, badge, made.name, made.capital, made.rest), made.list);
  made.box.style.setProperty("--truck", `var(--truck-${seat % 8})`);
  made.box.dataset.truck = seat;
  return made;
}

let cards = [];

function showTrucks(trucks, game) {
  if (cards.length !== trucks.length) {
    cards = trucks.map((_, seat) => card(seat));
    panel.trucks.replaceChildren(...cards.map(({ box }) => box));
  }
  for (const [seat, truck] of trucks.entries()) {
    const { name, capital, rest, layers, box } = cards[seat];
    say(name, `${truck.chromosome ?? "????"}${truck.wired ? " – this creature" : ""}`);
    say(capital, dollars(truck.capital_cents));
    const load = [`${Math.round(truck.tank_millilitres / 1000)} l`];
    if (truck.crates > 0) load.push(`${truck.crates} crates`);
    if (truck.items > 0) load.push(`${truck.items} items`);
    const way = truck.steps_to_go > 0 ? `, ${truck.steps_to_go} steps to go` : "";
    say(rest, `at ${truck.avenue},${truck.street}${way}; ${load.join(", ")}`);
    box.classList.toggle("wired", truck.wired === true);
    for (const [rank, line] of layers.entries()) {
      const layer = truck.layers[rank];
      line.line.hidden = layer === undefined;
      if (layer === undefined) continue;
      const holds = truck.holder === rank;
      line.line.dataset.state = holds ? "holds" : layer.inhibited ? "inhibited" : "quiet";
      say(line.name, layer.slot);
      say(line.strategy, layer.strategy.replaceAll("_", " "));
      say(line.plan, `${layer.inhibited ? "inhibited " : ""}${holds ? "▶ " : ""}${words(layer.plan, game)}`);
    }
  }
}

function showDealers(dealers) {
  while (panel.dealers.rows.length > dealers.length) panel.dealers.deleteRow(-1);
  while (panel.dealers.rows.length < dealers.length) {
    const row = panel.dealers.insertRow();
    for (let cell = 0; cell < 7; cell += 1) row.insertCell().className = cell === 0 ? "" : "number";
  }
  for (const [index, dealer] of dealers.entries()) {
    const { cells } = panel.dealers.rows[index];
    const price = (cents) => (cents > 0 ? dollars(cents) : "");
    const stock = [];
    if (dealer.kind === "producer" || dealer.crates > 0) stock.push(`${dealer.crates} crates`);
    if (dealer.kind === "retailer") stock.push(`${dealer.items} items`);
    const texts = [
      dealer.kind.replace("_", " "), `${dealer.avenue},${dealer.street}`, price(dealer.buying_cents), price(dealer.selling_cents),
      stock.join(", "), dealer.kind === "consumer" ? String(dealer.wanted_items) : "",
      dealer.kind === "retailer" || dealer.kind === "gas_station" ? dollars(dealer.capital_cents) : "",
    ];
    texts.forEach((text, cell) => say(cells[cell], text));
    cells[0].dataset.kind = dealer.kind;
  }
}
