#pragma once
// Builds graphs in code, so that the compiler is tested without the reader. Every declaration gets
// its own line number, in the order of the calls.

#include "framegraph/compile/compile.hpp"
#include "tests/support/matchers.hpp"

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace dermis::testing {

// Pairs a port with "resource", "resource#1[0]", "resource@-1", "resource@-1?" (must be valid) or
// "resource@-1?otherwise".
using Bindings = std::vector<std::pair<std::string, std::string>>;

// Returns these pass types:
// - test.shade (a b c -> out, out2)
// - test.update (a, own texel by texel, image in place)
// - test.fill (clears target)
// - test.list (writes buffer tiles)
// - test.count (updates buffer tiles)
// - test.tiles (tiles as list and indirect arguments, a -> out)
// - test.probe (reads a, has side effects)
// - test.narrow (a -> out, only rgba16f)
// - test.filter (a with linear filtering -> out)
// - test.blend (a, own texel by texel -> out)
// - test.ids (ids, whole numbers -> out)
// - test.levels (a -> out, internally ordered)
PassTypeRegistry test_pass_types();

struct GraphBuilder {
  Graph graph;
  PassTypeRegistry pass_types = test_pass_types();
  DeviceProfile device = generic_profile();
  uint32_t line = 0;

  GraphBuilder() { graph.name = "test"; }
  // Declares resources in this order: "import NAME", "image NAME", "export NAME", "history NAME",
  // "buffer NAME", or "in_out NAME" for an import that is also exported.
  explicit GraphBuilder(std::initializer_list<const char*> resources);

  SourceLocation next_line();
  ResourceDeclaration& import(const std::string& name);
  ResourceDeclaration& image(const std::string& name);
  // Adds a buffer with one element of 4 bytes per tile, and 4 more.
  ResourceDeclaration& buffer(const std::string& name);
  ResourceDeclaration& exported(const std::string& name); // Adds an image that the host binds.
  ResourceDeclaration& history(const std::string& name, uint32_t frames = 1);
  SettingDeclaration& boolean(const std::string& name, bool value);
  PassDeclaration& pass(const std::string& name, const std::string& type, const Bindings& reads,
                        const Bindings& writes);
  // Takes "setting" or "not setting".
  ExpressionId when(const std::string& setting, bool when_set = true);
  void otherwise(PassDeclaration& pass, const std::string& output, const std::string& instead);

  // Parses a reference as in Bindings, without "?".
  PortBinding reference(uint32_t port, const std::string& text) const;
  // Returns read number `index` of the pass, in the order of the call.
  PortBinding& read(uint32_t pass, uint32_t index);
  PortBinding& written(uint32_t pass, uint32_t index);
  ResourceId resource(const std::string& name) const;
  PassId pass_id(const std::string& name) const;
  CompileInput input(uint32_t width = 64, uint32_t height = 64) const;
};

// Compiles and runs the verifier. Fails the test if either reports an error.
CompiledPlan compiled(const GraphBuilder& builder);
CompiledPlan compiled(const GraphBuilder& builder, const CompileInput& input);

// Compiles, expects errors and returns them.
std::vector<Diagnostic> rejected(const GraphBuilder& builder);
std::vector<Diagnostic> rejected(const GraphBuilder& builder, const CompileInput& input);

// Compiles, expects one error with this id, all texts and matchers, and returns it.
template <class... Texts>
Diagnostic rejected_once(const GraphBuilder& builder, const CompileInput& input, DiagnosticId id,
                         const Texts&... texts) {
  const std::vector<Diagnostic> errors = rejected(builder, input);
  EXPECT_THAT(errors, SizeIs(1));
  EXPECT_EQ(errors.at(0).id, id);
  EXPECT_THAT(errors.at(0).text, HasAll("", texts...));
  return errors.at(0);
}
template <class... Texts>
Diagnostic rejected_once(const GraphBuilder& builder, DiagnosticId id, const Texts&... texts) {
  return rejected_once(builder, builder.input(), id, texts...);
}

// Returns the pass names of a plan in order, separated by spaces.
std::string pass_names(const GraphBuilder& builder, const Plan& plan);
// Returns all recorded reasons about one pass or resource.
std::string reasons(const GraphBuilder& builder, const CompiledPlan& compiled, Reason::About about,
                    uint32_t index);

} // namespace dermis::testing
