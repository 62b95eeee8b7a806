// The profiles as kernels evaluate them on a device, against the fp64 shapes that truths are made of.
#include "framegraph/compile/compile.hpp"
#include "framegraph/vulkan/device_profile.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "passes/subsurface/environment.hpp"
#include "passes/subsurface/profile.hpp"
#include "tests/support/vulkan_fixture.hpp"

#include "test_profile.spv.h"

#include <cmath>
#include <numbers>

namespace dermis::subsurface {
namespace {

constexpr uint32_t width = 208, rows = 3;                               // of each profile
constexpr const char* files[] = {"skin", "skin_dipole", "skin_artist"}; // in configs/profiles
constexpr uint32_t height = rows * uint32_t(std::size(files));

// Where test_profile.comp looks.
double radius_in_d(uint32_t x) {
  return std::exp2(x / 16.0 - 8);
}
double survival_asked(uint32_t x) {
  return std::exp2(-(x / 16.0));
}

constexpr Port ports[] = {{"target", Usage::storage_image_write, false, "image2D", "", {}}};
KindRegistry profile_kind() {
  KindRegistry kinds;
  kinds.add({"test.profile", "test_profile", "", ports, {}, DispatchShape::over_view, false});
  return kinds;
}

Graph profile_graph() {
  Graph graph;
  ResourceDeclaration& values = graph.resources.emplace_back();
  values.name = "values";
  values.formats = {Format::rgba32f};
  values.exported = true;
  PassDeclaration& pass = graph.passes.emplace_back();
  pass.name = "profile";
  pass.kind = KindId{0};
  PortBinding target;
  target.port = 0;
  target.resource = ResourceId{0};
  graph.bind(pass, PortSide::write, target, {});
  return graph;
}

class ProfileKernel : public dermis::testing::VulkanTest {
protected:
  void SetUp() override {
    VulkanTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    for (uint32_t i = 0; i < std::size(files); ++i) {
      Diagnostics diagnostics;
      const auto document = read_document(
          DERMIS_SOURCE_DIR "/configs/profiles/" + std::string(files[i]) + ".json", diagnostics);
      ASSERT_TRUE(document) << files[i];
      const auto profile = read_profile(*document, diagnostics);
      ASSERT_TRUE(profile) << files[i];
      profiles.push_back({i + 1, *profile});
    }
    evaluate();
  }

