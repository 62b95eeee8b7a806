#include "passes/generate/bindings.hpp"

#include "passes/choice/allotment.hpp"
#include "passes/common/accumulate.hpp"
#include "passes/common/flat_light.hpp"
#include "passes/common/kinds.hpp"
#include "passes/common/profiles/radial_table.hpp"
#include "passes/common/reproject.hpp"
#include "passes/common/truth/surface.hpp"
#include "passes/sap/sap_tiles.hpp"
#include "passes/separable/separable_kernel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>

namespace dermis {
namespace {

std::string upper(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return out;
}

std::string declare_port(const Port& port, uint32_t binding) {
  const std::string layout = fmt::format("set = 0, binding = {}", binding);
  switch (port.usage) {
  case Usage::sampled_image:
    return fmt::format("layout({}) uniform {} {}_image;\n", layout, port.glsl_type, port.name);
  case Usage::storage_image_write:
    return fmt::format("layout({}) writeonly uniform {} {}_image;\n", layout, port.glsl_type, port.name);
  case Usage::storage_image_update: // a load needs to know the format
    if (port.glsl_type.substr(0, 9) == "writeonly")
      return fmt::format("layout({}) uniform {} {}_image;\n", layout, port.glsl_type, port.name);
    return fmt::format("layout({}, rgba16f) uniform {} {}_image;\n", layout, port.glsl_type, port.name);
  case Usage::acceleration_structure:
    return fmt::format("layout({}) uniform {} {}_structure;\n", layout, port.glsl_type, port.name);
  case Usage::storage_buffer_read:
    return fmt::format("layout(std430, {}) readonly buffer {}_block {{ {} {}_data[]; }};\n", layout,
                       port.name, port.glsl_type, port.name);
  case Usage::storage_buffer_write:
    return fmt::format("layout(std430, {}) writeonly buffer {}_block {{ {} {}_data[]; }};\n", layout,
                       port.name, port.glsl_type, port.name);
  case Usage::storage_buffer_update:
    return fmt::format("layout(std430, {}) buffer {}_block {{ {} {}_data[]; }};\n", layout, port.name,
                       port.glsl_type, port.name);
  default: // no descriptor
    return {};
  }
}

std::string declare_setting(const KindSetting& setting) {
  const char* type = setting.type == SettingType::real ? "float" : "int";
  std::string out = fmt::format("  {} {}; // {}{}{}\n", type, setting.name, setting.doc,
                                setting.unit.empty() ? "" : "; ", setting.unit);
  return out;
}

std::string header_of(const PassKind& kind) {
  std::string out = fmt::format("// Generated from the signature of {}.\n\n", kind.name);
  for (uint32_t i = 0; i < kind.ports.size(); ++i)
    out += declare_port(kind.ports[i], i);
  out += "\nlayout(push_constant) uniform settings_block {\n  uint port_mask; // bit i: port i is bound\n";
  for (const KindSetting& setting : kind.settings)
    out += declare_setting(setting);
  out += "} settings;\n\n";
  for (const KindSetting& setting : kind.settings)
    for (uint32_t i = 0; i < setting.options.size(); ++i)
      out += fmt::format("const int {}_{} = {};\n", upper(setting.name), upper(setting.options[i]), i);
  for (uint32_t i = 0; i < kind.ports.size(); ++i)
    if (kind.ports[i].optional)
      out += fmt::format("bool has_{}() {{ return (settings.port_mask & {}u) != 0u; }}\n", kind.ports[i].name,
                         1u << i);
  return out;
}

// Numbers that C++ and GLSL must agree on.
std::string shared_constants() {
  return fmt::format(
      "// Generated from the constants of passes/common/.\n"
      "#ifndef DERMIS_CONSTANTS_GLSL\n#define DERMIS_CONSTANTS_GLSL\n\n"
      "const float copy_below_d_px = {}; // kinds.hpp\n"
      "const float flat_reach_d = {:.1f}; // flat_light.hpp\n"
      "const float flat_tolerance = {};\n"
      "const int flat_most_reach = {};\n"
      "const uint flat_cell_side = {}u;\n"
      "const int probe_most_reach = {}; // kinds.hpp\n"
      "const float allot_gain_0 = {}, allot_gain_1 = {}, allot_gain_2 = {}; // allotment.hpp\n"
      "const float allot_stay = {};\n"
      "const int allot_first_bin = {};\n"
      "const float min_patch_cosine = {}; // truth/surface.hpp\n"
      "const int separable_nodes = {}; // separable_kernel.hpp\n"
      "const float separable_first_log2_d = {:.1f};\n"
      "const float separable_log2_d_step = {:.1f};\n"
      "const int separable_rows_per_kernel = {};\n"
      "const int sap_levels = {}; // sap_weights.hpp\n"
      "const int sap_variants = {};\n"
      "const int sap_half = {}, sap_plain = {};\n"
      "const int sap_nodes = {};\n"
      "const float sap_nodes_per_octave = {:.1f};\n"
      "const float sap_log2_d_first = {};\n"
      "const uint sap_tiles_per_group_first = {}u; // sap_tiles.hpp\n"
      "const uint sap_tiles_per_group = {}u;\n"
      "const int radial_nodes = {}; // profiles/radial_table.hpp\n"
      "const float radial_log2_r_first = {:.1f};\n"
      "const float radial_nodes_per_octave = {:.1f};\n"
      "const float radial_inverse_nodes_per_unit = {:.1f};\n"
      "const float reproject_snap_px = {}; // temporal/reproject.hpp\n"
      "const float reproject_largest_velocity = {:.1f};\n"
      "const float reproject_depth_share = {};\n"
      "const float reproject_slope_pixels = {:.1f};\n"
      "const float reproject_least_weight = {};\n"
      "const float accumulate_least_brightness = {}; // temporal/accumulate.hpp\n"
      "const float accumulate_largest_remainder = {:.1f};\n"
      "const float counter_log2_shift = {:.1f}; // environment.hpp\n"
      "const float counter_log2_steps = {:.1f};\n"
      "const float through_square_steps = {:.1f};\n\n#endif\n",
      subsurface::copy_below_d_px, subsurface::flat_reach_d, subsurface::flat_tolerance,
      subsurface::flat_most_reach, subsurface::flat_cell_side, subsurface::probe_most_reach,
      choice::allot_gain[0], choice::allot_gain[1], choice::allot_gain[2], choice::allot_stay,
      choice::allot_first_bin, subsurface::min_patch_cosine, subsurface::separable_nodes,
      subsurface::separable_first_log2_d, subsurface::separable_log2_d_step,
      subsurface::separable_rows_per_profile, subsurface::sap_level_count, subsurface::sap_variant_count,
      static_cast<int>(subsurface::SapVariant::half), static_cast<int>(subsurface::SapVariant::plain),
      subsurface::sap_node_count, double(subsurface::sap_nodes_per_octave), subsurface::sap_log2_d_first,
      subsurface::sap_tiles_per_group_first, subsurface::sap_tiles_per_group, subsurface::radial_nodes,
      subsurface::radial_log2_r_first, subsurface::radial_nodes_per_octave,
      subsurface::radial_inverse_nodes_per_unit, subsurface::reproject_snap_px,
      subsurface::reproject_largest_velocity, subsurface::reproject_depth_share,
      subsurface::reproject_slope_pixels, subsurface::reproject_least_weight,
      subsurface::accumulate_least_brightness, subsurface::accumulate_largest_remainder,
      subsurface::counter_log2_shift, subsurface::counter_log2_steps, subsurface::through_square_steps);
}

} // namespace

std::vector<GeneratedFile> generated_glsl() {
  const KindRegistry kinds = subsurface::make_kinds();
  std::vector<GeneratedFile> files;
  for (uint32_t i = 0; i < kinds.size(); ++i) {
    const PassKind& kind = kinds[KindId{i}];
    files.push_back({fmt::format("{}.bindings.glsl", kind.shader), header_of(kind)});
  }
  files.push_back({"constants.glsl", shared_constants()});
  return files;
}

} // namespace dermis
