#pragma once
// Lists the configurations of a choice by budget: time, error, and the budgets that select each.
// Needs no device: times are those of calibrations, errors those of an error table.

#include "framegraph/text/json_writer.hpp"
#include "integration/examples/demo_engine/budget.hpp"
#include "integration/tools/command/run/choice_sets.hpp"

#include <string>
#include <vector>

namespace dermis::tools {

struct ChoiceRow {
  std::string configuration;
  double ms = 0;         // expected time, with all samples that tiles may request
  double rmse = 0;       // expected error
  bool selected = false; // by some budget
  double first_ms = 0;   // least budget that selects the configuration; 0: any budget
  double first_rmse = 0; // expected error with what fits that budget
  std::string better;    // takes no more time, or little more, with no more error; "": none
};

struct ChoiceTable {
  std::string device;          // of the calibration
  double d_px = 0;             // of the widest channel
  std::vector<ChoiceRow> rows; // by rising time
};

// Memory of the plan of a configuration.
struct ChoiceMemory {
  std::string configuration;
  uint64_t transient_bytes = 0, history_bytes = 0;
};

struct ChoiceTables {
  std::vector<ChoiceMemory> memory; // by plan, named after its first configuration
  // of a view, whose plans share memory; blocks that also hold histories count as histories
  uint64_t transient_bytes = 0, history_bytes = 0;
  std::vector<ChoiceTable> tables; // by calibration, then by d
  Diagnostics missing;             // rows that the error table and the calibrations lack
};

// Judges the choices of a graph in frames of which half of the tiles have subsurface. Without a
// calibration in `budget`, one table per built-in calibration. Returns nullopt with errors in
// `diagnostics`.
std::optional<ChoiceTables> choice_tables(const LoadedGraph& loaded, const Size& size,
                                          const CompileChoices& choices,
                                          const std::vector<bool>& pinned,
                                          const demo::Budget& budget, Diagnostics& diagnostics);

std::string describe_tables(const ChoiceTables& tables);
void write_tables(JsonWriter& writer, const ChoiceTables& tables);

} // namespace dermis::tools
