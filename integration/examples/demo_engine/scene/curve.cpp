#include "integration/examples/demo_engine/scene/curve.hpp"

#include <cmath>

namespace demo {
namespace {

template <class T> T between_keys(const Curve<T>& curve, double seconds) {
  const auto& keys = curve.keys;
  if (seconds <= keys.front().seconds) return keys.front().value;
  for (size_t i = 1; i < keys.size(); ++i) {
    if (seconds > keys[i].seconds) continue;
    const double t = (seconds - keys[i - 1].seconds) / (keys[i].seconds - keys[i - 1].seconds);
    return keys[i - 1].value * (1.0 - t) + keys[i].value * t;
  }
  return keys.back().value;
}

} // namespace

double value_at(const Curve<double>& curve, double seconds) {
  constexpr double tau = 6.283185307179586;
  const double wave = curve.amplitude * std::sin(tau * (curve.hertz * seconds + curve.phase));
  return between_keys(curve, seconds) + wave;
}

glm::dvec3 value_at(const Curve<glm::dvec3>& curve, double seconds) {
  return between_keys(curve, seconds);
}

} // namespace demo
