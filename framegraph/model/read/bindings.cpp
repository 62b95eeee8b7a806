// Reads "read" and "write" of a pass: the resource and frame bound to each port.

#include "framegraph/model/image_range.hpp"
#include "framegraph/model/read/graph_reader.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/suggest.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>

namespace dermis {

namespace {

// A binding of a port and its source location.
struct Found {
  PortBinding binding;
  SourceLocation where;
  std::string_view range_text; // as written: "#0..[1]"; "" if the reference names no range
};

class Bindings {
public:
  Bindings(GraphReader& reader, ObjectReader& object, PassDeclaration& pass)
      : reader_(reader), object_(object), pass_(pass),
        pass_type_(pass.type.valid() ? &reader.pass_types[pass.type] : nullptr),
        bound_(pass_type_ ? pass_type_->ports.size() : 0) {}

  void read_side(PortSide side) {
    const std::string_view key = side == PortSide::read ? "read" : "write";
    const NodeId list = object_.object(key, Need::optional);
    if (!list.valid()) {
      // The error was reported, or will be as an unknown key; nothing is known about the section's
      // ports.
      const bool mistyped =
          object_.has(key) || find_misspelt(reader_.document, object_.node(), key).valid();
      complete_ &= !mistyped;
      if (side == PortSide::write) writes_known_ &= !mistyped;
      return;
    }
    for (NodeId node : children(reader_.document, list)) {
      if (!read_one(side, node) && side == PortSide::write) writes_known_ = false;
    }
  }

  void report_missing() {
    if (pass_type_ == nullptr || !complete_) return;
    for (size_t i = 0; i < pass_type_->ports.size(); ++i) {
      const Port& port = pass_type_->ports[i];
      if (bound_[i] || port.optional) continue;
      if (side_of(port) == PortSide::write) writes_known_ = false;
      reader_.error(
          DiagnosticId::missing_port, pass_.where,
          fmt::format("{} of type '{}' needs a resource at the port '{}' under \"{}\" ({})",
                      object_.what(), pass_type_->name, port.name,
                      side_of(port) == PortSide::read ? "read" : "write", port.doc));
    }
    report_none_of();
  }

  bool writes_known() const { return writes_known_; }

private:
  void report_none_of() {
    if (pass_type_->one_of.empty()) return;
    for (uint32_t i = 0; i < pass_type_->ports.size(); ++i)
      if (bound_[i] && is_one_of(*pass_type_, i)) return;
    const Port& first =
        pass_type_->ports[static_cast<size_t>(find_port(*pass_type_, pass_type_->one_of.front()))];
    reader_.error(
        DiagnosticId::missing_port, pass_.where,
        fmt::format("{} of type '{}' needs a resource at one of its ports {} under \"{}\"",
                    object_.what(), pass_type_->name, list_words(pass_type_->one_of),
                    side_of(first) == PortSide::read ? "read" : "write"));
  }

  // Returns false if the binding could not be read.
  bool read_one(PortSide side, NodeId node) {
    const int port = find(side, node);
    const std::string what =
        fmt::format("port '{}' of {}", reader_.document.key(node), object_.what());
    if (side == PortSide::read && reader_.document[node].kind == NodeKind::object)
      return read_condition(node, port, what);
    Found found;
    if (!read_reference(side, node, port, what, found) || !choose_mip(what, found) ||
        !check_layers(what, found))
      return false;
    keep(side, what, found);
    return true;
  }

  bool read_reference(PortSide side, NodeId node, int port, const std::string& what, Found& found) {
    const auto text = read_string(reader_.document, node, what, reader_.diagnostics);
    if (!text) return false;
    found.where = reader_.document.where(node);
    // Stored even if the port is unknown, because checks of readers need to know all writes.
    found.binding.port = port < 0 ? unknown_port : static_cast<uint32_t>(port);
    return parse_reference(*text, what, side, found.where, found);
  }

  void keep(PortSide side, const std::string& what, const Found& found) {
    reader_.graph.bind(pass_, side, found.binding, found.where);
    if (found.binding.port != unknown_port &&
        !reader_.broken_resources[found.binding.resource.value])
      check(pass_type_->ports[found.binding.port], what, found);
  }

