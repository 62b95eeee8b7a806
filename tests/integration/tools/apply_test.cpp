// Tests apply and reference on captures made by hand: the output, and the messages for wrong
// captures.

#include "tests/integration/tools/capture_builder.hpp"
#include "tests/integration/tools/command_fixture.hpp"

#include "integration/tools/files/exr.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dermis::test {
namespace {

class Captures : public CommandTest {
protected:
  Outcome apply(const std::vector<std::string>& more = {}, const RunOptions& options = {}) const {
    std::vector<std::string> words{"apply",         "--graph", burley,     "--frames",
                                   path("capture"), "--out",   path("out")};
    words.insert(words.end(), more.begin(), more.end());
    return run(words, options);
  }
  Outcome reference(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"reference", "--frames", path("capture"), "--out", path("out")};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  // Returns the only file with that name below `out`.
  tools::Image picture(const std::string& name) const {
    for (const std::string& file : files("out")) {
      if (std::filesystem::path(file).filename() != name) continue;
      const std::vector<tools::ChannelNames> names{{"R", "G", "B"}, {"Y"}};
      std::string problem;
      const auto image = tools::read_exr(path("out/" + file), names, problem);
      EXPECT_TRUE(image.has_value()) << problem;
      return image.value_or(tools::Image{});
    }
    ADD_FAILURE() << "no " << name;
    return {};
  }
};

TEST_F(Captures, EvenLightIsUnchanged) {
  write_plane(path("capture"));
  ASSERT_THAT(apply(), Succeeds("scatter", "ms"));
  // 0.5 and its mean with any weights are exact in fp16; the remaining error is the division of two
  // sums in fp32.
  for (const float value : picture("scattered.exr").values)
    EXPECT_NEAR(value, 0.5f, 1e-3f);
  for (const float value : picture("combined.exr").values)
    EXPECT_NEAR(value, 0.5f, 1e-3f);
}

TEST_F(Captures, NoValidationMessages) {
  write_plane(path("capture/frame_0000"));
  Plane other;
  other.width = 48; // Another size: the graph is resized with its histories.
  write_plane(path("capture/frame_0001"), other);
  RunOptions options;
  options.environment = validation_environment();
  for (const char* graph :
       {burley, "configs/graphs/separable.json", "configs/graphs/papers/sap_residual.json",
        "configs/graphs/papers/afis_guided.json"}) {
    const Outcome outcome = run({"apply", "--graph", graph, "--frames", path("capture"), "--out",
                                 path("out"), "--json", "--repeat", "3"},
                                options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    // A message of the layer would appear in the output.
    EXPECT_TRUE(is_json(outcome.out)) << outcome.out;
  }
}

TEST_F(Captures, NoScattering_ReturnsTheLightBitForBit) {
  Plane plane;
  plane.profiles = R"([{ "id": 1, "dmfp_mm": [0, 0, 0], "albedo": [1, 1, 1] }])";
  plane.light = tools::Image::sized(plane.width, plane.height, 3);
  for (size_t i = 0; i < plane.light.values.size(); ++i)
    plane.light.values[i] = std::sin(static_cast<float>(i)) + 1.1f;
  write_plane(path("capture"), plane);
  ASSERT_THAT(apply(), Succeeds());
  EXPECT_EQ(picture("scattered.exr").values, plane.light.values);
  // The colour is returned in half floats: 11 significant bits, rounded to nearest.
  const tools::Image combined = picture("combined.exr");
  for (size_t i = 0; i < combined.values.size(); ++i)
    EXPECT_NEAR(combined.values[i], plane.light.values[i], plane.light.values[i] * 0x1p-11f);
}

TEST_F(Captures, EvenLight_EqualsItsReference) {
  write_plane(path("capture"));
  ASSERT_THAT(reference(), Succeeds());
  for (const float value : picture("reference.exr").values)
    EXPECT_NEAR(value, 0.5f, 1e-6f);
}

TEST_F(Captures, FramesAreComparedWithTheirReferences) {
  Plane plane;
  plane.light = filled(plane.width, plane.height, 3, 0.25f);
  for (uint32_t y = 0; y < plane.height; ++y) // An edge that scatters.
    for (uint32_t x = 0; x < plane.width / 2; ++x)
      plane.light.at(x, y, 0) = plane.light.at(x, y, 1) = plane.light.at(x, y, 2) = 1.0f;
  write_plane(path("capture/frame_0000"), plane);
  write_plane(path("capture/frame_0001"), plane);
  ASSERT_EQ(apply({"--set", "samples=512"}).exit_code, 0);
  for (const std::string subset : {"0", "100"}) {
    ASSERT_EQ(run({"reference", "--frames", path("capture"), "--out", path("truth" + subset),
                   "--subset", subset})
                  .exit_code,
              0);
    EXPECT_THAT(run({"compare", path("out"), path("truth" + subset), "--min-psnr", "35"}),
                Succeeds("frame_0000/scattered.exr", "\nall ", subset == "0" ? "1024" : "100"));
  }
  std::filesystem::remove_all(path("out/frame_0001"));
  EXPECT_THAT(run({"compare", path("out"), path("truth0")}).err, HasSubstr("frame_0001"));
}

TEST_F(Captures, SubsetHasAMaskOfItsPixels) {
  write_plane(path("capture"));
  ASSERT_THAT(reference({"--subset", "100"}), Succeeds());
  const tools::Image mask = picture("mask.exr");
  EXPECT_EQ(std::count(mask.values.begin(), mask.values.end(), 1.0f), 100);
}

TEST_F(Captures, FilesOfAnEarlierRun_AreRemoved) {
  write_plane(path("capture"));
  ASSERT_THAT(reference({"--subset", "100"}), Succeeds());
  ASSERT_THAT(reference(), Succeeds());
  ASSERT_THAT(apply(), Succeeds());
  EXPECT_THAT(run({"compare", path("out"), path("out")}), Succeeds("\nall ", "1024"))
      << "the mask was that of 100 pixels";
  const std::string graph = write("light_only.json", read_text(burley));
  ASSERT_THAT(run({"apply", "--graph", graph, "--overlay", write("overlay.json", R"({
    "dermis_overlay": 2, "edits": [ { "remove": "/passes/export_scattered" },
      { "remove": "/resources/scattered_light" },
      { "set": "/exports", "to": ["lighting"] } ] })"),
                   "--frames", path("capture"), "--out", path("out")}),
              Succeeds());
  EXPECT_THAT(files("out"), Not(Contains(HasSubstr("scattered.exr"))));
}

// Noise follows frame_index, and repetitions for times change no picture.
TEST_F(Captures, FrameIndexSeedsTheSamples) {
  Plane plane;
  plane.light = tools::Image::sized(plane.width, plane.height, 3);
  for (size_t i = 0; i < plane.light.values.size(); ++i)
    plane.light.values[i] = i % 7 == 0 ? 4.0f : 0.0f;
  write_plane(path("capture"), plane);
  const std::string frame = read("capture/frame.json");
  const auto pictures = [&](const char* index, const char* repeat) {
    write("capture/frame.json",
          replaced(frame, "\"frame_index\": 1,", fmt::format("\"frame_index\": {},", index)));
    EXPECT_THAT(apply({"--repeat", repeat}), Succeeds());
    return picture("scattered.exr").values;
  };
  const std::vector<float> first = pictures("3", "1");
  EXPECT_EQ(pictures("3", "4"), first);
  EXPECT_NE(pictures("4", "1"), first);
}

TEST_F(Captures, NonFiniteValues_AreZeroCountedAndReported) {
  Plane plane;
  plane.light = filled(plane.width, plane.height, 3, 0.5f);
  plane.light.values[7] = std::numeric_limits<float>::quiet_NaN();
  plane.light.values[70] = std::numeric_limits<float>::infinity();
  write_plane(path("capture"), plane);
  const Outcome outcome = apply();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("2 values of subsurface pixels were not finite"));
  for (const float value : picture("scattered.exr").values)
    EXPECT_TRUE(std::isfinite(value));
  EXPECT_THAT(apply({"--json"}).out, HasSubstr("\"sanitised_values\": 2"));
}

