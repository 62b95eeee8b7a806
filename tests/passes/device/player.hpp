#pragma once
// Runs a plan of the real pass types on a device, frame by frame, under validation, and returns the
// host's images.

#include "framegraph/compile/compile.hpp"
#include "framegraph/vulkan/device_profile.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "framegraph/vulkan/kernel_store.hpp"
#include "passes/common/environment.hpp"
#include "passes/common/kernel_tables.hpp"
#include "tests/passes/device/real_graph.hpp"
#include "tests/passes/device/show.hpp"
#include "tests/support/vulkan_fixture.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dermis::testing {

// Per frame, by slot that the plan writes: the defined texels. `lighting` is complete, others
// contain the rectangle.
using Played = std::vector<std::map<std::string, std::vector<std::byte>>>;

class DevicePlayer : public VulkanTest {
protected:
  void SetUp() override;
  void TearDown() override;

  CompileInput compile_input(const RealGraph& graph, const Show& show) const;
  // Fails the test on errors.
  Played play(const RealGraph& graph, const Show& show, const Plan& plan, bool poison);
  // Returns the device's key in golden tables: name, driver, version, processor features.
  std::string driver() const;

  vulkan::Device dermis_device;
  DeviceProfile profile;
  PassTypeRegistry pass_types;
  std::vector<vulkan::KernelCode> more_kernels;    // For pass types of the test.
  std::vector<subsurface::FrameCounters> counters; // By frame of the last play.

private:
  const subsurface::KernelTables& tables_for(const Graph& graph);

  std::vector<subsurface::NumberedProfile> profiles_;
  std::vector<std::unique_ptr<subsurface::KernelTables>> tables_;
  std::unique_ptr<vulkan::KernelStore> kernels_; // Kernels of all plans that ran.
  std::map<std::string, TestImage> images_;      // By format, size and slot, for reuse.
};

} // namespace dermis::testing