  // Reads { "from": "name@-N", "requires": "valid", "otherwise": "name" }.
  bool read_condition(NodeId node, int port, const std::string& what) {
    ObjectReader object(reader_.document, node, what, reader_.diagnostics);
    constexpr std::string_view requirements[] = {"valid"};
    const NodeId from = object.any("from");
    object.word("requires", requirements);
    const NodeId otherwise = object.any("otherwise", Need::optional);
    bool ok = object.finish();
    Found history, instead;
    ok &= from.valid() &&
          read_reference(PortSide::read, from, port, "'from' of " + what, history) &&
          check_layers("'from' of " + what, history);
    ok &= !otherwise.valid() ||
          (read_reference(PortSide::read, otherwise, port, "'otherwise' of " + what, instead) &&
           check_layers("'otherwise' of " + what, instead));
    if (!ok || !condition_fits(what, history, instead)) return false;
    const HistoryDeclaration& declared =
        reader_.graph.resources[history.binding.resource.value].history;
    const bool zeros = !otherwise.valid() && declared.first == HistoryDeclaration::First::clear;
    history.binding.when = zeros ? ReadWhen::always : ReadWhen::history_valid;
    keep(PortSide::read, what, history);
    if (!otherwise.valid()) return true;
    instead.binding.when = ReadWhen::history_invalid;
    keep(PortSide::read, what, instead);
    return true;
  }

  // Checks a conditional read. `instead` has no resource if the port has no "otherwise".
  bool condition_fits(const std::string& what, const Found& history, const Found& instead) {
    const ResourceDeclaration& resource = reader_.graph.resources[history.binding.resource.value];
    const auto reject = [&](const SourceLocation& where, std::string text) {
      reader_.error(DiagnosticId::bad_requires, where, std::move(text))
          .related.emplace_back(resource.where,
                                fmt::format("'{}' is declared here", resource.name));
      return false;
    };
    if (history.binding.frames_back == 0)
      return reject(history.where,
                    fmt::format("{} requires '{}' of the current frame to be valid; only "
                                "earlier frames (name@-1) can be required",
                                what, resource.name));
    if (instead.binding.frames_back > 0)
      return reject(instead.where, fmt::format("{} reads an earlier frame if '{}@-{}' is invalid, "
                                               "and that frame may be invalid, too",
                                               what, resource.name, history.binding.frames_back));
    if (history.binding.port == unknown_port) return true;
    const Port& port = pass_type_->ports[history.binding.port];
    if (port.usage == Usage::indirect_arguments)
      return reject(history.where, fmt::format("{} provides the size of the dispatch, which every "
                                               "frame reads; the read cannot be conditional",
                                               what));
    const bool has_fallback = instead.binding.resource.valid() || port.optional ||
                              resource.history.first == HistoryDeclaration::First::clear;
    if (has_fallback) return true;
    return reject(
        history.where,
        fmt::format(
            "{} must be bound, but nothing is declared for frames in which '{}@-{}' is invalid",
            what, resource.name, history.binding.frames_back));
  }

  int find(PortSide side, NodeId node) {
    if (pass_type_ == nullptr) return -1;
    const std::string_view name = reader_.document.key(node);
    if (const int port = find_port(*pass_type_, name, side); port >= 0) {
      bound_[static_cast<size_t>(port)] = true;
      return port;
    }
    if (const int other = find_port(*pass_type_, name); other >= 0) {
      bound_[static_cast<size_t>(other)] = true; // reports only one error
      reader_.error(
          DiagnosticId::port_direction, reader_.document.where_key(node),
          fmt::format("the port '{}' of type '{}' {}; list it under \"{}\"", name, pass_type_->name,
                      usage_info(pass_type_->ports[static_cast<size_t>(other)].usage).writes
                          ? "writes"
                          : "only reads",
                      side == PortSide::read ? "write" : "read"));
      return -1;
    }
    std::vector<std::string_view> names;
    for (const Port& port : pass_type_->ports) {
      if (side_of(port) == side) names.push_back(port.name);
    }
    Diagnostic& one = reader_.error(
        DiagnosticId::unknown_port, reader_.document.where_key(node),
        fmt::format("{} is of type '{}', which has no port '{}' under \"{}\"{}", object_.what(),
                    pass_type_->name, name, side == PortSide::read ? "read" : "write",
                    names.empty() ? std::string() : fmt::format("; it has {}", list_words(names))));
    one.suggestion = did_you_mean(name, names);
    // A misspelt port is not also reported as missing.
    const std::string_view meant = nearest(name, names);
    if (!meant.empty()) bound_[static_cast<size_t>(find_port(*pass_type_, meant, side))] = true;
    return -1;
  }

