#pragma once
// Names stages, accesses, layouts and reasons, consistently for all exports of a plan.

#include "framegraph/compile/plan.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace dermis {

// Return the names of the set bits, lowest first ("compute_shader"). Bits without a name are in
// hex.
std::vector<std::string> stage_names(Stage stages);
std::vector<std::string> access_names(Access accesses);
std::string_view layout_name(Layout layout);
std::string_view why_name(PlanBarrier::ReasonKind why);
std::string_view queue_name(Queue queue);
std::string_view transfer_name(PlanBarrier::Transfer transfer);
std::string_view read_when_name(ReadWhen when); // "history_valid"
std::string_view read_when_text(ReadWhen when); // " if valid", appended to what is read

// Return the names joined by '|'; "none" for an empty mask.
std::string stage_text(Stage stages);
std::string access_text(Access accesses);
std::string usage_text(ResourceType type, uint32_t vk_usage); // "sampled|storage"

// Returns the range as a graph file writes it after the resource's name: "#1..3[0]"; "" for the
// whole resource.
std::string range_text(const PlanResource& resource, const SubresourceRange& range);

// Returns "640x360, 3 mips, 2 layers" for an image; counts of 1 are omitted.
std::string shape_text(const PlanResource& resource);

// Returns e.g. "1.5 KiB" for 1536: one decimal, exact below 1 KiB.
std::string bytes_text(uint64_t bytes);

} // namespace dermis
