#pragma once
// Graph files for verbs that need no device: read, then compiled with the generic device profile.

#include "framegraph/compile/compile.hpp"
#include "framegraph/compose/compose.hpp"
#include "framegraph/model/host_pass_type.hpp"
#include "framegraph/text/document.hpp"
#include "integration/tools/command/verbs.hpp"

#include <memory>
#include <optional>
#include <span>
#include <string>

namespace dermis::tools {

struct LoadedGraph {
  PassTypeRegistry pass_types;
  std::shared_ptr<const HostPassTypes> host_pass_types; // that some of `pass_types` live in
  Graph graph;
  std::vector<Change> changes;                               // what included files and overlays did
  std::vector<std::pair<std::string, std::string>> overlays; // name and text of each, for the C interface
};

inline constexpr Size default_size{1920, 1080}; // where nobody says one

// The library's pass types and those of the files, without a graph; nullopt with errors in `diagnostics`.
std::optional<LoadedGraph> load_pass_types(std::span<const std::string> files, Diagnostics& diagnostics);
// `path` "-" is standard input. nullopt with errors in `diagnostics`.
std::optional<Document> read_input(const std::string& path, Diagnostics& diagnostics);
// Opens what graph files may include: below the folder of `path`, then below each of `roots`.
OpenFile open_beside(const std::string& path, const std::vector<std::string>& roots);
// The graph of a document or file with its overlays and included files. `pass_type_files` hold pass types of
// the host.
std::optional<LoadedGraph> load_graph(Document document, std::vector<Document> overlays, const OpenFile& open,
                                      Diagnostics& diagnostics,
                                      std::span<const std::string> pass_type_files = {});
// Overlay files by their paths; nullopt when one of them cannot be read.
std::optional<std::vector<Document>> read_overlays(const std::vector<std::string>& paths,
                                                   Diagnostics& diagnostics);
std::optional<LoadedGraph> load_graph(const std::string& path, const GraphParts& parts,
                                      Diagnostics& diagnostics);
// A fragment as a graph of its own.
std::optional<LoadedGraph> load_fragment(Document document, const OpenFile& open, Diagnostics& diagnostics,
                                         std::span<const std::string> pass_type_files = {});

// What --set and --unbound say, in the graph's terms. `problem` not empty: a usage error, nothing else is
// filled.
struct CompileChoices {
  std::vector<SettingValue> settings;
  std::vector<bool> bound;
  bool two_queues = false;
  std::string problem;
};
CompileChoices read_choices(const Graph& graph, std::span<const NamedValue> settings = {},
                            std::span<const std::string> unbound = {});
// The settings that --set gives as JSON text, for the C interface. Values must have passed read_choices.
std::vector<NamedValue> settings_as_json(const Graph& graph, std::span<const NamedValue> settings);

// Refers to `loaded` and `device`.
CompileInput compile_input(const LoadedGraph& loaded, const DeviceProfile& device, const Size& size,
                           const CompileChoices& choices);

// nullopt with errors in `diagnostics`.
std::optional<CompiledPlan> compile_generic(const LoadedGraph& loaded, const Size& size,
                                            const CompileChoices& choices, Diagnostics& diagnostics);

// Says that the graph `path` cannot be used, after its messages.
ExitCode fail_graph(const Session& session, const std::string& path, const Diagnostics& diagnostics);

} // namespace dermis::tools
