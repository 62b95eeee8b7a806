// Serialises everything that compiling reads of a graph, so that equal bytes mean equal plans.

#include "framegraph/serialize/plan_fields.hpp"

#include <algorithm>

namespace dermis {
namespace {

struct GraphWriter {
  const Graph& graph;
  const PassTypeRegistry& pass_types;
  serial::Writer out = {};

  void text(std::string_view value) { out.text("", value, 0); }
  void number(uint64_t value) { out.number("", value); }
  template <class Enum> void word(Enum value) { number(static_cast<uint64_t>(value)); }
  void value(const SettingValue& value) { serial::fields(out, value); }
  template <class Tag> void index(Index<Tag> id) { number(id.value); }
  template <class List, class Each> void all(const List& list, Each each) {
    number(list.size());
    for (const auto& one : list)
      each(one);
  }

  void size(const SizeExpression& size) {
    word(size.base);
    index(size.resource);
    for (const Rational& factor : {size.x, size.y}) {
      number(static_cast<uint64_t>(factor.numerator));
      number(static_cast<uint64_t>(factor.denominator));
    }
    word(size.rounding);
    number(size.align);
    number(size.border);
  }

  void dispatch(const DispatchRule& rule) {
    text(rule.name);
    word(rule.domain);
    number(rule.cell_side);
    number(rule.cells_per_group);
    number(rule.invocations);
    number(rule.border);
    number(rule.max_groups);
  }

  void setting(const SettingDeclaration& setting) {
    text(setting.name);
    word(setting.type);
    value(setting.default_value);
    out.real("", setting.minimum);
    out.real("", setting.maximum);
    all(setting.options, [&](const std::string& option) { text(option); });
    number(setting.by_budget);
    all(setting.needs, [&](const OptionNeeds& needs) {
      number(needs.features);
      all(needs.imports, [&](ResourceId import) { index(import); });
    });
  }

  void resource(const ResourceDeclaration& resource) {
    text(resource.name);
    word(resource.type);
    word(resource.origin);
    number(resource.exported);
    number(resource.optional);
    all(resource.formats, [&](Format format) { word(format); });
    size(resource.size);
    number(resource.mips);
    number(resource.layers);
    number(resource.stride);
    number(resource.extra_elements);
    serial::fields(out, resource.history);
  }

  void expression(const Expression& expression) {
    word(expression.op);
    value(expression.literal);
    index(expression.setting);
    index(expression.left);
    index(expression.right);
    all(expression.list, [&](const SettingValue& one) { value(one); });
  }

  void bindings(std::span<const PortBinding> bindings) {
    all(bindings, [&](const PortBinding& binding) {
      number(binding.port);
      index(binding.resource);
      number(binding.frames_back);
      word(binding.when);
      for (const uint64_t side :
           {uint64_t{binding.range.first_mip}, uint64_t{binding.range.mips},
            uint64_t{binding.range.first_layer}, uint64_t{binding.range.layers}})
        number(side);
    });
  }

  void type(const PassType& type) {
    text(type.name);
    all(type.ports, [&](const Port& port) {
      text(port.name);
      word(port.usage);
      number(port.optional);
      text(port.glsl_type);
      all(port.formats, [&](Format format) { word(format); });
      text(port.formats_while.setting);
      number(static_cast<uint64_t>(port.formats_while.option));
      all(port.formats_while.formats, [&](Format format) { word(format); });
      number(port.filtered);
      number(port.own_texels);
      number(port.internally_ordered);
    });
    all(type.one_of, [&](std::string_view port) { text(port); });
    all(type.settings, [&](const PassTypeSetting& setting) {
      text(setting.name);
      word(setting.type);
      value(setting.default_value);
      all(setting.options, [&](std::string_view option) { text(option); });
    });
    dispatch(type.dispatch);
    number(type.side_effects);
    number(type.features);
  }

  void pass(const PassDeclaration& pass) {
    text(pass.name);
    index(pass.type); // plans hold the number of the pass type
    index(pass.when);
    number(pass.async);
    bindings(graph.reads(pass));
    bindings(graph.writes(pass));
    all(pass.settings, [&](const SettingBinding& binding) {
      number(binding.setting);
      index(binding.from);
      value(binding.literal);
    });
    all(pass.otherwise, [&](const PassThrough& through) {
      index(through.output);
      index(through.instead);
    });
    all(pass.after, [&](const Ordering& ordering) { index(ordering.after); });
  }

  void used_pass_types() {
    std::vector<PassTypeId> used;
    for (const PassDeclaration& one : graph.passes)
      used.push_back(one.type);
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    all(used, [&](PassTypeId id) { type(pass_types[id]); });
  }

  std::string whole() {
    text(graph.name);
    number(graph.features);
    all(graph.settings, [&](const SettingDeclaration& one) { setting(one); });
    all(graph.resources, [&](const ResourceDeclaration& one) { resource(one); });
    all(graph.expressions, [&](const Expression& one) { expression(one); });
    all(graph.passes, [&](const PassDeclaration& one) { pass(one); });
    used_pass_types();
    return std::move(out).finish();
  }
};

} // namespace

std::string graph_bytes(const Graph& graph, const PassTypeRegistry& pass_types) {
  return GraphWriter{graph, pass_types}.whole();
}

} // namespace dermis
