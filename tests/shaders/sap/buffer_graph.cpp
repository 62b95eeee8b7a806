#include "tests/shaders/sap/buffer_graph.hpp"

#include "framegraph/compile/compile.hpp"
#include "framegraph/model/read_graph.hpp"
#include "framegraph/text/diagnostic.hpp"
#include "framegraph/vulkan/device_profile.hpp"
#include "passes/common/dispatch.hpp"
#include "passes/common/kernels.hpp"
#include "passes/common/pass_types.hpp"

#include <algorithm>

namespace dermis::testing {
namespace {

constexpr std::byte zero_bytes[256] = {};

vulkan::EnvironmentBinding storage_buffer(std::span<const std::byte> bytes) {
  return {vulkan::EnvironmentType::storage_buffer, bytes.size(), bytes};
}

subsurface::FrameConstants constants_of(const BufferGraph& input) {
  subsurface::FrameConstants constants{};
  constants.rect[2] = static_cast<int32_t>(input.width);
  constants.rect[3] = static_cast<int32_t>(input.height);
  constants.tiles[0] = static_cast<int32_t>(ceil_div(input.width, subsurface::tile_side));
  constants.tiles[1] = static_cast<int32_t>(ceil_div(input.height, subsurface::tile_side));
  constants.sample_units = input.sample_units;
  return constants;
}

} // namespace

void BufferGraphTest::run_graph(const BufferGraph& input, BufferGraphAnswers& answers) {
  auto host = device_input<vulkan::DeviceInput>();
  host.kernel_shape = input.shape;
  vulkan::Device dermis_device;
  const vulkan::Error made = vulkan::make_device(host, dermis_device);
  ASSERT_FALSE(made) << made.text;
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
  const DeviceProfile profile = vulkan::device_profile(dermis_device);
  CompileInput compiled;
  compiled.graph = &*graph;
  compiled.pass_types = &pass_types;
  compiled.device = &profile;
  compiled.view_width = input.width;
  compiled.view_height = input.height;
  compiled.pixel_grid = input.grid;
  compiled.bound.assign(graph->resources.size(), true);
  const auto plan = compile(compiled, diagnostics);
  ASSERT_TRUE(plan) << format_as_json(diagnostics);

  std::vector<float> questions = input.questions;
  questions.resize(std::max<size_t>(align_up(questions.size(), 4), 64));
  using vulkan::EnvironmentType;
  const vulkan::EnvironmentBinding environment[] = {
      {EnvironmentType::uniform_buffer, sizeof(subsurface::FrameConstants), {}},
      storage_buffer(zero_bytes),
      storage_buffer(bytes_of(questions)),
      {EnvironmentType::linear_sampler, 0, {}},
      storage_buffer(zero_bytes),
      storage_buffer(zero_bytes),
      {EnvironmentType::counters, sizeof(subsurface::FrameCounters), {}},
  };
  vulkan::ExecutorInput create;
  create.device = &dermis_device;
  create.graph = &*graph;
  create.pass_types = &pass_types;
  create.plan = &plan->plan;
  create.kernels = kernels;
  create.environment = environment;
  std::unique_ptr<vulkan::Executor> executor;
  const vulkan::Error error = vulkan::Executor::create(create, executor);
  ASSERT_FALSE(error) << error.text;

  const TestImage image = make_image(VK_FORMAT_R32G32B32A32_UINT, answer_columns, input.rows,
                                     VK_IMAGE_USAGE_STORAGE_BIT);
  transition(image, VK_IMAGE_LAYOUT_GENERAL);
  constexpr vulkan::HostState at_rest{VK_IMAGE_LAYOUT_GENERAL, VK_QUEUE_FAMILY_IGNORED,
                                      VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                      VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
  const vulkan::HostImage bound[] = {{image.image, image.view, at_rest, at_rest}};
  const subsurface::FrameConstants constants = constants_of(input);
  vulkan::FrameInput frame;
  frame.command_buffer = begin_commands();
  frame.images = bound;
  frame.frame_constants = std::as_bytes(std::span(&constants, 1));
  frame.rectangle = {0, 0, input.width, input.height};
  frame.frame_index = 1;
  const vulkan::RecordResult result = executor->record(frame);
  ASSERT_FALSE(result) << result.text;
  submit(frame.command_buffer);
  answers.texels = values_of<BufferTexel>(download(image, VK_IMAGE_LAYOUT_GENERAL));
  wait();
  auto* words = reinterpret_cast<uint32_t*>(&answers.counters);
  ASSERT_TRUE(executor->read_counters(1, {words, sizeof(answers.counters) / sizeof(uint32_t)}));
}

} // namespace dermis::testing
