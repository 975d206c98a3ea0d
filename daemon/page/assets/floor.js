// A floor from above: walls, furniture, people, the robot, its sonar and where it has been.
//
// Draws the office and the warehouse, and any body whose floor has walls or boxes.

import { listed } from "./words.js";

const TRAIL_S = 60;
const ECHO_S = 3;
const MARGIN_M = 0.25;
let colours = {};
let floor = {};
let bounds = [0, 0, 1, 1];
let radius = 0.2;
let trail = [];
let pings = [];
let latest = null;

export const label = "The floor from above with the robot, people and sonar";

export const legend = [
  ["robot", "dot", "robot"], ["sonar", "line", "sonar echo"], ["trail", "line", "last minute"],
  ["walker", "dot", "people"], ["attacker", "dot", "attacker"],
];

export function take(plan) {
  floor = plan.floor;
  radius = plan.robot_radius_m ?? 0.2;
  bounds = floor.bounds ?? around(listed(floor.walls));
  [trail, pings, latest] = [[], [], null];
  return (bounds[2] - bounds[0] + 2 * MARGIN_M) / (bounds[3] - bounds[1] + 2 * MARGIN_M);
}

function around(walls) {
  const xs = walls.flatMap((wall) => [wall[0], wall[2]]);
  const ys = walls.flatMap((wall) => [wall[1], wall[3]]);
  if (xs.length === 0) return [-5, -5, 5, 5];
  return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
}

export function see(state) {
  const time = state.time_s ?? 0;
  remember(state, time);
  latest = { state, time };
}

export function draw({ pen, wide, high, dense, colour }) {
  if (latest === null) return;
  const names = ["floor", "wall", "box", "box-line", "quiet", "robot", "robot-ink", "sonar", "trail", "walker", "attacker"];
  colours = Object.fromEntries(names.map((name) => [name, colour(name)]));
  const [x0, y0, x1, y1] = bounds;
  const scale = Math.min(wide / (x1 - x0 + 2 * MARGIN_M), high / (y1 - y0 + 2 * MARGIN_M));
  // Metres, y upwards, the floor in the middle of the canvas.
  pen.setTransform(scale, 0, 0, -scale, wide / 2 - (scale * (x0 + x1)) / 2, high / 2 + (scale * (y0 + y1)) / 2);
  const pixel = dense / scale;
  drawFloor(pen, pixel);
  const { state, time } = latest;
  drawTrail(pen, pixel, time, state.robot);
  drawSonar(pen, pixel, time, state.sonar?.max_m ?? Infinity);
  drawWalls(pen, pixel);
  for (const person of listed(state.people)) drawPerson(pen, pixel, person);
  if (state.robot) drawRobot(pen, pixel, state.robot, state.halt?.halted === true);
}

function remember(state, time) {
  const robot = state.robot;
  if (trail.length > 0 && time < trail[trail.length - 1].time) [trail, pings] = [[], []];
  if (!robot) return;
  const last = trail[trail.length - 1];
  if (!last || Math.hypot(robot.x - last.x, robot.y - last.y) > 0.02) trail.push({ x: robot.x, y: robot.y, time });
  trail = trail.filter((point) => time - point.time < TRAIL_S);
  const ranges = listed(state.sonar?.ranges_m);
  const newest = pings[pings.length - 1];
  if (ranges.length > 0 && (!newest || differ(newest.ranges, ranges))) {
    pings.push({ ranges, x: robot.x, y: robot.y, heading: robot.heading ?? 0, time });
  }
  pings = pings.filter((ping, index) => index === pings.length - 1 || time - ping.time < ECHO_S);
}

/** Whether two rings of ranges are two pings: no noise is as small as half a millimetre all round. */
function differ(before, now) {
  return before.length !== now.length || now.some((range, spoke) => Math.abs(range - before[spoke]) > 5e-4);
}

function drawFloor(pen, pixel) {
  const [x0, y0, x1, y1] = bounds;
  pen.fillStyle = colours.floor;
  pen.fillRect(x0, y0, x1 - x0, y1 - y0);
  for (const box of listed(floor.boxes)) {
    pen.save();
    pen.translate(box.x, box.y);
    pen.rotate(box.heading ?? 0);
    pen.fillStyle = colours.box;
    pen.strokeStyle = colours["box-line"];
    pen.lineWidth = pixel;
    pen.beginPath();
    pen.roundRect(-box.w / 2, -box.h / 2, box.w, box.h, Math.min(box.w, box.h) * 0.12);
    pen.fill();
    pen.stroke();
    pen.restore();
    const size = 9.5 * pixel;
    const along = box.w >= box.h ? 0 : Math.PI / 2;
    if (box.name && Math.min(box.w, box.h) > size && Math.max(box.w, box.h) > box.name.length * 0.6 * size) nameBox(pen, box, (box.heading ?? 0) + along, size);
  }
}

