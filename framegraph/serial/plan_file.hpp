#pragma once
// A plan as a file: little endian, versioned, with the whole key of what it was compiled from and the names
// that people know its parts by. The layout is in docs/plans.md.

#include "framegraph/compile/plan.hpp"
#include "framegraph/serial/plan_key.hpp"
#include "framegraph/text/diagnostic.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dermis {

inline constexpr uint32_t plan_file_version = 6; // raised with each change of the layout

struct NamedSettingValue {
  std::string name, text; // text: the value as a graph file would write it
};

// What the plan's indices into graph and pass types mean.
struct PlanNames {
  std::vector<std::string> passes, pass_types;  // one each per Plan::passes
  std::vector<std::string> resources;           // one per Plan::resources
  std::vector<std::string> ports;               // one per Plan::accesses
  std::vector<NamedSettingValue> settings;      // one per Plan::setting_values
  std::vector<NamedSettingValue> pass_settings; // one per Plan::settings
};

struct SavedPlan {
  PlanKey key;
  PlanNames names;
  Plan plan;
};

// `plan` must be what compiling `input` gives.
SavedPlan saved_plan(const CompileInput& input, const Plan& plan);

// Canonical bytes of the plan alone, names and key left out: what two compilers must agree on.
std::string plan_bytes(const Plan& plan);

// The file. The same value gives the same bytes.
std::string write_plan(const SavedPlan& saved);

// Does the file begin as one of plans does?
bool is_plan_file(std::string_view bytes);

// The value that gave these bytes, or nullopt with one error in `diagnostics`. Any bytes may be given: counts
// are checked before memory is taken for them, and a plan that is returned has passed verify_structure(), so
// that each of its indices can be followed. Whether it can be run without hazards says verify().
// Free-threaded.
std::optional<SavedPlan> read_plan(const std::string& name, std::string_view bytes, Diagnostics& diagnostics);

} // namespace dermis
