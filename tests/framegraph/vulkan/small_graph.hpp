#pragma once
// The test kernels' signatures, and graphs built from them in code, for tests that run plans on a
// device.

#include "framegraph/compile/compile.hpp"
#include "framegraph/vulkan/executor.hpp"

#include <string>
#include <utility>
#include <vector>

namespace dermis::testing {

// Returns test.fill, test.add, test.sample, test.classes, test.list, test.mark, test.stamp,
// test.show, test.constant and test.clear; their ports are those of kernels/*.comp.
const PassTypeRegistry& small_pass_types();
std::span<const vulkan::KernelCode> small_kernels();

struct SmallFrame { // std140, as in kernels/frame.glsl.
  int32_t rect[4];
  float time;
  float unused[3];
};

struct SmallGraph {
  // Pairs of a port and a source as in Bindings.
  using Ports = std::vector<std::pair<std::string, std::string>>;
  Graph graph;

  SmallGraph() = default;
  // Declares r32f images in this order: "import NAME", "image NAME", "export NAME", "history NAME",
  // or "in_out NAME" for an import that is also exported.
  explicit SmallGraph(std::initializer_list<const char*> images);

  ResourceDeclaration& import(const std::string& name, Format format, bool optional = false);
  ResourceDeclaration& exported(const std::string& name, Format format = Format::r32f);
  ResourceDeclaration& image(const std::string& name, Format format = Format::r32f);
  ResourceDeclaration& history(const std::string& name, uint32_t frames = 1);
  // 4 bytes per tile and extra element.
  ResourceDeclaration& buffer(const std::string& name, uint32_t extra_elements);
  PassDeclaration& pass(const std::string& name, const std::string& type, const Ports& reads,
                        const Ports& writes);
  void set(PassDeclaration& pass, const std::string& setting, double value);
  SettingDeclaration& setting(const std::string& name, double value);
  void follow(PassDeclaration& pass, const std::string& setting, const std::string& graph_setting);

  int32_t slot(const std::string& name) const; // Returns PlanResource::slot.
  // Compiles; fails the test and returns an empty plan on diagnostics.
  Plan compile(const DeviceProfile& device, uint32_t width, uint32_t height,
               const std::vector<std::string>& unbound = {}, bool poison = false) const;

private:
  ResourceDeclaration& resource(const std::string& name, Format format);
  PortBinding binding(const PassType& type, const std::string& port, const std::string& text) const;
  std::vector<PortBinding> bindings(const PassType& type, const Ports& ports) const;
};

} // namespace dermis::testing
