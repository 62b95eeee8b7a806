#include "tests/shaders/common/kernel_fixture.hpp"

#include "framegraph/compile/compile.hpp"
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

std::vector<float> KernelTest::answers_of(const vulkan::KernelCode& kernel, uint32_t width,
                                          uint32_t height, const KernelTables& tables) {
  std::vector<float> answers;
  run(kernel, width, height, tables, answers);
  return answers;
}

void KernelTest::run(const vulkan::KernelCode& kernel, uint32_t width, uint32_t height,
                     const KernelTables& tables, std::vector<float>& answers) {
  const auto host = device_input<vulkan::DeviceInput>();
  vulkan::Device dermis_device;
  const vulkan::Error made = vulkan::make_device(host, dermis_device);
  ASSERT_FALSE(made) << made.text;
  const DeviceProfile profile = vulkan::device_profile(dermis_device);
  const Graph graph = one_pass();
  PassTypeRegistry pass_types;
  pass_types.add({"test.kernel", kernel.shader, "", ports, {}, DispatchRule{}, false});
  CompileInput compiled;
  compiled.graph = &graph;
  compiled.pass_types = &pass_types;
  compiled.device = &profile;
  compiled.view_width = width;
  compiled.view_height = height;
  compiled.bound.assign(1, true);
  Diagnostics diagnostics;
  const auto plan = compile(compiled, diagnostics);
  ASSERT_TRUE(plan);

  using vulkan::EnvironmentType;
  const vulkan::EnvironmentBinding environment[] = {
      {EnvironmentType::uniform_buffer, sizeof(subsurface::FrameConstants), {}},
      buffer(tables.profiles),
      buffer(tables.questions),
      {EnvironmentType::linear_sampler, 0, {}},
      buffer({}),
      buffer(tables.radial),
      {EnvironmentType::counters, sizeof(subsurface::FrameCounters), {}},
  };
  vulkan::ExecutorInput input;
  input.device = &dermis_device;
  input.graph = &graph;
  input.pass_types = &pass_types;
  input.plan = &plan->plan;
  input.kernels = {&kernel, 1};
  input.environment = environment;
  std::unique_ptr<vulkan::Executor> executor;
  const vulkan::Error error = vulkan::Executor::create(input, executor);
  ASSERT_FALSE(error) << error.text;

  const TestImage image =
      make_image(VK_FORMAT_R32G32B32A32_SFLOAT, width, height, VK_IMAGE_USAGE_STORAGE_BIT);
  transition(image, VK_IMAGE_LAYOUT_GENERAL);
  constexpr vulkan::HostState at_rest{VK_IMAGE_LAYOUT_GENERAL, VK_QUEUE_FAMILY_IGNORED,
                                      VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                      VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
  const vulkan::HostImage bound[] = {{image.image, image.view, at_rest, at_rest}};
  subsurface::FrameConstants constants{};
  constants.rect[2] = static_cast<int32_t>(width);
  constants.rect[3] = static_cast<int32_t>(height);
  if (tables.frame != nullptr) constants = *tables.frame;
  constants.flags |= tables.frame_flags;
  vulkan::FrameInput frame;
  frame.command_buffer = begin_commands();
  frame.images = bound;
  frame.frame_constants = std::as_bytes(std::span(&constants, 1));
  frame.rectangle = {0, 0, width, height};
  frame.frame_index = 1;
  executor->record(frame);
  submit(frame.command_buffer);
  answers = values_of<float>(download(image, VK_IMAGE_LAYOUT_GENERAL));
  wait();
}

} // namespace dermis::testing
