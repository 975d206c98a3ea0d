// Where the wires of the wiring picture run, and how large it gets.
//
// A wire leaves its box to the right, runs up or down in a *gutter* (between two columns), across in
// a *lane* (between two rows) or through empty places of a row, and enters its reader from the left.
// Nets that would lie on each other get *tracks* of their own. Taps end on a circle that sits on the
// wire they act on: just before an input (suppress), just after an output (inhibit).

const PORT = 15;
const TITLE = 19;
const TRACK = 9;
const PAD = 13;
export const CIRCLE = 10;
const SLOT = 2 * CIRCLE + 6;
const ROW_GAP = 16;
const BAND_HEAD = 22;
const BAND_GAP = 10;

const sides = { wire: "inputs", suppress: "inputs", inhibit: "outputs" };

/** How far a port lies below the middle line of its row. */
function offset(node, side, port) {
  const ports = node[side];
  return (ports.indexOf(port) - (ports.length - 1) / 2) * PORT;
}

function measure(node) {
  if (node.kind !== "module") {
    node.width = Math.max(54, node.name.length * 7 + 22);
    node.height = 26;
    return;
  }
  const longest = (ports) => Math.max(0, ...ports.map((port) => port.length)) * 5.9;
  node.width = Math.ceil(Math.max(84, node.name.length * 7.6 + 22, longest(node.inputs) + longest(node.outputs) + 26));
  node.height = TITLE + Math.max(1, node.inputs.length, node.outputs.length) * PORT + 4;
}

/** A height in rows, fit for comparing: real heights are not known yet. */
const rough = (node, side, port) => node.row + 0.5 + offset(node, side, port) / 400;

/** Plans one branch of a net as pieces of gutters and lanes. */
function plan(net, end, filled) {
  const start = net.from.node;
  const goal = end.to.node;
  const [gutter, target] = [start.column, end.kind === "inhibit" ? goal.column : goal.column - 1];
  const ys = { at: rough(start, "outputs", net.from.port), row: start.row, off: offset(start, "outputs", net.from.port) };
  const side = sides[end.kind];
  const ye = { at: rough(goal, side, end.to.port), row: goal.row, off: offset(goal, side, end.to.port) };
  const between = [];
  for (let column = Math.min(gutter, target) + 1; column <= Math.max(gutter, target); column += 1) between.push(column);
  const open = (row) => between.every((column) => [undefined, net].includes(filled.get(`${row}:${column}`)));
  const claim = (row) => between.forEach((column) => filled.set(`${row}:${column}`, net));
  const branch = { net, end, gutter, target, ys, ye, through: null };
  if (gutter === target) return { ...branch, through: "gutter" };
  if (end.kind === "wire" && open(goal.row)) {
    claim(goal.row);
    return { ...branch, through: "end" };
  }
  if (open(start.row)) {
    claim(start.row);
    return { ...branch, through: "start" };
  }
  const below = goal.row > start.row;
  const lane = end.kind === "wire" ? goal.row + (goal.row < start.row ? 1 : 0) : start.row + (below ? 1 : 0);
  return { ...branch, through: "lane", lane };
}

/** Joins what a net needs in one gutter or lane into one stretch. */
function stretch(places, index, net, from, to, stubs = {}) {
  if (!places.has(index)) places.set(index, []);
  const list = places.get(index);
  let own = list.find((each) => each.net === net);
  if (!own) {
    own = { net, low: Infinity, high: -Infinity, left: new Set(), right: new Set(), track: 0 };
    list.push(own);
  }
  own.low = Math.min(own.low, from, to);
  own.high = Math.max(own.high, from, to);
  if (stubs.left !== undefined) own.left.add(stubs.left);
  if (stubs.right !== undefined) own.right.add(stubs.right);
}

/**
 * Gives stretches tracks so that none overlap, and so that where a stub comes from the left and
 * another leaves to the right at the same height, the first has the track further left.
 */
