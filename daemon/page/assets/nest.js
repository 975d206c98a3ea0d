// The nest builder's floor from above: robot with its hand, eyes and wheel, objects, obstacles, gas stations, nest sites.

import { listed } from "./words.js";

export const label = "The floor from above with robot, objects, obstacles, gas stations and nest";

export const legend = [
  ["object", "dot", "object"],
  ["station", "dot", "gas station"],
  ["site", "dot", "nest site"],
  ["box-line", "dot", "obstacle"],
  ["walker", "dot", "person"],
  ["sonar", "dot", "in view"],
];

let size = [1, 1];
let latest = null;

export function take(plan) {
  size = listed(plan.floor.size_m);
  latest = null;
  return size[0] / size[1];
}

export function see(state) {
  latest = state.nest ? { nest: state.nest, halted: state.halt?.halted === true } : null;
}

export function note({ nest }) {
  if (!nest) return "";
  const held = nest.robot.held === null ? "hand empty" : "carries an object";
  return `${nest.built} of ${nest.wanted} objects, fuel ${Math.round(nest.robot.fuel * 100)} %, ${held}`;
}

export function draw({ pen, wide, high, dense, colour }) {
  if (latest === null) return;
  const { nest, halted } = latest;
  const [width, depth] = size;
  const scale = Math.min(wide / width, high / depth);
  const ink = { pen, colour, pixel: dense / scale };
  pen.setTransform(scale, 0, 0, -scale, (wide - scale * width) / 2, (high + scale * depth) / 2);
  pen.fillStyle = colour("floor");
  pen.fillRect(0, 0, width, depth);
  pen.strokeStyle = colour("wall");
  pen.lineWidth = 3 * ink.pixel;
  pen.strokeRect(0, 0, width, depth);
  drawEyes(ink, nest);
  for (const site of listed(nest.sites)) drawSite(ink, site, nest);
  for (const station of listed(nest.stations)) drawStation(ink, station.place);
  for (const disc of listed(nest.obstacles)) round(ink, disc.place, disc.radius_m, colour("box"), colour("box-line"));
  for (const object of listed(nest.objects)) drawObject(ink, object.place);
  for (const person of listed(nest.persons)) drawPerson(ink, person);
  drawRobot(ink, nest, halted);
}

function round({ pen, pixel }, place, radius, fill, line) {
  pen.beginPath();
  pen.arc(place.x_m, place.y_m, radius, 0, 2 * Math.PI);
  pen.fillStyle = fill;
  pen.fill();
  pen.strokeStyle = line;
  pen.lineWidth = 1.5 * pixel;
  pen.stroke();
}

function drawEyes({ pen, colour }, nest) {
  const { place, heading_rad: heading } = nest.robot;
  const [range, side] = nest.eyes;
  pen.save();
  pen.beginPath();
  pen.rect(0, 0, ...size);
  pen.clip();
  pen.globalAlpha = 0.1;
  pen.fillStyle = colour("sonar");
  pen.beginPath();
  pen.moveTo(place.x_m, place.y_m);
  pen.arc(place.x_m, place.y_m, range, heading - side, heading + side);
  pen.fill();
  pen.restore();
}

function drawSite(ink, site, nest) {
  const { pen, pixel, colour } = ink;
  pen.setLineDash([5 * pixel, 4 * pixel]);
  pen.globalAlpha = site.proper ? 1 : 0.4;
  round(ink, site.place, nest.nest_m, "transparent", colour("site"));
  pen.globalAlpha = site.id === nest.robot.site ? 0.14 : 0;
  pen.setLineDash([]);
  round(ink, site.place, nest.nest_m, colour("site"), "transparent");
  pen.globalAlpha = 1;
}

function drawStation({ pen, pixel, colour }, place) {
  pen.fillStyle = colour("station");
  pen.strokeStyle = colour("station");
  pen.lineWidth = 2 * pixel;
  pen.fillRect(place.x_m - 0.16, place.y_m - 0.22, 0.26, 0.44);
  pen.beginPath();
  pen.moveTo(place.x_m + 0.1, place.y_m + 0.12);
  pen.lineTo(place.x_m + 0.22, place.y_m + 0.06);
  pen.lineTo(place.x_m + 0.22, place.y_m - 0.14);
  pen.stroke();
}

function drawObject({ pen, pixel, colour }, place) {
  const size = Math.max(0.16, 6 * pixel);
  pen.fillStyle = colour("object");
  pen.strokeStyle = colour("ink");
  pen.lineWidth = pixel;
  pen.beginPath();
  pen.rect(place.x_m - size / 2, place.y_m - size / 2, size, size);
  pen.fill();
  pen.stroke();
}

function drawPerson(ink, person) {
  round(ink, person.place, person.radius_m, ink.colour("walker"), "transparent");
  if (person.carries) drawObject(ink, person.place);
}

function drawRobot(ink, nest, halted) {
  const { pen, pixel, colour } = ink;
  const { robot, hand } = nest;
  const radius = 0.25;
  pen.strokeStyle = colour("ink");
  pen.lineWidth = 3.5 * pixel;
  pen.lineCap = "round";
  pen.beginPath();
  pen.moveTo(robot.place.x_m, robot.place.y_m);
  pen.lineTo(hand.x_m, hand.y_m);
  pen.stroke();
  round(ink, robot.place, radius, colour(halted ? "attacker" : "robot"), colour("robot-ink"));
  pen.save();
  pen.translate(robot.place.x_m, robot.place.y_m);
  pen.rotate(robot.heading_rad);
  pen.fillStyle = colour("robot-ink");
  pen.beginPath();
  pen.moveTo(radius * 0.75, 0);
  pen.lineTo(-radius * 0.35, radius * 0.5);
  pen.lineTo(-radius * 0.1, 0);
  pen.lineTo(-radius * 0.35, -radius * 0.5);
  pen.fill();
  // The steering wheel, in front of the axle.
  pen.translate(radius * 0.8, 0);
  pen.rotate(robot.steering_rad);
  pen.strokeStyle = colour("ink");
  pen.lineWidth = 3 * pixel;
  pen.beginPath();
  pen.moveTo(-0.08, 0);
  pen.lineTo(0.08, 0);
  pen.stroke();
  pen.restore();
  // An open hand is a ring; one that holds something shows the object in it.
  if (robot.held === null) round(ink, hand, 0.05, "transparent", colour("ink"));
  else drawObject(ink, hand);
}
