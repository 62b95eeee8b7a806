#include "integration/tools/command/bench/compile/shapes.hpp"

#include "framegraph/model/splitmix.hpp"
#include "integration/tools/command/bench/suite/bench_file.hpp"

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

// Reads two integers.
void read_pair(BenchObject& object, std::string_view key, int64_t maximum, int64_t& first,
               int64_t& second) {
  const NodeId list = object.reader.array(key, 2, 2);
  if (!list.valid()) return;
  const std::vector<NodeId> nodes = children(object.document, list);
  const std::string what = fmt::format("'{}' of {}", key, object.reader.what());
  first = read_integer(object.document, nodes[0], what, 1, maximum, object.diagnostics).value_or(1);
  second =
      read_integer(object.document, nodes[1], what, 1, maximum, object.diagnostics).value_or(1);
}

void read_resource(BenchObject& object, RandomResource& resource) {
  std::string name;
  object.count("percent", resource.percent, 1, 100);
  object.text("format", name);
  const auto format = format_from_name(name);
  if (!format)
    object.diagnostics.add(DiagnosticId::invalid_value, object.document.where(object.reader.node()),
                           fmt::format("no format has the name '{}'", name));
  resource.format = format.value_or(Format::undefined);
  read_pair(object, "scale", 64, resource.scale.numerator, resource.scale.denominator);
}

void read_shape(BenchObject& object, Shape& shape) {
  constexpr std::string_view kinds[] = {"chain", "fan", "random"}; // in the order of Shape::Kind
  object.name("name", shape.name);
  if (const auto kind = object.reader.word("kind", kinds))
    shape.kind = static_cast<Shape::Kind>(*kind);
  if (shape.kind == Shape::Kind::fan) {
    read_pair(object, "readers", 64, shape.readers.numerator, shape.readers.denominator);
    object.count("arity", shape.arity, 2, max_reads);
  } else if (shape.kind == Shape::Kind::random) {
    object.count("max_reads", shape.max_reads, 1, max_reads);
    object.count("max_writes", shape.max_writes, 1, max_writes);
    object.count("unread_percent", shape.unread_percent, 0, 100);
    object.count("window", shape.window, 1, 1 << 20);
    object.count("dead_percent", shape.dead_percent, 0, 90);
  }
}

} // namespace

std::optional<ShapeFile> read_shapes(const std::string& path, Diagnostics& diagnostics) {
  return read_bench_file<ShapeFile>(path, diagnostics, [](BenchObject& root, ShapeFile& file) {
    int64_t width = 1, height = 1;
    read_pair(root, "view", 16384, width, height);
    file.view_width = static_cast<uint32_t>(width);
    file.view_height = static_cast<uint32_t>(height);
    root.entries("resources", "resource", 1,
                 [&](BenchObject& entry) { read_resource(entry, file.resources.emplace_back()); });
    root.entries("shapes", "shape", 0,
                 [&](BenchObject& entry) { read_shape(entry, file.shapes.emplace_back()); });
  });
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
