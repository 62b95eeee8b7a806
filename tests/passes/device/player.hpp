#pragma once
// Plays a plan of the real pass types on a device, frame by frame, and hands out what the host gets. Under
// validation, as every device test.

#include "framegraph/compile/compile.hpp"
#include "framegraph/vulkan/device_profile.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "framegraph/vulkan/kernel_store.hpp"
#include "passes/common/kernel_tables.hpp"
#include "tests/passes/device/real_graph.hpp"
#include "tests/passes/device/show.hpp"
#include "tests/support/vulkan_fixture.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dermis::testing {

// Of one frame, by slot that the plan writes: the texels that are defined, `lighting` whole, others inside of
// the rectangle.
using Played = std::vector<std::map<std::string, std::vector<std::byte>>>;

class DevicePlayer : public VulkanTest {
protected:
  void SetUp() override;
  void TearDown() override;

  CompileInput compile_input(const RealGraph& graph, const Show& show) const;
  // Fails the test on errors.
  Played play(const RealGraph& graph, const Show& show, const Plan& plan, bool poison);
  // The device as golden tables call it: name, driver, version, what the processor has.
  std::string driver() const;

  vulkan::Device dermis_device;
  DeviceProfile profile;
  PassTypeRegistry pass_types;

private:
  const subsurface::KernelTables& tables_for(const Graph& graph);

  std::vector<subsurface::NumberedProfile> profiles_;
  std::vector<std::unique_ptr<subsurface::KernelTables>> tables_;
  std::unique_ptr<vulkan::KernelStore> kernels_; // of all that was played
  std::map<std::string, TestImage> images_;      // by format, size and slot: used again
};

} // namespace dermis::testing
