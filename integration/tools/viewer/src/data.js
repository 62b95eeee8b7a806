// Unpacks the page's data: one compressed document. Plans are lists of runs of lines that all plans
// share.

export async function unpack(base64) {
  const packed = Uint8Array.from(atob(base64.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return JSON.parse(await new Response(stream).text());
}

function unfold(runs, lines) {
  const parts = [];
  for (let i = 0; i < runs.length; i += 2) parts.push(lines.slice(runs[i], runs[i] + runs[i + 1]).join('\n'));
  return JSON.parse(parts.join('\n'));
}

// Returns plans by configuration; each plan is parsed on first access.
export function make_configurations(document) {
  const plans = document.plans.map(() => null);
  const key = (values) => values.join(',');
  const by_values = new Map(document.configurations.map((configuration) => [key(configuration.values), configuration]));
  return {
    count: document.configurations.length,
    first: document.configurations[0].values,
    // Returns { plan } or { problem }.
    at(values) {
      const configuration = by_values.get(key(values));
      if (configuration.plan === null) return { problem: configuration.problem };
      plans[configuration.plan] ??= unfold(document.plans[configuration.plan], document.lines);
      return { plan: plans[configuration.plan] };
    },
  };
}
