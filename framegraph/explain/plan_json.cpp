#include "framegraph/explain/plan_json.hpp"

#include "framegraph/explain/names.hpp"
#include "framegraph/explain/reasons.hpp"
#include "framegraph/text/json_writer.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis {
namespace {

// Indexed by the value of the enumeration.
constexpr std::string_view setting_types[] = {"bool", "int", "real", "enum", "choice"};
constexpr std::string_view subjects[] = {"pass", "resource", "barrier", "setting", "order"};
constexpr std::string_view history_first[] = {"discard", "clear"};
constexpr std::string_view history_on_cut[] = {"invalidate", "keep"};
constexpr std::string_view history_on_resize[] = {"invalidate", "rescale"};

template <class Enum, size_t count>
std::string_view name_in(const std::string_view (&names)[count], Enum value) {
  return static_cast<size_t>(value) < count ? names[static_cast<size_t>(value)] : "unknown";
}

struct Exporter {
  const Graph& graph;
  const PassTypeRegistry& pass_types;
  const CompiledPlan& compiled;
  const Provenance& provenance;
  const Plan& plan = compiled.plan;
  JsonWriter out = {};

  const std::string& name(uint32_t resource) const {
    return graph.resources[plan.resources[resource].declared.value].name;
  }

  void mask(std::string_view key, uint64_t bits, const std::vector<std::string>& names) {
    out.key(key)
        .open_object(true)
        .member("mask", fmt::format("{:#x}", bits))
        .key("names")
        .open_array(true);
    for (const std::string& one : names)
      out.value(one);
    out.close().close();
  }

  void layout(std::string_view key, Layout which) {
    out.key(key).open_object(true).member("vulkan", static_cast<uint32_t>(which));
    out.member("name", layout_name(which)).close();
  }

  // Options are written by name, other values as they are.
  template <class Options> void setting_value(const SettingValue& value, const Options& options) {
    const bool named =
        (value.type == SettingType::enumeration || value.type == SettingType::choice) &&
        value.integer >= 0 && static_cast<size_t>(value.integer) < options.size();
    out.key("value");
    if (named)
      out.value(std::string_view(options[static_cast<size_t>(value.integer)]));
    else if (value.type == SettingType::boolean)
      out.value(value.integer != 0);
    else if (value.type == SettingType::real)
      out.value(value.real);
    else
      out.value(value.integer);
  }

  void settings() {
    out.key("settings").open_array();
    for (size_t i = 0; i < graph.settings.size(); ++i) {
      const SettingDeclaration& setting = graph.settings[i];
      out.open_object(true)
          .member("name", setting.name)
          .member("type", name_in(setting_types, setting.type));
      setting_value(plan.setting_values[i], setting.options);
      out.close();
    }
    out.close();
  }

  void resources() {
    out.key("resources").open_array();
    for (const PlanResource& resource : plan.resources) {
      const bool image = resource.type == ResourceType::image;
      out.open_object();
      out.member("name", graph.resources[resource.declared.value].name);
      out.member("type", type_name(resource.type));
      out.member("origin", resource.origin == Origin::imported ? "import" : "resource");
      out.member("exported", resource.exported).key("slot");
      resource.slot < 0 ? out.null() : out.value(resource.slot);
      if (image) {
        out.key("format").open_object(true).member("name", format_info(resource.format).name);
        out.member("vulkan", format_info(resource.format).vulkan).close();
        out.member("width", resource.width).member("height", resource.height);
        out.member("mips", resource.mips).member("layers", resource.layers);
      } else {
        out.member("bytes", resource.bytes);
      }
      out.member("vulkan_usage", resource.vk_usage).member("instances", resource.instance_count);
      out.key("first_placement");
      resource.first_instance == no_instance ? out.null() : out.value(resource.first_instance);
      out.close();
    }
    out.close();
  }

