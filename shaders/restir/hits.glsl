// Finds one of a probe's hits by its place in the order of distance. A ray query returns hits in
// any order, and a GPU keeps an array with a variable index in slow memory. Therefore each pass
// over all hits keeps only the nearest few hits that the passes before did not keep.
#ifndef DERMIS_RESTIR_HITS_GLSL
#define DERMIS_RESTIR_HITS_GLSL

#include "restir/probe.glsl"

// Number of hits that a pass keeps. Probes through a closed object mostly have two hits, and then
// one pass is enough.
const uint hits_a_pass = 2u;
const float beyond_rays = 3.0e38; // distance of an empty place

struct hit_pass {
  uint before;    // number of hits that earlier passes kept
  probe_hit last; // the last one of these
  uint count;     // number of hits of the probe
  probe_hit nearest[hits_a_pass];
};

probe_hit no_hit() { return probe_hit(0u, 0u, vec2(0.0), beyond_rays); }

void begin_pass(inout hit_pass pass) {
  pass.count = 0u;
  for (uint i = 0u; i < hits_a_pass; ++i)
    pass.nearest[i] = no_hit();
}

hit_pass first_pass() {
  hit_pass pass;
  pass.before = 0u;
  pass.last = no_hit();
  begin_pass(pass);
  return pass;
}

// Orders hits at equal distances, too: results do not depend on a driver's order.
bool is_nearer(probe_hit a, probe_hit b) {
  if (a.distance != b.distance)
    return a.distance < b.distance;
  return a.instance < b.instance || (a.instance == b.instance && a.primitive < b.primitive);
}

void add_hit(inout hit_pass pass, probe_hit hit) {
  ++pass.count;
  if (pass.before > 0u && !is_nearer(pass.last, hit))
    return;
  for (uint i = 0u; i < hits_a_pass; ++i)
    if (is_nearer(hit, pass.nearest[i])) {
      probe_hit farther = pass.nearest[i];
      pass.nearest[i] = hit;
      hit = farther;
    }
}

// Ends a pass. Returns true if the search is over; begins the next pass otherwise.
bool choose_hit(inout hit_pass pass, hit_choice choice, out chosen_hit chosen) {
  uint count = min(pass.count, max_probe_hits);
  chosen = chosen_hit(count, count, no_hit());
  uint picked = count > 0u ? picked_hit(choice.pick, count) : 0u;
  for (uint i = 0u; i < hits_a_pass; ++i) {
    probe_hit hit = pass.nearest[i];
    uint index = pass.before + i;
    bool is_chosen = index == picked;
    if (choice.by_primitive)
      is_chosen = hit.instance == choice.instance && hit.primitive == choice.primitive;
    if (is_chosen && index < count) {
      chosen.index = index;
      chosen.hit = hit;
    }
  }
  pass.before += hits_a_pass;
  pass.last = pass.nearest[hits_a_pass - 1u];
  begin_pass(pass);
  return chosen.index < count || pass.before >= count;
}

#endif
