#include "tests/integration/abi/dermis_fixture.hpp"
#include "integration/examples/demo_engine/render/reported_frame.hpp"

#include <algorithm>
#include <stdexcept>

namespace dermis::abi_test {
namespace {

const demo::ImageState sampled{VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                               VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT};

DermisTest* running_test = nullptr;
std::map<uint32_t, dermis_context> shared_contexts; // by flags

void DERMIS_CALL log_message(void*, const dermis_message* message) {
  if (running_test != nullptr) running_test->logged.emplace_back(message->text);
}

std::vector<float> contents(const std::string& slot, uint32_t width, uint32_t height,
                            uint32_t channels) {
  std::vector<float> texels(size_t{width} * height * channels, 0.0f);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c) {
        float& texel = texels[(size_t{y} * width + x) * channels + c];
        if (slot == "lighting") texel = c < 3 && x < width / 2 ? 1.0f : 0.0f;
        if (slot == "material") texel = 1.0f;
        if (slot == "depth") texel = 0.5f;
      }
  return texels;
}

} // namespace

std::unique_ptr<demo::VulkanHost> DermisTest::host;

Said take(dermis_report report) {
  Said said;
  for (uint32_t i = 0; i < dermis_report_count(report); ++i) {
    dermis_message message = DERMIS_MESSAGE_INIT;
    EXPECT_OK(dermis_report_message(report, i, &message));
    said.names.emplace_back(message.code_name);
    said.texts.emplace_back(message.text);
    said.places.emplace_back(message.line, message.column);
  }
  said.all = dermis_report_text(report);
  dermis_report_destroy(report);
  return said;
}

void DermisTest::SetUpTestSuite() {
  auto made = demo::create_vulkan_host({.validation = true, .device = ""});
  if (made) host = made.take();
}

void DermisTest::TearDownTestSuite() {
  for (const auto& [flags, context] : shared_contexts)
    dermis_context_destroy(context);
  shared_contexts.clear();
  host.reset();
}

void DermisTest::SetUp() {
  running_test = this;
  if (!host) GTEST_SKIP() << "no Vulkan device with the validation layer";
  share_context();
}

void DermisTest::share_context(uint32_t flags) {
  drop_context();
  dermis_context& shared = shared_contexts[flags];
  if (shared == nullptr) {
    dermis_context_desc desc = context_desc();
    desc.flags |= flags;
    ASSERT_OK(dermis_context_create(&desc, &shared));
  }
  context = shared;
}

void DermisTest::own_context(const dermis_context_desc& desc) {
  drop_context();
  ASSERT_OK(dermis_context_create(&desc, &context));
}

void DermisTest::drop_context() {
  const bool is_shared = std::any_of(shared_contexts.begin(), shared_contexts.end(),
                                     [&](const auto& one) { return one.second == context; });
  if (!is_shared) dermis_context_destroy(context);
  context = nullptr;
}

void DermisTest::TearDown() {
  for (const dermis_graph graph : graphs)
    dermis_graph_destroy(graph);
  drop_context();
  images.clear();
  running_test = nullptr;
  if (!host) return;
  EXPECT_THAT(host->log.messages, IsEmpty());
  host->log.messages.clear();
}

dermis_context_desc DermisTest::context_desc() {
  dermis_context_desc desc = DERMIS_CONTEXT_DESC_INIT;
  desc.flags = DERMIS_CONTEXT_TIMINGS;
  desc.queue_family = host->queue_family;
  desc.instance = host->instance;
  desc.physical_device = host->physical_device;
  desc.device = host->device;
  desc.get_instance_proc_addr = vkGetInstanceProcAddr;
  desc.log = log_message;
  return desc;
}

namespace {

// Calls use(desc) with the description of `options`.
template <class Use> dermis_result described(const GraphOptions& options, Use use) {
  const std::string text =
      options.text.empty() ? read_text("configs/graphs/burley.json") : options.text;
  const std::string skin =
      options.profile.empty() ? read_text("configs/profiles/skin.json") : options.profile;
  std::vector<dermis_profile> profiles(options.profile_count, dermis_profile DERMIS_PROFILE_INIT);
  for (uint32_t i = 0; i < options.profile_count; ++i) {
    profiles[i].id = i + 1;
    profiles[i].source = source_of(skin, "skin.json");
  }
  std::vector<const char*> unbound;
  for (const std::string& name : options.unbound)
    unbound.push_back(name.c_str());
  std::vector<dermis_slot_format> formats;
  for (const auto& [name, format] : options.formats)
    formats.push_back(slot_format(name.c_str(), format));
  dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;
  desc.source = source_of(text, "graph.json");
  desc.width = options.width;
  desc.height = options.height;
  desc.profiles = profiles.data();
  desc.profile_count = options.profiles ? options.profile_count : 0;
  desc.unbound = unbound.data();
  desc.unbound_count = static_cast<uint32_t>(unbound.size());
  desc.formats = formats.data();
  desc.format_count = static_cast<uint32_t>(formats.size());
  std::vector<dermis_source> overlays;
  for (const std::string& overlay : options.overlays)
    overlays.push_back(source_of(overlay, "overlay.json"));
  desc.overlays = overlays.data();
  desc.overlay_count = static_cast<uint32_t>(overlays.size());
  desc.include = options.include;
  desc.include_user = options.include_user;
  return use(desc);
}

} // namespace