TEST_F(Captures, TooBrightWithoutProfile_IsClampedToTheLargestFloat) {
  constexpr float maximum = std::numeric_limits<float>::max();
  Plane plane;
  plane.light = filled(plane.width, plane.height, 3, maximum);
  plane.profile = filled(plane.width, plane.height, 1, 0);
  write_plane(path("capture"), plane);
  write_channel(path("capture"), "albedo", filled(plane.width, plane.height, 3, 65504));
  write_channel(path("capture"), "specular", filled(plane.width, plane.height, 3, maximum));
  ASSERT_THAT(apply(), Succeeds());
  for (const float value : picture("combined.exr").values)
    EXPECT_EQ(value, maximum);
}

// No pass writes pixels outside of the rectangle; the device's old memory must not appear.
TEST_F(Captures, OutsideOfTheRectangle_LightIsUnchanged) {
  Plane plane;
  plane.light = filled(plane.width, plane.height, 3, 0.25f);
  write_plane(path("capture"), plane);
  write_channel(path("capture"), "albedo", filled(plane.width, plane.height, 3, 0.5f));
  write("capture/frame.json",
        replaced(read("capture/frame.json"), "[0, 0, 32, 32]", "[3, 5, 17, 11]"));
  ASSERT_THAT(apply(), Succeeds());
  for (const float value : picture("scattered.exr").values)
    EXPECT_NEAR(value, 0.25f, 1e-3f);
  for (const float value : picture("combined.exr").values)
    EXPECT_NEAR(value, 0.125f, 1e-3f);
}

