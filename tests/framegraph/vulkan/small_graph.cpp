#include "tests/framegraph/vulkan/small_graph.hpp"

#include "framegraph/model/image_range.hpp"

#include <gtest/gtest.h>

#include "test_add.spv.h"
#include "test_classes.spv.h"
#include "test_constant.spv.h"
#include "test_count.spv.h"
#include "test_fill.spv.h"
#include "test_list.spv.h"
#include "test_mark.spv.h"
#include "test_sample.spv.h"
#include "test_show.spv.h"
#include "test_stamp.spv.h"

namespace dermis::testing {
namespace {

constexpr Port target{"target", Usage::storage_image_write, false, "image2D", "", {}};
constexpr Port fill_ports[] = {target};
constexpr PassTypeSetting fill_settings[] = {
    {"value", SettingType::real, {SettingType::real, 0, 1.0}, -1e6, 1e6, {}, "", ""},
    {"slope", SettingType::integer, {SettingType::integer, 0, 0.0}, -1000, 1000, {}, "", ""},
};
constexpr Port add_ports[] = {
    {"a", Usage::sampled_image, false, "texture2D", "", {}},
    {"b", Usage::sampled_image, true, "texture2D", "", {}},
    {"ids", Usage::sampled_image, true, "utexture2D", "", {}},
    target,
    {"second", Usage::storage_image_write, true, "image2D", "", {}},
    {"weights", Usage::storage_buffer_read, true, "float", "", {}},
};
constexpr PassTypeSetting add_settings[] = {
    {"bias", SettingType::real, {SettingType::real, 0, 0.0}, -1e6, 1e6, {}, "", ""},
};
constexpr Port sample_ports[] = {{"a", Usage::sampled_image, false, "texture2D", "", {}}, target};
constexpr Port classes_ports[] = {{"classes", Usage::storage_buffer_write, false, "uint", "", {}}};
constexpr Port list_ports[] = {
    {"classes", Usage::storage_buffer_read, false, "uint", "", {}},
    {"tiles", Usage::storage_buffer_write, false, "uint", "", {}},
    {"arguments", Usage::storage_buffer_write, false, "uint", "", {}},
};
constexpr Port mark_ports[] = {
    {"tiles", Usage::storage_buffer_read, false, "uint", "", {}},
    {"arguments", Usage::indirect_arguments, false, "uint", "", {}},
    {"target", Usage::storage_image_update, false, "image2D", "", {}},
};
constexpr Port stamp_ports[] = {
    {"target", Usage::storage_image_write, true, "image2D", "", {}},
    {"ids", Usage::storage_image_write, true, "uimage2D", "", {}},
};
constexpr PassTypeSetting stamp_settings[] = {
    {"seed", SettingType::integer, {SettingType::integer, 0, 0.0}, 0, 1000, {}, "", ""},
};
constexpr Port show_ports[] = {
    {"a", Usage::sampled_image, true, "texture2D", "", {}},
    {"ids", Usage::sampled_image, true, "utexture2D", "", {}},
    target,
};
constexpr Port constant_ports[] = {
    {"more", Usage::sampled_image, true, "texture2D", "", {}},
    target,
};
constexpr std::string_view mode_options[] = {"low", "mid", "high"};
constexpr PassTypeSetting constant_settings[] = {
    {"bias", SettingType::real, {SettingType::real, 0, 0.0}, -1e6, 1e6, {}, "", ""},
    {"mode",
     SettingType::enumeration,
     {SettingType::enumeration, 1, 0},
     0,
     0,
     mode_options,
     "",
     ""},
    {"negate", SettingType::boolean, {SettingType::boolean, 0, 0}, 0, 0, {}, "", ""},
};
constexpr Port clear_ports[] = {
    {"target", Usage::clear, true, "", "", {}},
    {"buffer", Usage::clear, true, "", "", {}},
};

PassTypeRegistry make_pass_types() {
  using enum DispatchRule::Domain;
  PassTypeRegistry pass_types;
  const auto add = [&](std::string_view name, std::string_view kernel, std::span<const Port> ports,
                       std::span<const PassTypeSetting> settings, DispatchRule rule = {}) {
    pass_types.add({name, kernel, "", ports, settings, rule});
  };
  add("test.fill", "test_fill", fill_ports, fill_settings);
  add("test.add", "test_add", add_ports, add_settings);
  add("test.sample", "test_sample", sample_ports, {});
  add("test.classes", "test_classes", classes_ports, {}, {.cells_per_group = 64});
  add("test.list", "test_list", list_ports, {}, {.domain = one});
  add("test.mark", "test_mark", mark_ports, {}, {.domain = indirect});
  add("test.stamp", "test_stamp", stamp_ports, stamp_settings);
  add("test.show", "test_show", show_ports, {});
  add("test.count", "test_count", fill_ports, {}, {.domain = one}); // needs counters
  add("test.constant", "test_constant", constant_ports, constant_settings);
  add("test.clear", "", clear_ports, {}, {.domain = none});
  return pass_types;
}

} // namespace

const PassTypeRegistry& small_pass_types() {
  static const PassTypeRegistry pass_types = make_pass_types();
  return pass_types;
}

std::span<const vulkan::KernelCode> small_kernels() {
  static const vulkan::KernelCode kernels[] = {
      {"test_fill", test_fill_spirv},     {"test_add", test_add_spirv},
      {"test_sample", test_sample_spirv}, {"test_classes", test_classes_spirv},
      {"test_list", test_list_spirv},     {"test_mark", test_mark_spirv},
      {"test_show", test_show_spirv},     {"test_stamp", test_stamp_spirv},
      {"test_count", test_count_spirv},   {"test_constant", test_constant_spirv},
  };
  return kernels;
}

SmallGraph::SmallGraph(std::initializer_list<const char*> images) {
  for (const std::string declared : images) {
    const size_t blank = declared.find(' ');
    const std::string kind = declared.substr(0, blank);
    ResourceDeclaration& made = image(declared.substr(blank + 1));
    if (kind == "import" || kind == "in_out") made.origin = Origin::imported;
    made.exported = kind == "export" || kind == "in_out";
    if (kind == "history") made.history.frames = 1;
  }
}

ResourceDeclaration& SmallGraph::resource(const std::string& name, Format format) {
  ResourceDeclaration& added = graph.resources.emplace_back();
  added.name = name;
  added.formats = {format};
  return added;
}

ResourceDeclaration& SmallGraph::import(const std::string& name, Format format, bool optional) {
  ResourceDeclaration& added = resource(name, format);
  added.origin = Origin::imported;
  added.optional = optional;
  return added;
}

ResourceDeclaration& SmallGraph::exported(const std::string& name, Format format) {
  ResourceDeclaration& added = resource(name, format);
  added.exported = true;
  return added;
}

ResourceDeclaration& SmallGraph::image(const std::string& name, Format format) {
  return resource(name, format);
}

ResourceDeclaration& SmallGraph::history(const std::string& name, uint32_t frames) {
  ResourceDeclaration& added = resource(name, Format::r32f);
  added.history.frames = frames;
  return added;
}

ResourceDeclaration& SmallGraph::buffer(const std::string& name, uint32_t extra_elements) {
  ResourceDeclaration& added = graph.resources.emplace_back();
  added.name = name;
  added.type = ResourceType::buffer;
  added.stride = 4;
  added.size.x.denominator = added.size.y.denominator = 8;
  added.extra_elements = extra_elements;
  return added;
}

PortBinding SmallGraph::binding(const PassType& type, const std::string& port,
                                const std::string& text) const {
  const size_t at = std::min(text.find("@-"), text.size());
  const size_t end = std::min(text.find_first_of("#["), at);
  PortBinding result;
  result.range = parse_image_range(text.substr(end, at - end)).value_or(ImageRange{});
  result.port = static_cast<uint32_t>(find_port(type, port));
  result.frames_back =
      at == text.size() ? 0 : static_cast<uint32_t>(std::stoul(text.substr(at + 2)));
  for (uint32_t i = 0; i < graph.resources.size(); ++i)
    if (graph.resources[i].name == text.substr(0, end)) result.resource = ResourceId{i};
  EXPECT_TRUE(result.resource.valid()) << text;
  EXPECT_LT(result.port, type.ports.size()) << port;
  return result;
}

std::vector<PortBinding> SmallGraph::bindings(const PassType& type, const Ports& ports) const {
  std::vector<PortBinding> result;
  for (const auto& [port, text] : ports) {
    const size_t condition = text.find('?');
    result.push_back(binding(type, port, text.substr(0, condition)));
    if (condition == std::string::npos) continue;
    result.back().when = ReadWhen::history_valid;
    if (condition + 1 == text.size()) continue;
    result.push_back(binding(type, port, text.substr(condition + 1)));
    result.back().when = ReadWhen::history_invalid;
  }
  return result;
}

PassDeclaration& SmallGraph::pass(const std::string& name, const std::string& type,
                                  const Ports& reads, const Ports& writes) {
  PassDeclaration& added = graph.passes.emplace_back();
  added.name = name;
  added.type = small_pass_types().find(type);
  for (const PortBinding& one : bindings(small_pass_types()[added.type], reads))
    graph.bind(added, PortSide::read, one, {});
  for (const PortBinding& one : bindings(small_pass_types()[added.type], writes))
    graph.bind(added, PortSide::write, one, {});
  return added;
}

void SmallGraph::set(PassDeclaration& pass, const std::string& setting, double value) {
  const PassType& type = small_pass_types()[pass.type];
  SettingBinding& added = pass.settings.emplace_back();
  added.setting = static_cast<uint32_t>(find_setting(type, setting));
  added.literal = {type.settings[added.setting].type, static_cast<int64_t>(value), value};
}

SettingDeclaration& SmallGraph::setting(const std::string& name, double value) {
  SettingDeclaration& added = graph.settings.emplace_back();
  added.name = name;
  added.type = SettingType::real;
  added.default_value = {SettingType::real, 0, value};
  added.minimum = -1e6;
  added.maximum = 1e6;
  return added;
}

void SmallGraph::follow(PassDeclaration& pass, const std::string& setting,
                        const std::string& graph_setting) {
  SettingBinding& added = pass.settings.emplace_back();
  added.setting = static_cast<uint32_t>(find_setting(small_pass_types()[pass.type], setting));
  for (uint32_t i = 0; i < graph.settings.size(); ++i)
    if (graph.settings[i].name == graph_setting) added.from = SettingId{i};
}

int32_t SmallGraph::slot(const std::string& name) const {
  int32_t number = 0;
  for (const ResourceDeclaration& declared : graph.resources) {
    if (declared.origin != Origin::imported && !declared.exported) continue;
    if (declared.name == name) return number;
    ++number;
  }
  ADD_FAILURE() << name << " is not a slot";
  return 0;
}

Plan SmallGraph::compile(const DeviceProfile& device, uint32_t width, uint32_t height,
                         const std::vector<std::string>& unbound, bool poison) const {
  CompileInput input;
  input.graph = &graph;
  input.pass_types = &small_pass_types();
  input.device = &device;
  input.view_width = width;
  input.view_height = height;
  input.poison = poison;
  input.bound.assign(graph.resources.size(), true);
  for (const std::string& name : unbound)
    for (size_t i = 0; i < graph.resources.size(); ++i)
      if (graph.resources[i].name == name) input.bound[i] = false;
  Diagnostics diagnostics;
  const auto compiled = dermis::compile(input, diagnostics);
  for (const Diagnostic& diagnostic : diagnostics.list)
    ADD_FAILURE() << diagnostic.text;
  return compiled ? compiled->plan : Plan{};
}

} // namespace dermis::testing
