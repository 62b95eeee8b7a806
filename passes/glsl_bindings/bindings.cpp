#include "passes/glsl_bindings/bindings.hpp"

#include "passes/choice/sample_allocation.hpp"
#include "passes/choice/tile_selection.hpp"
#include "passes/common/accumulate.hpp"
#include "passes/common/dispatch.hpp"
#include "passes/common/pass_types.hpp"
#include "passes/common/profiles/radial_table.hpp"
#include "passes/common/reference/relief.hpp"
#include "passes/common/reference/surface.hpp"
#include "passes/common/reproject.hpp"
#include "passes/common/uniform_light.hpp"
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

// Returns the format of an image that a kernel also loads.
std::string_view load_format(const Port& port) {
  return port.glsl_type.front() == 'u' ? "rgba32ui" : "rgba16f";
}

std::string declare_port(const Port& port, uint32_t binding) {
  const std::string layout = fmt::format("set = 0, binding = {}", binding);
  switch (port.usage) {
  case Usage::sampled_image:
    return fmt::format("layout({}) uniform {} {}_image;\n", layout, port.glsl_type, port.name);
  case Usage::storage_image_write:
    if (port.internally_ordered)
      return fmt::format("layout({}, {}) coherent uniform {} {}_image;\n", layout,
                         load_format(port), port.glsl_type, port.name);
    return fmt::format("layout({}) writeonly uniform {} {}_image;\n", layout, port.glsl_type,
                       port.name);
  // A load needs the format.
  case Usage::storage_image_update:
    if (port.glsl_type.substr(0, 9) == "writeonly")
      return fmt::format("layout({}) uniform {} {}_image;\n", layout, port.glsl_type, port.name);
    return fmt::format("layout({}, rgba16f) uniform {} {}_image;\n", layout, port.glsl_type,
                       port.name);
  case Usage::acceleration_structure:
    return fmt::format("layout({}) uniform {} {}_structure;\n", layout, port.glsl_type, port.name);
  case Usage::storage_buffer_read:
    return fmt::format("layout(std430, {}) readonly buffer {}_block {{ {} {}_data[]; }};\n", layout,
                       port.name, port.glsl_type, port.name);
  case Usage::storage_buffer_write:
    return fmt::format("layout(std430, {}) {} buffer {}_block {{ {} {}_data[]; }};\n", layout,
                       port.internally_ordered ? "coherent" : "writeonly", port.name,
                       port.glsl_type, port.name);
  case Usage::storage_buffer_update:
    return fmt::format("layout(std430, {}) buffer {}_block {{ {} {}_data[]; }};\n", layout,
                       port.name, port.glsl_type, port.name);
  default: // no descriptor
    return {};
  }
}

const char* glsl_type(const PassTypeSetting& setting) {
  return setting.type == SettingType::real ? "float" : "int";
}

std::string comment_on(const PassTypeSetting& setting) {
  return fmt::format(" // {}{}{}\n", setting.doc, setting.unit.empty() ? "" : "; ", setting.unit);
}

// Declares the specialisation constants. A kernel that is compiled without values for them reads
// the presence of its ports from the push constants.
std::string declare_constants(const PassType& type) {
  std::string out;
  if (std::ranges::any_of(type.ports, &Port::optional))
    out +=
        fmt::format("layout(constant_id = {}) const uint bound_ports = 0u; // bit i: port i is "
                    "bound in every frame\n"
                    "layout(constant_id = {}) const uint changing_ports = 0xffffffffu; // bit i: "
                    "port i is bound in some frames\n",
                    constant_id::bound_ports, constant_id::changing_ports);
  for (uint32_t i = 0; i < type.settings.size(); ++i)
    if (const PassTypeSetting& setting = type.settings[i]; is_constant(setting))
      out += fmt::format("layout(constant_id = {}) const int constant_{} = {};{}",
                         constant_id::first_setting + i, setting.name,
                         setting.default_value.integer, comment_on(setting));
  return out;
}

std::string declare_push_constants(const PassType& type) {
  std::string out = "layout(push_constant) uniform push_constant_block {\n"
                    "  uint port_mask; // bit i: port i is bound in this frame\n";
  for (const PassTypeSetting& setting : type.settings)
    if (!is_constant(setting))
      out += fmt::format("  {} {};{}", glsl_type(setting), setting.name, comment_on(setting));
  return out + "} push_constants;\n";
}

