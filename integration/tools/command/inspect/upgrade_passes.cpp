#include "integration/tools/command/inspect/upgrade_passes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace dermis::tools {
namespace {

constexpr size_t level_count = 8;

std::string_view type_of(const TextEdits& edits, NodeId pass) {
  const NodeId type = edits.string_at(pass, "kind");
  return type.valid() ? edits.document.text(type) : std::string_view();
}

NodeId port_of(const TextEdits& edits, NodeId pass, std::string_view side, std::string_view port) {
  return edits.string_at(edits.document.find(pass, side), port);
}

// Returns a name that differs for each resource `of`; plain for its usual name.
std::string name_for(std::string_view what, std::string_view of, std::string_view usual) {
  return of == usual ? std::string(what) : fmt::format("{}_of_{}", what, of);
}

// Resources that a separable pass of version 1 reads, and the pass that writes them.
struct SeparableInputs {
  NodeId setup;        // the pass that writes the light; invalid: none
  bool shared = false; // other passes read the light, too
  std::string_view light, material, depth, classes = "classes";
};

SeparableInputs inputs_of(const TextEdits& edits, const std::vector<NodeId>& passes,
                          NodeId separable) {
  SeparableInputs inputs;
  inputs.light = edits.at_port(separable, "read", "light");
  inputs.material = edits.at_port(separable, "read", "material");
  inputs.depth = edits.at_port(separable, "read", "depth");
  const Document& document = edits.document;
  for (const NodeId pass : passes) {
    const std::string_view type = type_of(edits, pass);
    if (type == "subsurface.setup" && edits.at_port(pass, "write", "light") == inputs.light)
      inputs.setup = pass;
    if (type == "subsurface.classify" && edits.at_port(pass, "read", "material") == inputs.material)
      inputs.classes = edits.at_port(pass, "write", "classes");
    const NodeId read = document.find(pass, "read");
    if (!read.valid() || document[read].kind != NodeKind::object || type == "subsurface.separable")
      continue;
    for (const NodeId value : children(document, read))
      inputs.shared = inputs.shared || (document[value].kind == NodeKind::string &&
                                        document.text(value) == inputs.light);
  }
  return inputs;
}

// Converts the setup pass if only separable passes read what it writes.
bool convert_setup(TextEdits& edits, const SeparableInputs& inputs, const std::string& view_depth) {
  const NodeId setup = inputs.setup;
  if (!setup.valid() || inputs.shared) return false;
  const NodeId written = edits.document.find(setup, "write");
  const NodeId tiles = port_of(edits, setup, "read", "tiles"),
               arguments = port_of(edits, setup, "read", "arguments");
  if (children(edits.document, written).size() != 1 || !tiles.valid() || !arguments.valid())
    return false;
  edits.rename(edits.string_at(setup, "kind"), "subsurface.separable_setup");
  edits.replace_member(tiles, fmt::format(R"("classes": "{}")", inputs.classes));
  edits.remove_member(arguments);
  edits.add_member(written, fmt::format(R"("view_depth": "{}")", view_depth));
  return true;
}

void insert_setup(TextEdits& edits, NodeId separable, const SeparableInputs& inputs,
                  const std::string& light, const std::string& view_depth) {
  const NodeId setup = inputs.setup;
  const std::string_view albedo =
      setup.valid() ? edits.at_port(setup, "read", "albedo") : std::string_view();
  const std::string_view texturing =
      setup.valid() ? edits.at_port(setup, "set", "texturing") : std::string_view();
  const size_t begin = edits.document[separable].offset;
  edits.replace(
      begin, begin,
      fmt::format(
          R"({{ "pass": "{}", "type": "subsurface.separable_setup", "read": {{ "lighting": "{}", )"
          R"("material": "{}", "depth": "{}"{}, "classes": "{}" }}, )"
          R"("write": {{ "light": "{}", "view_depth": "{}" }}{} }}, )",
          name_for("separable_setup", inputs.light, "light"),
          setup.valid() ? edits.at_port(setup, "read", "lighting") : inputs.light, inputs.material,
          inputs.depth, albedo.empty() ? "" : fmt::format(R"(, "albedo": "{}")", albedo),
          inputs.classes, light, view_depth,
          texturing.empty() ? "" : fmt::format(R"(, "set": {{ "texturing": "{}" }})", texturing)));
}

// Returns the name of the image whose mips are the levels that a pass reads.
std::string levels_of(const TextEdits& edits, NodeId pass) {
  return name_for("levels", edits.at_port(pass, "read", "level_1"), "level_1");
}

// Renames a level at the ports of a pass that reads or writes single levels.
void rename_levels(TextEdits& edits, NodeId pass,
                   const std::map<std::string_view, std::string>& mips) {
  const Document& document = edits.document;
  bool reads_mip = false, writes_mip = false;
  for (const char* side : {"read", "write"}) {
    const NodeId ports = document.find(pass, side);
    if (!ports.valid() || document[ports].kind != NodeKind::object) continue;
    for (const NodeId value : children(document, ports)) {
      if (document[value].kind != NodeKind::string) continue;
      const auto mip = mips.find(document.text(value));
      if (mip == mips.end()) continue;
      edits.rename(value, mip->second);
      (side[0] == 'r' ? reads_mip : writes_mip) = true;
    }
  }
  if (!writes_mip || type_of(edits, pass) != "subsurface.pyramid_down") return;
  const std::string borders = fmt::format(R"("borders": "{}")", reads_mip ? "none" : "fine");
  if (const NodeId set = document.find(pass, "set"); set.valid())
    edits.add_member(set, borders);
  else
    edits.add_member(pass, fmt::format(R"("set": {{ {} }})", borders));
}

} // namespace

