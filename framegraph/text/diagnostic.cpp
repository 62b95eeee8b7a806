#include "framegraph/text/diagnostic.hpp"

#include "framegraph/text/limits.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>

namespace dermis {

namespace {

// The code is 'D' and a number of four digits; the literals in diagnostics.def have three.
#define DERMIS_DIAGNOSTIC(id, name, severity, hint)                                                \
  {DiagnosticId::name, "D0" #id, #name, Severity::severity, hint},
constexpr DiagnosticInfo infos[] = {
#include "framegraph/text/diagnostics.def"
};
#undef DERMIS_DIAGNOSTIC

constexpr bool sorted() {
  for (size_t i = 1; i < std::size(infos); ++i) {
    if (infos[i - 1].id >= infos[i].id) return false;
  }
  return true;
}
static_assert(sorted(), "diagnostics.def is kept sorted by number, each number once");

} // namespace

const DiagnosticInfo& diagnostic_info(DiagnosticId id) {
  const auto found =
      std::lower_bound(std::begin(infos), std::end(infos), id,
                       [](const DiagnosticInfo& info, DiagnosticId key) { return info.id < key; });
  return found != std::end(infos) && found->id == id ? *found : infos[0];
}

std::span<const DiagnosticInfo> all_diagnostic_infos() {
  return infos;
}

Diagnostic& Diagnostics::add(DiagnosticId id, SourceLocation where, std::string text) {
  const bool was_full = full(), is_error = diagnostic_info(id).severity == Severity::error;
  // The first error is listed in any case, in place of the last note or warning.
  const bool replaces = was_full && is_error && !has_errors();
  if (was_full && is_error && !replaces) ++dropped_errors;
  if (!was_full) list.emplace_back();
  const size_t index = replaces ? limits::diagnostics - 1 : list.size() - 1;
  if (list.size() == limits::diagnostics) {
    Diagnostic& last = list.emplace_back();
    last.id = DiagnosticId::too_many_diagnostics;
    last.text = fmt::format("only the first {} diagnostics are listed", limits::diagnostics);
  }
  Diagnostic& one = was_full && !replaces ? dropped : list[index];
  one.id = id;
  one.where = std::move(where);
  one.text = std::move(text);
  one.suggestion.clear();
  one.related.clear();
  return one;
}

bool Diagnostics::full() const {
  return list.size() > limits::diagnostics;
}

bool Diagnostics::has_errors() const {
  return errors() > 0;
}

uint64_t Diagnostics::errors() const {
  return count(Severity::error) + dropped_errors;
}

uint32_t Diagnostics::count(Severity severity) const {
  return static_cast<uint32_t>(std::count_if(list.begin(), list.end(), [&](const Diagnostic& one) {
    return diagnostic_info(one.id).severity == severity;
  }));
}

} // namespace dermis
