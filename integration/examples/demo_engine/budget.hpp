#pragma once
// How the choices of a graph are made (docs/choice.md).

#include <cstdint>
#include <string>

namespace demo {

struct NamedText {
  std::string name, text; // name of the file, for messages
  bool operator==(const NamedText&) const = default;
};

// When the choices may run a technique only to measure its time.
enum class Trials : uint8_t { always, cuts, never };

struct Budget {
  double ms = 0;         // device time per frame; 0: the choices take their defaults
  double percentile = 0; // fraction of frames within the budget; 0: the library's
  Trials trials = Trials::always;
  bool deterministic = false; // decides by the calibration only
  NamedText calibration = {}; // JSON, as of RenderSummary::calibration; "": the library's
  NamedText errors = {};      // JSON of an error table; "": the library's
};

} // namespace demo
