#include "tests/properties/head_frames.hpp"

#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/files/metrics.hpp"
#include "tests/properties/sequences.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace properties {

using namespace dermis;
using namespace dermis::tools;

namespace {

constexpr double scan_height_m = 0.426;      // 0.24 m from chin to crown.
constexpr double step_m = 1e-3, step_px = 4; // A depth step is larger than both.
constexpr double edge_min_px = 2, edge_max_px = 12;
constexpr float sure_from = 0.95f; // confidence

// Returns the pixels within d (2 to 12 pixels) of a depth step or of another material.
std::vector<bool> near_edges(const ReferenceFrame& frame) {
  const int width = static_cast<int>(frame.width), height = static_cast<int>(frame.height);
  const double pixel = std::sqrt(std::abs(frame.rays.scale_x * frame.rays.scale_y));
  const auto index = [&](int x, int y) { return size_t(y) * frame.width + size_t(x); };
  std::vector<std::array<int, 2>> steps;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const auto& [i, j] : {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (x + i < 0 || y + j < 0 || x + i >= width || y + j >= height) continue;
        const size_t here = index(x, y), there = index(x + i, y + j);
        if (frame.profile[here] == 0) break;
        const double depth = double(frame.depth[here]), other = double(frame.depth[there]);
        if (frame.profile[there] != frame.profile[here] ||
            std::abs(depth - other) > std::max(step_m, step_px * pixel * std::min(depth, other))) {
          steps.push_back({x, y});
          break;
        }
      }
  std::vector<bool> near(frame.profile.size());
  constexpr int reach = static_cast<int>(edge_max_px);
  for (const auto& [x, y] : steps)
    for (int v = std::max(0, y - reach); v <= std::min(height - 1, y + reach); ++v)
      for (int u = std::max(0, x - reach); u <= std::min(width - 1, x + reach); ++u) {
        const size_t i = index(u, v);
        if (frame.profile[i] == 0 || near[i]) continue;
        const subsurface::PerChannel& d = frame.d_m[frame.profile[i]];
        const double d_px = std::max({d[0], d[1], d[2]}) / (pixel * double(frame.depth[i]));
        near[i] = std::hypot(u - x, v - y) <= std::clamp(d_px, edge_min_px, edge_max_px);
      }
  return near;
}

double rms(double squares, size_t count) {
  return count > 0 ? std::sqrt(squares / double(count)) : 0;
}

} // namespace

std::vector<HeadFraming> head_framings() {
  return {{"scan_close", true, {{0.0, 0.10, 0.219}, {0.0, 0.10, 0.12}, 25}},
          {"scan_profile", true, {{0.29, 0.08, 0.07}, {0.06, 0.08, 0.06}, 25}},
          {"scan_whole", true, {{0.0, 0.0, 2.165}, {0.0, 0.0, 0.0}, 25}},
          {"bust_close", false, {{0.0, 0.01, 0.18}, {0.0, 0.01, 0.09}, 25}},
          {"bust_profile", false, {{-0.35, 0.0, 0.05}, {-0.06, 0.0, 0.04}, 25}},
          {"bust_whole", false, {{0.0, 0.0, 2.165}, {0.0, 0.0, 0.0}, 25}}};
}

void HeadTest::show(const HeadFraming& framing, uint32_t width, uint32_t height, uint32_t maximum) {
  // Rendering creates another device, and Vulkan functions are loaded for one device at a time.
  SubjectOptions options{width, height, {}};
  if (framing.scan) {
    const char* named = std::getenv("DERMIS_HEAD");
    const bool is_named = named != nullptr && *named != '\0';
    const std::string folder = is_named ? named : root() + "/../shared/data/head";
    if (!is_named && !std::filesystem::exists(folder))
      GTEST_SKIP() << "no scanned head: DERMIS_HEAD names no folder, and " << folder
                   << " is not there";
    options.model = {folder + "/LeePerrySmith.glb", folder + "/Map-COL.jpg",
                     folder + "/Infinite-Level_02_Tangent_SmoothUV.jpg", folder + "/Map-SPEC.jpg",
                     scan_height_m};
  }
  const std::string scene =
      root() + (framing.scan ? "/configs/scenes/head_study.json" : "/configs/scenes/bust.json");
  auto subject = render_subject(
      {"head", framing.name, {}, scene, framing.camera, {}, framing.scan, false}, options);
  ASSERT_TRUE(subject) << subject.error().text;
  frame_ = subject.take().frame;
  Session quiet;
  quiet.quiet = true;
  reference_ = *make_reference(quiet, frame_, "truth", maximum, "");
  edge_ = near_edges(make_reference_frame(frame_));
}

