#include "tests/framegraph/vulkan/executor_fixture.hpp"

namespace dermis::testing {

void ExecutorTest::SetUp() {
  VulkanTest::SetUp();
  if (IsSkipped() || HasFatalFailure()) return;
  auto input = device_input<vulkan::DeviceInput>();
  input.labels = input.timings = true;
  const vulkan::Error error = vulkan::make_device(input, dermis_device);
  ASSERT_FALSE(error) << error.text;
  profile = vulkan::device_profile(dermis_device);
}

void ExecutorTest::TearDown() {
  if (device != VK_NULL_HANDLE) wait();
  executor.reset();
  replaced.reset();
  VulkanTest::TearDown();
}

vulkan::Error ExecutorTest::try_executor(const SmallGraph& graph, const Plan& plan,
                                         const vulkan::Device& on,
                                         std::unique_ptr<vulkan::Executor>& result) {
  static const float table[] = {0.0f, 2.0f};
  std::vector<vulkan::EnvironmentBinding> environment = {
      {vulkan::EnvironmentType::uniform_buffer, sizeof(SmallFrame), {}},
      {vulkan::EnvironmentType::storage_buffer, sizeof(table), std::as_bytes(std::span(table))},
      {vulkan::EnvironmentType::linear_sampler, 0, {}},
  };
  if (counters) environment.push_back({vulkan::EnvironmentType::counters, sizeof(uint32_t), {}});
  vulkan::ExecutorInput input;
  input.device = &on;
  input.graph = &graph.graph;
  input.pass_types = &small_pass_types();
  input.plan = &plan;
  input.kernels = small_kernels();
  input.environment = environment;
  input.frames_in_flight = test_frames_in_flight;
  input.poison = poison;
  input.settings = prepared;
  return vulkan::Executor::create(input, result);
}

void ExecutorTest::make_executor(const SmallGraph& graph, uint32_t width, uint32_t height,
                                 const std::vector<std::string>& unbound) {
  view_width = width;
  view_height = height;
  const Plan plan = graph.compile(profile, width, height, unbound, poison);
  const vulkan::Error error = try_executor(graph, plan, dermis_device, executor);
  ASSERT_FALSE(error) << error.text;
}

TestImage ExecutorTest::start(const SmallGraph& graph, uint32_t width, uint32_t height) {
  make_executor(graph, width, height);
  return bind(graph, "result", {});
}

TestImage ExecutorTest::bind(const SmallGraph& graph, const std::string& slot,
                             const std::vector<float>& texels, VkImageLayout layout) {
  const TestImage image = make_image(VK_FORMAT_R32_SFLOAT, view_width, view_height,
                                     VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT);
  if (texels.empty())
    transition(image, layout);
  else
    upload(image, bytes_of(texels), layout);
  bind_image(graph, slot, image, layout, layout);
  return image;
}

void ExecutorTest::bind_image(const SmallGraph& graph, const std::string& slot,
                              const TestImage& image, VkImageLayout before, VkImageLayout after) {
  const auto number = static_cast<size_t>(graph.slot(slot));
  if (images.size() <= number) images.resize(number + 1);
  constexpr VkPipelineStageFlags2 stages = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  constexpr VkAccessFlags2 access = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  images[number] = {image.image,
                    image.view,
                    {before, VK_QUEUE_FAMILY_IGNORED, stages, access},
                    {after, VK_QUEUE_FAMILY_IGNORED, stages, access}};
}

vulkan::RecordResult ExecutorTest::frame(float time, vulkan::Rectangle rectangle,
                                         bool reset_history) {
  if (rectangle.width == 0) rectangle = {0, 0, view_width, view_height};
  const SmallFrame constants{{static_cast<int32_t>(rectangle.x), static_cast<int32_t>(rectangle.y),
                              static_cast<int32_t>(rectangle.width),
                              static_cast<int32_t>(rectangle.height)},
                             time,
                             {}};
  vulkan::FrameInput input;
  input.command_buffer = begin_commands();
  input.images = images;
  input.buffers = buffers;
  input.frame_constants = std::as_bytes(std::span(&constants, 1));
  input.settings = settings;
  input.rectangle = rectangle;
  input.frame_index = ++frame_index;
  input.reset_history = reset_history;
  input.before = replaced.get();
  // The contract is that frame_index - frames_in_flight has finished. Waiting for all frames of an
  // older pair keeps two frames in flight.
  if (frame_index % test_frames_in_flight == 1) wait();
  const vulkan::RecordResult result = executor->record(input);
  submit(input.command_buffer);
  return result;
}

void ExecutorTest::run_frames(uint32_t count) {
  for (uint32_t i = 0; i < count; ++i)
    ASSERT_FALSE(frame());
}

void ExecutorTest::expect_frames(const TestImage& image, const std::vector<float>& values) {
  for (size_t i = 0; i < values.size(); ++i) {
    ASSERT_FALSE(frame());
    EXPECT_THAT(read(image), Each(FloatEq(values[i]))) << "frame " << i;
  }
}

std::vector<float> ExecutorTest::read(const TestImage& image, VkImageLayout layout) {
  return values_of<float>(download(image, layout));
}

} // namespace dermis::testing