// Declares `settings`, so that a kernel reads each setting in one way.
std::string declare_settings(const PassType& type) {
  if (type.settings.empty()) return {};
  std::string members;
  std::vector<std::string> values;
  for (const PassTypeSetting& setting : type.settings) {
    members += fmt::format("  {} {};\n", glsl_type(setting), setting.name);
    values.push_back(
        fmt::format("{}{}", is_constant(setting) ? "constant_" : "push_constants.", setting.name));
  }
  return fmt::format("\nstruct settings_values {{\n{}}};\n"
                     "settings_values settings = settings_values({});\n",
                     members, fmt::join(values, ", "));
}

std::string declare_presence(const Port& port, uint32_t bit) {
  return fmt::format(
      "bool has_{}() {{\n"
      "  return (bound_ports & {}u) != 0u ||\n"
      "         ((changing_ports & {}u) != 0u && (push_constants.port_mask & {}u) != 0u);\n}}\n",
      port.name, bit, bit, bit);
}

std::string header_of(const PassType& type) {
  std::string out = fmt::format("// Generated from the signature of {}.\n", type.name);
  out += "#include \"options.glsl\"\n\n";
  for (uint32_t i = 0; i < type.ports.size(); ++i)
    out += declare_port(type.ports[i], i);
  out += "\n";
  out += declare_constants(type);
  out += declare_push_constants(type);
  out += declare_settings(type);
  out += "\n";
  for (uint32_t i = 0; i < type.ports.size(); ++i)
    if (type.ports[i].optional) out += declare_presence(type.ports[i], 1u << i);
  return out;
}

// Returns the values of the options of all settings. Settings of one name must number their options
// alike; otherwise a constant is defined twice and no kernel compiles.
std::string option_values(const PassTypeRegistry& pass_types) {
  std::vector<std::string> lines;
  for (uint32_t type = 0; type < pass_types.size(); ++type)
    for (const PassTypeSetting& setting : pass_types[PassTypeId{type}].settings)
      for (uint32_t i = 0; i < setting.options.size(); ++i) {
        std::string line =
            fmt::format("const int {}_{} = {};", upper(setting.name), upper(setting.options[i]), i);
        if (std::ranges::find(lines, line) == lines.end()) lines.push_back(std::move(line));
      }
  return fmt::format("// Generated from the settings of all pass types.\n"
                     "#ifndef DERMIS_OPTIONS_GLSL\n#define DERMIS_OPTIONS_GLSL\n\n{}\n\n#endif\n",
                     fmt::join(lines, "\n"));
}

