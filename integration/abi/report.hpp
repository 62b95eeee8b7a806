#pragma once
// Holds all messages of one call for the host: structured, as text and as JSON. Texts live as long
// as the report.

#include "framegraph/text/diagnostic.hpp"
#include "integration/abi/failure.hpp"
#include "integration/include/dermis/dermis.h"

#include <string>

struct dermis_report_t {
  dermis::Diagnostics diagnostics;
  std::vector<std::string> texts; // one per message: text and suggestion
  std::string text, json;
};

namespace dermis::abi {

// Logs every message, stores the first error as the thread's last error, and returns the report in
// `out` unless that is null. Returns `result`. May throw std::bad_alloc before the report is
// returned.
dermis_result conclude(const Log& log, dermis_result result, Diagnostics&& diagnostics,
                       dermis_report* out);

dermis_message message_at(const dermis_report_t& report, size_t index);

} // namespace dermis::abi
