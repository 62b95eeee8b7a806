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
export function make_outcomes(document) {
  const plans = document.plans.map(() => null);
  const key = (values) => values.join(',');
  const by_values = new Map(document.outcomes.map((outcome) => [key(outcome.values), outcome]));
  return {
    count: document.outcomes.length,
    first: document.outcomes[0].values,
    // Returns { plan } or { problem }.
    at(values) {
      const outcome = by_values.get(key(values));
      if (outcome.plan === null) return { problem: outcome.problem };
      plans[outcome.plan] ??= unfold(document.plans[outcome.plan], document.lines);
      return { plan: plans[outcome.plan] };
    },
  };
}