  void evaluate() {
    vulkan::DeviceInput host;
    host.get_instance_proc_addr = get_instance_proc_addr;
    host.instance = instance;
    host.physical = physical;
    host.device = device;
    host.queue_family = queue_family;
    vulkan::Device dermis_device;
    const vulkan::Error made = vulkan::make_device(host, dermis_device);
    ASSERT_FALSE(made) << made.text;
    const DeviceProfile profile = vulkan::device_profile(dermis_device);
    const Graph graph = profile_graph();
    const KindRegistry kinds = profile_kind();
    CompileInput compiled;
    compiled.graph = &graph;
    compiled.kinds = &kinds;
    compiled.device = &profile;
    compiled.view_width = width;
    compiled.view_height = height;
    compiled.bound.assign(1, true);
    Diagnostics diagnostics;
    const auto plan = compile(compiled, diagnostics);
    ASSERT_TRUE(plan);

    const std::vector<ProfileEntry> entries = make_profile_table(profiles, false);
    const std::vector<RadialRow> radial = make_radial_table(profiles);
    const float nothing[4] = {};
    using vulkan::EnvironmentType;
    const auto buffer = [](auto& table) {
      const auto bytes = std::as_bytes(std::span(table));
      return vulkan::EnvironmentBinding{EnvironmentType::storage_buffer, bytes.size(), bytes};
    };
    const vulkan::EnvironmentBinding environment[] = {
        {EnvironmentType::uniform_buffer, sizeof(FrameConstants), {}},
        buffer(entries),
        buffer(nothing),
        {EnvironmentType::linear_sampler, 0, {}},
        buffer(nothing),
        buffer(radial),
        {EnvironmentType::counters, sizeof(FrameCounters), {}},
    };
    const vulkan::KernelCode kernel[] = {{"test_profile", test_profile_spirv}};
    vulkan::ExecutorInput input;
    input.device = &dermis_device;
    input.graph = &graph;
    input.kinds = &kinds;
    input.plan = &plan->plan;
    input.kernels = kernel;
    input.environment = environment;
    std::unique_ptr<vulkan::Executor> executor;
    const vulkan::Error error = vulkan::Executor::create(input, executor);
    ASSERT_FALSE(error) << error.text;

    const dermis::testing::TestImage image =
        make_image(VK_FORMAT_R32G32B32A32_SFLOAT, width, height, VK_IMAGE_USAGE_STORAGE_BIT);
    transition(image, VK_IMAGE_LAYOUT_GENERAL);
    constexpr vulkan::HostState at_rest{VK_IMAGE_LAYOUT_GENERAL, VK_QUEUE_FAMILY_IGNORED,
                                        VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                        VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
    const vulkan::HostImage bound[] = {{image.image, image.view, at_rest, at_rest}};
    FrameConstants constants{};
    constants.rect[2] = width;
    constants.rect[3] = height;
    vulkan::FrameInput frame;
    frame.command_buffer = begin_commands();
    frame.images = bound;
    frame.frame_constants = std::as_bytes(std::span(&constants, 1));
    frame.rectangle = {0, 0, width, height};
    frame.frame_index = 1;
    executor->record(frame);
    submit(frame.command_buffer);
    values = dermis::testing::values_of<float>(download(image, VK_IMAGE_LAYOUT_GENERAL));
    wait();
  }

  double at(size_t profile, uint32_t row, uint32_t x, size_t channel) const {
    return double(values[4 * ((profile * rows + row) * width + x) + channel]);
  }

  std::vector<NumberedProfile> profiles;
  std::vector<float> values;
};

TEST_F(ProfileKernel, DensityAndDistributionAreThoseOfTheShapes) {
  ASSERT_FALSE(values.empty());
  for (size_t i = 0; i < profiles.size(); ++i) {
    const Profile& profile = profiles[i].profile;
    const double d = profile.d_mm[static_cast<size_t>(profile.widest)];
    for (uint32_t x = 0; x < width; ++x)
      for (size_t c = 0; c < 3; ++c) {
        const double r = radius_in_d(x) * d, R = at(i, 0, x, c) / (2 * std::numbers::pi);
        const double truth = shape_R(profile.shape_mm[c], r), most = shape_R(profile.shape_mm[c], d / 256);
        // Tables are linear in log R over 1/24 octave; far out what is left of the largest value counts.
        EXPECT_NEAR(R, truth, 4e-3 * truth + 1e-9 * most)
            << files[i] << " R at " << r << " mm, channel " << c;
        EXPECT_NEAR(2 * std::numbers::pi * r * R, shape_pdf(profile.shape_mm[c], r),
                    4e-3 * shape_pdf(profile.shape_mm[c], r) + 1e-8 / d)
            << files[i] << " pdf at " << r << " mm, channel " << c;
        EXPECT_NEAR(1 - at(i, 1, x, c), shape_cdf(profile.shape_mm[c], r), 2e-4)
            << files[i] << " cdf at " << r << " mm, channel " << c;
      }
  }
}

TEST_F(ProfileKernel, InversesUndoTheDistribution) {
  ASSERT_FALSE(values.empty());
  for (size_t i = 0; i < profiles.size(); ++i) {
    const Profile& profile = profiles[i].profile;
    const ChannelShape& shape = profile.shape_mm[static_cast<size_t>(profile.widest)];
    const bool burley =
        i == 0; // a polynomial within .52 %, and exact weights; tables within a thousandth of d
    for (uint32_t x = 1; x < width; ++x) {
      const double r = at(i, 2, x, 0), truth = shape_inverse_survival(shape, survival_asked(x));
      EXPECT_NEAR(r, truth, (burley ? 5.2e-3 * truth : 0) + 1e-3 * shape.d)
          << files[i] << " " << survival_asked(x);
      // The density is the sampler's own: within some percent of the profile's.
      EXPECT_NEAR(at(i, 2, x, 1) / shape_pdf(shape, r), 1, 0.05) << files[i] << " " << survival_asked(x);
    }
  }
}

} // namespace
} // namespace dermis::subsurface
