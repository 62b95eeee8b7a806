// dermis bench truth: compares known results with those of formulas, the reference and the
// techniques.

#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/bench/suite/techniques.hpp"
#include "integration/tools/command/bench/truth/truth_file.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/files/capture_reference.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

demo::Result<std::vector<float>> scatter_exactly(const CapturedFrame& frame) {
  const ReferenceFrame reference = make_reference_frame(frame);
  const subsurface::ReferenceInput input = reference.input();
  std::vector<float> light(reference.light);
  if (subsurface::is_planar(input)) {
    const std::vector<double> everywhere = subsurface::reference_everywhere(input);
    std::copy(everywhere.begin(), everywhere.end(), light.begin());
    return light;
  }
  // Only the evaluated pixels: a band around the middle row.
  std::vector<uint32_t> pixels;
  for (uint32_t i = 0; i < reference.profile.size(); ++i)
    if (is_looked_at(i % reference.width, i / reference.width)) pixels.push_back(i);
  const std::vector<double> values = subsurface::reference_at(input, pixels);
  for (size_t i = 0; i < pixels.size(); ++i)
    for (size_t c = 0; c < 3; ++c)
      light[3 * size_t{pixels[i]} + c] = static_cast<float>(values[3 * i + c]);
  return light;
}

Scatter until_interrupted(Scatter scatter) {
  return [scatter =
              std::move(scatter)](const CapturedFrame& frame) -> demo::Result<std::vector<float>> {
    if (interrupted()) return stopped();
    return scatter(frame);
  };
}

demo::Result<> measure_truth(SuiteRun& run, const Emit<PropertyRow>& emit) {
  auto read = run.read(read_property_file);
  if (!read) return read.error();
  PropertyFile file = read.take();
  if (run.quick) keep_few(file.techniques);
  const auto host = run.open_device();
  if (!host) return host.error();
  const auto measure = [&](const PropertySubject& subject) -> demo::Result<> {
    const auto measured = plane_properties(subject);
    if (!measured) return measured.error();
    for (const PropertyRow& row : *measured)
      emit(row);
    return demo::success();
  };
  for (const PropertyRow& row : formula_properties())
    emit(row);
  Progress progress = run.progress("technique", file.techniques.size() + 1);
  if (auto done = measure({"truth", until_interrupted(scatter_exactly), file.reference}); !done)
    return done;
  uint64_t done = 1;
  const std::vector<CaptureProfile> profiles = property_profiles();
  for (const PropertyTechnique& technique : file.techniques) {
    progress.update(done++);
    if (!is_usable(run, technique)) continue;
    const auto made = TechniqueRun::create(**host, technique, profiles, {});
    if (!made) return made.error();
    const Scatter scatter = [&](const CapturedFrame& frame) { return (*made)->scatter(frame); };
    if (auto measured =
            measure({name_of(technique), until_interrupted(scatter), technique.tolerances});
        !measured)
      return measured;
  }
  return demo::success();
}

} // namespace

Suite truth_suite() {
  using Row = PropertyRow;
  return make_suite<Row>(
      {.name = "truth",
       .what = "Compare every technique with known results",
       .title = "Known results",
       .summary = "Required and measured results of planes, edges, discs and steps. Rows without a "
                  "tolerance "
                  "are only reported.",
       .options = {file_option("tests/benchmark/truth.json", "Techniques and tolerances")}},
      {{"property", "property", &Row::property},
       {"technique", "technique", &Row::technique, {.groups = true}},
       {"expected", "expected", &Row::expected, {7}},
       {"measured", "measured", &Row::measured, {7}},
       {"tolerance", "tolerance", &Row::tolerance},
       {"holds",
        "holds",
        [](const Row& row) { return row.tolerance ? std::optional(row.holds()) : std::nullopt; },
        {.goal = Goal::required}}},
      measure_truth);
}

} // namespace dermis::tools
