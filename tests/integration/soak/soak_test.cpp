// Runs many frames in which graphs, views, sizes, settings, budgets, light and surfaces change at
// random. Expects no message, no value that is not finite, no light from nowhere, and no growth of
// memory.
// DERMIS_SOAK_FRAMES: number of frames (300; ./test.sh --full: 20 times 5,000). DERMIS_SOAK_SEED:
// seed. DERMIS_SOAK_VALIDATION=0: without the validation layer.

#include "framegraph/vulkan/kernel_store.hpp"
#include "tests/integration/abi/sources.hpp"
#include "tests/integration/soak/memory_counts.hpp"
#include "tests/integration/soak/object_counts.hpp"
#include "tests/integration/soak/stage.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <tuple>

namespace dermis::abi_test {
namespace {

constexpr size_t max_views = 3;
const demo::ImageState between{VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                               VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT};

uint64_t from_environment(const char* name, uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::strtoull(text, nullptr, 10) : otherwise;
}

struct Recorded {
  Stage* stage;
  size_t view;
  dermis_frame frame;
};

struct Soak : DermisTest {
  CountedHeap heap;
  std::unique_ptr<CountedDeviceMemory> memory;
  dermis_allocator host_allocator = DERMIS_ALLOCATOR_INIT;
  dermis_device_allocator device_allocator = DERMIS_DEVICE_ALLOCATOR_INIT;
  bool counts_heap = true;
  SplitMix64 random{from_environment("DERMIS_SOAK_SEED", 1)};
  SoakTotals totals;
  std::vector<Stage> stages;
  std::vector<std::pair<uint32_t, uint32_t>> sizes; // Sizes of graphs in this round, in pixels.

