#include "framegraph/explain/plan_diff.hpp"

#include "framegraph/explain/names.hpp"
#include "framegraph/text/json_writer.hpp"

#include <fmt/format.h>

#include <iterator>

namespace dermis {
namespace {

void append_total(std::string& out, std::string_view what, const std::string& a,
                  const std::string& b) {
  out += a == b ? fmt::format("  {:<10} {}\n", what, a)
                : fmt::format("  {:<10} {} -> {}\n", what, a, b);
}

std::string heading(std::string_view section) {
  std::string text(section);
  for (char& c : text)
    if (c == '_') c = ' ';
  return text;
}

void write_side(JsonWriter& out, std::string_view key, std::string_view name,
                const PlanTotals& totals) {
  out.key(key).open_object(true).member("name", name).member("passes", totals.passes);
  out.member("barriers", totals.barriers).member("batches", totals.batches);
  out.member("transient_bytes", totals.transient_bytes)
      .member("history_bytes", totals.history_bytes)
      .close();
}

void write_text(JsonWriter& out, std::string_view key, const std::string& text) {
  out.key(key);
  text.empty() ? out.null() : out.value(text);
}

} // namespace

std::string plan_diff_text(const PlanDiff& diff, std::string_view name_a, std::string_view name_b) {
  std::string out = fmt::format("A: {}\nB: {}\n{}\n", name_a, name_b,
                                diff.same ? "the plans are the same" : "the plans differ");
  for (const PlanDiffSection& section : diff.sections) {
    if (section.differences.empty()) continue;
    out += fmt::format("\n{}\n", heading(section.name));
    for (const PlanDifference& one : section.differences) {
      if (one.b.empty())
        out += fmt::format("  - {}: {}\n", one.name, one.a);
      else if (one.a.empty())
        out += fmt::format("  + {}: {}\n", one.name, one.b);
      else if (one.a.size() + one.b.size() < 60)
        out += fmt::format("  ~ {}: {} -> {}\n", one.name, one.a, one.b);
      else
        out += fmt::format("  ~ {}\n      A {}\n      B {}\n", one.name, one.a, one.b);
    }
  }
  out += "\ntotals\n";
  const auto count = [](uint64_t number) { return fmt::format("{}", number); };
  append_total(out, "passes", count(diff.a.passes), count(diff.b.passes));
  append_total(out, "barriers", count(diff.a.barriers), count(diff.b.barriers));
  append_total(out, "batches", count(diff.a.batches), count(diff.b.batches));
  append_total(out, "transients", bytes_text(diff.a.transient_bytes),
               bytes_text(diff.b.transient_bytes));
  append_total(out, "histories", bytes_text(diff.a.history_bytes),
               bytes_text(diff.b.history_bytes));
  return out;
}

std::string plan_diff_json(const PlanDiff& diff, std::string_view name_a, std::string_view name_b) {
  JsonWriter out;
  out.open_object().member("same", diff.same);
  write_side(out, "a", name_a, diff.a);
  write_side(out, "b", name_b, diff.b);
  for (const PlanDiffSection& section : diff.sections) {
    out.key(section.name).open_array();
    for (const PlanDifference& one : section.differences) {
      out.open_object(true).member("name", one.name);
      write_text(out, "a", one.a);
      write_text(out, "b", one.b);
      out.close();
    }
    out.close();
  }
  out.close();
  return std::move(out).finish();
}

} // namespace dermis
