#pragma once
// Reads curves of scene files: a constant, {"keys": [[seconds, value...], ...]} or {"sine": {...}}.

#include "framegraph/text/reader.hpp"
#include "integration/examples/demo_engine/scene/curve.hpp"

#include <string_view>

namespace demo {

inline constexpr double longest_seconds = 86400.0; // maximum length of a scene

// Inclusive range of every value at the curve's keys.
struct ValueRange {
  double minimum, maximum;
};

// Read a curve. They leave `curve` unchanged if the key is absent and optional, or wrong (then they
// add an error).
void read_curve(dermis::ObjectReader& object, std::string_view key, const ValueRange& range,
                dermis::Need need, const dermis::Document& document,
                dermis::Diagnostics& diagnostics, Curve<double>& curve);
void read_curve(dermis::ObjectReader& object, std::string_view key, const ValueRange& range,
                dermis::Need need, const dermis::Document& document,
                dermis::Diagnostics& diagnostics, Curve<glm::dvec3>& curve);

} // namespace demo
