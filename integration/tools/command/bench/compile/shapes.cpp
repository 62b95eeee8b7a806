#include "integration/tools/command/bench/compile/shapes.hpp"

#include "framegraph/model/splitmix.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

constexpr Port ports[] = {{"a", Usage::sampled_image, true, "texture2D", ""},
                          {"b", Usage::sampled_image, true, "texture2D", ""},
                          {"c", Usage::sampled_image, true, "texture2D", ""},
                          {"out", Usage::storage_image_write, false, "image2D", ""},
                          {"out2", Usage::storage_image_write, true, "image2D", ""}};
constexpr uint32_t max_reads = 3, max_writes = 2, first_output = 3; // of `ports`
// indices in benchmark_pass_types()
constexpr PassTypeId plain{0}, kept{1};

struct Random : SplitMix64 {
  uint32_t below(size_t limit) { return static_cast<uint32_t>(SplitMix64::below(limit)); }
};

struct Draft {
  const ShapeFile& file;
  Random random;
  Graph graph = {};

  ResourceId image() {
    uint32_t ticket = random.below(100);
    size_t which = 0;
    while (which + 1 < file.resources.size() && ticket >= file.resources[which].percent)
      ticket -= file.resources[which++].percent;
    ResourceDeclaration declared;
    declared.name = fmt::format("image{}", graph.resources.size());
    declared.formats = {file.resources[which].format};
    declared.size.x = declared.size.y = file.resources[which].scale;
    graph.resources.push_back(std::move(declared));
    return {static_cast<uint32_t>(graph.resources.size() - 1)};
  }

  static PortBinding bound(uint32_t port, ResourceId resource) {
    PortBinding binding;
    binding.port = port;
    binding.resource = resource;
    return binding;
  }

  void pass(const std::vector<ResourceId>& reads, const std::vector<ResourceId>& writes) {
    PassDeclaration declared;
    declared.name = fmt::format("pass{}", graph.passes.size());
    declared.type = plain;
    for (uint32_t i = 0; i < reads.size(); ++i)
      graph.bind(declared, PortSide::read, bound(i, reads[i]), {});
    for (uint32_t i = 0; i < writes.size(); ++i)
      graph.bind(declared, PortSide::write, bound(first_output + i, writes[i]), {});
    graph.passes.push_back(std::move(declared));
  }

  void chain(uint32_t passes) {
    ResourceId last = image();
    pass({}, {last});
    while (graph.passes.size() < passes) {
      const ResourceId next = image();
      pass({last}, {next});
      last = next;
    }
    graph.passes.back().type = kept;
  }

  void fan(const Shape& shape, uint32_t passes) {
    const ResourceId source = image();
    pass({}, {source});
    const auto readers =
        std::max<uint64_t>(uint64_t{passes} * static_cast<uint64_t>(shape.readers.numerator) /
                               static_cast<uint64_t>(shape.readers.denominator),
                           1);
    std::vector<ResourceId> level;
    for (uint64_t i = 0; i < readers; ++i) {
      level.push_back(image());
      pass({source}, {level.back()});
    }
    while (level.size() > 1) { // one level of the reduction tree per iteration
      std::vector<ResourceId> above;
      for (size_t i = 0; i < level.size(); i += shape.arity) {
        const auto end = std::min(i + shape.arity, level.size());
        above.push_back(image());
        pass({level.begin() + static_cast<std::ptrdiff_t>(i),
              level.begin() + static_cast<std::ptrdiff_t>(end)},
             {above.back()});
      }
      level = std::move(above);
    }
    graph.passes.back().type = kept;
  }

  // Outputs so far of one group of passes (needed or dead).
  struct Side {
    std::vector<ResourceId> written, unread;
  };

  void draw_random(const Shape& shape, uint32_t passes) {
    Side sides[2]; // needed, dead
    std::vector<uint8_t> has_reader;
    std::vector<uint32_t> writer;
    std::vector<uint8_t> dead(passes, 0);
    for (uint32_t p = 0; p < passes; ++p) {
      dead[p] = random.below(100) < shape.dead_percent;
      std::vector<ResourceId> reads;
      const uint32_t count = 1 + random.below(shape.max_reads);
      for (uint32_t i = 0; i < count; ++i) {
        Side& side = sides[dead[p] != 0 && random.below(2) != 0 ? 1 : 0];
        // Dead passes do not read unread outputs of needed passes, which must find needed readers.
        const bool fresh = random.below(100) < shape.unread_percent && (&side == &sides[dead[p]]);
        ResourceId id;
        if (fresh && !side.unread.empty()) {
          const uint32_t at = random.below(side.unread.size());
          id = side.unread[at];
          side.unread[at] = side.unread.back();
          side.unread.pop_back();
        } else if (!side.written.empty()) {
          id = side.written[side.written.size() - 1 -
                            random.below(std::min<size_t>(shape.window, side.written.size()))];
          const auto found = std::find(side.unread.begin(), side.unread.end(), id);
          if (found != side.unread.end() && !dead[p]) side.unread.erase(found);
        }
        if (!id.valid() || std::find(reads.begin(), reads.end(), id) != reads.end()) continue;
        if (!dead[p]) has_reader[id.value] = 1;
        reads.push_back(id);
      }
      std::vector<ResourceId> writes;
      for (uint32_t i = 1 + random.below(shape.max_writes); i > 0; --i) {
        writes.push_back(image());
        sides[dead[p]].written.push_back(writes.back());
        sides[dead[p]].unread.push_back(writes.back());
        has_reader.push_back(0);
        writer.push_back(p);
      }
      pass(reads, writes);
    }
    std::vector<uint8_t> read_by_others(passes, 0);
    for (size_t r = 0; r < writer.size(); ++r)
      if (has_reader[r]) read_by_others[writer[r]] = 1;
    for (uint32_t p = 0; p < passes; ++p)
      if (!dead[p] && !read_by_others[p]) graph.passes[p].type = kept;
  }
};