  void memory() {
    out.key("heaps").open_array();
    for (const Heap& heap : plan.heaps) {
      out.open_object(true).member("size", heap.size).member("alignment", heap.alignment);
      out.member("memory_type_bits", heap.memory_type_bits)
          .member("max_live_bytes", heap.max_live_bytes);
      out.member("optimal", heap.size == heap.max_live_bytes)
          .member("persistent", heap.persistent)
          .close();
    }
    out.close().key("placements").open_array();
    for (const Placement& placement : plan.placements) {
      out.open_object(true)
          .member("resource", placement.resource)
          .member("name", name(placement.resource));
      out.member("heap", placement.heap)
          .member("offset", placement.offset)
          .member("size", placement.size);
      out.member("alignment", placement.alignment).member("first_use", placement.first_use);
      out.member("last_use", placement.last_use).member("persistent", placement.persistent).close();
    }
    out.close();
  }

  void subresources(const SubresourceRange& range, std::string_view key = "range") {
    if (!key.empty()) out.key(key);
    out.open_object(true).member("first_mip", range.first_mip).member("mips", range.mips);
    out.member("first_layer", range.first_layer).member("layers", range.layers).close();
  }

  void barriers(std::string_view key, uint32_t first, uint32_t count) {
    out.key(key).open_array();
    for (uint32_t b = first; b < first + count; ++b) {
      const PlanBarrier& barrier = plan.barriers[b];
      out.open_object();
      out.member("index", b)
          .member("resource", barrier.resource)
          .member("name", name(barrier.resource));
      out.member("frames_back", barrier.frames_back);
      subresources(barrier.range);
      out.member("why", why_name(barrier.why));
      out.member("from_host", barrier.from_host).member("to_host", barrier.to_host);
      out.member("transfer", transfer_name(barrier.transfer));
      mask("source_stages", barrier.source_stages, stage_names(barrier.source_stages));
      mask("source_access", barrier.source_access, access_names(barrier.source_access));
      mask("destination_stages", barrier.destination_stages,
           stage_names(barrier.destination_stages));
      mask("destination_access", barrier.destination_access,
           access_names(barrier.destination_access));
      layout("old_layout", barrier.old_layout);
      layout("new_layout", barrier.new_layout);
      out.close();
    }
    out.close();
  }

  void point(std::string_view key, bool none, uint32_t number) {
    out.key(key);
    none ? out.null() : out.value(number);
  }

  void accesses(const PlanPass& pass) {
    out.key("accesses").open_array();
    for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a) {
      const PlanAccess& access = plan.accesses[a];
      const Port& port = pass_types[pass.type].ports[access.port];
      out.open_object();
      out.member("port", port.name)
          .member("binding", access.port)
          .member("usage", usage_info(port.usage).name);
      out.member("resource", access.resource).member("name", name(access.resource));
      out.member("frames_back", access.frames_back);
      subresources(access.range);
      mask("stages", access.stages, stage_names(access.stages));
      mask("access", access.access, access_names(access.access));
      layout("layout", access.layout);
      out.member("own_texels", access.own_texels)
          .member("internally_ordered", access.internally_ordered)
          .member("when", read_when_name(access.when));
      out.close();
    }
    out.close();
  }

  void pass(const PlanPass& pass) {
    const PassType& type = pass_types[pass.type];
    out.open_object();
    out.member("name", graph.passes[pass.declared.value].name).member("kind", type.name);
    out.member("dispatch", type.dispatch.name);
    out.member("queue", queue_name(pass.queue));
    point("wait", pass.wait == no_point, pass.wait);
    out.key("after").open_array(true);
    const auto position = static_cast<uint32_t>(&pass - plan.passes.data());
    const auto [first, last] =
        std::equal_range(plan.orderings.begin(), plan.orderings.end(), PlanOrdering{0, position});
    for (auto at = first; at != last; ++at)
      out.value(at->earlier);
    out.close();
    barriers("barriers", pass.first_barrier, pass.barrier_count);
    accesses(pass);
    barriers("releases", pass.first_barrier + pass.barrier_count, pass.release_count);
    point("signal", pass.signal == 0, pass.signal);
    out.key("settings").open_array();
    for (uint32_t s = 0; s < type.settings.size(); ++s) {
      const PlanSetting& setting = plan.settings[pass.first_setting + s];
      out.open_object(true).member("name", type.settings[s].name);
      setting_value(setting.value, type.settings[s].options);
      out.key("follows");
      setting.from.valid() ? out.value(graph.settings[setting.from.value].name) : out.null();
      out.close();
    }
    out.close().close();
  }

