#pragma once
// Names of stages, accesses, layouts and reasons, as every export of a plan writes them.

#include "framegraph/compile/plan.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace dermis {

// Names of the bits of a mask, lowest first ("compute_shader"); a bit without a name is written in hex.
std::vector<std::string> stage_names(Stage stages);
std::vector<std::string> access_names(Access accesses);
std::string_view layout_name(Layout layout);
std::string_view why_name(PlanBarrier::ReasonKind why);
std::string_view queue_name(Queue queue);
std::string_view transfer_name(PlanBarrier::Transfer transfer);
std::string_view read_when_name(ReadWhen when); // "history_valid"
std::string_view read_when_text(ReadWhen when); // " where it is valid", to stand behind what is read

// The same joined by '|'; "none" for an empty mask.
std::string stage_text(Stage stages);
std::string access_text(Access accesses);
std::string usage_text(ResourceType type, uint32_t vk_usage); // "sampled|storage"

// As a graph file names it, behind the name of the resource: "#1..3[0]"; "" for all that it has.
std::string range_text(const PlanResource& resource, const SubresourceRange& range);

// "640x360, 3 mips, 2 layers"; what there is one of is left out. Images.
std::string shape_text(const PlanResource& resource);

// 1536 -> "1.5 KiB", to one decimal, exact below 1 KiB.
std::string bytes_text(uint64_t bytes);

} // namespace dermis
