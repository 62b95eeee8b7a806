// Builds nodes and edges of one plan: which pass reads which pass's output. Each write of a
// resource makes a new version, so that the graph has no cycle. Contents of earlier frames are
// sources without a writer.

const reads = (access) => access.access.names.some((name) => name.endsWith('read'));
const writes = (access) => access.access.names.some((name) => name.endsWith('write'));

export function accesses_of(pass) {
  return {
    reads: pass.accesses.filter((access) => reads(access) || access.frames_back > 0),
    writes: pass.accesses.filter((access) => writes(access) && access.frames_back === 0),
  };
}

// Returns the passes that read and write the resource, in execution order.
export function users_of(plan, resource) {
  const found = { readers: [], writers: [] };
  plan.passes.forEach((pass) => {
    const { reads: read, writes: written } = accesses_of(pass);
    if (read.some((access) => access.resource === resource)) found.readers.push(pass.name);
    if (written.some((access) => access.resource === resource)) found.writers.push(pass.name);
  });
  return found;
}

// Returns nodes { id, kind: pass | resource | past, name, pass | resource } and edges { from, to,
// kind: flow | keep | past }. Without `with_resources` edges connect passes, and edges of kind past
// lead back.
export function make_flow(plan, with_resources) {
  const nodes = [], edges = [], seen = new Set();
  const version = plan.resources.map(() => 0), writer = plan.resources.map(() => null);
  const past = []; // reads of earlier frames: [pass, resource]

  const add_edge = (from, to, kind) => {
    const id = `${from}>${to}`;
    if (from === null || from === to || seen.has(id)) return;
    seen.add(id);
    edges.push({ id, from, to, kind });
  };
  const resource_node = (resource, back) => {
    const name = plan.resources[resource].name;
    const id = back > 0 ? `h${resource}.${back}` : `r${resource}.${version[resource]}`;
    if (!seen.has(id)) {
      seen.add(id);
      const suffix = back > 0 ? `@-${back}` : '′'.repeat(Math.min(version[resource], 3));
      nodes.push({ id, kind: back > 0 ? 'past' : 'resource', name, label: name + suffix, resource });
    }
    return id;
  };
  const source_of = (resource) => (with_resources ? resource_node(resource, 0) : writer[resource]);

  plan.passes.forEach((pass, position) => {
    const id = `p${position}`;
    nodes.push({ id, kind: 'pass', name: pass.name, label: pass.name, pass: position });
    const uses = accesses_of(pass);
    for (const access of uses.reads) {
      if (access.frames_back > 0) past.push([id, access.resource]);
      if (access.frames_back === 0) add_edge(source_of(access.resource), id, 'flow');
      else if (with_resources) add_edge(resource_node(access.resource, access.frames_back), id, 'past');
    }
    for (const earlier of pass.after) add_edge(`p${earlier}`, id, 'keep');
    for (const resource of new Set(uses.writes.map((access) => access.resource))) {
      // texels not written keep their value
      if (writer[resource] !== null) add_edge(source_of(resource), id, 'keep');
      version[resource] += 1;
      writer[resource] = id;
      if (with_resources) add_edge(id, resource_node(resource, 0), 'flow');
    }
  });
  if (!with_resources)
    for (const [reader, resource] of past) add_edge(writer[resource], reader, 'past');
  return { nodes, edges };
}
