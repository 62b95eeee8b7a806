#pragma once
// Graph files for verbs that need no device: reading, and compiling with the generic device
// profile.

#include "framegraph/compile/compile.hpp"
#include "framegraph/compose/compose.hpp"
#include "framegraph/model/host_pass_type.hpp"
#include "framegraph/text/document.hpp"
#include "integration/tools/command/verbs.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace dermis::tools {

struct LoadedGraph {
  PassTypeRegistry pass_types;
  std::shared_ptr<const HostPassTypes> host_pass_types; // owns some of `pass_types`
  Graph graph;
  std::string text;                      // of its file
  std::vector<Change> changes;           // changes made by included files and overlays
  std::vector<demo::NamedText> overlays; // for the C interface
};

inline constexpr Size default_size{1920, 1080}; // default of --size

// Loads the library's pass types and those of the files, without a graph. Returns nullopt with
// errors in `diagnostics`.
std::optional<LoadedGraph> load_pass_types(std::span<const std::string> files,
                                           Diagnostics& diagnostics);
// Reads a document; `path` "-" is standard input. Returns nullopt with errors in `diagnostics`.
std::optional<Document> read_input(const std::string& path, Diagnostics& diagnostics);
// Reads the document of a graph. If the file does not exist, the error suggests a shipped graph of
// a similar name.
std::optional<Document> read_graph_file(const std::string& path, Diagnostics& diagnostics);
// Opens files that graph files include: below the folder of `path`, then below each of `roots`.
OpenFile open_included(const std::string& path, const std::vector<std::string>& roots);
// Returns `open` as a callback of the demo engine.
std::function<std::optional<demo::NamedText>(const std::string& name)> for_engine(OpenFile open);
// Loads the graph of a document or file with its overlays and included files. `pass_type_files`
// declare pass types of the host.
std::optional<LoadedGraph> load_graph(Document document, std::vector<Document> overlays,
                                      const OpenFile& open, Diagnostics& diagnostics,
                                      std::span<const std::string> pass_type_files = {});
// Reads overlay files. Returns nullopt if one of them cannot be read.
std::optional<std::vector<Document>> read_overlays(const std::vector<std::string>& paths,
                                                   Diagnostics& diagnostics);
std::optional<LoadedGraph> load_graph(const std::string& path, const GraphInputs& inputs,
                                      Diagnostics& diagnostics);
// Loads a fragment as a graph of its own.
std::optional<LoadedGraph> load_fragment(Document document, const OpenFile& open,
                                         Diagnostics& diagnostics,
                                         std::span<const std::string> pass_type_files = {});

// Values of --set and --unbound, resolved for the graph. A non-empty `problem` is a usage error;
// other members are then not set.
struct CompileChoices {
  std::vector<SettingValue> settings;
  std::vector<bool> bound;
  PixelGrid pixel_grid = 0;
  bool two_queues = false;
  std::string problem;
};
CompileChoices read_choices(const Graph& graph, std::span<const NamedValue> settings = {},
                            std::span<const std::string> unbound = {});
// Returns the settings of --set as JSON text for the C interface. Values must have passed
// read_choices.
std::vector<NamedValue> settings_as_json(const Graph& graph, std::span<const NamedValue> settings);

// The result refers to `loaded` and `device`.
CompileInput compile_input(const LoadedGraph& loaded, const DeviceProfile& device, const Size& size,
                           const CompileChoices& choices);

// Compiles `input`, which refers to the loaded graph. Returns nullopt with errors in `diagnostics`,
// which also name the overlays that removed what is missing.
std::optional<CompiledPlan> compile_loaded(const LoadedGraph& loaded, const CompileInput& input,
                                           Diagnostics& diagnostics);

// The same for a generic device.
std::optional<CompiledPlan> compile_generic(const LoadedGraph& loaded, const Size& size,
                                            const CompileChoices& choices,
                                            Diagnostics& diagnostics);

// Prints the diagnostics and reports that the graph `path` cannot be used.
ExitCode fail_graph(const Session& session, const std::string& path,
                    const Diagnostics& diagnostics);

} // namespace dermis::tools
