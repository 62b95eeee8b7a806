#include "integration/tools/command/bench/technique.hpp"

#include "integration/tools/command/run/captured.hpp"
#include "integration/tools/references/image_reads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

namespace dermis::tools {
namespace {

// Passes before and after scattering, common to all techniques.
constexpr std::array<std::string_view, 13> common_pass_types = {"clear",
                                                                "subsurface.classify",
                                                                "subsurface.classify_uniform_light",
                                                                "subsurface.tile_list",
                                                                "subsurface.sap_tiles",
                                                                "subsurface.setup",
                                                                "subsurface.separable_setup",
                                                                "subsurface.sap_setup",
                                                                "subsurface.sap_setup_half_res",
                                                                "subsurface.pyramid_setup",
                                                                "subsurface.combine",
                                                                "subsurface.combine_copies",
                                                                "subsurface.export_scattered"};

std::string text_of(const Diagnostics& diagnostics) {
  std::string text;
  for (const Diagnostic& one : diagnostics.list)
    text.append(text.empty() ? "" : "\n").append(format_for_people(diagnostics, one));
  return text;
}

demo::Error input_error(const std::string& graph, const std::string& text) {
  return {demo::ErrorKind::input, fmt::format("{}\nthe graph '{}' cannot be used", text, graph)};
}

// Returns the number of texels that a pass computes per pixel of the view: those of the first image
// it writes, or 1 if it writes none.
double invocations_per_pixel(const Plan& plan, const PlanPass& pass, const PassType& type) {
  for (uint32_t i = 0; i < pass.access_count; ++i) {
    const PlanAccess& access = plan.accesses[pass.first_access + i];
    const PlanResource& resource = plan.resources[access.resource];
    if (type.ports[access.port].usage != Usage::storage_image_write ||
        resource.type != ResourceType::image)
      continue;
    const uint32_t mip = access.range.first_mip;
    const double texels =
        double(std::max(resource.width >> mip, 1u)) * std::max(resource.height >> mip, 1u);
    return texels / (double(plan.view_width) * plan.view_height);
  }
  return 1;
}

// Converts view depths in host units to Vulkan's depth, 0..1. Distance 0 is background.
std::vector<float> depth_buffer_of(std::span<const float> distances,
                                   const subsurface::Matrix4& clip_from_view) {
  const subsurface::Matrix4& m = clip_from_view;
  const bool reversed = m[14] == 0 ? m[10] > 0 : m[11] > 0; // nearer surfaces have larger values
  std::vector<float> depth;
  depth.reserve(distances.size());
  for (const float distance : distances)
    depth.push_back(distance == 0 ? (reversed ? 0.0f : 1.0f)
                                  : static_cast<float>((m[11] - m[10] * double(distance)) /
                                                       (m[15] - m[14] * double(distance))));
  return depth;
}

// A GPU that has worked for this long runs at its full clock rate.
constexpr std::chrono::milliseconds time_to_full_clock{20};

} // namespace

subsurface::PerChannel d_of(const CapturedFrame& frame, double d_px) {
  std::array<uint64_t, 256> count{};
  for (const uint8_t id : frame.profile)
    count[id] += id != 0;
  const auto maximum =
      static_cast<uint32_t>(std::max_element(count.begin(), count.end()) - count.begin());
  for (const CaptureProfile& one : frame.description.profiles)
    if (one.id == maximum) {
      const auto& d = one.profile.d_mm;
      const double widest = std::max({d[0], d[1], d[2], 1e-30});
      return {d_px * d[0] / widest, d_px * d[1] / widest, d_px * d[2] / widest};
    }
  return {d_px, d_px, d_px};
}

demo::Result<std::unique_ptr<TechniqueRun>>
TechniqueRun::create(demo::VulkanHost& host, const TechniqueRequest& request,
                     std::span<const CaptureProfile> profiles, std::span<const float> sap_tables) {
  Diagnostics diagnostics;
  std::optional<LoadedGraph> loaded = load_graph(
      request.graph, {.overlays = request.overlays, .roots = {}, .pass_types = {}}, diagnostics);
  if (!loaded) return input_error(request.graph, text_of(diagnostics));
  const CompileChoices choices = read_choices(loaded->graph, request.set);
  if (!choices.problem.empty()) return input_error(request.graph, choices.problem);
  std::unique_ptr<TechniqueRun> made(new TechniqueRun(host, request));
  made->loaded_ = std::move(*loaded);
  made->text_ = diagnostics.files.front().text;
  made->sap_tables_ = sap_tables;
  for (const CaptureProfile& one : profiles)
    made->profiles_.push_back({one.id, one.profile.name, profile_as_json(one.profile)});
  return made;
}

demo::Result<> TechniqueRun::prepare(const CapturedFrame& frame, const SlotChoice& slots,
                                     bool follows) {
  DeviceGraphRequest device_request;
  device_request.graph_name = request_.graph;
  device_request.graph_text = text_;
  device_request.overlays = loaded_.overlays;
  device_request.width = frame.description.width;
  device_request.height = frame.description.height;
  device_request.pixel_aspect = std::abs(frame.rays.scale_x / frame.rays.scale_y);
  device_request.profiles = profiles_;
  device_request.settings = settings_as_json(loaded_.graph, request_.set);
  device_request.unbound = slots.unbound;
  for (const auto& [slot, format] : slots.formats)
    device_request.formats.emplace_back(slot, static_cast<VkFormat>(format_info(format).vulkan));
  const bool same = device_ != nullptr && same_but_size(device_request, made_for_);
  made_anew_ =
      !same || device_request.width != made_for_.width || device_request.height != made_for_.height;
  if (!made_anew_) return demo::success();
  Diagnostics diagnostics;
  const CompileChoices choices = read_choices(loaded_.graph, request_.set, slots.unbound);
  if (!choices.problem.empty()) return input_error(request_.graph, choices.problem);
  auto plan =
      compile_generic(loaded_, {device_request.width, device_request.height}, choices, diagnostics);
  if (!plan) return input_error(request_.graph, text_of(diagnostics));
  if (same && follows) {
    if (auto resized = device_->resize(device_request.width, device_request.height); !resized)
      return resized.error();
  } else {
    device_.reset();
    auto device = DeviceGraph::create(host_, device_request);
    if (!device) return device.error();
    device_ = device.take();
  }
  plan_ = std::move(*plan);
  made_for_ = std::move(device_request);
  return demo::success();
}

demo::Result<std::vector<float>> TechniqueRun::scatter(const CapturedFrame& frame, bool follows,
                                                       DepthGiven depth) {
  SlotChoice slots = choose_slots(loaded_.graph, frame);
  if (!slots.problem.empty()) return input_error(request_.graph, slots.problem);
  if (auto ready = prepare(frame, slots, follows); !ready) return ready.error();
  if (depth == DepthGiven::depth_buffer)
    for (SlotData& data : slots.data)
      if (data.slot == "depth")
        data.texels = depth_buffer_of(data.texels, frame.description.clip_from_view);
  for (const SlotData& data : slots.data)
    if (auto given = device_->upload(data.slot, data.texels, data.channels); !given)
      return given.error();
  device_->skip_to(std::exchange(next_frame_index_, 0));
  frame_ = c_frame(frame.description);
  if (depth == DepthGiven::depth_buffer) frame_.depth_kind = DERMIS_DEPTH_DEVICE;
  frame_.delta_seconds = frame_seconds_;
  frame_.flags = follows ? 0 : DERMIS_FRAME_RESET_HISTORY;
  if (auto ran = device_->run(frame_); !ran) return ran.error();
  return device_->read_rgb("scattered_light");
}

void TechniqueRun::skip_to(uint64_t frame_index) {
  next_frame_index_ = frame_index;
}

demo::Result<std::vector<float>> TechniqueRun::sampling() {
  if (!device_->has("sampling")) return std::vector<float>();
  return device_->read_rgb("sampling");
}

uint64_t TechniqueRun::history_bytes() {
  return device_->memory().history_bytes;
}

demo::Result<TechniqueTimes> TechniqueRun::run_again() {
  const auto end = std::chrono::steady_clock::now() + time_to_full_clock;
  do {
    if (auto ran = device_->run(frame_); !ran) return ran.error();
  } while (std::chrono::steady_clock::now() < end);
  return times();
}

demo::Result<TechniqueTimes> TechniqueRun::times_at_full_clock() {
  auto last = times();
  if (!last) return last.error();
  return std::chrono::duration<double, std::milli>(last->device) < time_to_full_clock ? run_again()
                                                                                      : last;
}

demo::Result<TechniqueTimes> TechniqueRun::times() {
  TechniqueTimes times;
  const std::vector<DeviceGraph::PassTime> all = device_->times();
  if (all.empty())
    return demo::Error{demo::ErrorKind::environment,
                       "the device has no timestamps; nothing can be compared"};
  for (const DeviceGraph::PassTime& one : all) {
    const auto pass =
        std::find_if(plan_.plan.passes.begin(), plan_.plan.passes.end(), [&](const PlanPass& each) {
          return loaded_.graph.passes[each.declared.value].name == one.pass;
        });
    const std::string_view type =
        pass != plan_.plan.passes.end() ? loaded_.pass_types[pass->type].name : "";
    if (type == export_scattered_type) continue;
    times.device += one.milliseconds;
    if (std::find(common_pass_types.begin(), common_pass_types.end(), type) ==
        common_pass_types.end())
      times.sampling += one.milliseconds;
  }
  return times;
}

TechniqueCounts TechniqueRun::counts(double sampled_fraction, const subsurface::PerChannel& d_px,
                                     std::optional<double> taken) {
  TechniqueCounts counts;
  counts.transient_bytes = device_->memory().transient_bytes;
  counts.reads_per_pixel = 0.0;
  const Plan& plan = plan_.plan;
  for (const PlanPass& pass : plan.passes) {
    const PassType& type = loaded_.pass_types[pass.type];
    if (type.name == export_scattered_type) continue;
    counts.dispatches += type.dispatch.is_kernel();
    std::vector<SettingValue> settings;
    for (size_t i = 0; i < type.settings.size(); ++i)
      settings.push_back(plan.settings[pass.first_setting + i].value);
    subsurface::ReadsInput input{settings, std::vector<bool>(type.ports.size(), false), d_px,
                                 sap_tables_};
    for (uint32_t i = 0; i < pass.access_count; ++i)
      input.bound[plan.accesses[pass.first_access + i].port] = true;
    auto reads = subsurface::image_reads(type, input);
    if (reads && taken && reads->samples > 0) {
      input.sampled_fraction = *taken / reads->samples;
      reads = subsurface::image_reads(type, input);
      // image_reads assumed samples in all pixels
      counts.mean_spp += reads->samples * (1 - sampled_fraction);
    }
    if (!reads) {
      counts.reads_per_pixel.reset();
      counts.unknown_pass_type = type.name;
      continue;
    }
    counts.mean_spp += reads->samples * sampled_fraction;
    if (counts.reads_per_pixel)
      *counts.reads_per_pixel += reads->per_invocation * invocations_per_pixel(plan, pass, type);
  }
  return counts;
}

} // namespace dermis::tools
