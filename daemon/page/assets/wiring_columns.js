// Which module stands in which column and row of the wiring picture.
//
// Columns follow the data from the sensors to the motors (the longest path), rows belong to layers,
// level 0 at the bottom. Everything here is counted in columns and rows; lengths come later.

import { listed } from "./words.js";

/** Splits "module.port"; a name without a point is a port of the body. */
function split(text) {
  const at = String(text).lastIndexOf(".");
  return at < 0 ? ["body", String(text)] : [text.slice(0, at), text.slice(at + 1)];
}

function addPort(ports, port) {
  if (!ports.includes(port)) ports.push(port);
}

/** All boxes of the picture, and a way to find the one that an end of a wire names. */
function collect(graph) {
  const nodes = new Map();
  const layers = listed(graph.layers).slice().sort((a, b) => (b.level ?? 0) - (a.level ?? 0));
  for (const layer of layers) {
    for (const module of listed(layer.modules)) {
      const key = nodes.has(module.name) ? `${layer.name}.${module.name}` : module.name;
      nodes.set(key, {
        key, name: module.name, kind: "module", type: module.kind ?? "", layer,
        inputs: listed(module.inputs).slice(), outputs: listed(module.outputs).slice(),
      });
    }
  }
  const body = (port, kind) => {
    const key = `${kind}:${port}`;
    const ports = { inputs: kind === "motor" ? [port] : [], outputs: kind === "sensor" ? [port] : [] };
    if (!nodes.has(key)) nodes.set(key, { key, name: port, kind, layer: null, ...ports });
    return nodes.get(key);
  };
  for (const port of listed(graph.body?.outputs)) body(port, "sensor");
  for (const port of listed(graph.body?.inputs)) body(port, "motor");
  const find = (text, side) => {
    const [owner, port] = split(text);
    const short = owner.split(/[/.]/).pop();
    const node = nodes.get(owner) ?? nodes.get(short) ?? body(port, side === "outputs" ? "sensor" : "motor");
    addPort(node[side], port);
    return { node, port };
  };
  return { nodes, layers, find };
}

/** Nets: one for each output that is read or taps something. */
function connect(graph, find) {
  const nets = new Map();
  const net = (from) => {
    if (!nets.has(from)) nets.set(from, { wire: from, from: find(from, "outputs"), ends: [] });
    return nets.get(from);
  };
  for (const wire of listed(graph.wires)) {
    const readers = Array.isArray(wire.to) ? wire.to : [wire.to];
    for (const to of readers) net(wire.from).ends.push({ kind: "wire", to: find(to, "inputs") });
  }
  for (const tap of listed(graph.taps)) {
    const side = tap.kind === "inhibit" ? "outputs" : "inputs";
    net(tap.from).ends.push({ kind: tap.kind, to: find(tap.to, side), tap });
  }
  return [...nets.values()];
}

const level = (node) => node.layer?.level ?? 0;

/** Edges between modules that make no cycle: what leads down or stays in a layer counts first. */
function acyclic(nets) {
  const edges = [];
  for (const net of nets) {
    for (const end of net.ends) {
      const [a, b] = [net.from.node, end.to.node];
      if (end.kind === "inhibit" || a.kind !== "module" || b.kind !== "module" || a === b) continue;
      edges.push({ a, b, rank: a.layer === b.layer ? 0 : level(a) > level(b) ? 1 : 2 });
    }
  }
  edges.sort((left, right) => left.rank - right.rank);
  const after = new Map();
  const reaches = (from, to) => from === to || (after.get(from) ?? []).some((next) => reaches(next, to));
  const kept = [];
  for (const edge of edges) {
    if (reaches(edge.b, edge.a)) continue;
    if (!after.has(edge.a)) after.set(edge.a, []);
    after.get(edge.a).push(edge.b);
    kept.push(edge);
  }
  return kept;
}