  void histories() {
    out.key("histories").open_array();
    for (const PlanHistory& history : plan.histories) {
      out.open_object();
      out.member("resource", history.resource).member("name", name(history.resource));
      out.member("frames", history.frames);
      out.member("first", name_in(history_first, history.declaration.first));
      out.member("on_cut", name_in(history_on_cut, history.declaration.on_cut));
      out.member("on_resize", name_in(history_on_resize, history.declaration.on_resize));
      out.key("layout_at_start").open_array(true);
      for (uint32_t i = 0; i < (history.frames + 1) * history.range_count; ++i)
        out.value(layout_name(plan.history_layouts[history.first_layout + i]));
      out.close().key("parts").open_array();
      for (uint32_t r = 0; r < history.range_count; ++r)
        subresources(plan.history_ranges[history.first_range + r], {});
      out.close().close();
    }
    out.close();
  }

  void reasons() {
    out.key("reasons").open_array();
    for (const Reason& reason : compiled.reasons) {
      out.open_object(true)
          .member("about", name_in(subjects, reason.about))
          .member("index", reason.index);
      if (reason.about == Reason::About::pass) out.member("name", graph.passes[reason.index].name);
      if (reason.about == Reason::About::resource)
        out.member("name", graph.resources[reason.index].name);
      if (reason.about == Reason::About::choice)
        out.member("name", graph.settings[reason.index].name);
      out.member("text", reason_text(graph, pass_types, plan, reason)).close();
    }
    if (!compiled.reasons.empty()) {
      const std::vector<std::string> texts = placement_reasons(graph, plan);
      for (size_t i = 0; i < texts.size(); ++i)
        out.open_object(true)
            .member("about", "placement")
            .member("index", i)
            .member("text", texts[i])
            .close();
    }
    out.close();
  }

  void changes() {
    out.key("changes").open_array();
    for (const Change& change : provenance.changes) {
      const uint32_t file = change.where.file.value;
      out.open_object(true).member("did", change_name(change.what)).member("at", change.at);
      out.member("file",
                 file < provenance.files.size() ? provenance.files[file].name : std::string());
      out.member("line", change.where.line).member("column", change.where.column).close();
    }
    out.close();
  }

  std::string whole() {
    out.open_object();
    out.member("dermis_plan", plan_json_version).member("graph", plan.graph);
    out.key("view").open_array(true).value(plan.view_width).value(plan.view_height).close();
    out.member("device_profile", plan.device_profile);
    out.member("transient_bytes", plan.transient_bytes).member("history_bytes", plan.history_bytes);
    settings();
    resources();
    memory();
    histories();
    out.key("passes").open_array();
    for (const PlanPass& one : plan.passes)
      pass(one);
    out.close();
    point("final_wait", plan.final_wait == no_point, plan.final_wait);
    barriers("final_barriers", plan.first_final_barrier, plan.final_barrier_count);
    reasons();
    changes();
    out.close();
    return std::move(out).finish();
  }
};

} // namespace

std::string plan_json(const Graph& graph, const PassTypeRegistry& pass_types,
                      const CompiledPlan& compiled, const Provenance& provenance) {
  return Exporter{graph, pass_types, compiled, provenance}.whole();
}

} // namespace dermis
