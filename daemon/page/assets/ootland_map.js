// The map of OOTland: roads, dealers with price and stock, trucks on their way.

import { paint, picture, shape } from "./ootland_shape.js";
import { listed, say } from "./words.js";

const STEP = 72;
const EDGE = 44;
const LETTERS = { producer: "P", retailer: "R", consumer: "C", gas_station: "G" };
let size = "";
let dealers = new Map();
let trucks = [];
let places = null;

/** Streets are counted from the south, as on a map. */
function place(game, avenue, street) {
  return [EDGE + avenue * STEP, EDGE + (game.streets - 1 - street) * STEP];
}

function build(box, game) {
  const wide = 2 * EDGE + (game.avenues - 1) * STEP;
  const high = 2 * EDGE + (game.streets - 1) * STEP;
  const map = picture(wide, high, "Map of OOTland with dealers and trucks; the tables say the same in words");
  const roads = shape("g", { class: "roads" }, map);
  for (let avenue = 0; avenue < game.avenues; avenue += 1) {
    const [x] = place(game, avenue, 0);
    shape("line", { x1: x, x2: x, y1: EDGE, y2: high - EDGE }, roads);
    shape("text", { x, y: high - 8, class: "scale" }, map, String(avenue));
  }
  for (let street = 0; street < game.streets; street += 1) {
    const [, y] = place(game, 0, street);
    shape("line", { x1: EDGE, x2: wide - EDGE, y1: y, y2: y }, roads);
    shape("text", { x: 10, y: y + 4, class: "scale" }, map, String(street));
  }
  places = { dealers: shape("g", {}, map), trucks: shape("g", {}, map) };
  [dealers, trucks] = [new Map(), []];
  box.replaceChildren(map);
}

/** Cents in the room a corner has. */
function short(cents) {
  return cents >= 10_000 ? `$${(cents / 100).toFixed(0)}` : `$${(cents / 100).toFixed(2)}`;
}

function dealerLines(dealer) {
  const { kind, buying_cents: buying, selling_cents: selling } = dealer;
  if (kind === "producer") return [`${short(selling)}`, `${dealer.crates} cr`];
  if (kind === "consumer") return [`pays ${short(buying)}`, `wants ${dealer.wanted_items}`];
  if (kind === "gas_station") return [`${short(selling)}/l`, ""];
  return [`${short(buying)}▸${short(selling)}`, `${dealer.crates} cr ${dealer.items} it`];
}

function drawDealer(game, dealer) {
  const key = `${dealer.avenue},${dealer.street}`;
  if (!dealers.has(key)) {
    const [x, y] = place(game, dealer.avenue, dealer.street);
    const group = shape("g", { transform: `translate(${x} ${y})`, class: "dealer", "data-kind": dealer.kind }, places.dealers);
    shape("rect", { x: -11, y: -11, width: 22, height: 22, rx: 4 }, group);
    shape("text", { y: 4.5, class: "letter" }, group, LETTERS[dealer.kind] ?? "?");
    const lines = [shape("text", { y: 22, class: "price" }, group, ""), shape("text", { y: 32, class: "price" }, group, "")];
    dealers.set(key, lines);
  }
  dealerLines(dealer).forEach((text, line) => say(dealers.get(key)[line], text));
}

function drawTrucks(game, all) {
  if (trucks.length !== all.length) {
    places.trucks.replaceChildren();
    trucks = all.map((_, seat) => {
      const group = shape("g", { class: "truck" }, places.trucks);
      paint(group, seat);
      shape("circle", { r: 10 }, group);
      shape("text", { y: 4 }, group, String(seat + 1));
      return group;
    });
  }
  const crowd = new Map();
  all.forEach((truck, seat) => {
    const key = `${truck.avenue},${truck.street}`;
    const before = crowd.get(key) ?? 0;
    crowd.set(key, before + 1);
    const [x, y] = place(game, truck.avenue, truck.street);
    // Around the corner, clear of the dealer and its prices.
    const angle = -Math.PI / 2 + (before % 2 === 0 ? 1 : -1) * (0.75 + 0.5 * Math.floor(before / 2));
    const at = `translate(${(x + 26 * Math.cos(angle)).toFixed(1)} ${(y + 26 * Math.sin(angle)).toFixed(1)})`;
    trucks[seat].setAttribute("transform", at);
    trucks[seat].classList.toggle("busy", truck.busy_minutes > 0);
    trucks[seat].classList.toggle("wired", truck.wired === true);
  });
}

/** Draws a game into `box`. */
export function drawMap(box, game, all) {
  const wanted = `${game.avenues}x${game.streets}`;
  if (size !== wanted || box.childElementCount === 0) {
    build(box, game);
    size = wanted;
  }
  for (const dealer of listed(game.dealers)) drawDealer(game, dealer);
  drawTrucks(game, all);
}
