#include "tests/properties/sequences.hpp"

#include "integration/tools/command/bench/dynamic/figures.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <algorithm>
#include <limits>

namespace properties {

using namespace dermis;
using namespace dermis::tools;

namespace {

constexpr uint32_t reference_pixels = 1024;

// The reference counts pixels of the rendered rectangle.
size_t in_picture(const FrameDescription& frame, uint32_t pixel) {
  const uint32_t x = pixel % frame.render.width, y = pixel / frame.render.width;
  return size_t{y + frame.render.y} * frame.width + x + frame.render.x;
}

// Returns the mean of the red channel over pixels with a profile.
double mean_where_scattering(const std::vector<float>& values,
                             const std::vector<uint8_t>& profile) {
  double sum = 0, pixels = 0;
  for (size_t i = 0; i < profile.size() && !values.empty(); ++i)
    if (profile[i] != 0) {
      sum += double(values[3 * i]);
      pixels += 1;
    }
  return pixels > 0 ? sum / pixels : 0;
}

} // namespace

std::string root() {
  return DERMIS_SOURCE_DIR;
}

TechniqueRequest request_of(const std::string& graph, const std::vector<NamedValue>& set) {
  return {graph, "", root() + "/" + dermis::shipped::graph_file(graph), set, false, {}};
}

Frames range(uint32_t first, uint32_t end) {
  Frames frames;
  for (uint32_t t = first; t < end; ++t)
    frames.push_back(t);
  return frames;
}

const Reference& Judge::at(uint32_t frame) {
  auto found = references.find(frame);
  if (found != references.end()) return found->second;
  Session quiet;
  quiet.quiet = true;
  return references
      .emplace(frame, *make_reference(quiet, sequence.frames[frame].captured, "truth",
                                      reference_pixels, ""))
      .first->second;
}

Sequence standing_still(Sequence sequence, uint32_t count) {
  SequenceFrame one = sequence.frames.front();
  one.captured.description.previous_clip_from_view = one.captured.description.clip_from_view;
  one.captured.description.previous_view_from_world = one.captured.description.view_from_world;
  one.captured.velocity = {};
  sequence.frames.assign(count, one);
  return sequence;
}

Sequence SequenceTest::frames_of(const std::string& scene, uint32_t first, uint32_t count,
                                 uint32_t width, uint32_t height) {
  auto sequence = render_sequence({scene, "close", root() + "/configs/scenes/" + scene + ".json",
                                   close_d_px, first, count, false},
                                  width, height, {});
  EXPECT_TRUE(sequence) << sequence.error().text;
  return sequence ? sequence.take() : Sequence{};
}

SequenceRun SequenceTest::run(Judge& judge, const TechniqueRequest& request, const Frames& judged,
                              const Follows& follows) {
  SequenceRun result;
  auto made = TechniqueRun::create(shared_host(), request,
                                   judge.sequence.frames.front().captured.description.profiles, {});
  EXPECT_TRUE(made) << made.error().text;
  if (!made) return result;
  std::vector<FrameLight> light;
  for (uint32_t t = 0; t < judge.sequence.frames.size(); ++t) {
    const SequenceFrame& frame = judge.sequence.frames[t];
    const bool is_judged = std::find(judged.begin(), judged.end(), t) != judged.end();
    // Without histories a frame does not depend on the earlier frames.
    if (t > 0 && !judged.empty() && !is_judged && (*made)->history_bytes() == 0) {
      result.samples.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    (*made)->skip_to(t + 1); // The first frame has number 1.
    auto found = (*made)->scatter(frame.captured, follows ? follows(t) : t > 0 && !frame.cut);
    EXPECT_TRUE(found) << found.error().text;
    auto sampling = (*made)->sampling();
    if (!found || !sampling) return result;
    result.samples.push_back(mean_where_scattering(*sampling, frame.captured.profile));
    if (!is_judged) continue;
    const Reference& reference = judge.at(t);
    FrameLight one{{}, reference.light};
    for (const uint32_t pixel : reference.pixels)
      for (size_t c = 0; c < 3; ++c)
        one.found.push_back(
            double((*found)[3 * in_picture(frame.captured.description, pixel) + c]));
    result.psnr_db[t] = sequence_figures({one}, 0, false, judge.sequence.exposure).psnr_db_frame;
    light.push_back(std::move(one));
    result.pictures[t] = found.take();
    result.sampling[t] = sampling.take();
  }
  result.mean_psnr_db = sequence_figures(light, 0, false, judge.sequence.exposure).psnr_db_frame;
  result.history_bytes = (*made)->history_bytes();
  return result;
}

} // namespace properties
