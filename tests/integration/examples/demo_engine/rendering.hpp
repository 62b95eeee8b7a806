#pragma once
// Runs renderings that must succeed without messages of the validation layer.
#include "integration/examples/demo_engine/engine.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace demo {

struct Rendering {
  std::vector<FrameOutputs> frames; // Empty: the test has failed.
  std::vector<std::string> warnings;
};

inline Rendering rendered(const RenderOptions& options, RenderCache* cache = nullptr) {
  Rendering out;
  RenderCallbacks callbacks;
  callbacks.on_start = [&](const RenderInfo& info) {
    out.warnings = info.warnings;
    return success();
  };
  callbacks.on_frame = [&](const FrameOutputs& frame) {
    out.frames.push_back(frame);
    return success();
  };
  const auto summary = render(options, callbacks, cache);
  if (!summary) {
    ADD_FAILURE() << summary.error().text;
    return {};
  }
  EXPECT_THAT(summary->validation_messages, testing::IsEmpty());
  EXPECT_EQ(out.frames.size(), options.frames);
  return out;
}

} // namespace demo