void upgrade_separable(TextEdits& edits, const std::vector<NodeId>& passes, AddedResources& added) {
  std::map<std::string_view, std::string> lights; // by old light: the light of version 2
  for (const NodeId pass : passes) {
    if (type_of(edits, pass) != "subsurface.separable") continue;
    const SeparableInputs inputs = inputs_of(edits, passes, pass);
    if (inputs.light.empty() || inputs.material.empty() || inputs.depth.empty()) continue;
    const std::string view_depth = name_for("view_depth", inputs.light, "light");
    auto known = lights.find(inputs.light);
    if (known == lights.end()) {
      std::string light(inputs.light);
      added.emplace(view_depth, "view_depth");
      if (!convert_setup(edits, inputs, view_depth)) {
        light = name_for("separable_light", inputs.light, "light");
        added.emplace(light, "separable_light");
        insert_setup(edits, pass, inputs, light, view_depth);
      }
      known = lights.emplace(inputs.light, light).first;
    }
    if (known->second != inputs.light)
      edits.rename(port_of(edits, pass, "read", "light"), known->second);
    edits.replace_member(port_of(edits, pass, "read", "material"),
                         fmt::format(R"("view_depth": "{}")", view_depth));
    edits.remove_member(port_of(edits, pass, "read", "depth"));
  }
}

void upgrade_level_light(TextEdits& edits, const std::vector<NodeId>& passes) {
  const Document& document = edits.document;
  std::set<std::string_view> images;
  for (const NodeId pass : passes)
    if (type_of(edits, pass).starts_with("subsurface.sap_"))
      for (const char* side : {"read", "write"})
        for (const char* port : {"light", "second_light", "coarse_light", "second_coarse_light"})
          images.insert(edits.at_port(pass, side, port));
  const NodeId resources = document.find(document.root(), "resources");
  for (const std::string_view image : images) {
    const NodeId declared = resources.valid() ? document.find(resources, image) : NodeId{};
    const NodeId format = edits.string_at(declared, "format");
    if (format.valid() && document.text(format) == "rgba16f") edits.rename(format, "rg16f");
  }
}

void upgrade_levels(TextEdits& edits, const std::vector<NodeId>& passes, AddedResources& added) {
  std::map<std::string_view, std::string> mips; // by old image
  const auto samples_levels = [&](NodeId pass) {
    const std::string_view type = type_of(edits, pass);
    return type == "subsurface.afis" || type == "subsurface.afis_tiles" ||
           type == "subsurface.guided";
  };
  for (const NodeId pass : passes) {
    if (!samples_levels(pass)) continue;
    for (size_t level = level_count; level >= 1; --level) {
      const NodeId value = port_of(edits, pass, "read", fmt::format("level_{}", level));
      if (!value.valid()) continue;
      const std::string levels = levels_of(edits, pass);
      mips.emplace(edits.document.text(value), fmt::format("{}#{}", levels, level - 1));
      added.emplace(levels, "levels");
      if (level == 1)
        edits.replace_member(value, fmt::format(R"("levels": "{}")", levels));
      else
        edits.remove_member(value);
    }
  }
  for (const NodeId pass : passes)
    if (!samples_levels(pass)) rename_levels(edits, pass, mips);
  const NodeId resources = edits.document.find(edits.document.root(), "resources");
  for (const auto& [image, mip] : mips)
    if (const NodeId declared =
            resources.valid() ? edits.document.find(resources, image) : NodeId{};
        declared.valid())
      edits.remove_member(declared);
}

void upgrade_tile_variance(TextEdits& edits, const std::vector<NodeId>& passes,
                           AddedResources& added) {
  const auto type_is = [&](std::string_view type) {
    return [&edits, type](NodeId pass) { return type_of(edits, pass) == type; };
  };
  const auto sampling =
      std::find_if(passes.begin(), passes.end(), type_is("subsurface.afis_tiles"));
  if (sampling == passes.end()) return;
  for (const NodeId pass : passes) {
    const NodeId read = edits.document.find(pass, "read"),
                 written = edits.document.find(pass, "write");
    if (!type_is("subsurface.contrast")(pass) || !read.valid() || !written.valid()) continue;
    std::string ports = fmt::format(R"("levels": "{}", "depth": "{}")", levels_of(edits, *sampling),
                                    edits.at_port(*sampling, "read", "depth"));
    if (const auto scale = edits.at_port(*sampling, "read", "scatter_scale"); !scale.empty())
      ports += fmt::format(R"(, "scatter_scale": "{}")", scale);
    const std::string d = name_for("tile_d", edits.at_port(pass, "write", "doubts"), "doubts");
    edits.add_member(read, ports);
    edits.add_member(written, fmt::format(R"("tile_d": "{}")", d));
    added.emplace(d, "tile_d");
  }
}

} // namespace dermis::tools
