#include "integration/tools/command/run/apply_slots.hpp"

#include "framegraph/text/suggest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>

namespace dermis::tools {
namespace {

// Slots that a captured frame can fill, most exact format first. Depth is passed as view depth,
// which requires a colour format.
struct Fillable {
  std::string_view slot;
  std::vector<Format> formats;
};

// A velocity image of three channels includes the change of depth.
std::vector<Fillable> fillable_slots(const CapturedFrame& frame) {
  const std::vector<Format> velocity = frame.velocity.channels == 3
                                           ? std::vector{Format::rgba32f, Format::rgba16f}
                                           : std::vector{Format::rg32f, Format::rg16f};
  return {
      {"lighting", {Format::rgba32f, Format::rgba16f, Format::b10g11r11f}},
      {"depth", {Format::r32f}},
      {"normal", {Format::rgba32f, Format::rgba16f}},
      {"material", {Format::r8_uint}},
      {"albedo", {Format::rgba32f, Format::rgba16f, Format::rgba8_srgb}},
      {"velocity", velocity},
      {"scatter_scale", {Format::r32f, Format::r16f}},
      {"specular", {Format::rgba32f, Format::rgba16f}},
      {"thickness", {Format::r32f, Format::r16f}},
      {"back_lighting", {Format::rgba32f, Format::rgba16f}},
      {"scattered_light", {Format::rgba32f, Format::rgba16f}},
  };
}

std::vector<float> to_floats(std::span<const uint8_t> ids) {
  return {ids.begin(), ids.end()};
}

// Converts depth from metres to the frame's units.
std::vector<float> in_units(const CapturedFrame& frame) {
  std::vector<float> depth = frame.depth.values;
  for (float& value : depth)
    value = static_cast<float>(static_cast<double>(value) / frame.description.metres_per_unit);
  return depth;
}

// Returns empty texels if the frame has no such image.
SlotData data_of(const CapturedFrame& frame, std::string_view slot) {
  const auto from = [&](const Image& image) {
    return SlotData{std::string(slot), image.values, image.channels};
  };
  if (slot == "lighting") return from(frame.lighting);
  if (slot == "depth") return {std::string(slot), in_units(frame), 1};
  if (slot == "normal") return from(frame.normal);
  if (slot == "material") return {std::string(slot), to_floats(frame.profile), 1};
  if (slot == "albedo") return from(frame.albedo);
  if (slot == "velocity") return from(frame.velocity);
  if (slot == "scatter_scale") return from(frame.scatter_scale);
  if (slot == "thickness") return from(frame.thickness);
  if (slot == "back_lighting") return from(frame.back_lighting);
  if (slot == "specular") return from(frame.specular);
  return {std::string(slot), {}, 0};
}

std::string names_of(std::span<const Format> formats) {
  std::vector<std::string_view> names;
  for (const Format format : formats)
    names.push_back(format_info(format).name);
  return list_words(names);
}

} // namespace

SlotChoice choose_slots(const Graph& graph, const CapturedFrame& frame) {
  SlotChoice choice;
  const std::vector<Fillable> fillable = fillable_slots(frame);
  for (const ResourceDeclaration& declared : graph.resources) {
    const bool imported = declared.origin == Origin::imported;
    if (!imported && !declared.exported) continue;
    const auto known = std::find_if(fillable.begin(), fillable.end(),
                                    [&](const Fillable& one) { return one.slot == declared.name; });
    SlotData data = data_of(frame, declared.name);
    if (imported && data.texels.empty()) {
      if (!declared.optional) {
        choice.problem =
            fmt::format("the graph requires '{}', which the capture lacks", declared.name);
        return choice;
      }
      choice.unbound.push_back(declared.name);
      continue;
    }
    if (known != fillable.end()) {
      const auto format = std::find_first_of(known->formats.begin(), known->formats.end(),
                                             declared.formats.begin(), declared.formats.end());
      if (format == known->formats.end()) {
        choice.problem =
            fmt::format("the graph accepts '{}' as {}, but a captured frame provides {}",
                        declared.name, names_of(declared.formats), names_of(known->formats));
        return choice;
      }
      choice.formats.emplace_back(declared.name, *format);
    }
    if (!data.texels.empty()) choice.data.push_back(std::move(data));
  }
  return choice;
}

} // namespace dermis::tools
