#include "tests/passes/device/player.hpp"

#include "framegraph/vulkan/create_infos.hpp"
#include "integration/examples/demo_engine/pixel_format.hpp"
#include "passes/common/kernels.hpp"
#include "passes/common/pass_types.hpp"

#include <fmt/format.h>

namespace dermis::testing {
namespace {

constexpr double pitch_m = 0.0005; // 0.5 mm per pixel; skin's red d is about 2 px.
constexpr uint32_t frames_in_flight = 2;
constexpr const char* profile_files[] = {"skin", "jade"}; // Profiles 1 and 2.
constexpr vulkan::HostState at_rest{VK_IMAGE_LAYOUT_GENERAL, VK_QUEUE_FAMILY_IGNORED,
                                    VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                    VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};

subsurface::FrameInput frame_input(const ShownFrame& shown, const vulkan::Rectangle& previous,
                                   uint64_t frame_index, bool history_invalid) {
  subsurface::FrameInput input;
  input.rect_x = shown.x;
  input.rect_y = shown.y;
  input.rect_width = shown.width;
  input.rect_height = shown.height;
  input.bounds = {0, 0, static_cast<int32_t>(shown.width), static_cast<int32_t>(shown.height)};
  input.camera.clip_from_view[0] = 2.0 / (shown.width * pitch_m);
  input.camera.clip_from_view[5] = -2.0 / (shown.height * pitch_m);
  input.camera.clip_from_view[10] = -1.0;
  input.camera.clip_from_view[15] = 1.0;
  input.depth_kind = subsurface::DepthKind::view_units;
  input.frame_index = frame_index;
  input.history_invalid = history_invalid;
  input.previous_x = previous.x;
  input.previous_y = previous.y;
  input.previous_width = previous.width;
  input.previous_height = previous.height;
  input.camera.previous_clip_from_view = input.camera.clip_from_view;
  for (size_t i = 0; i < 4; ++i)
    input.camera.view_from_world[5 * i] = input.camera.previous_view_from_world[5 * i] = 1.0;
  return input;
}

bool writes(const Plan& plan, uint32_t resource) {
  for (const PlanAccess& access : plan.accesses)
    if (access.resource == resource && (access.access & all_write_access) != 0) return true;
  return false;
}

// Returns the rows of the rectangle.
std::vector<std::byte> inside(const std::vector<std::byte>& texels, const TestImage& image,
                              const ShownFrame& frame) {
  std::vector<std::byte> out;
  for (uint32_t y = frame.y; y < frame.y + frame.height; ++y) {
    const auto* row = texels.data() + (size_t{y} * image.width + frame.x) * image.texel_bytes;
    out.insert(out.end(), row, row + size_t{frame.width} * image.texel_bytes);
  }
  return out;
}

// Returns the processor features that compiled kernels and the C library depend on, in addition to
// the driver.
std::string processor() {
  std::string out;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) out += " avx2";
  if (__builtin_cpu_supports("fma")) out += " fma";
  if (__builtin_cpu_supports("avx512f")) out += " avx512f";
#endif
  return out.empty() ? " other" : out;
}

} // namespace

void DevicePlayer::SetUp() {
  VulkanTest::SetUp();
  if (IsSkipped() || HasFatalFailure()) return;
  auto input = device_input<vulkan::DeviceInput>();
  input.labels = true; // Names in messages of the validation layer.
  const vulkan::Error error = vulkan::make_device(input, dermis_device);
  ASSERT_FALSE(error) << error.text;
  profile = vulkan::device_profile(dermis_device);
  pass_types = subsurface::make_pass_types();
  for (uint32_t i = 0; i < std::size(profile_files); ++i) {
    Diagnostics diagnostics;
    const auto document = read_document(
        fmt::format("{}/configs/profiles/{}.json", DERMIS_SOURCE_DIR, profile_files[i]),
        diagnostics);
    ASSERT_TRUE(document);
    const auto read = subsurface::read_profile(*document, diagnostics);
    ASSERT_TRUE(read);
    profiles_.push_back({i + 1, *read});
  }
}

void DevicePlayer::TearDown() {
  if (device != VK_NULL_HANDLE) wait();
  kernels_.reset();
  VulkanTest::TearDown();
}

const subsurface::KernelTables& DevicePlayer::tables_for(const Graph& graph) {
  const subsurface::TableUse use = subsurface::table_use(graph, pass_types);
  for (const auto& tables : tables_)
    if (tables->use == use) return *tables;
  tables_.push_back(
      std::make_unique<subsurface::KernelTables>(subsurface::make_kernel_tables(use, profiles_)));
  return *tables_.back();
}

CompileInput DevicePlayer::compile_input(const RealGraph& graph, const Show& show) const {
  CompileInput input;
  input.graph = &graph.graph;
  input.pass_types = &pass_types;
  input.device = &profile;
  input.view_width = show.width;
  input.view_height = show.height;
  input.bound = show.bound;
  input.host_formats = show.formats;
  return input;
}

