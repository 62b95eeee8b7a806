#pragma once
// Saves a plan as a file: little endian, versioned, with the whole key of its input and the names
// of its parts. docs/plans.md describes the layout.

#include "framegraph/compile/plan.hpp"
#include "framegraph/serialize/plan_key.hpp"
#include "framegraph/text/diagnostic.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dermis {

inline constexpr uint32_t plan_file_version = 7; // raised with each change of the layout

struct NamedSettingValue {
  std::string name, text; // text: the value as a graph file would write it
};

// Names for the plan's indices into graph and pass types.
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

// `plan` must be the result of compiling `input`.
SavedPlan saved_plan(const CompileInput& input, const Plan& plan);

// Returns the canonical bytes of the plan without names and key. Two compilers must agree on them.
std::string plan_bytes(const Plan& plan);

// Returns the file. Equal values give equal bytes.
std::string write_plan(const SavedPlan& saved);

// Returns whether the bytes begin like a plan file.
bool is_plan_file(std::string_view bytes);

// Returns the plan that gave these bytes, or nullopt with one error in `diagnostics`. Accepts any
// bytes: counts are checked before memory is allocated for them. A returned plan has passed
// verify_structure(), so each of its indices can be followed; verify() checks it for hazards.
// Free-threaded.
std::optional<SavedPlan> read_plan(const std::string& name, std::string_view bytes,
                                   Diagnostics& diagnostics);

} // namespace dermis
