#include "tests/shaders/sap/buffer_graph.hpp"

#include "framegraph/model/read_graph.hpp"
#include "framegraph/text/diagnostic.hpp"
#include "passes/common/dispatch.hpp"
#include "passes/common/kernels.hpp"
#include "passes/common/pass_types.hpp"

#include <algorithm>

namespace dermis::testing {
namespace {

subsurface::FrameConstants constants_of(const BufferGraph& input) {
  subsurface::FrameConstants constants{};
  constants.rect[2] = static_cast<int32_t>(input.width);
  constants.rect[3] = static_cast<int32_t>(input.height);
  constants.tiles[0] = static_cast<int32_t>(ceil_div(input.width, subsurface::tile_side));
  constants.tiles[1] = static_cast<int32_t>(ceil_div(input.height, subsurface::tile_side));
  constants.sample_units = input.sample_units;
  constants.previous_rect[2] = static_cast<int32_t>(input.previous_width);
  constants.previous_rect[3] = static_cast<int32_t>(input.previous_height);
  return constants;
}

} // namespace

void BufferGraphTest::run_graph(const BufferGraph& input, BufferGraphAnswers& answers) {
  PassTypeRegistry pass_types = subsurface::make_pass_types();
  std::vector<vulkan::KernelCode> kernels;
  for (const OwnPassType& own : input.own) {
    pass_types.add(own.type);
    kernels.push_back({own.type.shader, own.spirv});
  }
  for (const Kernel& kernel : embedded_kernels())
    kernels.push_back({kernel.shader, kernel.spirv});
  Diagnostics diagnostics;
  const auto document = parse_document("graph.json", input.text, diagnostics);
  ASSERT_TRUE(document) << format_as_json(diagnostics);
  const auto graph = read_graph(*document, pass_types, diagnostics);
  ASSERT_TRUE(graph) << format_as_json(diagnostics);

  std::vector<float> questions = input.questions;
  questions.resize(std::max<size_t>(align_up(questions.size(), 4), 64));
  const subsurface::FrameConstants constants = constants_of(input);
  const KernelTables tables{.questions = bytes_of(questions), .frame = &constants};
  std::vector<std::byte> texels;
  run_frame({*graph, pass_types, kernels, input.width, input.height, tables,
             VK_FORMAT_R32G32B32A32_UINT, answer_columns, input.rows, input.grid, input.shape},
            texels, answers.counters);
  answers.texels = values_of<BufferTexel>(texels);
}

} // namespace dermis::testing