function assign(list) {
  const waits = new Map(list.map((own) => [own, list.filter((other) => other !== own && [...other.left].some((y) => own.right.has(y)))]));
  const done = [];
  const waiting = list.slice().sort((a, b) => a.low - b.low);
  while (waiting.length > 0) {
    const ready = waiting.findIndex((own) => waits.get(own).every((other) => done.includes(other)));
    const [own] = waiting.splice(Math.max(0, ready), 1);
    const first = Math.max(0, ...waits.get(own).filter((other) => done.includes(other)).map((other) => other.track + 1));
    for (own.track = first; done.some((other) => other.track === own.track && other.low <= own.high && own.low <= other.high);) own.track += 1;
    done.push(own);
  }
  return list.length === 0 ? 0 : Math.max(...list.map((own) => own.track)) + 1;
}

/** Numbers the circles of a column so that no vertical runs through another circle. */
function slots(branches) {
  const counts = { suppress: new Map(), inhibit: new Map() };
  const taps = branches.filter((branch) => branch.end.tap);
  // The highest level stands nearest to the port: its window also rejects the lower ones.
  taps.sort((a, b) => (a.net.from.node.layer?.level ?? 0) - (b.net.from.node.layer?.level ?? 0));
  for (const branch of taps) {
    const count = counts[branch.end.kind] ?? counts.suppress;
    branch.slot = count.get(branch.target) ?? 0;
    count.set(branch.target, branch.slot + 1);
  }
  return counts;
}

function stretches(branches) {
  const [gutters, lanes] = [new Map(), new Map()];
  for (const { net, end, gutter, target, ys, ye, through, lane } of branches) {
    const tap = end.kind !== "wire";
    if (through === "gutter" && !tap && ys.at !== ye.at) stretch(gutters, gutter, net, ys.at, ye.at, { left: ys.at, right: ye.at });
    if (through === "end" && ys.at !== ye.at) stretch(gutters, gutter, net, ys.at, ye.at, { left: ys.at, right: ye.at });
    if (through === "start" && !tap && ys.at !== ye.at) stretch(gutters, target, net, ys.at, ye.at, { left: ys.at, right: ye.at });
    if (through !== "lane") continue;
    stretch(lanes, lane, net, gutter + 0.5, target + 0.5);
    stretch(gutters, gutter, net, ys.at, lane, { left: ys.at });
    if (!tap) stretch(gutters, target, net, lane, ye.at, { right: ye.at });
  }
  return { gutters, lanes };
}

/** Real places for columns, rows, tracks and lanes. */
function sizes(picture, gutters, lanes, counts) {
  const columns = [];
  let x = 10;
  for (let column = 0; column < picture.columns; column += 1) {
    const own = picture.nodes.filter((node) => node.column === column);
    const width = Math.max(0, ...own.map((node) => node.width));
    const tracks = assign(gutters.get(column) ?? []);
    const [after, before] = [(counts.inhibit.get(column) ?? 0) * SLOT, (counts.suppress.get(column) ?? 0) * SLOT];
    const gutter = Math.max(28, 2 * PAD + after + before + tracks * TRACK);
    columns.push({ x, width, right: x + width, tracks: x + width + PAD + after + (gutter - 2 * PAD - after - before - tracks * TRACK) / 2, gutter });
    x += width + (column + 1 < picture.columns ? gutter : 0);
  }
  const rows = [];
  const lanesAt = [];
  let y = 2;
  for (let row = 0; row <= picture.rows; row += 1) {
    const band = picture.bands.find((each) => each.first === row);
    if (band) {
      y += row > 0 ? BAND_GAP : 0;
      band.top = y;
      y += BAND_HEAD;
    }
    const count = assign(lanes.get(row) ?? []);
    lanesAt.push(y + 5);
    y += count > 0 ? count * TRACK + 8 : 0;
    if (row === picture.rows) break;
    const high = Math.max(26, ...picture.nodes.filter((node) => node.row === row).map((node) => node.height));
    rows.push({ line: y + high / 2 + 7, y });
    y += high + ROW_GAP;
    for (const each of picture.bands) if (each.first + each.rows - 1 === row) each.bottom = y - 4;
  }
  return { columns, rows, lanesAt, width: x + 10, height: y + 4 };
}

