#pragma once
// Lists the members of everything in a plan file in file order. Private to serialize/.

#include "framegraph/serialize/archive.hpp"
#include "framegraph/serialize/plan_file.hpp"
#include "framegraph/text/limits.hpp"

#include <limits>

namespace dermis::serial {

// only bounded by the size of the file
inline constexpr size_t many = std::numeric_limits<uint32_t>::max();
// the name of a host's pass type has two parts and a dot
inline constexpr size_t plan_name_bytes = 2 * limits::name_bytes + 1;
// an option in quotes, or a number
inline constexpr size_t setting_text_bytes = 2 * limits::name_bytes;

template <class A> void fields(A& a, Of<A, uint8_t>& value) {
  a.number("byte", value);
}

template <class A> void fields(A& a, Of<A, std::string>& value) {
  a.text("name", value, plan_name_bytes);
}

template <class A> void fields(A& a, Of<A, Format>& value) {
  a.word("format", value, static_cast<Format>(static_cast<uint8_t>(Format::count) - 1));
}

template <class A> void fields(A& a, Of<A, Layout>& value) {
  a.word("layout", value, Layout::transfer_destination);
}

template <class A, class Tag> void fields(A& a, Index<Tag>& id) {
  a.number("index", id.value);
}
template <class A, class Tag> void fields(A& a, const Index<Tag>& id) {
  a.number("index", id.value);
}

template <class A> void fields(A& a, Of<A, SettingValue>& value) {
  a.word("setting type", value.type, SettingType::choice);
  a.number("setting value", value.integer);
  a.real("setting value", value.real);
}

template <class A> void fields(A& a, Of<A, NamedSettingValue>& setting) {
  fields(a, setting.name);
  a.text("setting text", setting.text, setting_text_bytes);
}

template <class A> void fields(A& a, Of<A, PlanResource>& resource) {
  fields(a, resource.declared);
  a.word("resource type", resource.type, ResourceType::acceleration_structure);
  a.word("origin", resource.origin, Origin::transient);
  a.flag("exported", resource.exported);
  fields(a, resource.format);
  a.number("width", resource.width);
  a.number("height", resource.height);
  a.number("mips", resource.mips);
  a.number("layers", resource.layers);
  a.number("bytes", resource.bytes);
  a.number("usage", resource.vk_usage);
  a.number("instances", resource.instance_count);
  a.number("first instance", resource.first_instance);
  a.number("slot", resource.slot);
}

template <class A> void fields(A& a, Of<A, Heap>& heap) {
  a.number("memory type bits", heap.memory_type_bits);
  a.number("heap size", heap.size);
  a.number("heap alignment", heap.alignment);
  a.number("max live bytes", heap.max_live_bytes);
  a.flag("persistent", heap.persistent);
}

template <class A> void fields(A& a, Of<A, Placement>& placement) {
  a.number("placement's resource", placement.resource);
  a.number("placement's heap", placement.heap);
  a.number("offset", placement.offset);
  a.number("size", placement.size);
  a.number("alignment", placement.alignment);
  a.number("first use", placement.first_use);
  a.number("last use", placement.last_use);
  a.flag("persistent", placement.persistent);
}

template <class A> void fields(A& a, Of<A, PlanPass>& pass) {
  fields(a, pass.declared);
  fields(a, pass.type);
  a.number("first access", pass.first_access);
  a.number("accesses", pass.access_count);
  a.number("first barrier", pass.first_barrier);
  a.number("barriers", pass.barrier_count);
  a.number("first setting", pass.first_setting);
  a.word("queue", pass.queue, Queue::async);
  a.number("wait", pass.wait);
  a.number("releases", pass.release_count);
  a.number("signal", pass.signal);
}

template <class A> void fields(A& a, Of<A, SubresourceRange>& range) {
  a.number("first mip", range.first_mip);
  a.number("mips", range.mips);
  a.number("first layer", range.first_layer);
  a.number("layers", range.layers);
}

template <class A> void fields(A& a, Of<A, PlanAccess>& access) {
  a.number("port", access.port);
  a.number("access's resource", access.resource);
  a.number("frames back", access.frames_back);
  fields(a, access.range);
  a.number("stages", access.stages);
  a.number("access", access.access);
  fields(a, access.layout);
  a.flag("own texels", access.own_texels);
  a.flag("internally ordered", access.internally_ordered);
  a.word("when", access.when, ReadWhen::history_invalid);
}

template <class A> void fields(A& a, Of<A, PlanBarrier>& barrier) {
  a.number("barrier's resource", barrier.resource);
  a.number("frames back", barrier.frames_back);
  fields(a, barrier.range);
  a.number("source stages", barrier.source_stages);
  a.number("destination stages", barrier.destination_stages);
  a.number("source access", barrier.source_access);
  a.number("destination access", barrier.destination_access);
  fields(a, barrier.old_layout);
  fields(a, barrier.new_layout);
  a.word("why", barrier.why, PlanBarrier::ReasonKind::host_after);
  a.flag("from host", barrier.from_host);
  a.flag("to host", barrier.to_host);
  a.word("transfer", barrier.transfer, PlanBarrier::Transfer::acquire);
}

template <class A> void fields(A& a, Of<A, PlanSetting>& setting) {
  fields(a, setting.from);
  fields(a, setting.value);
}

template <class A> void fields(A& a, Of<A, PlanOrdering>& ordering) {
  a.number("earlier pass", ordering.earlier);
  a.number("later pass", ordering.later);
}

template <class A> void fields(A& a, Of<A, HistoryDeclaration>& history) {
  a.number("declared frames", history.frames);
  a.word("first", history.first, HistoryDeclaration::First::clear);
  a.word("on cut", history.on_cut, HistoryDeclaration::OnCut::keep);
  a.word("on resize", history.on_resize, HistoryDeclaration::OnResize::rescale);
}

template <class A> void fields(A& a, Of<A, PlanHistory>& history) {
  a.number("history's resource", history.resource);
  a.number("history's frames", history.frames);
  a.number("first range", history.first_range);
  a.number("ranges", history.range_count);
  a.number("first layout", history.first_layout);
  fields(a, history.declaration);
}

template <class A> void fields(A& a, Of<A, Plan>& plan) {
  a.text("graph", plan.graph, limits::name_bytes);
  a.number("view width", plan.view_width);
  a.number("view height", plan.view_height);
  a.number("pixel grid", plan.pixel_grid);
  a.text("device profile", plan.device_profile, limits::string_bytes);
  a.list("setting values", plan.setting_values, limits::settings);
  a.list("resources", plan.resources, limits::resources);
  a.list("heaps", plan.heaps, many);
  a.list("placements", plan.placements, many);
  a.list("passes", plan.passes, limits::passes);
  a.list("accesses", plan.accesses, many);
  a.list("barriers", plan.barriers, many);
  a.list("settings", plan.settings, many);
  a.list("orderings", plan.orderings, many);
  a.list("histories", plan.histories, limits::resources);
  a.list("history ranges", plan.history_ranges, many);
  a.list("history layouts", plan.history_layouts, many);
  a.number("first final barrier", plan.first_final_barrier);
  a.number("final barriers", plan.final_barrier_count);
  a.number("final wait", plan.final_wait);
  a.number("transient bytes", plan.transient_bytes);
  a.number("history bytes", plan.history_bytes);
}

template <class A> void fields(A& a, Of<A, PlanNames>& names) {
  a.list("names of passes", names.passes, limits::passes);
  a.list("names of pass types", names.pass_types, limits::passes);
  a.list("names of resources", names.resources, limits::resources);
  a.list("names of ports", names.ports, many);
  a.list("named settings", names.settings, limits::settings);
  a.list("named settings of passes", names.pass_settings, many);
}

template <class A> void fields(A& a, Of<A, PlanKey>& key) {
  for (auto& byte : key.graph)
    a.number("graph digest", byte);
  a.number("view width", key.view_width);
  a.number("view height", key.view_height);
  a.number("pixel grid", key.pixel_grid);
  a.text("device profile", key.device_profile, limits::string_bytes);
  a.number("buffer image granularity", key.buffer_image_granularity);
  a.number("max storage buffer bytes", key.max_storage_buffer_bytes);
  a.number("max image dimension", key.max_image_dimension);
  a.number("max image layers", key.max_image_layers);
  a.number("device local type bits", key.device_local_type_bits);
  a.number("max workgroup count", key.max_workgroup_count);
  a.number("max push constants bytes", key.max_push_constants_bytes);
  a.number("features", key.features);
  a.list("settings", key.settings, limits::settings);
  a.list("bound", key.bound, limits::resources);
  a.list("host formats", key.host_formats, limits::resources);
  a.word("order", key.order, PassOrder::random);
  a.number("order seed", key.order_seed);
  a.word("packing", key.packing, PackingLevel::optimize);
  a.flag("alias", key.alias);
  a.flag("cull", key.cull);
  a.flag("poison", key.poison);
  a.flag("single queue", key.single_queue);
  fields(a, key.keep_alive);
}

} // namespace dermis::serial