  static void SetUpTestSuite() { // Hides the function of the fixture, which always validates.
    const bool validation = from_environment("DERMIS_SOAK_VALIDATION", 1) != 0;
    auto made = demo::create_vulkan_host({.validation = validation, .device = ""});
    if (made) host = made.take();
  }
  void SetUp() override {
    DermisTest::SetUp();
    if (!host) return;
    memory = std::make_unique<CountedDeviceMemory>(CountedDeviceMemory{*host});
    host_allocator = heap.allocator();
    device_allocator = memory->allocator();
    dermis_context_desc desc = context_desc();
    desc.log = nullptr; // The test provokes rejected reloads.
    desc.device_allocator = &device_allocator;
    desc.allocator = &host_allocator;
    desc.get_instance_proc_addr = counting_loader(*host);
    dermis_context probed = nullptr; // sanitizers count leaks themselves
    counts_heap = dermis_context_create(&desc, &probed) != DERMIS_ERROR_UNSUPPORTED;
    dermis_context_destroy(probed);
    if (!counts_heap) desc.allocator = nullptr;
    own_context(desc);
  }
  void TearDown() override {
    drop();
    DermisTest::TearDown();
    if (!memory) return;
    EXPECT_EQ(memory->blocks, 0);
    EXPECT_EQ(heap.blocks, 0) << heap.bytes << " bytes";
    EXPECT_EQ(object_counts().text, "none");
  }
  // Mesa's software driver destroys pipelines on a separate thread when other work is submitted.
  void let_the_driver_clean_up() {
    for (int i = 0; i < 3; ++i) {
      const auto ran = demo::run_commands(
          *host, [](VkCommandBuffer) -> demo::Result<> { return demo::success(); });
      ASSERT_TRUE(ran) << ran.error().text;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }
  void drop() {
    for (Stage& stage : stages)
      dermis_graph_destroy(stage.graph);
    stages.clear();
  }

  bool chance(double fraction) { return unit(random) < fraction; }
  template <class List> const auto& any(const List& list) {
    return list[random.below(list.size())];
  }

  // Few sizes per round, because a driver may recompile kernels for each.
  void draw_sizes() {
    constexpr size_t sizes_a_round = 6;
    sizes = {{soak_side, soak_side}, {1, 1}};
    while (sizes.size() < sizes_a_round)
      sizes.emplace_back(1 + random.below(soak_side), 1 + random.below(soak_side));
  }

  std::string text_of(const StageDesc& desc) {
    return read_text(dermis::shipped::graph_file(desc.graph));
  }

  void create(const StageDesc& desc) {
    Stage stage;
    stage.desc = desc;
    const std::string text = text_of(desc), skin = read_text("configs/profiles/skin.json"),
                      wax = read_text("configs/profiles/wax.json");
    dermis_profile profiles[2] = {DERMIS_PROFILE_INIT, DERMIS_PROFILE_INIT};
    profiles[0].id = 1;
    profiles[0].source = source_of(skin, "skin.json");
    profiles[1].id = 2;
    profiles[1].source = source_of(wax, "wax.json");
    std::vector<std::string> overlays;
    std::vector<dermis_source> sources;
    for (const std::string& name : desc.overlays)
      overlays.push_back(read_text("configs/overlays/" + name));
    for (const std::string& overlay : overlays)
      sources.push_back(source_of(overlay, "overlay.json"));
    const char* unbound[] = {"albedo",   "scatter_scale", "importance",     "thickness",
                             "sampling", "back_lighting", "scattered_light"};
    dermis_slot_format depth = slot_format("depth", VK_FORMAT_R32_SFLOAT);
    dermis_graph_desc out = graph_desc(text, "graph.json", soak_side);
    out.profiles = profiles;
    out.profile_count = 2;
    out.unbound = unbound;
    out.unbound_count = static_cast<uint32_t>(std::size(unbound));
    out.formats = &depth;
    out.format_count = 1;
    out.overlays = sources.data();
    out.overlay_count = static_cast<uint32_t>(sources.size());
    ASSERT_OK(dermis_graph_create(context, &out, &stage.graph, nullptr));
    stages.push_back(std::move(stage));
    add_view(stages.back(), nullptr);
    ++totals.graphs;
  }

  // The view's images have the largest size that the graph may get.
  void add_view(Stage& stage, dermis_view view) {
    SoakView added;
    added.view = view;
    for (const dermis_slot& slot : slots_of(stage.graph)) {
      if (slot.bound == 0) continue;
      demo::ImageDesc desc;
      desc.format = slot.format;
      desc.width = desc.height = soak_side;
      desc.usage = slot.usage | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                   VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
      auto image = demo::create_image(*host, desc);
      ASSERT_TRUE(image) << image.error().text;
      images.emplace(slot.name, image.take());
    }
    added.bound = bindings(stage.graph);
    added.images.swap(images);
    images.clear();
    stage.views.push_back(std::move(added));
    show(stage.views.back());
  }

  void put(SoakView& view, const std::string& slot, const std::vector<float>& texels,
           uint32_t channels) {
    const auto image = view.images.find(slot);
    if (image == view.images.end()) return;
    const auto done = demo::upload_image(*host, image->second, texels, channels, between);
    ASSERT_TRUE(done) << done.error().text;
  }
  // Shows another surface.
  void show(SoakView& view) {
    view.surface = draw_surface(random);
    put(view, "depth", view.surface.depth, 1);
    put(view, "material", view.surface.material, 1);
    put(view, "velocity", view.surface.velocity, 2);
  }

  // Gives a view another value of a setting, or the graph's value again. Settings of the graph are
  // rejected.
  void set_for_a_view(Stage& stage) {
    const dermis_view view = stage.views.back().view;
    if (view == nullptr) return;
    const auto& [name, values] = any(stage.desc.settings);
    const auto settings = list_of(dermis_setting DERMIS_SETTING_INIT, dermis_view_settings, view);
    const auto found =
        std::find_if(settings.begin(), settings.end(),
                     [&, &name = name](const dermis_setting& one) { return one.name == name; });
    ASSERT_NE(found, settings.end()) << name;
    const dermis_result expected = found->per_frame != 0 ? DERMIS_OK : DERMIS_ERROR_ARGUMENT;
    EXPECT_EQ(dermis_view_set_setting(view, name.c_str(),
                                      chance(0.3) ? nullptr : any(values).c_str(), nullptr),
              expected)
        << name << ": " << dermis_last_error();
    ++totals.view_settings;
  }

  void change(Stage& stage) {
    if (chance(0.02)) { // Half of the texts are broken.
      std::string text = text_of(stage.desc);
      const bool broken = chance(0.5);
      if (broken) text.resize(text.size() * (1 + random.below(98)) / 100);
      EXPECT_EQ(reload_text(stage.graph, source_of(text, "graph.json")),
                broken ? DERMIS_ERROR_CONFIG : DERMIS_OK)
          << dermis_last_error();
      ++(broken ? totals.rejected_reloads : totals.reloads);
    }
    if (chance(0.02)) {
      std::tie(stage.width, stage.height) = any(sizes);
      EXPECT_OK(dermis_graph_resize(stage.graph, stage.width, stage.height, nullptr));
      ++totals.resizes;
    }
    if (chance(0.1)) {
      const auto& [name, values] = any(stage.desc.settings);
      EXPECT_OK(dermis_graph_set_setting(stage.graph, name.c_str(), any(values).c_str(), nullptr));
      ++totals.settings;
    }
    if (chance(0.05)) set_for_a_view(stage);
    if (chance(0.01)) {
      const std::string text =
          read_text(chance(0.5) ? "configs/profiles/wax.json" : "configs/profiles/jade.json");
      const dermis_source source = source_of(text, "profile.json");
      EXPECT_OK(dermis_graph_set_profile(stage.graph, static_cast<uint32_t>(1 + random.below(2)),
                                         &source, nullptr));
      ++totals.profiles;
    }
    if (chance(0.03)) {
      dermis_budget budget = budget_of(static_cast<float>(random.below(4)) * 0.5f,
                                       chance(0.5) ? DERMIS_BUDGET_DETERMINISTIC : 0);
      EXPECT_OK(dermis_graph_set_budget(stage.graph, &budget, nullptr));
      ++totals.budgets;
    }
    if (chance(0.01) && stage.views.size() < max_views) {
      dermis_view view = view_of(stage.graph);
      add_view(stage, view);
      ++totals.views;
    } else if (chance(0.01) && stage.views.size() > 1) {
      dermis_view_destroy(stage.views.back().view);
      stage.views.pop_back();
    }
  }

  dermis_frame frame_for(Stage& stage, SoakView& view) {
    dermis_frame out = frame(view.bound);
    out.frame_index = view.frame + 1;
    out.completed_frame_index = view.frame;
    for (float* from_world : {out.view_from_world, out.previous_view_from_world})
      for (size_t i = 0; i < 16; i += 5)
        from_world[i] = 1.0f;
    if (chance(0.15)) {
      out.rect_width = static_cast<uint32_t>(1 + random.below(stage.width));
      out.rect_height = static_cast<uint32_t>(1 + random.below(stage.height));
      out.rect_x = static_cast<uint32_t>(random.below(stage.width - out.rect_width + 1));
      out.rect_y = static_cast<uint32_t>(random.below(stage.height - out.rect_height + 1));
    }
    const uint32_t width = out.rect_width > 0 ? out.rect_width : stage.width,
                   height = out.rect_width > 0 ? out.rect_height : stage.height;
    out.clip_from_view[0] = static_cast<float>(2.0 / (width * pitch_m));
    out.clip_from_view[5] = static_cast<float>(-2.0 / (height * pitch_m));
    std::copy(std::begin(out.clip_from_view), std::end(out.clip_from_view),
              out.previous_clip_from_view);
    if (chance(0.03)) {
      out.flags |= DERMIS_FRAME_RESET_HISTORY;
      view.brightest_yet = view.light.brightest;
      view.calm = view.light.even;
      ++totals.cuts;
    }
    if (chance(0.01)) out.flags |= DERMIS_FRAME_BOUNDS; // Empty bounds.
    out.exposure = chance(0.1) ? 4.0f : 0.0f;
    return out;
  }

  dermis_result record(const Recorded& one, VkCommandBuffer commands) {
    dermis_frame frame = one.frame;
    frame.command_buffer = commands;
    const dermis_view view = one.stage->views[one.view].view;
    return view != nullptr ? dermis_view_record(view, &frame)
                           : dermis_view_record(dermis_graph_view(one.stage->graph), &frame);
  }

  // Records a frame that is not submitted.
  void record_unsubmitted(const Recorded& one) {
    auto allocate = demo::vulkan_struct<VkCommandBufferAllocateInfo>(
        VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
    allocate.commandPool = host->pool;
    allocate.commandBufferCount = 1;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    ASSERT_EQ(host->vk.vkAllocateCommandBuffers(host->device, &allocate, &commands), VK_SUCCESS);
    const auto begin =
        demo::vulkan_struct<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
    ASSERT_EQ(host->vk.vkBeginCommandBuffer(commands, &begin), VK_SUCCESS);
    EXPECT_OK(record(one, commands));
    host->vk.vkEndCommandBuffer(commands);
    const dermis_view view = one.stage->views[one.view].view;
    EXPECT_OK(view != nullptr ? dermis_view_discard(view, one.frame.frame_index)
                              : dermis_view_discard(dermis_graph_view(one.stage->graph),
                                                    one.frame.frame_index));
    host->vk.vkFreeCommandBuffers(host->device, host->pool, 1, &commands);
    ++totals.discards;
  }

  void light_up(SoakView& view) {
    if (chance(0.05)) show(view);
    if (view.light.texels.empty() || chance(0.6)) {
      const bool damaged = chance(0.1);
      view.light = draw_light(random, damaged);
      totals.damaged += damaged;
    }
    view.brightest_yet = std::max(view.brightest_yet, view.light.brightest);
    view.calm = view.calm && view.light.even;
    put(view, "lighting", view.light.texels, 4);
  }

  void judge(const Recorded& one) {
    if ((one.frame.flags & DERMIS_FRAME_BOUNDS) != 0)
      return; // Nothing ran: the light is unchanged, damaged or not.
    Stage& stage = *one.stage;
    SoakView& view = stage.views[one.view];
    auto read = demo::read_image(*host, view.images.at("lighting"), between);
    ASSERT_TRUE(read) << read.error().text;
    const std::vector<float> out = read.take();
    const bool part = one.frame.rect_width > 0;
    const uint32_t width = part ? one.frame.rect_width : stage.width,
                   height = part ? one.frame.rect_height : stage.height;
    const double level = stage.desc.keeps_history ? view.brightest_yet : view.light.brightest;
    double brightest = 0, off = 0;
    for (uint32_t y = one.frame.rect_y; y < one.frame.rect_y + height; ++y)
      for (uint32_t x = one.frame.rect_x; x < one.frame.rect_x + width; ++x) {
        const size_t i = size_t{y} * soak_side + x;
        if (view.surface.material[i] == 0.0f) continue; // A pixel without profile keeps its light.
        for (size_t c = 0; c < 3; ++c) {
          const double value = out[4 * i + c];
          if (!std::isfinite(value) || value < 0) {
            if (totals.not_finite++ < 5)
              ADD_FAILURE() << stage.desc.name << ", frame " << totals.frames << ", pixel " << x
                            << ", " << y << ": " << value;
            continue;
          }
          brightest = std::max(brightest, value);
          off = std::max(off, std::abs(value - view.light.brightest));
        }
      }
    double& maximum = totals.brightest[stage.desc.name];
    maximum = std::max(maximum, brightest / level);
    EXPECT_LE(brightest / level, stage.desc.maximum)
        << stage.desc.name << ", frame " << totals.frames;
    if (stage.desc.keeps_history ? view.calm : view.light.even) {
      ++totals.even;
      double& worst = totals.even_error[stage.desc.name];
      worst = std::max(worst, off / level);
      EXPECT_LE(off / level, stage.desc.even_error)
          << stage.desc.name << ", frame " << totals.frames;
    }
    ++totals.pictures;
  }

  void step() {
    Stage& stage = stages[random.below(stages.size())];
    change(stage);
    std::vector<Recorded> all;
    for (size_t v = 0; v < stage.views.size(); ++v) {
      if (v > 0 && chance(0.3)) continue;
      SoakView& view = stage.views[v];
      light_up(view);
      const Recorded one{&stage, v, frame_for(stage, view)};
      if (chance(0.02)) record_unsubmitted(one);
      all.push_back(one);
    }
    const auto ran = demo::run_commands(*host, [&](VkCommandBuffer commands) -> demo::Result<> {
      for (const Recorded& one : all)
        EXPECT_OK(record(one, commands));
      return demo::success();
    });
    ASSERT_TRUE(ran) << ran.error().text;
    for (const Recorded& one : all) {
      stage.views[one.view].frame = one.frame.frame_index;
      judge(one);
    }
    ++totals.frames;
  }
};

// The memory left when all graphs of a round are destroyed: the context, and the kernels that it
// keeps.
struct Rest {
  int64_t heap_blocks = 0, heap_bytes = 0, device_blocks = 0;
  ObjectCounts objects;
  // Each kernel has a pipeline layout, a set layout, and a pipeline for each use of its constants.
  uint64_t pipelines() const { return objects.alive_pipelines; }
  uint64_t kernels() const { return (objects.alive - pipelines()) / 2; }
  // Only reported: drivers keep memory of each compiled kernel (null_soak_test.cpp checks process
  // memory).
  ProcessMemory process;
};

constexpr uint64_t max_kernels = 64; // More than the library has.

TEST_F(Soak, ManyFrames_NothingAccumulates) {
  const uint64_t frames = from_environment("DERMIS_SOAK_FRAMES", 300);
  constexpr uint64_t frames_a_round = 1000;
  const uint64_t rounds = std::max<uint64_t>(2, frames / frames_a_round);
  const std::vector<StageDesc> descs = soak_stages();
  std::vector<Rest> rests;
  uint32_t rounds_alike = 0;          // Rounds without a new pipeline, whose memory is compared.
  constexpr uint64_t more_rounds = 6; // Additional rounds until one has no new pipeline.
  for (uint64_t round = 0; round < rounds + (rounds_alike == 0 ? more_rounds : 0) && !HasFailure();
       ++round) {
    draw_sizes();
    for (const StageDesc& desc : descs)
      ASSERT_NO_FATAL_FAILURE(create(desc));
    while (totals.frames < frames * (round + 1) / rounds && !HasFailure())
      ASSERT_NO_FATAL_FAILURE(step());
    drop();
    ASSERT_NO_FATAL_FAILURE(let_the_driver_clean_up());
    rests.push_back({heap.blocks, heap.bytes, memory->blocks, object_counts(), process_memory()});
    const Rest &rest = rests.back(), &before = rests[rests.size() < 2 ? 0 : rests.size() - 2];
    fmt::print("{} frames: {} blocks of {} bytes on the heap, {} of the device's, {} of {} "
               "objects; process: {} MiB "
               "resident, {} MiB on its heap, {} MiB of compiled kernels\n",
               totals.frames, rest.heap_blocks, rest.heap_bytes, rest.device_blocks,
               rest.objects.alive, rest.objects.made, rest.process.resident >> 20,
               rest.process.heap >> 20, rest.process.compiled >> 20);
    std::fflush(stdout);
    EXPECT_EQ(rest.objects.text,
              fmt::format("{0} DescriptorSetLayouts, {0} PipelineLayouts, {1} Pipelines",
                          rest.kernels(), rest.pipelines()));
    EXPECT_LE(rest.kernels(), max_kernels);
    EXPECT_LE(rest.pipelines(), rest.kernels() * vulkan::KernelStore::max_unused);
    EXPECT_GE(rest.kernels(), before.kernels());
    const auto more = static_cast<int64_t>(rest.objects.pipelines - before.objects.pipelines);
    if (more == 0) {
      EXPECT_EQ(rest.heap_blocks, before.heap_blocks);
      EXPECT_EQ(rest.heap_bytes, before.heap_bytes);
    }
    rounds_alike += more == 0 && rests.size() > 1;
    EXPECT_EQ(rest.device_blocks, 0);
  }
  fmt::print(
      "{} frames, {} pictures: {} reloads, {} rejected, {} resizes, {} settings, {} settings of "
      "views, {} profiles, {} budgets, {} cuts, {} discarded, {} views, {} graphs; {} lights "
      "damaged, "
      "{} pictures judged as even\n",
      totals.frames, totals.pictures, totals.reloads, totals.rejected_reloads, totals.resizes,
      totals.settings, totals.view_settings, totals.profiles, totals.budgets, totals.cuts,
      totals.discards, totals.views, totals.graphs, totals.damaged, totals.even);
  for (const auto& [name, maximum] : totals.brightest)
    fmt::print("{}: brightest {:.5f} of the light, off even light {:.5f}\n", name, maximum,
               totals.even_error[name]);
  EXPECT_EQ(totals.not_finite, 0u);
  EXPECT_GT(rounds_alike, 0u);
}

} // namespace
} // namespace dermis::abi_test