  // Parses "name" or "name#mips[layers]", with "@-N" for an earlier frame.
  bool parse_reference(std::string_view text, const std::string& what, PortSide side,
                       const SourceLocation& where, Found& out) {
    const size_t at = text.find('@');
    if (at != std::string_view::npos) {
      int64_t frame = 0;
      const std::string_view digits = text.substr(at + 1);
      const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), frame);
      if (result.ec != std::errc() || result.ptr != digits.data() + digits.size() || frame >= 0 ||
          frame < INT32_MIN) {
        reader_.error(DiagnosticId::bad_reference, where,
                      fmt::format("{} names '{}'; earlier frames are @-1, @-2 ...", what, text));
        return false;
      }
      out.binding.frames_back = static_cast<uint32_t>(-frame);
    }
    const size_t end = std::min(text.find_first_of("#[@"), text.size());
    const std::string_view range_text = text.substr(end, std::min(at, text.size()) - end);
    const auto image_range = parse_image_range(range_text);
    if (!image_range) {
      reader_.error(
          DiagnosticId::bad_reference, where,
          fmt::format(
              "{} names '{}'; mips are #0, #1..3, #1.., layers [0], [1..3], [1..]; at most {} "
              "mips and {} layers",
              what, text, limits::image_mips, limits::image_layers));
      return false;
    }
    out.binding.range = *image_range;
    out.range_text = range_text;
    out.binding.resource = find_resource(reader_, text.substr(0, end), what, where);
    if (!out.binding.resource.valid()) return false;
    const ResourceDeclaration& resource = reader_.graph.resources[out.binding.resource.value];
    if (out.binding.frames_back > 0 && side == PortSide::write) {
      reader_.error(DiagnosticId::history_write, where,
                    fmt::format("{} writes '{}', an earlier frame", what, text));
      return false;
    }
    if (out.binding.frames_back > resource.history.frames &&
        !reader_.broken_resources[out.binding.resource.value]) {
      reader_
          .error(DiagnosticId::history_range, where,
                 resource.origin == Origin::imported
                     ? fmt::format("{} reads '{}', but an import has no history", what, text)
                     : fmt::format("{} reads '{}', but '{}' keeps {} earlier frames", what, text,
                                   resource.name, resource.history.frames))
          .related.emplace_back(resource.where,
                                fmt::format("'{}' is declared here", resource.name));
      return false;
    }
    return range_text.empty() || check_image_range(text, what, out);
  }

  // Checks that the resource has the named mips and layers, as far as this is known without a view.
  bool check_image_range(std::string_view text, const std::string& what, const Found& found) {
    const ResourceDeclaration& resource = reader_.graph.resources[found.binding.resource.value];
    if (reader_.broken_resources[found.binding.resource.value]) return true;
    std::string problem;
    const uint32_t last_mip =
        found.binding.range.first_mip + std::max<uint32_t>(found.binding.range.mips, 1) - 1;
    const uint32_t last_layer =
        found.binding.range.first_layer + std::max<uint32_t>(found.binding.range.layers, 1) - 1;
    if (resource.type != ResourceType::image)
      problem = fmt::format("'{}' is {}", resource.name, type_phrase(resource.type));
    else if (resource.origin == Origin::imported || resource.exported)
      problem = fmt::format("'{}' is bound by the host and cannot be divided", resource.name);
    else if (resource.mips != 0 && last_mip >= resource.mips)
      problem = fmt::format("'{}' has {} mip{}", resource.name, resource.mips,
                            resource.mips == 1 ? "" : "s");
    else if (last_layer >= resource.layers)
      problem = fmt::format("'{}' has {} layer{}", resource.name, resource.layers,
                            resource.layers == 1 ? "" : "s");
    if (problem.empty()) return true;
    reader_
        .error(DiagnosticId::bad_subresource, found.where,
               fmt::format("{} names '{}', but {}", what, text, problem))
        .related.emplace_back(resource.where, fmt::format("'{}' is declared here", resource.name));
    return false;
  }

