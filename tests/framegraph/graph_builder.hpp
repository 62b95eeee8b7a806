#pragma once
// Graphs built by hand, so that the compiler is tested apart from the reader. Every declaration gets a line
// of its own, in the order of the calls.

#include "framegraph/compile/compile.hpp"

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace dermis::testing {

// Port and "resource", "resource#1[0]", "resource@-1", "resource@-1?" (required to be valid) or
// "resource@-1?otherwise".
using Bindings = std::vector<std::pair<std::string, std::string>>;

// Kinds: test.shade (a b c -> out, out2), test.update (a, own texel by texel, image in place), test.fill
// (clears target), test.list (writes buffer tiles), test.count (updates buffer tiles), test.tiles (tiles as
// list and indirect arguments, a -> out), test.probe (reads a, has side effects), test.narrow (a -> out,
// rgba16f only), test.blend (a, own texel by texel -> out), test.ids (ids, whole numbers -> out).
PassTypeRegistry test_pass_types();

struct GraphBuilder {
  Graph graph;
  PassTypeRegistry pass_types = test_pass_types();
  DeviceProfile device = generic_profile();
  uint32_t line = 0;

  GraphBuilder() { graph.name = "test"; }

  SourceLocation next_line();
  ResourceDeclaration& import(const std::string& name);
  ResourceDeclaration& image(const std::string& name);
  ResourceDeclaration& buffer(const std::string& name);   // one element of 4 bytes a tile, and 4 more
  ResourceDeclaration& exported(const std::string& name); // a declared image that the host binds
  ResourceDeclaration& history(const std::string& name, uint32_t frames = 1);
  SettingDeclaration& boolean(const std::string& name, bool value);
  PassDeclaration& pass(const std::string& name, const std::string& type, const Bindings& reads,
                        const Bindings& writes);
  ExpressionId when(const std::string& setting, bool wanted = true); // "setting" or "not setting"
  void otherwise(PassDeclaration& pass, const std::string& output, const std::string& instead);

  PortBinding reference(uint32_t port, const std::string& text) const; // as there, without "?"
  PortBinding& read(uint32_t pass, uint32_t index); // what a pass reads, in the order of the call
  PortBinding& written(uint32_t pass, uint32_t index);
  ResourceId resource(const std::string& name) const;
  PassId pass_id(const std::string& name) const;
  CompileInput input(uint32_t width = 64, uint32_t height = 64) const;
};

// Compiles, expects success and that the verifier proves the plan; fails the test otherwise.
CompiledPlan compiled(const GraphBuilder& builder);
CompiledPlan compiled(const GraphBuilder& builder, const CompileInput& input);

// Compiles, expects errors, returns them.
std::vector<Diagnostic> refused(const GraphBuilder& builder);
std::vector<Diagnostic> refused(const GraphBuilder& builder, const CompileInput& input);

// Names of the passes of a plan, in order, with a space between them.
std::string pass_names(const GraphBuilder& builder, const Plan& plan);
// All reasons about one thing.
std::string reasons(const GraphBuilder& builder, const CompiledPlan& compiled, Reason::About about,
                    uint32_t index);

} // namespace dermis::testing