dermis_result DermisTest::create_graph(const GraphOptions& options, dermis_graph* graph,
                                       dermis_report* report) {
  return described(options, [&](const dermis_graph_desc& desc) {
    return dermis_graph_create(context, &desc, graph, report);
  });
}

dermis_result DermisTest::reload_graph(dermis_graph graph, const GraphOptions& options,
                                       dermis_report* report) {
  return described(options, [&](const dermis_graph_desc& desc) {
    return dermis_graph_reload(graph, &desc, report);
  });
}

dermis_graph DermisTest::make_graph(const GraphOptions& options) {
  dermis_graph graph = nullptr;
  if (create_graph(options, &graph) != DERMIS_OK) throw std::runtime_error(last_error());
  graphs.push_back(graph);
  return graph;
}

dermis_graph DermisTest::make_bound_graph(const GraphOptions& options) {
  const dermis_graph graph = make_graph(options);
  make_images(graph);
  return graph;
}

void DermisTest::make_images(dermis_graph graph, std::string_view but) {
  images.clear();
  for (const dermis_slot& slot : slots_of(graph)) {
    if (slot.bound == 0 || slot.name == but) continue;
    demo::ImageDesc desc;
    desc.format = slot.format;
    desc.width = slot.width;
    desc.height = slot.height;
    desc.usage = slot.usage | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                 VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    auto image = demo::create_image(*host, desc);
    ASSERT_TRUE(image) << image.error().text;
    const uint32_t channels = demo::find_pixel_format(slot.format)->channels;
    const auto uploaded = demo::upload_image(
        *host, *image, contents(slot.name, slot.width, slot.height, channels), channels, sampled);
    ASSERT_TRUE(uploaded) << uploaded.error().text;
    images.emplace(slot.name, image.take());
  }
}

void DermisTest::fill(const std::string& slot,
                      const std::function<float(uint32_t, uint32_t)>& value) {
  const demo::Image& image = images.at(slot);
  const uint32_t channels = demo::find_pixel_format(image.format)->channels;
  std::vector<float> values;
  for (uint32_t y = 0; y < image.height; ++y)
    for (uint32_t x = 0; x < image.width; ++x)
      values.insert(values.end(), channels, value(x, y));
  upload(slot, values);
}

void DermisTest::upload(const std::string& slot, const std::vector<float>& values) {
  demo::Image& image = images.at(slot);
  const uint32_t channels = demo::find_pixel_format(image.format)->channels;
  const auto uploaded = demo::upload_image(*host, image, values, channels, sampled);
  ASSERT_TRUE(uploaded) << uploaded.error().text;
}

std::vector<dermis_image_binding> DermisTest::bindings(dermis_graph graph) {
  std::vector<dermis_image_binding> bound;
  for (const dermis_slot& slot : slots_of(graph)) {
    const auto image = images.find(slot.name);
    if (image == images.end()) continue;
    dermis_image_binding binding = DERMIS_IMAGE_BINDING_INIT;
    binding.slot = slot.id;
    binding.format = image->second.format;
    binding.image = image->second.image;
    binding.view = image->second.view;
    binding.width = image->second.width;
    binding.height = image->second.height;
    binding.before = {sampled.layout, 0, sampled.stages, sampled.access, 0};
    binding.after = binding.before;
    binding.content_id = image->second.id;
    bound.push_back(binding);
  }
  return bound;
}

dermis_frame DermisTest::frame(const std::vector<dermis_image_binding>& bound, uint32_t width,
                               uint32_t height) {
  dermis_frame frame = DERMIS_FRAME_INIT;
  frame.bindings = bound.data();
  frame.binding_count = static_cast<uint32_t>(bound.size());
  frame.frame_index = last_frame + 1;
  frame.completed_frame_index = last_frame;
  frame.depth_kind = DERMIS_DEPTH_VIEW_UNITS;
  frame.clip_from_view[0] = static_cast<float>(2.0 / (width * pitch_m));
  frame.clip_from_view[5] = static_cast<float>(-2.0 / (height * pitch_m));
  frame.clip_from_view[10] = -1.0f;
  frame.clip_from_view[15] = 1.0f;
  return frame;
}

