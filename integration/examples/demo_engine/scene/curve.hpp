#pragma once
// Values that change with time.

#include <glm/glm.hpp>

#include <cstddef>
#include <vector>

namespace demo {

// Keyframes with linear interpolation, constant before the first and after the last, plus a sine.
template <class T> struct Curve {
  struct Key {
    double seconds;
    T value;
  };
  std::vector<Key> keys = {{0.0, T(0.0)}};          // at least one, ascending
  double amplitude = 0.0, hertz = 0.0, phase = 0.0; // adds amplitude * sin(2 pi (hertz t + phase))

  Curve() = default;
  explicit Curve(T constant) : keys{{0.0, constant}} {}
};

double value_at(const Curve<double>& curve, double seconds);
glm::dvec3 value_at(const Curve<glm::dvec3>& curve, double seconds);

} // namespace demo
