#include "tests/passes/restir/cpu/reservoir.hpp"

#include "tests/passes/restir/cpu/word.hpp"

#include <algorithm>

namespace dermis::restir {

namespace {

bool usable(double x) {
  return x >= 0 && std::isfinite(x); // NaN compares false.
}

} // namespace

bool has_sample(const Reservoir& reservoir) {
  return reservoir.instance != no_instance && reservoir.weight > 0;
}

Reservoir sanitised(const Reservoir& reservoir) {
  Reservoir clean = reservoir;
  clean.confidence = reservoir.confidence > 0 ? std::min(reservoir.confidence, max_confidence) : 0;
  bool good = usable(clean.weight) && usable(clean.density);
  for (const double x : clean.irradiance)
    good = good && usable(x);
  for (const double x : {clean.barycentrics[0], clean.barycentrics[1], clean.numbers.survival,
                         clean.numbers.angle, clean.numbers.pick})
    good = good && usable(x) && x <= 1;
  good = good && clean.numbers.axis < 3 && clean.numbers.channel < 3 &&
         (clean.hits <= max_probe_hits || clean.hits == assumed_hits);
  if (good) return clean;
  Reservoir none;
  none.confidence = clean.confidence;
  return none;
}

PackedReservoir pack_reservoir(const Reservoir& r) {
  const ProbeNumbers& n = r.numbers;
  return {r.instance,
          r.primitive,
          bits(r.barycentrics[0]),
          bits(r.barycentrics[1]),
          r.light,
          r.place,
          n.axis | n.channel << 2 | r.hits << 4,
          bits(n.survival),
          bits(n.angle),
          bits(n.pick),
          bits(r.density),
          bits(r.irradiance[0]),
          bits(r.irradiance[1]),
          bits(r.irradiance[2]),
          bits(r.weight),
          bits(r.confidence)};
}

Reservoir unpack_reservoir(const PackedReservoir& w) {
  Reservoir r;
  r.instance = w[0];
  r.primitive = w[1];
  r.barycentrics = {number(w[2]), number(w[3])};
  r.light = w[4];
  r.place = w[5];
  r.numbers = {w[6] & 3u, w[6] >> 2 & 3u, number(w[7]), number(w[8]), number(w[9])};
  r.hits = w[6] >> 4 & 255u;
  r.density = number(w[10]);
  r.irradiance = {number(w[11]), number(w[12]), number(w[13])};
  r.weight = number(w[14]);
  r.confidence = number(w[15]);
  return sanitised(r);
}

void stream_add(Stream& stream, const Reservoir& candidate, double target, double weight,
                double confidence, double u) {
  stream.confidence += confidence;
  if (!(weight > 0) || !(target > 0) || !std::isfinite(weight) || !std::isfinite(target)) return;
  stream.sum += weight;
  if (!(u * stream.sum < weight)) return;
  stream.chosen = candidate;
  stream.target = target;
}

Reservoir stream_end(const Stream& stream) {
  Reservoir result = stream.chosen;
  result.confidence = stream.confidence;
  result.weight = stream.target > 0 ? stream.sum / stream.target : 0;
  return sanitised(result);
}

} // namespace dermis::restir
