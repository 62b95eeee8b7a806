#include "tests/shaders/common/kernel_fixture.hpp"

#include "framegraph/compile/compile.hpp"
#include "framegraph/text/diagnostic.hpp"
#include "framegraph/vulkan/device_profile.hpp"

namespace dermis::testing {
namespace {

constexpr Port ports[] = {{"target", Usage::storage_image_write, false, "image2D", "", {}}};

Graph one_pass() {
  Graph graph;
  ResourceDeclaration& answers = graph.resources.emplace_back();
  answers.name = "answers";
  answers.formats = {Format::rgba32f};
  answers.exported = true;
  PassDeclaration& pass = graph.passes.emplace_back();
  pass.name = "ask";
  pass.type = PassTypeId{0};
  PortBinding target;
  target.port = 0;
  target.resource = ResourceId{0};
  graph.bind(pass, PortSide::write, target, {});
  return graph;
}

vulkan::EnvironmentBinding buffer(std::span<const std::byte> bytes) {
  static constexpr std::byte zeros[256] = {};
  if (bytes.empty()) bytes = zeros;
  return {vulkan::EnvironmentType::storage_buffer, bytes.size(), bytes};
}

} // namespace

void KernelTest::run_frame(const KernelFrame& input, std::vector<std::byte>& texels,
                           subsurface::FrameCounters& counters) {
  auto host = device_input<vulkan::DeviceInput>();
  host.kernel_shape = input.shape;
  vulkan::Device dermis_device;
  const vulkan::Error made = vulkan::make_device(host, dermis_device);
  ASSERT_FALSE(made) << made.text;
  const DeviceProfile profile = vulkan::device_profile(dermis_device);
  CompileInput compiled;
  compiled.graph = &input.graph;
  compiled.pass_types = &input.pass_types;
  compiled.device = &profile;
  compiled.view_width = input.width;
  compiled.view_height = input.height;
  compiled.pixel_grid = input.grid;
  compiled.bound.assign(input.graph.resources.size(), true);
  Diagnostics diagnostics;
  const auto plan = compile(compiled, diagnostics);
  ASSERT_TRUE(plan) << format_as_json(diagnostics);

  using vulkan::EnvironmentType;
  const vulkan::EnvironmentBinding environment[] = {
      {EnvironmentType::uniform_buffer, sizeof(subsurface::FrameConstants), {}},
      buffer(input.tables.profiles),
      buffer(input.tables.questions),
      {EnvironmentType::linear_sampler, 0, {}},
      buffer({}),
      buffer(input.tables.radial),
      {EnvironmentType::counters, sizeof(subsurface::FrameCounters), {}},
  };
  vulkan::ExecutorInput create;
  create.device = &dermis_device;
  create.graph = &input.graph;
  create.pass_types = &input.pass_types;
  create.plan = &plan->plan;
  create.kernels = input.kernels;
  create.environment = environment;
  std::unique_ptr<vulkan::Executor> executor;
  const vulkan::Error error = vulkan::Executor::create(create, executor);
  ASSERT_FALSE(error) << error.text;

  const TestImage image =
      make_image(input.format, input.image_width, input.image_height, VK_IMAGE_USAGE_STORAGE_BIT);
  transition(image, VK_IMAGE_LAYOUT_GENERAL);
  constexpr vulkan::HostState at_rest{VK_IMAGE_LAYOUT_GENERAL, VK_QUEUE_FAMILY_IGNORED,
                                      VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                      VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
  const vulkan::HostImage bound[] = {{image.image, image.view, at_rest, at_rest}};
  subsurface::FrameConstants constants{};
  constants.rect[2] = static_cast<int32_t>(input.width);
  constants.rect[3] = static_cast<int32_t>(input.height);
  if (input.tables.frame != nullptr) constants = *input.tables.frame;
  constants.flags |= input.tables.frame_flags;
  vulkan::FrameInput frame;
  frame.command_buffer = begin_commands();
  frame.images = bound;
  frame.frame_constants = std::as_bytes(std::span(&constants, 1));
  frame.rectangle = {0, 0, input.width, input.height};
  frame.frame_index = 1;
  const vulkan::RecordResult result = executor->record(frame);
  ASSERT_FALSE(result) << result.text;
  submit(frame.command_buffer);
  texels = download(image, VK_IMAGE_LAYOUT_GENERAL);
  wait();
  auto* words = reinterpret_cast<uint32_t*>(&counters);
  ASSERT_TRUE(executor->read_counters(1, {words, sizeof(counters) / sizeof(uint32_t)}));
}

std::vector<float> KernelTest::answers_of(const vulkan::KernelCode& kernel, uint32_t width,
                                          uint32_t height, const KernelTables& tables) {
  PassTypeRegistry pass_types;
  pass_types.add({"test.kernel", kernel.shader, "", ports, {}, DispatchRule{}, false});
  std::vector<std::byte> texels;
  subsurface::FrameCounters counters;
  run_frame({one_pass(),
             pass_types,
             {&kernel, 1},
             width,
             height,
             tables,
             VK_FORMAT_R32G32B32A32_SFLOAT,
             width,
             height},
            texels, counters);
  return values_of<float>(texels);
}

} // namespace dermis::testing