  // Selects the single mip of a storage image: the first, unless another is named.
  bool choose_mip(const std::string& what, Found& found) {
    const ResourceDeclaration& resource = reader_.graph.resources[found.binding.resource.value];
    if (found.binding.port == unknown_port || resource.type != ResourceType::image ||
        resource.mips == 1 || resource.origin == Origin::imported || resource.exported)
      return true;
    const Usage usage = pass_type_->ports[found.binding.port].usage;
    if (usage != Usage::storage_image_write && usage != Usage::storage_image_update) return true;
    if (!found.range_text.starts_with('#')) found.binding.range.mips = 1;
    if (found.binding.range.mips == 1) return true;
    reader_
        .error(DiagnosticId::bad_subresource, found.where,
               fmt::format("{} writes one mip, but '{}{}' names several", what, resource.name,
                           found.range_text))
        .related.emplace_back(resource.where, fmt::format("'{}' is declared here", resource.name));
    return false;
  }

  // Checks that a kernel that declares one layer, or an array of layers, gets it. Host passes see
  // what the graph binds.
  bool check_layers(const std::string& what, const Found& found) {
    const ResourceDeclaration& resource = reader_.graph.resources[found.binding.resource.value];
    if (found.binding.port == unknown_port || resource.type != ResourceType::image ||
        reader_.broken_resources[found.binding.resource.value])
      return true;
    const Port& port = pass_type_->ports[found.binding.port];
    const ImageRange& range = found.binding.range;
    const uint32_t layers = range.layers == 0 ? resource.layers - range.first_layer : range.layers;
    if (layers_fit(*pass_type_, port, layers)) return true;
    const bool array = port.glsl_type.ends_with("Array");
    reader_
        .error(DiagnosticId::bad_subresource, found.where,
               array ? fmt::format("{} accesses several layers, but '{}{}' has one", what,
                                   resource.name, found.range_text)
                     : fmt::format("{} accesses one layer, but '{}{}' has {}; name one, as in "
                                   "'{}[0]'",
                                   what, resource.name, found.range_text, layers, resource.name))
        .related.emplace_back(resource.where, fmt::format("'{}' is declared here", resource.name));
    return false;
  }

  void check(const Port& port, const std::string& what, const Found& found) {
    const ResourceDeclaration& resource = reader_.graph.resources[found.binding.resource.value];
    const UsageInfo& usage = usage_info(port.usage);
    const bool image = resource.type == ResourceType::image;
    const auto declared_here = [&](Diagnostic& one) {
      one.related.emplace_back(resource.where, fmt::format("'{}' is declared here", resource.name));
    };
    const bool taken = image                                   ? usage.image
                       : resource.type == ResourceType::buffer ? usage.buffer
                                                               : usage.acceleration_structure;
    if (!taken) {
      const ResourceType expected = usage.image    ? ResourceType::image
                                    : usage.buffer ? ResourceType::buffer
                                                   : ResourceType::acceleration_structure;
      declared_here(
          reader_.error(DiagnosticId::usage_mismatch, found.where,
                        fmt::format("{} expects {}; '{}' is {}", what, type_phrase(expected),
                                    resource.name, type_phrase(resource.type))));
      return;
    }
    if (!image || formats_fit(port, resource)) return;
    report_formats(reader_, found.binding.resource, found.where,
                   fmt::format("{} supports {}", what, formats_taken(port)));
  }

  GraphReader& reader_;
  ObjectReader& object_;
  PassDeclaration& pass_;
  const PassType* pass_type_;
  std::vector<bool> bound_; // by port: named in the file, correctly or not
  bool complete_ = true;    // all bindings were read
  bool writes_known_ = true;
};

} // namespace

bool read_bindings(GraphReader& reader, ObjectReader& pass, PassDeclaration& out) {
  Bindings bindings(reader, pass, out);
  bindings.read_side(PortSide::read);
  bindings.read_side(PortSide::write);
  bindings.report_missing();
  return bindings.writes_known();
}

} // namespace dermis
