// Compares techniques through the demo engine's temporal anti-aliasing with the same techniques at
// so many samples that only their own error is left.
#include "tests/framegraph/test_scale.hpp"
#include "tests/properties/sequences.hpp"

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/files/metrics.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <cmath>

namespace {

using namespace dermis::tools;

struct Taa : properties::DeviceTest {
  using Pictures = std::vector<demo::FloatImage>;

  static Pictures resolved(const std::string& graph,
                           std::vector<std::pair<std::string, std::string>> settings, bool resting,
                           uint32_t frames) {
    demo::RenderOptions options;
    // Less than a pixel per frame at this size.
    options.scene = properties::root() + "/configs/scenes/pan.json";
    options.graph = properties::root() + "/" + dermis::shipped::graph_file(graph);
    options.settings = std::move(settings);
    options.width = 160;
    options.height = 90;
    options.zoom = 2;
    options.first_frame = 40;
    options.frames = frames;
    options.taa = true;
    options.validation = true;
    if (resting) options.camera = demo::CameraPlace{{-0.12, 0.03, 0.50}, {0.0, 0.005, 0.07}, 24};
    Pictures pictures;
    demo::RenderCallbacks callbacks;
    callbacks.on_frame = [&](const demo::FrameOutputs& frame) {
      pictures.push_back(frame.color);
      return demo::success();
    };
    const auto summary = demo::render(options, callbacks);
    EXPECT_TRUE(summary) << summary.error().text;
    if (summary)
      for (const std::string& message : summary->validation_messages)
        ADD_FAILURE() << message;
    return pictures;
  }

  struct Figures {
    double psnr_db = 0, flicker = 0;
  };
  static Figures compare(const Pictures& found, const Pictures& reference, uint32_t counted) {
    double squares = 0, changes = 0, values = 0;
    std::vector<double> last;
    for (size_t t = counted; t < found.size(); ++t) {
      std::vector<double> error(found[t].texels.size());
      for (size_t i = 0; i < error.size(); ++i)
        error[i] = double(found[t].texels[i]) - double(reference[t].texels[i]);
      for (size_t i = 0; i < error.size(); ++i) {
        squares += error[i] * error[i];
        if (!last.empty()) changes += (error[i] - last[i]) * (error[i] - last[i]);
        values += 1;
      }
      last = std::move(error);
    }
    return {psnr_from_mse(squares / values), std::sqrt(changes / values)};
  }

  // docs/papers.md quotes the recorded numbers. `min_gain_db` is the gain of sap_residual over sap.
  void judge(bool resting, double min_gain_db) {
    constexpr uint32_t frames = 32, counted = 24;
    const Pictures reference = resolved("burley", {{"samples", "192"}}, resting, frames);
    const Figures sap = compare(resolved("sap", {}, resting, frames), reference, counted),
                  residual =
                      compare(resolved("sap_residual", {}, resting, frames), reference, counted),
                  afis = compare(
                      resolved("afis", {{"samples", "8"}, {"lod_bias", "-1.5"}}, resting, frames),
                      reference, counted);
    for (const auto& [name, figures] :
         {std::pair{"sap", sap}, std::pair{"sap_residual", residual}, std::pair{"afis_8", afis}}) {
      RecordProperty(std::string(name) + "_db", std::to_string(figures.psnr_db));
      RecordProperty(std::string(name) + "_flicker", std::to_string(figures.flicker));
    }
    EXPECT_GE(residual.psnr_db, sap.psnr_db + min_gain_db);
    EXPECT_GE(residual.psnr_db, afis.psnr_db);
    EXPECT_LE(residual.flicker, afis.flicker);
    EXPECT_LE(sap.flicker, afis.flicker);
  }
};

TEST_F(Taa, CameraAtRest_RefinedBeatsEightSamples) {
  judge(true, 1.5); // Regression bound: measured 2.0 dB.
}

TEST_F(Taa, SubpixelPan_RefinedBeatsEightSamples) {
  DERMIS_FULL_TESTS_ONLY();
  // Regression bound: measured 2.3 dB. It was 4.1 dB when noise of samples was accepted on folds.
  judge(false, 1.8);
}

} // namespace
