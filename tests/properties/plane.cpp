#include "tests/properties/plane.hpp"

#include "integration/tools/command/run/device_graph.hpp"
#include "passes/common/profiles/burley_profile.hpp"
#include "tests/support/shipped_graphs.hpp"
#include "tests/support/text_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>

namespace properties {

namespace {

// Returns a profile with the given shape parameters in metres: at albedo 0.33 the scaling is 3.5.
std::string profile_text(const Plane& plane) {
  if (!plane.profile_file.empty()) return plane.profile_file;
  auto dmfp = [&](size_t c) {
    return plane.d_px[c] * plane.pixel_pitch_m * 1000 *
           dermis::subsurface::burley_scaling_dmfp(0.33);
  };
  return fmt::format(R"({{"dermis_profile": 1, "name": "plane", "source": "test",
                          "dmfp_mm": [{:.12g}, {:.12g}, {:.12g}], "albedo": [0.33, 0.33, 0.33]}})",
                     dmfp(0), dmfp(1), dmfp(2));
}

// Looks down -z with one pixel pitch and clip space y down. The depth range has no effect, because
// the frame contains view depth.
std::array<float, 16> orthographic(double width_m, double height_m) {
  std::array<float, 16> m{};
  m[0] = static_cast<float>(2 / width_m);
  m[5] = static_cast<float>(-2 / height_m);
  m[10] = -0.01f;
  m[15] = 1;
  return m;
}

// As orthographic() at a depth of 1 m.
std::array<float, 16> perspective(double width_m, double height_m) {
  constexpr float near = 0.01f, far = 100.0f;
  std::array<float, 16> m{};
  m[0] = static_cast<float>(2 / width_m);
  m[5] = static_cast<float>(-2 / height_m);
  m[10] = far / (near - far);
  m[11] = near * far / (near - far);
  m[14] = -1;
  return m;
}

struct Uploads {
  std::vector<float> light, depth, id, earlier_id, scale, thickness;
};

Uploads fill(const Plane& plane) {
  Uploads out;
  for (uint32_t y = 0; y < plane.height; ++y)
    for (uint32_t x = 0; x < plane.width; ++x) {
      const int ix = static_cast<int>(x), iy = static_cast<int>(y);
      const float value = plane.light(x, y);
      out.light.insert(out.light.end(), {value, value, value});
      out.depth.push_back(plane.depth_m(ix, iy));
      out.id.push_back(plane.profile(ix, iy));
      if (plane.earlier_profile) out.earlier_id.push_back(plane.earlier_profile(ix, iy));
      if (plane.thickness_m) out.thickness.push_back(plane.thickness_m(ix, iy));
      out.scale.push_back(plane.scatter_scale ? plane.scatter_scale(ix, iy) : 1.0f);
    }
  return out;
}

// Destroys the hosts before main() returns: validation layers do not live longer.
class Hosts : public ::testing::Environment {
public:
  void TearDown() override { hosts.clear(); }

  std::map<demo::KernelShape, std::unique_ptr<demo::VulkanHost>> hosts;
};

Hosts& all = static_cast<Hosts&>(*::testing::AddGlobalTestEnvironment(new Hosts));

} // namespace

demo::VulkanHost& shared_host(demo::KernelShape kernels) {
  std::unique_ptr<demo::VulkanHost>& host = all.hosts[kernels];
  if (host == nullptr) {
    auto made = demo::create_vulkan_host({.validation = true, .device = "", .kernels = kernels});
    if (!made) throw std::runtime_error(made.error().text);
    host = made.take();
  }
  return *host;
}

void report_messages() {
  for (const auto& [kernels, host] : all.hosts) {
    const std::lock_guard lock(host->log.mutex);
    for (const std::string& message : host->log.messages)
      ADD_FAILURE() << message;
    host->log.messages.clear();
  }
}

const std::string& missing() {
  static const std::string reason = [] {
    const auto host = demo::create_vulkan_host({.validation = true, .device = ""});
    return host ? std::string() : host.error().text;
  }();
  return reason;
}

Picture run(const std::string& graph, const Plane& plane, const Settings& settings) {
  Picture result;
  run_frames(graph, plane, settings, 1, [&](const Picture& picture) { result = picture; });
  return result;
}

