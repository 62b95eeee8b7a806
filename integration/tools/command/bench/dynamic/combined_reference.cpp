#include "integration/tools/command/bench/dynamic/combined_reference.hpp"

#include "integration/tools/files/capture_reference.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

// A frame counts as a sum of known frames if no pixel differs by more than the rounding of half
// floats, 2^-11 of each of three frames, relative to the brightest light.
constexpr double little_light = 3.0 / 2048;

std::vector<float> light_of(const ReferenceFrame& frame) {
  std::vector<float> light;
  for (size_t i = 0; i < frame.profile.size(); ++i)
    if (frame.profile[i] != 0)
      light.insert(light.end(), &frame.light[3 * i], &frame.light[3 * i] + 3);
  return light;
}

double dot(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i)
    sum += double(a[i]) * double(b[i]);
  return sum;
}

float largest(const std::vector<float>& values) {
  float maximum = 0;
  for (const float value : values)
    maximum = std::max(maximum, std::abs(value));
  return maximum;
}

} // namespace

std::optional<Reference> make_reference_of_still(const Session& session, const CapturedFrame& frame,
                                                 const std::string& what, uint32_t subset,
                                                 const std::string& cache, KnownReferences& known) {
  std::vector<float> rest = light_of(make_reference_frame(frame));
  const float brightest = largest(rest);
  std::vector<double> fraction, reference(known.first.light.size());
  const bool comparable = known.known.empty() || known.known.front().light.size() == rest.size();
  for (const KnownReferences::Known& one : known.known) {
    if (!comparable) break;
    fraction.push_back(dot(rest, one.light));
    for (size_t i = 0; i < rest.size(); ++i)
      rest[i] -= static_cast<float>(fraction.back() * double(one.light[i]));
    for (size_t i = 0; i < reference.size(); ++i)
      reference[i] += fraction.back() * one.reference[i];
  }
  if (!known.known.empty() && comparable &&
      double(largest(rest)) <= little_light * double(brightest)) {
    Reference combined = known.first;
    combined.light = std::move(reference);
    combined.exposure = frame.description.exposure;
    return combined;
  }
  auto made = make_reference(session, frame, what, subset, cache);
  if (!made || !comparable || known.known.size() >= max_known_references) return made;
  if (known.known.empty()) known.first = *made;
  const double length = std::sqrt(dot(rest, rest));
  if (!(length > 0) || made->pixels != known.first.pixels) return made;
  KnownReferences::Known one{std::move(rest), made->light};
  for (size_t k = 0; k < fraction.size(); ++k)
    for (size_t i = 0; i < one.reference.size(); ++i)
      one.reference[i] -= fraction[k] * known.known[k].reference[i];
  for (double& value : one.reference)
    value /= length;
  for (float& value : one.light)
    value = static_cast<float>(double(value) / length);
  known.known.push_back(std::move(one));
  return made;
}

} // namespace dermis::tools
