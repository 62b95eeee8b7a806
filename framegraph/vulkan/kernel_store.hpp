#pragma once
// Shares kernels and their pipelines between executors, so that another graph compiles only the
// pipelines that no earlier graph has.

#include "framegraph/model/pass_type.hpp"

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace dermis::vulkan {

struct Kernel; // both are defined in executor/state.hpp
struct Pipeline;

// Serves executors with one device, one registry of pass types and environments with equal types.
// Must be destroyed before the device. Any thread.
class KernelStore {
public:
  // A setting that changes back finds its pipeline again, but a host that tries all combinations of
  // settings does not keep them all.
  static constexpr size_t max_unused = 16;

  KernelStore() = default;
  // Also finds the pipelines of `shared`, which must outlive this store. Pipelines added here reach
  // `shared` only through hand_over().
  explicit KernelStore(KernelStore& shared) : shared_(&shared) {}
  // Returns null if no pipeline has a kernel with that pass type and KernelCode::version.
  std::shared_ptr<const Kernel> find_kernel(PassTypeId type, uint64_t version) const;
  // Returns the pipeline of the pass type's kernel with this version and these constants, or null.
  std::shared_ptr<const Pipeline> find(PassTypeId type, uint64_t version,
                                       std::span<const uint32_t> constants) const;
  void add(std::shared_ptr<const Pipeline> pipeline);
  // Moves all pipelines to the shared store, which must exist. The shared store keeps pipelines of
  // version 0 until it is destroyed, but at most max_unused per kernel that no executor uses; it
  // keeps others as long as an executor uses them. If memory runs out, no pipeline moves.
  void hand_over() noexcept;

private:
  struct InUse {
    PassTypeId type;
    uint64_t version = 0;
    std::weak_ptr<const Pipeline> pipeline;
  };
  template <class Accepts>
  std::shared_ptr<const Pipeline> find_pipeline(PassTypeId type, uint64_t version,
                                                Accepts accepts) const;
  void take(std::vector<std::shared_ptr<const Pipeline>>& pipelines);
  void drop_unused(PassTypeId type);

  KernelStore* shared_ = nullptr;
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<const Pipeline>> kept_; // oldest first
  std::vector<InUse> in_use_;
};

} // namespace dermis::vulkan