/** Writes the name of a box along its longer side, never upside down. */
function nameBox(pen, box, angle, size) {
  const upright = Math.atan(Math.tan(angle));
  pen.save();
  pen.translate(box.x, box.y);
  pen.rotate(Math.abs(upright) < 1e-6 ? 0 : upright);
  pen.scale(size / 10, -size / 10);
  pen.font = "10px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillStyle = colours.quiet;
  pen.fillText(box.name, 0, 0);
  pen.restore();
}

function drawWalls(pen, pixel) {
  pen.strokeStyle = colours.wall;
  pen.lineWidth = Math.max(0.07, 2 * pixel);
  pen.lineCap = "square";
  pen.beginPath();
  for (const wall of listed(floor.walls)) {
    pen.moveTo(wall[0], wall[1]);
    pen.lineTo(wall[2], wall[3]);
  }
  pen.stroke();
}

function drawTrail(pen, pixel, time, robot) {
  pen.strokeStyle = colours.trail;
  pen.lineWidth = 2 * pixel;
  pen.lineCap = "round";
  const points = robot ? [...trail, { x: robot.x, y: robot.y, time }] : trail;
  for (let index = 1; index < points.length; index += 1) {
    pen.globalAlpha = Math.max(0.05, 1 - (time - points[index].time) / TRAIL_S);
    pen.beginPath();
    pen.moveTo(points[index - 1].x, points[index - 1].y);
    pen.lineTo(points[index].x, points[index].y);
    pen.stroke();
  }
  pen.globalAlpha = 1;
}

/** Reading 0 looks straight ahead; the others follow counterclockwise, evenly spread. */
function drawSonar(pen, pixel, time, max) {
  const [x0, y0, x1, y1] = bounds;
  pen.save();
  pen.beginPath();
  pen.rect(x0, y0, x1 - x0, y1 - y0);
  pen.clip();
  pings.forEach((ping, index) => {
    const newest = index === pings.length - 1;
    const fade = Math.max(newest ? 0.35 : 0, 1 - (time - ping.time) / ECHO_S);
    const half = (Math.PI / ping.ranges.length) * 0.86;
    ping.ranges.forEach((range, spoke) => {
      if (!(range > 0)) return;
      const angle = ping.heading + (spoke * 2 * Math.PI) / ping.ranges.length;
      if (newest) {
        pen.fillStyle = colours.sonar;
        pen.globalAlpha = range < max ? 0.09 : 0.03;
        pen.beginPath();
        pen.moveTo(ping.x, ping.y);
        pen.arc(ping.x, ping.y, range, angle - half, angle + half);
        pen.fill();
      }
      if (range >= max) return;
      pen.strokeStyle = colours.sonar;
      pen.globalAlpha = fade * (newest ? 1 : 0.5);
      pen.lineWidth = (newest ? 2.5 : 1.5) * pixel;
      pen.lineCap = "butt";
      pen.beginPath();
      pen.arc(ping.x, ping.y, range, angle - half, angle + half);
      pen.stroke();
    });
  });
  pen.restore();
}

function drawPerson(pen, pixel, person) {
  const attacker = person.kind === "attacker";
  pen.save();
  pen.translate(person.x, person.y);
  pen.rotate(person.heading ?? 0);
  pen.fillStyle = attacker ? colours.attacker : colours.walker;
  pen.beginPath();
  pen.ellipse(0, 0, 0.15, 0.25, 0, 0, 2 * Math.PI);
  pen.globalAlpha = 0.55;
  pen.fill();
  pen.globalAlpha = 1;
  pen.beginPath();
  pen.arc(0.02, 0, 0.12, 0, 2 * Math.PI);
  pen.fill();
  if (attacker) {
    pen.strokeStyle = colours.attacker;
    pen.lineWidth = 1.5 * pixel;
    pen.setLineDash([3 * pixel, 3 * pixel]);
    pen.beginPath();
    pen.arc(0, 0, 0.36, 0, 2 * Math.PI);
    pen.stroke();
  }
  pen.restore();
}

function drawRobot(pen, pixel, robot, halted) {
  pen.save();
  pen.translate(robot.x, robot.y);
  pen.rotate(robot.heading ?? 0);
  pen.fillStyle = halted ? colours.attacker : colours.robot;
  pen.strokeStyle = colours["robot-ink"];
  pen.lineWidth = 1.5 * pixel;
  pen.beginPath();
  pen.arc(0, 0, radius, 0, 2 * Math.PI);
  pen.fill();
  pen.stroke();
  pen.fillStyle = colours["robot-ink"];
  pen.beginPath();
  pen.moveTo(radius * 0.75, 0);
  pen.lineTo(-radius * 0.35, radius * 0.5);
  pen.lineTo(-radius * 0.1, 0);
  pen.lineTo(-radius * 0.35, -radius * 0.5);
  pen.fill();
  pen.restore();
}
