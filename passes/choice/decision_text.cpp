#include "passes/choice/budget_controller.hpp"

namespace dermis::choice {
namespace {

const char* text_of(ReasonKind why) {
  switch (why) {
  case ReasonKind::no_budget:
    return "no budget is set";
  case ReasonKind::first_frame:
    return "least error within the budget; first frame";
  case ReasonKind::fits_best:
    return "least error within the budget";
  case ReasonKind::better_fits:
    return "a configuration with less error now fits the budget";
  case ReasonKind::over_budget:
    return "the previous configuration exceeds the budget";
  case ReasonKind::nothing_fits:
    return "no configuration fits the budget: the fastest runs";
  case ReasonKind::held:
    return "kept, to switch less often";
  case ReasonKind::trial:
    return "tried, because it has less error and might fit the budget";
  case ReasonKind::trial_failed:
    return "the configuration that was tried exceeds the budget";
  }
  return "";
}

} // namespace

const char* why_text(const Decision& decision) {
  if (!decision.by_transmission) return text_of(decision.why);
  switch (decision.why) {
  case ReasonKind::first_frame:
    return "least error within the budget, considering transmitted light; first frame";
  case ReasonKind::fits_best:
    return "least error within the budget, considering transmitted light";
  case ReasonKind::better_fits:
    return "a configuration with less error now fits the budget, considering transmitted light";
  case ReasonKind::no_budget:
  case ReasonKind::over_budget:
  case ReasonKind::nothing_fits:
  case ReasonKind::held:
  case ReasonKind::trial:
  case ReasonKind::trial_failed:
    break;
  }
  return text_of(decision.why);
}

} // namespace dermis::choice