dermis_result DermisTest::record(dermis_graph graph, dermis_frame& frame) {
  dermis_result result = DERMIS_ERROR_INTERNAL;
  const auto ran = demo::run_commands(*host, [&](VkCommandBuffer commands) -> demo::Result<> {
    frame.command_buffer = commands;
    result = dermis_view_record(dermis_graph_view(graph), &frame);
    return demo::success();
  });
  EXPECT_TRUE(ran) << ran.error().text;
  if (result == DERMIS_OK) last_frame = frame.frame_index;
  return result;
}

demo::ReportedFrame DermisTest::run_frame(dermis_graph graph) {
  dermis_frame one = bound_frame(graph);
  return record_and_read(graph, one);
}

dermis_frame DermisTest::bound_frame(dermis_graph graph, uint32_t width, uint32_t height) {
  return frame(bound_.emplace_back(bindings(graph)), width, height);
}

void DermisTest::record_unsubmitted(dermis_graph graph, dermis_frame& frame) {
  const auto ran = demo::run_commands(*host, [&](VkCommandBuffer commands) -> demo::Result<> {
    frame.command_buffer = commands;
    EXPECT_OK(dermis_view_record(dermis_graph_view(graph), &frame));
    return demo::Error{demo::ErrorKind::internal, "not to be submitted"};
  });
  EXPECT_FALSE(ran);
}

demo::Image DermisTest::make_depth_image(VkFormat format, VkImageUsageFlags usage) {
  demo::Image made;
  made.host = host.get();
  made.format = format;
  made.aspect = VK_IMAGE_ASPECT_DEPTH_BIT;
  if (format == VK_FORMAT_D24_UNORM_S8_UINT || format == VK_FORMAT_D32_SFLOAT_S8_UINT)
    made.aspect |= VK_IMAGE_ASPECT_STENCIL_BIT;
  made.width = made.height = 64;
  auto info = demo::vulkan_struct<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {made.width, made.height, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.usage =
      usage | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  EXPECT_EQ(host->vk.vkCreateImage(host->device, &info, nullptr, &made.image), VK_SUCCESS);
  VkMemoryRequirements needs{};
  host->vk.vkGetImageMemoryRequirements(host->device, made.image, &needs);
  auto memory = demo::vulkan_struct<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  memory.allocationSize = needs.size;
  memory.memoryTypeIndex =
      demo::find_memory_type(*host, needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0);
  EXPECT_EQ(host->vk.vkAllocateMemory(host->device, &memory, nullptr, &made.memory), VK_SUCCESS);
  EXPECT_EQ(host->vk.vkBindImageMemory(host->device, made.image, made.memory, 0), VK_SUCCESS);
  auto view = demo::vulkan_struct<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  view.image = made.image;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = format;
  view.subresourceRange = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, 0, 1};
  EXPECT_EQ(host->vk.vkCreateImageView(host->device, &view, nullptr, &made.view), VK_SUCCESS);
  return made;
}

demo::ReportedFrame DermisTest::record_and_read(dermis_graph graph, dermis_frame& frame) {
  EXPECT_OK(record(graph, frame));
  demo::ReportedFrame choice;
  EXPECT_OK(demo::read_reported(dermis_graph_view(graph), last_frame, choice));
  return choice;
}

void rest(dermis_frame& frame) {
  for (size_t i = 0; i < 16; ++i)
    frame.view_from_world[i] = frame.previous_view_from_world[i] = i % 5 == 0 ? 1.0f : 0.0f;
  std::ranges::copy(frame.clip_from_view, frame.previous_clip_from_view);
}

void expect_equal_rgb(const std::vector<float>& texels, const std::vector<float>& expected) {
  ASSERT_EQ(texels.size(), expected.size());
  for (size_t i = 0; i < texels.size(); ++i)
    if (i % 4 != 3) {
      ASSERT_EQ(texels[i], expected[i]) << i;
    }
}

std::vector<float> DermisTest::texels(const std::string& slot) {
  auto read = demo::read_image(*host, images.at(slot), sampled);
  EXPECT_TRUE(read) << read.error().text;
  return read ? read.take() : std::vector<float>{};
}

} // namespace dermis::abi_test