/** The corners of one branch, from port to port or from port to circle. */
function corners(branch, grid, gutters, lanes) {
  const { net, end, gutter, target, ys, ye, through, lane } = branch;
  const track = (index) => grid.columns[index].tracks + (gutters.get(index)?.find((own) => own.net === net)?.track ?? 0) * TRACK + TRACK / 2;
  const y1 = grid.rows[ys.row].line + ys.off;
  const y2 = grid.rows[ye.row].line + ye.off;
  const start = [net.from.node.x + net.from.node.width, y1];
  const across = through === "lane" ? grid.lanesAt[lane] + (lanes.get(lane).find((own) => own.net === net).track + 0.5) * TRACK : 0;
  if (end.kind === "wire") {
    const goal = [end.to.node.x, y2];
    if (y1 === y2 && through !== "lane") return [start, goal];
    if (through === "lane") return [start, [track(gutter), y1], [track(gutter), across], [track(target), across], [track(target), y2], goal];
    const at = track(through === "start" ? target : gutter);
    return [start, [at, y1], [at, y2], goal];
  }
  const column = grid.columns[target];
  branch.circle = end.kind === "inhibit"
    ? [column.right + PAD + (branch.slot + 0.5) * SLOT - 6, y2]
    : [column.right + column.gutter - PAD - (branch.total - branch.slot - 0.5) * SLOT + 3, y2];
  const down = (from) => (from < y2 ? y2 - CIRCLE : y2 + CIRCLE);
  if (through === "lane") {
    return [start, [track(gutter), y1], [track(gutter), across], [branch.circle[0], across], [branch.circle[0], down(across)]];
  }
  return [start, [branch.circle[0], y1], [branch.circle[0], down(y1)]];
}

/** Where branches of one net part: corners of one that lie on another. */
function joints(branches) {
  const found = new Map();
  for (const one of branches) {
    for (const other of branches) {
      if (one === other) continue;
      for (const [x, y] of one.points.slice(1, -1)) {
        for (let index = 1; index < other.points.length; index += 1) {
          const [[ax, ay], [bx, by]] = [other.points[index - 1], other.points[index]];
          const inside = (ax === bx && x === ax && y > Math.min(ay, by) && y < Math.max(ay, by))
            || (ay === by && y === ay && x > Math.min(ax, bx) && x < Math.max(ax, bx));
          if (inside) found.set(`${x},${y}`, [x, y]);
        }
      }
    }
  }
  return [...found.values()];
}

/** Gives boxes, bands, wires and circles of an arranged picture their places. */
export function route(picture) {
  const filled = new Map();
  for (const node of picture.nodes) {
    measure(node);
    filled.set(`${node.row}:${node.column}`, node);
  }
  const branches = picture.nets.flatMap((net) => net.ends.map((end) => plan(net, end, filled)));
  const counts = slots(branches);
  for (const branch of branches) branch.total = counts[branch.end.kind]?.get(branch.target) ?? 0;
  const { gutters, lanes } = stretches(branches);
  const grid = sizes(picture, gutters, lanes, counts);
  for (const node of picture.nodes) {
    const column = grid.columns[node.column];
    node.x = node.kind === "sensor" ? column.x + column.width - node.width : column.x;
    node.width = node.kind === "module" ? column.width : node.width;
    node.y = grid.rows[node.row].line - (node.kind === "module" ? TITLE + (node.height - TITLE - 4) / 2 : node.height / 2);
    node.line = grid.rows[node.row].line;
    node.portAt = (side, port) => node.line + offset(node, side, port);
  }
  for (const branch of branches) branch.points = corners(branch, grid, gutters, lanes);
  for (const net of picture.nets) {
    net.branches = branches.filter((branch) => branch.net === net);
    net.joints = joints(net.branches);
  }
  const inner = picture.nodes.filter((node) => node.kind === "module");
  const left = Math.min(grid.width, ...inner.map((node) => node.x)) - 12;
  const right = Math.max(0, ...inner.map((node) => node.x + node.width)) + 12;
  return { ...picture, left, right, width: grid.width, height: grid.height };
}
