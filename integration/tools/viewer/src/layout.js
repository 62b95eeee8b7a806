// Places nodes in layers from left to right. Small graphs use dagre. Large graphs use a faster
// approximation: layers by the longest path, and the order inside a layer by the positions of the
// sources.
import dagre from '@dagrejs/dagre';

const dagre_edges = 900; // dagre takes too long for more edges
const gap = { layer: 60, node: 14 };

function place_with_dagre(nodes, edges) {
  const graph = new dagre.graphlib.Graph();
  graph.setGraph({ rankdir: 'LR', ranksep: gap.layer, nodesep: gap.node, ranker: edges.length > 250 ? 'longest-path' : 'network-simplex' });
  for (const node of nodes) graph.setNode(node.id, { width: node.width, height: node.height });
  for (const edge of edges) graph.setEdge(edge.from, edge.to, {});
  dagre.layout(graph);
  return new Map(nodes.map((node) => [node.id, { x: graph.node(node.id).x, y: graph.node(node.id).y }]));
}

// Requires nodes in topological order of the edges, ignoring edges that lead back.
function place_by_layers(nodes, edges) {
  const sources = new Map(nodes.map((node) => [node.id, []]));
  for (const edge of edges) sources.get(edge.to).push(edge.from);
  const layer = new Map(), layers = [];
  for (const node of nodes) {
    const at = Math.max(-1, ...sources.get(node.id).map((from) => layer.get(from) ?? -1)) + 1;
    layer.set(node.id, at);
    (layers[at] ??= []).push(node);
  }
  const places = new Map();
  let x = 0;
  for (const members of layers) {
    const preferred_y = new Map(members.map((node) => {
      const ys = sources.get(node.id).map((from) => places.get(from)?.y ?? 0);
      return [node.id, ys.length === 0 ? 0 : ys.reduce((a, b) => a + b, 0) / ys.length];
    }));
    members.sort((a, b) => preferred_y.get(a.id) - preferred_y.get(b.id));
    const width = Math.max(...members.map((node) => node.width));
    const height = members.reduce((sum, node) => sum + node.height + gap.node, 0);
    let y = members.reduce((sum, node) => sum + preferred_y.get(node.id), 0) / members.length - height / 2;
    for (const node of members) {
      places.set(node.id, { x: x + width / 2, y: y + node.height / 2 });
      y += node.height + gap.node;
    }
    x += width + gap.layer;
  }
  return places;
}

// Returns a map of id to { x, y }, centres in pixels. `nodes` have width and height.
export function place(nodes, edges) {
  const forward = edges.filter((edge) => edge.kind !== 'past' || edge.from.startsWith('h'));
  return edges.length <= dagre_edges ? place_with_dagre(nodes, forward) : place_by_layers(nodes, forward);
}
