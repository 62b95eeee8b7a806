// dermis reference: computes the exact scattered light of captured frames in double precision and
// writes EXR images.

#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/run/captured.hpp"
#include "integration/tools/command/run/reference_run.hpp"
#include "integration/tools/command/verbs.hpp"
#include "integration/tools/files/capture_reference.hpp"
#include "integration/tools/files/exr.hpp"

#include <fmt/format.h>

#include <chrono>
#include <numeric>

namespace dermis::tools {
namespace {

// Results at their image positions. Other pixels hold the input light.
struct FrameReference {
  Image light, mask; // mask: 1 where the reference was computed
  uint64_t pixels = 0;
};

std::vector<uint32_t> chosen_pixels(const ReferenceFrame& frame, uint32_t subset) {
  if (subset > 0)
    return subsurface::stratified_subset(frame.width, frame.height, frame.profile, subset);
  std::vector<uint32_t> all;
  for (uint32_t i = 0; i < frame.profile.size(); ++i)
    if (frame.profile[i] != 0) all.push_back(i);
  return all;
}

std::optional<std::vector<double>> solve(const Session& session, const ReferenceFrame& frame,
                                         const std::string& name,
                                         const std::vector<uint32_t>& pixels) {
  const subsurface::ReferenceInput input = frame.input();
  if (!subsurface::is_planar(input)) return run_reference(session, name, input, pixels);
  // by FFT, takes seconds
  const std::vector<double> everywhere = subsurface::reference_everywhere(input);
  std::vector<double> chosen;
  for (const uint32_t pixel : pixels)
    chosen.insert(chosen.end(), everywhere.begin() + 3 * std::ptrdiff_t{pixel},
                  everywhere.begin() + 3 * std::ptrdiff_t{pixel} + 3);
  return chosen;
}

std::optional<FrameReference> compute_reference(const Session& session,
                                                const CapturedFrame& captured,
                                                const std::string& name, uint32_t subset) {
  const ReferenceFrame frame = make_reference_frame(captured);
  const std::vector<uint32_t> pixels = chosen_pixels(frame, subset);
  const auto reference = solve(session, frame, name, pixels);
  if (!reference) return std::nullopt;
  FrameReference made{captured.lighting,
                      Image::sized(captured.lighting.width, captured.lighting.height, 1),
                      pixels.size()};
  const Rectangle& render = captured.description.render;
  for (size_t i = 0; i < pixels.size(); ++i) {
    const uint32_t x = render.x + pixels[i] % frame.width, y = render.y + pixels[i] / frame.width;
    made.mask.at(x, y, 0) = 1.0f;
    for (uint32_t c = 0; c < 3; ++c)
      made.light.at(x, y, c) = static_cast<float>((*reference)[i * 3 + c]);
  }
  return made;
}

std::string write_reference(const FrameReference& made, const std::string& name, bool with_mask,
                            OutputFolder& out) {
  std::string problem = out.open_below(name);
  if (!problem.empty()) return problem;
  if (!write_exr(out.path_of(name + "/reference.exr"), made.light, {"R", "G", "B"}, problem))
    return problem;
  if (!with_mask) out.remove(name + "/mask.exr"); // of an earlier run
  if (with_mask && !write_exr(out.path_of(name + "/mask.exr"), made.mask, {"Y"}, problem))
    return problem;
  return "";
}

} // namespace

ExitCode reference(const Session& session, const ReferenceOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const auto sequence = check_sequence(session, options.frames, options.profiles, options.roots);
  if (!sequence) return ExitCode::problems;
  OutputFolder out;
  if (const std::string problem = out.open(options.out); !problem.empty())
    return fail(session, ExitCode::environment, problem);

  uint64_t pixels = 0;
  for (size_t i = 0; i < sequence->folders.size(); ++i) {
    const std::optional<CapturedFrame> captured = load_frame(*sequence, i);
    if (!captured)
      return fail(session, ExitCode::problems, "the capture changed while it was read");
    const std::optional<FrameReference> made =
        compute_reference(session, *captured, sequence->names[i], options.subset);
    if (!made || interrupted()) return fail(session, ExitCode::interrupted, "stopped");
    const std::string problem = write_reference(*made, sequence->names[i], options.subset > 0, out);
    if (!problem.empty()) return fail(session, ExitCode::environment, problem);
    pixels += made->pixels;
  }
  warn_of_earlier("reference", options.out, *sequence, {"reference.exr", "mask.exr"});
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  say(session, fmt::format("{}, {} pixels in {}; the reference is in {}\n",
                           format_count(sequence->folders.size(), "frame"), pixels,
                           format_duration(seconds), options.out));
  if (session.json) {
    JsonWriter answer;
    answer.open_object()
        .member("ok", true)
        .member("frames", static_cast<uint64_t>(sequence->folders.size()));
    answer.member("pixels", pixels).member("seconds", seconds).member("out", options.out);
    answer.member("sanitised_values", sequence->sanitised_values).close();
    print(std::move(answer).finish());
  }
  return ExitCode::ok;
}

} // namespace dermis::tools