TEST_F(Captures, ImageOfAnotherSize_IsNamed) {
  write_plane(path("capture"));
  write_channel(path("capture"), "depth", filled(31, 32, 1, 1.0f));
  EXPECT_THAT(apply(), FailsWith(1, "depth.exr", "31", "32"));
  EXPECT_THAT(files("out"), IsEmpty());
}

TEST_F(Captures, MissingProfileIsNamed) {
  Plane plane;
  plane.profiles = R"([{ "id": 1, "file": "skinn" }])";
  write_plane(path("capture"), plane);
  for (const Outcome& outcome : {apply(), reference()}) {
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasAll("frame.json:", "skinn"));
  }
  EXPECT_THAT(files("out"), IsEmpty());
}

TEST_F(Captures, AFolderWithoutFramesIsRejected) {
  std::filesystem::create_directories(path("capture"));
  EXPECT_THAT(apply(), FailsWith(1, "capture"));
}

TEST_F(Captures, UnwritableFolder_IsAnEnvironmentError) {
  write_plane(path("capture"));
  write("out", "a file, not a folder");
  for (const Outcome& outcome : {apply(), reference()}) {
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("output folder"));
  }
}

TEST_F(Captures, NoVulkanDriver_IsAnEnvironmentError) {
  write_plane(path("capture"));
  RunOptions options;
  options.environment = {"VK_ICD_FILENAMES=/nonexistent.json", "VK_DRIVER_FILES=/nonexistent.json"};
  EXPECT_THAT(apply({}, options), FailsWith(3, "Vulkan"));
  EXPECT_THAT(files("out"), IsEmpty());
}

TEST_F(Captures, JsonOutputIsOneDocument) {
  write_plane(path("capture"));
  EXPECT_THAT(apply({"--json", "--repeat", "2"}),
              Succeeds(IsJson(), "\"ok\": true", "\"device_ms\""));
  const Outcome bad =
      run({"apply", "--graph", burley, "--frames", path("none"), "--out", path("out"), "--json"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_TRUE(is_json(bad.out)) << bad.out;
}

} // namespace
} // namespace dermis::test
