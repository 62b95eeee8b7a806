#include "integration/examples/demo_engine/scene/read_curve.hpp"

#include <fmt/format.h>

#include <array>
#include <string>

namespace demo {
namespace {

using dermis::DiagnosticId;
using dermis::Diagnostics;
using dermis::Document;
using dermis::Need;
using dermis::NodeId;
using dermis::NodeKind;
using dermis::ObjectReader;

constexpr size_t max_keys = 4096;

constexpr size_t width_of(const double&) {
  return 1;
}
constexpr size_t width_of(const glm::dvec3&) {
  return 3;
}

void put(double& value, const double* from) {
  value = from[0];
}
void put(glm::dvec3& value, const double* from) {
  value = {from[0], from[1], from[2]};
}

struct Reading {
  const Document& document;
  Diagnostics& diagnostics;
  ValueRange range;
  std::string what;
};

template <class T> bool read_keys(const Reading& reading, ObjectReader& object, Curve<T>& curve) {
  const NodeId list = object.array("keys", 1, max_keys);
  if (!list.valid()) return false;
  std::vector<typename Curve<T>::Key> keys;
  for (const NodeId row : dermis::children(reading.document, list)) {
    std::array<double, 1 + width_of(T{})> numbers{};
    const double minimum = std::min(reading.range.minimum, 0.0);
    const double maximum = std::max(reading.range.maximum, longest_seconds);
    const std::string what = fmt::format("keyframe {} of {}", keys.size(), reading.what);
    if (!dermis::read_numbers(reading.document, row, what, numbers, minimum, maximum,
                              reading.diagnostics))
      return false;
    const auto reject = [&](DiagnosticId id, std::string text) {
      reading.diagnostics.add(id, reading.document.where(row), std::move(text));
      return false;
    };
    const std::string at = fmt::format("{} is at {} s; times ascend from 0 to {} s", what,
                                       numbers[0], longest_seconds);
    if (numbers[0] < 0.0 || numbers[0] > longest_seconds)
      return reject(DiagnosticId::out_of_range, at);
    if (!keys.empty() && numbers[0] <= keys.back().seconds)
      return reject(DiagnosticId::scene_range, at);
    for (size_t i = 1; i < numbers.size(); ++i)
      if (numbers[i] < reading.range.minimum || numbers[i] > reading.range.maximum)
        return reject(DiagnosticId::out_of_range,
                      fmt::format("{} has the value {}; expected {} to {}", what, numbers[i],
                                  reading.range.minimum, reading.range.maximum));
    typename Curve<T>::Key key{numbers[0], T(0.0)};
    put(key.value, &numbers[1]);
    keys.push_back(key);
  }
  curve = Curve<T>();
  curve.keys = std::move(keys);
  return true;
}

bool read_sine(const Reading& reading, ObjectReader& parent, Curve<double>& curve) {
  const NodeId node = parent.object("sine");
  if (!node.valid()) return false;
  ObjectReader object(reading.document, node, "'sine' of " + reading.what, reading.diagnostics);
  const double span = reading.range.maximum - reading.range.minimum;
  const auto mean = object.number("mean", reading.range.minimum, reading.range.maximum);
  const auto amplitude = object.number("amplitude", 0.0, span);
  constexpr double fastest_hertz = 1000.0;
  const auto hertz = object.number("hertz", 0.0, fastest_hertz);
  const auto phase = object.number("phase", -1.0, 1.0, Need::optional);
  if (!object.finish()) return false;
  if (*mean - *amplitude < reading.range.minimum || *mean + *amplitude > reading.range.maximum) {
    reading.diagnostics.add(DiagnosticId::scene_range, reading.document.where(node),
                            fmt::format("the sine of {} swings from {} to {}; expected {} to {}",
                                        reading.what, *mean - *amplitude, *mean + *amplitude,
                                        reading.range.minimum, reading.range.maximum));
    return false;
  }
  curve = Curve<double>(*mean);
  curve.amplitude = *amplitude;
  curve.hertz = *hertz;
  curve.phase = phase.value_or(0.0);
  return true;
}

bool read_sine(const Reading& reading, ObjectReader& parent, Curve<glm::dvec3>&) {
  reading.diagnostics.add(DiagnosticId::wrong_type, reading.document.where(parent.node()),
                          reading.what + " takes keyframes, not a sine");
  return false;
}

template <class T>
void read_any(ObjectReader& object, std::string_view key, const ValueRange& range, Need need,
              const Document& document, Diagnostics& diagnostics, Curve<T>& curve) {
  const NodeId node = object.any(key, need);
  if (!node.valid()) return;
  const Reading reading{document, diagnostics, range,
                        fmt::format("'{}' of {}", key, object.what())};
  if (document[node].kind == NodeKind::object) {
    ObjectReader inner(document, node, reading.what, diagnostics);
    const bool done =
        inner.has("sine") ? read_sine(reading, inner, curve) : read_keys(reading, inner, curve);
    if (done) inner.finish();
    return;
  }
  std::array<double, width_of(T{})> numbers{};
  if constexpr (width_of(T{}) == 1) {
    const auto number = dermis::read_number(document, node, reading.what, range.minimum,
                                            range.maximum, diagnostics);
    if (!number) return;
    numbers[0] = *number;
  } else if (!dermis::read_numbers(document, node, reading.what, numbers, range.minimum,
                                   range.maximum, diagnostics)) {
    return;
  }
  T value(0.0);
  put(value, numbers.data());
  curve = Curve<T>(value);
}

} // namespace

void read_curve(ObjectReader& object, std::string_view key, const ValueRange& range, Need need,
                const Document& document, Diagnostics& diagnostics, Curve<double>& curve) {
  read_any(object, key, range, need, document, diagnostics, curve);
}

void read_curve(ObjectReader& object, std::string_view key, const ValueRange& range, Need need,
                const Document& document, Diagnostics& diagnostics, Curve<glm::dvec3>& curve) {
  read_any(object, key, range, need, document, diagnostics, curve);
}

} // namespace demo