Played DevicePlayer::play(const RealGraph& graph, const Show& show, const Plan& plan, bool poison) {
  const subsurface::KernelTables& tables = tables_for(graph.graph);
  using vulkan::EnvironmentType;
  const auto buffer = [](std::span<const std::byte> bytes) {
    return vulkan::EnvironmentBinding{EnvironmentType::storage_buffer, bytes.size(), bytes};
  };
  const vulkan::EnvironmentBinding environment[] = {
      {EnvironmentType::uniform_buffer, sizeof(subsurface::FrameConstants), {}},
      buffer(bytes_of(tables.profiles)),
      buffer(bytes_of(tables.separable)),
      {EnvironmentType::linear_sampler, 0, {}},
      buffer(bytes_of(tables.pyramid)),
      buffer(bytes_of(tables.radial)),
      {EnvironmentType::counters, sizeof(subsurface::FrameCounters), {}},
  };
  std::vector<vulkan::KernelCode> kernels = more_kernels;
  for (const Kernel& kernel : embedded_kernels())
    kernels.push_back({kernel.shader, kernel.spirv});
  vulkan::ExecutorInput input;
  input.device = &dermis_device;
  input.graph = &graph.graph;
  input.pass_types = &pass_types;
  input.plan = &plan;
  input.kernels = kernels;
  input.environment = environment;
  input.frames_in_flight = frames_in_flight;
  if (kernels_ == nullptr) kernels_ = std::make_unique<vulkan::KernelStore>();
  input.kernel_store = kernels_.get();
  input.poison = poison;
  std::unique_ptr<vulkan::Executor> executor;
  const vulkan::Error error = vulkan::Executor::create(input, executor);
  EXPECT_FALSE(error) << error.text;
  if (error) return {};

  struct Slot {
    std::string name;
    TestImage image;
    bool import = false, written = false;
  };
  std::vector<Slot> slots;
  std::vector<vulkan::HostImage> bound;
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    const PlanResource& resource = plan.resources[r];
    if (resource.slot < 0 || resource.first_instance != no_instance) continue;
    Slot slot;
    slot.name = graph.graph.resources[resource.declared.value].name;
    slot.import = resource.origin == Origin::imported;
    slot.written = writes(plan, r);
    TestImage& image =
        images_[fmt::format("{} {} {} {} {}", slot.name, static_cast<int>(resource.format),
                            resource.vk_usage, show.width, show.height)];
    if (image.image == VK_NULL_HANDLE) {
      image = make_image(vulkan::vk_format(resource.format), resource.width, resource.height,
                         // Sampled usage allows a view of an otherwise unused image.
                         resource.vk_usage | VK_IMAGE_USAGE_SAMPLED_BIT);
      transition(image, VK_IMAGE_LAYOUT_GENERAL);
    }
    slot.image = image;
    const auto number = static_cast<size_t>(resource.slot);
    if (bound.size() <= number) bound.resize(number + 1);
    bound[number] = {image.image, image.view, at_rest, at_rest};
    slots.push_back(std::move(slot));
  }

  Played played;
  counters.assign(show.frames.size(), {});
  for (const ShownFrame& shown : show.frames) {
    for (const Slot& slot : slots) {
      if (!slot.import) continue;
      const demo::PixelFormat* format = demo::find_pixel_format(slot.image.format);
      EXPECT_NE(format, nullptr) << slot.name;
      upload(slot.image,
             demo::encode_texels(*format, shown.pictures.at(slot.name), shown_channels(slot.name)),
             VK_IMAGE_LAYOUT_GENERAL);
    }
    bool history_invalid = false;
    for (uint32_t i = 0; i < executor->history_count(); ++i)
      history_invalid = history_invalid || !executor->history_state(i, shown.cut).valid;
    subsurface::FrameConstants constants{};
    const uint64_t index = played.size() + 1;
    EXPECT_TRUE(subsurface::fill_frame_constants(
        frame_input(shown, executor->previous_rectangle(), index, history_invalid), constants));
    vulkan::FrameInput frame;
    frame.command_buffer = begin_commands();
    frame.images = bound;
    frame.frame_constants = std::as_bytes(std::span(&constants, 1));
    frame.rectangle = {shown.x, shown.y, shown.width, shown.height};
    frame.frame_index = index;
    frame.reset_history = shown.cut;
    const vulkan::RecordResult result = executor->record(frame);
    EXPECT_FALSE(result) << result.text;
    submit(frame.command_buffer);
    wait();
    auto* words = reinterpret_cast<uint32_t*>(&counters[played.size()]);
    EXPECT_TRUE(executor->read_counters(
        index, {words, sizeof(subsurface::FrameCounters) / sizeof(uint32_t)}));
    auto& out = played.emplace_back();
    for (const Slot& slot : slots) {
      if (!slot.written) continue;
      std::vector<std::byte> texels = download(slot.image, VK_IMAGE_LAYOUT_GENERAL);
      out[slot.name] = slot.import ? std::move(texels) : inside(texels, slot.image, shown);
    }
  }
  return played;
}

std::string DevicePlayer::driver() const {
  const auto properties2 = reinterpret_cast<PFN_vkGetPhysicalDeviceProperties2>(
      get_instance_proc_addr(instance, "vkGetPhysicalDeviceProperties2"));
  VkPhysicalDeviceDriverProperties driver{};
  driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  VkPhysicalDeviceProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  properties.pNext = &driver;
  properties2(physical, &properties);
  return fmt::format("{} | {} {} {:#x} |{}", properties.properties.deviceName, driver.driverName,
                     driver.driverInfo, properties.properties.driverVersion, processor());
}

} // namespace dermis::testing