void run_frames(const std::string& graph, const Plane& plane, const Settings& settings,
                uint32_t frames, const std::function<void(const Picture&)>& each) {
  dermis::tools::DeviceGraphRequest request;
  request.graph_name = graph + ".json";
  request.graph_text =
      dermis::test::read_text(DERMIS_SOURCE_DIR "/" + dermis::shipped::graph_file(graph));
  if (!plane.overlay.empty())
    request.overlays = {
        {plane.overlay + ".json", dermis::test::read_text(DERMIS_SOURCE_DIR "/configs/overlays/" +
                                                          plane.overlay + ".json")}};
  request.width = plane.width;
  request.height = plane.height;
  request.pixel_aspect = plane.pixel_aspect;
  request.profiles = {{1, "one", profile_text(plane)}, {2, "two", profile_text(plane)}};
  request.formats = {{"lighting", VK_FORMAT_R32G32B32A32_SFLOAT},
                     {"depth", VK_FORMAT_R32_SFLOAT},
                     {"scattered_light", VK_FORMAT_R32G32B32A32_SFLOAT}};
  request.unbound = {"albedo", "velocity", "importance"};
  if (plane.scatter_scale)
    request.formats.emplace_back("scatter_scale", VK_FORMAT_R32_SFLOAT);
  else
    request.unbound.push_back("scatter_scale");
  if (plane.thickness_m) {
    request.formats.emplace_back("thickness", VK_FORMAT_R32_SFLOAT);
    request.formats.emplace_back("back_lighting", VK_FORMAT_R32G32B32A32_SFLOAT);
  } else {
    request.unbound.insert(request.unbound.end(), {"thickness", "back_lighting"});
  }
  request.settings = settings;
  {
    auto device = dermis::tools::DeviceGraph::create(shared_host(plane.kernels), request);
    if (!device) {
      ADD_FAILURE() << device.error().text;
      return;
    }
    const Uploads uploads = fill(plane);
    const auto upload = [&](const char* slot, std::span<const float> texels, uint32_t channels) {
      const auto result = (*device)->upload(slot, texels, channels);
      EXPECT_TRUE(result) << result.error().text;
    };
    upload("lighting", uploads.light, 3);
    upload("depth", uploads.depth, 1);
    upload("material", uploads.id, 1);
    upload("scatter_scale", uploads.scale, 1);
    upload("thickness", uploads.thickness, 1);
    upload("back_lighting", std::vector<float>(3 * uploads.thickness.size(), 1.0f), 3);

    dermis_frame frame = DERMIS_FRAME_INIT;
    const auto& r = plane.rectangle;
    frame.rect_x = r[0];
    frame.rect_y = r[1];
    frame.rect_width = r[2];
    frame.rect_height = r[3];
    const uint32_t w = r[2] != 0 ? r[2] : plane.width, h = r[2] != 0 ? r[3] : plane.height;
    const double stretch = std::sqrt(plane.pixel_aspect);
    const double width_m = w * plane.pixel_pitch_m * stretch,
                 height_m = h * plane.pixel_pitch_m / stretch;
    const auto clip =
        plane.perspective ? perspective(width_m, height_m) : orthographic(width_m, height_m);
    constexpr float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    for (size_t i = 0; i < 16; ++i) {
      frame.clip_from_view[i] = frame.previous_clip_from_view[i] = clip[i];
      frame.view_from_world[i] = frame.previous_view_from_world[i] = identity[i];
    }
    frame.metres_per_unit = 1;
    frame.depth_kind = DERMIS_DEPTH_VIEW_UNITS;
    for (uint32_t i = 0; i < frames; ++i) {
      if (plane.earlier_profile)
        upload("material", i + 1 < frames ? uploads.earlier_id : uploads.id, 1);
      // The graph has written scattered light there.
      if (i > 0) upload("lighting", uploads.light, 3);
      (*device)->skip_to(1 + uint64_t{i} * plane.frame_step);
      frame.flags = i + 1 == plane.cut_frame ? DERMIS_FRAME_RESET_HISTORY : 0;
      const auto ran = (*device)->run(frame);
      EXPECT_TRUE(ran) << ran.error().text;
      auto pixels = (*device)->read_rgb("scattered_light");
      if (!ran || !pixels) {
        ADD_FAILURE() << (ran ? pixels.error().text : ran.error().text);
        return;
      }
      each({plane.width, plane.height, std::move(*pixels)});
    }
  }
  report_messages();
}

} // namespace properties