struct Fields {
  const Document& document;
  Diagnostics& diagnostics;

  NodeId member(NodeId object, std::string_view key, NodeKind kind) {
    const NodeId node = document.find(object, key);
    if (node.valid() && document[node].kind == kind) return node;
    diagnostics.add(node.valid() ? DiagnosticId::wrong_type : DiagnosticId::missing_key,
                    document.where(node.valid() ? node : object),
                    fmt::format("'{}' must be {}", key, kind_name(kind)));
    return {};
  }

  uint32_t integer(NodeId object, std::string_view key, int64_t minimum, int64_t maximum) {
    const NodeId node = member(object, key, NodeKind::integer);
    return node.valid() ? checked(node, minimum, maximum) : 1;
  }

  uint32_t checked(NodeId node, int64_t minimum, int64_t maximum) {
    const int64_t value = document[node].integer;
    if (document[node].kind == NodeKind::integer && value >= minimum && value <= maximum)
      return static_cast<uint32_t>(value);
    diagnostics.add(DiagnosticId::out_of_range, document.where(node),
                    fmt::format("an integer within {} .. {} is expected", minimum, maximum));
    return 1;
  }

  std::pair<uint32_t, uint32_t> pair(NodeId object, std::string_view key, int64_t maximum) {
    const NodeId node = member(object, key, NodeKind::array);
    if (!node.valid()) return {1, 1};
    if (document[node].child_count != 2) {
      diagnostics.add(DiagnosticId::wrong_type, document.where(node), "two integers are expected");
      return {1, 1};
    }
    const NodeId first = document[node].first_child;
    return {checked(first, 1, maximum), checked(document[first].next, 1, maximum)};
  }

  void resource(NodeId node, ShapeFile& file) {
    DrawnResource drawn;
    drawn.percent = integer(node, "percent", 1, 100);
    const NodeId name = member(node, "format", NodeKind::string);
    const auto format = name.valid() ? format_from_name(document.text(name)) : std::nullopt;
    if (name.valid() && !format)
      diagnostics.add(DiagnosticId::invalid_value, document.where(name), "no format has this name");
    drawn.format = format.value_or(Format::undefined);
    const auto [numerator, denominator] = pair(node, "scale", 64);
    drawn.scale = {numerator, denominator};
    file.resources.push_back(drawn);
  }

  void shape(NodeId node, ShapeFile& file) {
    Shape shape;
    const NodeId name = member(node, "name", NodeKind::string), kind = member(node, "kind", NodeKind::string);
    if (!name.valid() || !kind.valid()) return;
    shape.name = document.text(name);
    if (document.text(kind) == "fan") {
      shape.kind = Shape::Kind::fan;
      const auto [numerator, denominator] = pair(node, "readers", 64);
      shape.readers = {numerator, denominator};
      shape.arity = integer(node, "arity", 2, max_reads);
    } else if (document.text(kind) == "random") {
      shape.kind = Shape::Kind::random;
      shape.max_reads = integer(node, "max_reads", 1, max_reads);
      shape.max_writes = integer(node, "max_writes", 1, max_writes);
      shape.unread_percent = integer(node, "unread_percent", 0, 100);
      shape.window = integer(node, "window", 1, 1 << 20);
      shape.dead_percent = integer(node, "dead_percent", 0, 90);
    } else if (document.text(kind) != "chain") {
      diagnostics.add(DiagnosticId::invalid_value, document.where(kind), "expected chain, fan or random");
    }
    file.shapes.push_back(std::move(shape));
  }
};

} // namespace

std::optional<ShapeFile> read_shapes(const std::string& path, Diagnostics& diagnostics) {
  const std::optional<Document> document = read_document(path, diagnostics);
  if (!document) return std::nullopt;
  Fields fields{*document, diagnostics};
  ShapeFile file;
  fields.integer(document->root(), "dermis_benchmark", 1, 1);
  std::tie(file.view_width, file.view_height) = fields.pair(document->root(), "view", 16384);
  const NodeId resources = fields.member(document->root(), "resources", NodeKind::array);
  const NodeId shapes = fields.member(document->root(), "shapes", NodeKind::array);
  if (!resources.valid() || !shapes.valid()) return std::nullopt;
  for (NodeId at = (*document)[resources].first_child; at.valid(); at = (*document)[at].next)
    fields.resource(at, file);
  for (NodeId at = (*document)[shapes].first_child; at.valid(); at = (*document)[at].next)
    fields.shape(at, file);
  if (file.resources.empty())
    diagnostics.add(DiagnosticId::missing_key, document->where(resources),
                    "at least one resource is expected");
  return diagnostics.has_errors() ? std::nullopt : std::optional(std::move(file));
}

PassTypeRegistry benchmark_pass_types() {
  PassTypeRegistry pass_types;
  PassType type;
  type.name = "benchmark.shade";
  type.ports = ports;
  pass_types.add(type);
  type.name = "benchmark.keep";
  type.side_effects = true;
  pass_types.add(type);
  return pass_types;
}

Graph draw_graph(const ShapeFile& file, const Shape& shape, uint32_t passes, uint64_t seed) {
  Draft draft{file, {seed}};
  draft.graph.name = fmt::format("{}-{}-{}", shape.name, passes, seed);
  if (shape.kind == Shape::Kind::chain) draft.chain(passes);
  if (shape.kind == Shape::Kind::fan) draft.fan(shape, passes);
  if (shape.kind == Shape::Kind::random) draft.draw_random(shape, passes);
  return std::move(draft.graph);
}

} // namespace dermis::tools
