#pragma once
// Shares compiled kernels between executors, so that another graph compiles only the kernels that
// no earlier graph has.

#include "framegraph/model/pass_type.hpp"

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace dermis::vulkan {

struct Kernel; // defined in executor/state.hpp

// Serves executors with one device, one registry of pass types and environments with equal types.
// Must be destroyed before the device. Any thread.
class KernelStore {
public:
  KernelStore() = default;
  // Also finds the kernels of `shared`, which must outlive this store. Kernels added here reach
  // `shared` only through hand_over().
  explicit KernelStore(KernelStore& shared) : shared_(&shared) {}
  // Returns null if there is no kernel with that pass type and KernelCode::version.
  std::shared_ptr<const Kernel> find(PassTypeId type, uint64_t version) const;
  void add(std::shared_ptr<const Kernel> kernel);
  // Moves all kernels to the shared store, which must exist. The shared store keeps kernels of
  // version 0 until it is destroyed, and others as long as an executor uses them. If memory runs
  // out, no kernel moves.
  void hand_over() noexcept;

private:
  struct InUse {
    PassTypeId type;
    uint64_t version = 0;
    std::weak_ptr<const Kernel> kernel;
  };
  void take(std::vector<std::shared_ptr<const Kernel>>& kernels);

  KernelStore* shared_ = nullptr;
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<const Kernel>> kept_;
  std::vector<InUse> in_use_;
};

} // namespace dermis::vulkan