double HeadTest::luminance_at(const std::vector<float>& light, size_t pixel) const {
  return luminance_of(&light[3 * pixel]) * reference_.exposure;
}

HeadErrors HeadTest::errors_of(const std::vector<float>& light,
                               const std::vector<float>* confidence) const {
  double all = 0, edge = 0, inner = 0, sure = 0;
  std::vector<double> at_edges;
  size_t sure_count = 0;
  const size_t count = reference_.pixels.size();
  for (size_t i = 0; i < count; ++i) {
    const uint32_t pixel = reference_.pixels[i];
    const double reference = luminance_of(&reference_.light[3 * i]) * reference_.exposure;
    const double error = luminance_at(light, pixel) - reference;
    all += error * error;
    (edge_[pixel] ? edge : inner) += error * error;
    if (edge_[pixel]) at_edges.push_back(std::abs(error));
    if (confidence == nullptr || (*confidence)[pixel] < sure_from) continue;
    sure += error * error;
    ++sure_count;
  }
  HeadErrors errors{.rmse = rms(all, count),
                    .edge = rms(edge, at_edges.size()),
                    .inner = rms(inner, count - at_edges.size()),
                    .sure = rms(sure, sure_count),
                    .unsure_pixels = 1 - double(sure_count) / double(count)};
  if (!at_edges.empty()) {
    std::sort(at_edges.begin(), at_edges.end());
    errors.edge_p99 = at_edges[static_cast<size_t>(0.99 * double(at_edges.size() - 1) + 0.5)];
  }
  return errors;
}

std::vector<float> HeadTest::scatter(const std::string& graph, const std::vector<NamedValue>& set,
                                     uint32_t frames, double* samples) {
  TechniqueRequest request = request_of(graph, set);
  if (!overlay_.empty()) request.overlays = {root() + "/configs/overlays/" + overlay_ + ".json"};
  auto run = TechniqueRun::create(shared_host(), request, frame_.description.profiles, {});
  EXPECT_TRUE(run) << run.error().text;
  if (!run) return {};
  CapturedFrame frame = frame_;
  frame.description.previous_clip_from_view = frame.description.clip_from_view;
  frame.description.previous_view_from_world = frame.description.view_from_world;
  std::vector<float> found;
  double taken = 0, pixels = 0;
  for (uint32_t t = 0; t < frames; ++t) {
    auto light = (*run)->scatter(frame, t > 0);
    EXPECT_TRUE(light) << light.error().text;
    if (!light) return {};
    found = light.take();
  }
  if (samples == nullptr) return found;
  const auto sampling = (*run)->sampling();
  EXPECT_TRUE(sampling) << sampling.error().text;
  for (size_t i = 0; sampling && !sampling->empty() && i < frame.profile.size(); ++i)
    if (frame.profile[i] != 0) {
      taken += double((*sampling)[3 * i]);
      pixels += 1;
    }
  *samples = pixels > 0 ? taken / pixels : 0;
  return found;
}

subsurface::SapResult<float> HeadTest::cpu_kernel(const CapturedFrame& frame,
                                                  subsurface::SapVariant variant,
                                                  uint32_t first_layered) {
  const std::vector<float> table = subsurface::make_sap_table(subsurface::fit_sap_weights(variant));
  const ReferenceFrame reference = make_reference_frame(frame);
  return subsurface::sap_scatter<float>(reference.input(), table,
                                        {.variant = variant, .first_layered = first_layered});
}

} // namespace properties