function setColumns(nodes, nets) {
  const modules = [...nodes.values()].filter((node) => node.kind === "module");
  const edges = acyclic(nets);
  for (const node of modules) node.column = 1;
  for (let moved = true; moved;) {
    moved = false;
    for (const { a, b } of edges) {
      if (b.column > a.column) continue;
      b.column = a.column + 1;
      moved = true;
    }
  }
  // What nothing leads to stands just before what it leads to.
  for (const node of modules) {
    const fed = nets.some((net) => net.ends.some((end) => end.to.node === node && end.kind !== "inhibit" && net.from.node.column <= node.column));
    const sensed = nets.some((net) => net.from.node.kind === "sensor" && net.ends.some((end) => end.to.node === node));
    const next = edges.filter((edge) => edge.a === node).map((edge) => edge.b.column);
    if (!fed && !sensed && next.length > 0) node.column = Math.min(...next) - 1;
  }
  const last = Math.max(1, ...modules.map((node) => node.column)) + 1;
  for (const node of nodes.values()) {
    if (node.kind === "sensor") node.column = 0;
    if (node.kind === "motor") node.column = last;
  }
  return last + 1;
}

/** The free row nearest to `wanted`; later rows before earlier ones. */
function freeRow(wanted, taken, rows) {
  for (let away = 0; away < 1000; away += 1) {
    for (const row of [wanted + away, wanted - away]) {
      if (row >= 0 && row < rows && !taken.has(row)) return row;
    }
  }
  return wanted;
}

const middle = (numbers) => numbers.reduce((sum, each) => sum + each, 0) / numbers.length;

function setRows(nodes, layers, nets) {
  const bands = [];
  let first = 0;
  for (const layer of layers) {
    const own = [...nodes.values()].filter((node) => node.layer === layer);
    own.sort((a, b) => a.column - b.column);
    const taken = new Map();
    for (const node of own) {
      const before = nets
        .filter((net) => net.from.node.layer === layer && net.from.node.column < node.column)
        .filter((net) => net.ends.some((end) => end.to.node === node))
        .map((net) => net.from.node.row);
      if (!taken.has(node.column)) taken.set(node.column, new Set());
      const column = taken.get(node.column);
      const wanted = before.length > 0 ? Math.round(middle(before)) : 0;
      node.row = freeRow(wanted, column, Infinity);
      column.add(node.row);
    }
    const rows = Math.max(1, ...own.map((node) => node.row + 1));
    for (const node of own) node.row += first;
    bands.push({ layer, first, rows });
    first += rows;
  }
  setBodyRows(nodes, nets, Math.max(1, first));
  const lowest = Math.max(0, ...[...nodes.values()].map((node) => node.row));
  return { bands, rows: Math.max(first, lowest + 1) };
}

/** Sensors stand beside their lowest reader, motors beside their writer, nearest writer first. */
function setBodyRows(nodes, nets, rows) {
  for (const kind of ["sensor", "motor"]) {
    const beside = (node) => {
      const partners = kind === "sensor"
        ? nets.filter((net) => net.from.node === node).flatMap((net) => net.ends.map((end) => end.to.node))
        : nets.filter((net) => net.ends.some((end) => end.to.node === node)).map((net) => net.from.node);
      const modules = partners.filter((partner) => partner.kind === "module");
      modules.sort((a, b) => level(a) - level(b) || (kind === "sensor" ? a.column - b.column : b.column - a.column));
      return modules[0];
    };
    const own = [...nodes.values()].filter((node) => node.kind === kind).map((node) => ({ node, near: beside(node) }));
    own.sort((a, b) => (b.near?.column ?? -1) - (a.near?.column ?? -1));
    const taken = new Set();
    for (const { node, near } of own) {
      node.row = freeRow(near?.row ?? rows - 1, taken, Math.max(rows, own.length));
      taken.add(node.row);
    }
  }
}

/** Boxes, nets, bands and counts of columns and rows for a graph. */
export function arrange(graph) {
  const { nodes, layers, find } = collect(graph);
  const nets = connect(graph, find);
  const columns = setColumns(nodes, nets);
  const { bands, rows } = setRows(nodes, layers, nets);
  return { nodes: [...nodes.values()], nets, bands, columns, rows };
}
