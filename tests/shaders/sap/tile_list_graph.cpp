#include "tests/shaders/sap/tile_list_graph.hpp"

#include "passes/common/dispatch.hpp"

#include "test_sample_input.spv.h"
#include "test_sample_output.spv.h"

#include <algorithm>

namespace dermis::testing {

std::vector<OwnPassType> list_pass_types(std::span<const Port> inputs,
                                         std::span<const Port> outputs) {
  return {{{"test.input", "input", "", inputs, {}, subsurface::over_tile_grid},
           test_sample_input_spirv},
          {{"test.output", "output", "", outputs, {}, subsurface::over_written_image},
           test_sample_output_spirv}};
}

void expect_list(const BufferGraphAnswers& answers, size_t channel,
                 std::vector<uint32_t> expected) {
  ASSERT_EQ(answers.texels[0][channel], expected.size());
  std::vector<uint32_t> listed;
  for (size_t i = 1; i <= expected.size(); ++i)
    listed.push_back(answers.texels[i][channel]);
  std::sort(listed.begin(), listed.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_TRUE(listed == expected) << "channel " << channel;
}

void expect_arguments(const BufferGraphAnswers& answers, size_t length) {
  EXPECT_EQ(answers.texels[0][2], std::min<size_t>(length, 32768));
  EXPECT_EQ(answers.texels[1][2], ceil_div(length, 32768));
  EXPECT_EQ(answers.texels[2][2], 1u);
}

} // namespace dermis::testing
