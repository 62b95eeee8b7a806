// Checks the producers of resources as far as possible before any `when` is decided. The compiler
// checks the rest.

#include "framegraph/model/read/graph_reader.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace dermis {

namespace {

struct Producer {
  PassId pass;
  SourceLocation where;
};

// Producers of one resource. `first` is always on and creates the resource's first version.
struct Producers {
  bool any = false;   // some pass writes the resource, possibly conditionally or only updating
  bool fresh = false; // some pass writes the resource without needing earlier contents
  Producer first;
};

bool updates(const GraphReader& reader, const PassDeclaration& pass, const PortBinding& binding) {
  return binding.port != unknown_port &&
         usage_info(reader.pass_types[pass.type].ports[binding.port].usage).reads;
}

bool reads_now(std::span<const PortBinding> reads, const PortBinding& written) {
  return std::any_of(reads.begin(), reads.end(), [&](const PortBinding& one) {
    return one.resource == written.resource && one.frames_back == 0 &&
           overlap(one.range, written.range);
  });
}

// Reports passes that write the same memory through two ports.
void check_written_once(GraphReader& reader, const PassDeclaration& pass) {
  const auto writes = reader.graph.writes(pass);
  for (size_t i = 0; i < writes.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (writes[i].resource != writes[j].resource || !overlap(writes[i].range, writes[j].range))
        continue;
      reader
          .error(DiagnosticId::two_producers, reader.graph.place_of(writes[i]),
                 fmt::format("pass '{}' writes '{}' through two ports", pass.name,
                             reader.graph.resources[writes[i].resource.value].name))
          .related.emplace_back(reader.graph.place_of(writes[j]), "the other port is bound here");
      break;
    }
  }
}

void collect(GraphReader& reader, PassId id, std::vector<Producers>& all) {
  const PassDeclaration& pass = reader.graph.passes[id.value];
  for (const PortBinding& binding : reader.graph.writes(pass)) {
    Producers& producers = all[binding.resource.value];
    const ResourceDeclaration& resource = reader.graph.resources[binding.resource.value];
    const bool continues =
        updates(reader, pass, binding) || reads_now(reader.graph.reads(pass), binding);
    producers.any = true;
    if (continues) continue;
    producers.fresh = true;
    // Two producers are not an error if one has a `when`, since they may exclude each other, or if
    // its port is unknown, since that port may update the earlier contents.
    const bool sometimes = reader.document.find(reader.pass_nodes[id.value], "when").valid();
    // The compiler checks ranges of images, because it knows how many mips and layers there are.
    if (sometimes || binding.port == unknown_port || resource.origin == Origin::imported ||
        !binding.range.whole())
      continue;
    if (!producers.first.pass.valid()) {
      producers.first = {id, reader.graph.place_of(binding)};
    } else if (producers.first.pass != id) {
      const std::string& earlier = reader.graph.passes[producers.first.pass.value].name;
      reader
          .error(DiagnosticId::two_producers, reader.graph.place_of(binding),
                 fmt::format(
                     "passes '{}' and '{}' both write '{}', and '{}' does not read what '{}' wrote",
                     earlier, pass.name, resource.name, pass.name, earlier))
          .related.emplace_back(producers.first.where, fmt::format("'{}' writes it here", earlier));
    }
  }
}

void require_producer(GraphReader& reader, std::vector<Producers>& all, ResourceId id,
                      const SourceLocation& where, const std::string& who) {
  const ResourceDeclaration& resource = reader.graph.resources[id.value];
  Producers& producers = all[id.value];
  if (resource.origin == Origin::imported || producers.fresh || reader.broken_resources[id.value])
    return;
  reader
      .error(DiagnosticId::no_producer, where,
             fmt::format("{} '{}', which {}", who, resource.name,
                         producers.any ? "passes only update: no pass writes its first contents"
                                       : "no pass writes"))
      .related.emplace_back(resource.where, fmt::format("'{}' is declared here", resource.name));
  producers.fresh = true; // one error per resource
}

} // namespace

bool overlap(const ImageRange& a, const ImageRange& b) {
  const auto apart = [](uint32_t first, uint32_t count, uint32_t other) { // count 0: to the last
    return count != 0 && first + count <= other;
  };
  return !apart(a.first_mip, a.mips, b.first_mip) && !apart(b.first_mip, b.mips, a.first_mip) &&
         !apart(a.first_layer, a.layers, b.first_layer) &&
         !apart(b.first_layer, b.layers, a.first_layer);
}

void check_producers(GraphReader& reader) {
  std::vector<Producers> all(reader.graph.resources.size());
  for (uint32_t i = 0; i < reader.graph.passes.size(); ++i) {
    check_written_once(reader, reader.graph.passes[i]);
    collect(reader, {i}, all);
  }
  // a producer that seems to be missing may be among the unknown writes
  if (reader.unknown_writes) return;
  for (const PassDeclaration& pass : reader.graph.passes) {
    for (const PortBinding& binding : reader.graph.reads(pass)) {
      require_producer(reader, all, binding.resource, reader.graph.place_of(binding),
                       fmt::format("pass '{}' reads", pass.name));
    }
    for (const PortBinding& binding : reader.graph.writes(pass)) {
      if (!updates(reader, pass, binding)) continue;
      require_producer(reader, all, binding.resource, reader.graph.place_of(binding),
                       fmt::format("pass '{}' updates", pass.name));
    }
  }
  for (uint32_t i = 0; i < all.size(); ++i) {
    const ResourceDeclaration& resource = reader.graph.resources[i];
    if (resource.exported) require_producer(reader, all, {i}, resource.where, "the graph exports");
  }
}

} // namespace dermis
