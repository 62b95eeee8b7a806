#pragma once
// Compiled kernels that executors share, so that a graph made beside or after another compiles only what no
// other had.

#include "framegraph/model/pass_type.hpp"

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace dermis::vulkan {

struct Kernel; // executor/state.hpp

// Of executors with one device, one registry of pass types and environments of the same types; destroyed
// before the device is. Any thread.
class KernelStore {
public:
  KernelStore() = default;
  // Has what `shared` has, which must outlive it; what is added `shared` has only once it is handed over.
  explicit KernelStore(KernelStore& shared) : shared_(&shared) {}
  // Null: there is none of that pass type and KernelCode::version.
  std::shared_ptr<const Kernel> find(PassTypeId type, uint64_t version) const;
  void add(std::shared_ptr<const Kernel> kernel);
  // For a store that has a `shared` one, which keeps kernels of version 0 until it is destroyed, others as
  // long as an executor uses them. Where memory for that cannot be had, none of them.
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
