// A layered drawing of a graph, from left to right (Sugiyama, Tagawa, Toda 1981): layers by longest path, dummy points for edges
// over several layers, order by medians of neighbours, heights by their means.

// nodes: [{id, height}], edges: [{from, to}] without cycles. Gives {nodes: Map id -> {x, y}, routes: [[{x, y}]] one an edge,
// width, height}; x, y are of a node's top left corner. Cost: linear in nodes and edge lengths for each of 24 sweeps.
export function layoutGraph(nodes, edges, {width = 150, gapX = 56, gapY = 18} = {}) {
  const layers = assignLayers(nodes, edges);
  const {columns, chains} = insertDummies(nodes, edges, layers);
  order(columns);
  place(columns, gapY);
  const x = (layer) => layer * (width + gapX);
  const at = new Map();
  let height = 0;
  for (const column of columns)
    for (const v of column) {
      if (!v.dummy) at.set(v.id, {x: x(v.layer), y: v.y});
      height = Math.max(height, v.y + v.height);
    }
  const routes = chains.map((chain) => chain.map((v) => ({x: x(v.layer) + width / 2, y: v.y + v.height / 2})));
  return {nodes: at, routes, width: x(columns.length) - gapX, height};
}

function assignLayers(nodes, edges) {
  const into = new Map(nodes.map((n) => [n.id, []])), out = new Map(nodes.map((n) => [n.id, []]));
  for (const e of edges) into.get(e.to).push(e.from), out.get(e.from).push(e.to);
  const layer = new Map();
  const waiting = new Map(nodes.map((n) => [n.id, into.get(n.id).length]));
  const ready = nodes.filter((n) => waiting.get(n.id) === 0).map((n) => n.id);
  const sorted = [];
  while (ready.length > 0) {
    const id = ready.shift();
    sorted.push(id);
    layer.set(id, Math.max(-1, ...into.get(id).map((f) => layer.get(f))) + 1);
    for (const t of out.get(id)) {
      waiting.set(t, waiting.get(t) - 1);
      if (waiting.get(t) === 0) ready.push(t);
    }
  }
  // From the end: whoever can move right towards its first reader does, so that cameras and lights stand by their use.
  for (const id of sorted.reverse())
    if (out.get(id).length > 0) layer.set(id, Math.min(...out.get(id).map((t) => layer.get(t))) - 1);
  return layer;
}

function insertDummies(nodes, edges, layers) {
  const columns = [];
  const add = (v) => ((columns[v.layer] ??= []).push(v), v);
  const byId = new Map(nodes.map((n) => [n.id, add({id: n.id, height: n.height, layer: layers.get(n.id), up: [], down: []})]));
  const chains = edges.map((e) => {
    const from = byId.get(e.from), to = byId.get(e.to), chain = [];
    let last = from;
    for (let l = from.layer + 1; l < to.layer; ++l) {
      const dummy = add({dummy: true, height: 6, layer: l, up: [last], down: []});
      last.down.push(dummy);
      chain.push(dummy);
      last = dummy;
    }
    last.down.push(to);
    to.up.push(last);
    return chain;
  });
  return {columns: Array.from(columns, (c) => c ?? []), chains};
}

function number_(columns) { for (const c of columns) c.forEach((v, i) => (v.rank = i)); }

// Crossings between neighbouring layers: inversions of the pairs of ranks, counted by insertion.
function crossings(columns) {
  let sum = 0;
  for (const column of columns) {
    const ends = column.flatMap((v) => v.down.map((w) => w.rank).sort((a, b) => a - b));
    const seen = [];
    for (const r of ends) {
      let low = 0, high = seen.length;
      while (low < high) seen[(low + high) >> 1] <= r ? (low = ((low + high) >> 1) + 1) : (high = (low + high) >> 1);
      sum += seen.length - low;
      seen.splice(low, 0, r);
    }
  }
  return sum;
}

function order(columns) {
  number_(columns);
  let best = crossings(columns), kept = columns.map((c) => [...c]);
  for (let sweep = 0; sweep < 24 && best > 0; ++sweep) {
    const down = sweep % 2 === 0;
    for (const column of down ? columns : [...columns].reverse()) {
      for (const v of column) {
        const near = (down ? v.up : v.down).map((w) => w.rank).sort((a, b) => a - b);
        const m = near.length >> 1;
        v.key = near.length === 0 ? v.rank : near.length % 2 ? near[m] : (near[m - 1] + near[m]) / 2;
      }
      column.sort((a, b) => a.key - b.key || a.rank - b.rank);
      column.forEach((v, i) => (v.rank = i));
    }
    const now = crossings(columns);
    if (now < best) best = now, kept = columns.map((c) => [...c]);
  }
  kept.forEach((c, i) => (columns[i] = c));
  number_(columns);
}

// Each column moves towards the mean of its neighbours, keeping its order and gaps; long edges pull hardest, so they are straight.
function place(columns, gap) {
  for (const column of columns) column.reduce((y, v) => ((v.y = y), y + v.height + gap), 0);
  for (let sweep = 0; sweep < 24; ++sweep)
    for (const column of sweep % 2 ? [...columns].reverse() : columns) {
      for (const v of column) {
        const near = sweep % 2 ? v.down : v.up, all = near.length > 0 ? near : [...v.up, ...v.down];
        v.goal = all.length === 0 ? v.y : all.reduce((s, w) => s + w.y + w.height / 2, 0) / all.length - v.height / 2;
      }
      settle(column, gap);
    }
  const top = Math.min(...columns.flat().map((v) => v.y));
  for (const column of columns) for (const v of column) v.y -= top;
}

// Least squares under order: neighbours that would overlap become a block that lies at its mean (pool adjacent violators).
function settle(column, gap) {
  const blocks = [];
  for (const v of column) {
    let block = {items: [v], offsets: [0], sum: v.goal, size: v.height + gap};
    while (blocks.length > 0) {
      const before = blocks[blocks.length - 1];
      if (before.sum / before.items.length + before.size <= block.sum / block.items.length) break;
      blocks.pop();
      const shifted = block.offsets.map((o) => o + before.size);
      block = {items: [...before.items, ...block.items], offsets: [...before.offsets, ...shifted],
               sum: before.sum + block.sum - before.size * block.items.length, size: before.size + block.size};
    }
    blocks.push(block);
  }
  for (const b of blocks) b.items.forEach((v, i) => (v.y = b.sum / b.items.length + b.offsets[i]));
}