// Returns the constants that C++ and GLSL share.
std::string shared_constants() {
  return fmt::format(
      "// Generated from the constants of passes/common/.\n"
      "#ifndef DERMIS_CONSTANTS_GLSL\n#define DERMIS_CONSTANTS_GLSL\n\n"
      "const float copy_below_d_px = {}; // pass_types.hpp\n"
      "const float uniform_reach_d = {:.1f}; // uniform_light.hpp\n"
      "const float uniform_tolerance = {};\n"
      "const int uniform_max_reach = {};\n"
      "const uint uniform_cell_side = {}u;\n"
      "const float allot_gain_0 = {}, allot_gain_1 = {}, allot_gain_2 = {}; // "
      "sample_allocation.hpp\n"
      "const float allocation_stay = {};\n"
      "const int allocation_first_bin = {};\n"
      "const uint full_pixel_weight = {}u, pixel_weight_step = {}u; // tile_selection.hpp\n"
      "const uint no_pixel_weight = {}u;\n"
      "const uint all_steady = {}u, min_steady = {}u, steady_gain = {}u;\n"
      "const uint selection_kept_bit = {}u, selection_level_shift = {}u;\n"
      "const uint max_selection_level = {}u, highest_level_weight = {}u;\n"
      "const float selection_stay = {};\n"
      "const uint selection_first_bin = {}u;\n"
      "const float min_patch_cosine = {}, max_patch_slope = {}; // reference/surface.hpp\n"
      "const float relief_near_d = {}, relief_far_d = {}; // reference/relief.hpp\n"
      "const float relief_max_offset = {}; // pixels\n"
      "const float relief_turn = {}, relief_width = {}, relief_range_d = {:.1f};\n"
      "const int separable_nodes = {}; // separable_kernel.hpp\n"
      "const float separable_first_log2_d = {:.1f};\n"
      "const float separable_log2_d_step = {:.1f};\n"
      "const int separable_rows_per_kernel = {};\n"
      "const int sap_levels = {}; // sap_weights.hpp\n"
      "const int sap_variants = {};\n"
      "const int sap_half = {}, sap_plain = {};\n"
      "const int sap_nodes = {}, sap_table_pairs = {};\n"
      "const float sap_nodes_per_octave = {:.1f};\n"
      "const float sap_log2_d_first = {};\n"
      "const int sap_shape_nodes = {};\n"
      "const float sap_last_log2_aspect = {}, sap_log2_aspect_step = {};\n"
      "const int sap_first_short_tent = {};\n"
      "const float sap_max_short_variance = {};\n"
      "const uint sap_tiles_per_group_first = {}u; // sap_tiles.hpp\n"
      "const uint sap_tiles_per_group = {}u;\n"
      "const int sap_coarse_words = {};\n"
      "const uint tiles_per_run_group = {}u; // dispatch.hpp\n"
      "const int radial_nodes = {}; // profiles/radial_table.hpp\n"
      "const float radial_log2_r_first = {:.1f};\n"
      "const float radial_nodes_per_octave = {:.1f};\n"
      "const float radial_inverse_nodes_per_unit = {:.1f};\n"
      "const float reproject_snap_px = {}; // reproject.hpp\n"
      "const float reproject_largest_velocity = {:.1f};\n"
      "const float reproject_depth_fraction = {};\n"
      "const float reproject_depth_pixels = {:.1f};\n"
      "const float reproject_depth_rounding = {};\n"
      "const float reproject_slope_pixels = {:.1f};\n"
      "const float reproject_min_weight = {};\n"
      "const float accumulate_min_mean = {}; // accumulate.hpp\n"
      "const float accumulate_largest_remainder = {:.1f};\n"
      "const float counter_log2_shift = {:.1f}; // environment.hpp\n"
      "const float counter_log2_steps = {:.1f};\n"
      "const float through_square_steps = {:.1f}, relief_steps = {:.1f};\n\n#endif\n",
      subsurface::copy_below_d_px, subsurface::uniform_reach_d, subsurface::uniform_tolerance,
      subsurface::uniform_max_reach, subsurface::uniform_cell_side, choice::allocation_gain[0],
      choice::allocation_gain[1], choice::allocation_gain[2], choice::allocation_stay,
      choice::allocation_first_bin, choice::full_pixel_weight, choice::pixel_weight_step,
      choice::no_pixel_weight, choice::all_steady, choice::min_steady, choice::steady_gain,
      choice::selection_kept_bit, choice::selection_level_shift, choice::max_selection_level,
      choice::highest_level_weight, choice::selection_stay, choice::selection_first_bin,
      subsurface::min_patch_cosine, subsurface::max_patch_slope, subsurface::relief_near_d,
      subsurface::relief_far_d, subsurface::relief_max_offset, subsurface::relief_turn,
      subsurface::relief_width, subsurface::relief_range_d, subsurface::separable_nodes,
      subsurface::separable_first_log2_d, subsurface::separable_log2_d_step,
      subsurface::separable_rows_per_profile, subsurface::sap_level_count,
      subsurface::sap_variant_count, static_cast<int>(subsurface::SapVariant::half),
      static_cast<int>(subsurface::SapVariant::plain), subsurface::sap_node_count,
      subsurface::sap_table_pairs, double(subsurface::sap_nodes_per_octave),
      subsurface::sap_log2_d_first, subsurface::sap_shape_nodes, subsurface::sap_last_log2_aspect,
      subsurface::sap_log2_aspect_step, subsurface::sap_first_short_tent,
      subsurface::sap_max_short_variance, subsurface::sap_tiles_per_group_first,
      subsurface::sap_tiles_per_group, subsurface::sap_coarse_words(subsurface::sap_max_view_side),
      subsurface::tiles_per_run_group, subsurface::radial_nodes, subsurface::radial_log2_r_first,
      subsurface::radial_nodes_per_octave, subsurface::radial_inverse_nodes_per_unit,
      subsurface::reproject_snap_px, subsurface::reproject_largest_velocity,
      subsurface::reproject_depth_fraction, subsurface::reproject_depth_pixels,
      subsurface::reproject_depth_rounding, subsurface::reproject_slope_pixels,
      subsurface::reproject_min_weight, subsurface::accumulate_min_mean,
      subsurface::accumulate_largest_remainder, subsurface::counter_log2_shift,
      subsurface::counter_log2_steps, subsurface::through_square_steps, subsurface::relief_steps);
}

} // namespace

std::vector<GeneratedFile> generated_glsl() {
  const PassTypeRegistry pass_types = subsurface::make_pass_types();
  std::vector<GeneratedFile> files;
  for (uint32_t i = 0; i < pass_types.size(); ++i) {
    const PassType& type = pass_types[PassTypeId{i}];
    files.push_back({fmt::format("{}.bindings.glsl", type.shader), header_of(type)});
  }
  files.push_back({"constants.glsl", shared_constants()});
  files.push_back({"options.glsl", option_values(pass_types)});
  return files;
}

} // namespace dermis
