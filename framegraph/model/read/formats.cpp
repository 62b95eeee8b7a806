// Checks which formats of a resource a port supports.

#include "framegraph/model/read/graph_reader.hpp"
#include "framegraph/text/suggest.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace dermis {
namespace {

std::string format_list(std::span<const Format> formats) {
  std::vector<std::string_view> names;
  for (const Format format : formats)
    names.push_back(format_info(format).name);
  return list_words(names);
}

} // namespace

bool formats_fit(const Port& port, const ResourceDeclaration& resource) {
  const auto fits = [&](Format format) { return works_with(port, format); };
  return may_be_host_owned(resource)
             ? std::all_of(resource.formats.begin(), resource.formats.end(), fits)
             : std::any_of(resource.formats.begin(), resource.formats.end(), fits);
}

bool layers_fit(const PassType& type, const Port& port, uint32_t layers) {
  if (type.shader.empty() || port.glsl_type.empty()) return true;
  return port.glsl_type.ends_with("Array") == (layers > 1);
}

std::string formats_taken(const Port& port) {
  std::vector<Format> taken;
  for (size_t i = 1; i < static_cast<size_t>(Format::count); ++i)
    if (works_with(port, static_cast<Format>(i))) taken.push_back(static_cast<Format>(i));
  return format_list(taken);
}

void report_formats(GraphReader& reader, ResourceId id, const SourceLocation& where,
                    const std::string& port) {
  const auto known = reader.format_mismatches.find(id);
  if (known != reader.format_mismatches.end()) {
    constexpr size_t max_related = 8;
    auto& related = reader.diagnostics.list[known->second].related;
    if (related.size() <= max_related) related.emplace_back(where, port);
    return;
  }
  if (!reader.diagnostics.full())
    reader.format_mismatches.emplace(id, reader.diagnostics.list.size());
  const ResourceDeclaration& resource = reader.graph.resources[id.value];
  const bool each = may_be_host_owned(resource) && resource.formats.size() > 1;
  reader
      .error(DiagnosticId::format_mismatch, where,
             fmt::format("{}; '{}' declares {}{}", port, resource.name,
                         format_list(resource.formats),
                         each ? ", any of which the host may bind" : ""))
      .related.emplace_back(resource.where, fmt::format("'{}' is declared here", resource.name));
}

} // namespace dermis
