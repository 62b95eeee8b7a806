#include "framegraph/vulkan/kernel_store.hpp"

#include "framegraph/vulkan/executor/state.hpp"

#include <algorithm>
#include <cassert>
#include <new>

namespace dermis::vulkan {

template <class Accepts>
std::shared_ptr<const Pipeline> KernelStore::find_pipeline(PassTypeId type, uint64_t version,
                                                           Accepts accepts) const {
  {
    const std::lock_guard lock(mutex_);
    for (const std::shared_ptr<const Pipeline>& pipeline : kept_)
      if (pipeline->kernel->type == type && pipeline->kernel->version == version &&
          accepts(*pipeline))
        return pipeline;
    for (const InUse& one : in_use_)
      if (one.type == type && one.version == version)
        if (std::shared_ptr<const Pipeline> pipeline = one.pipeline.lock();
            pipeline != nullptr && accepts(*pipeline))
          return pipeline;
  }
  return shared_ != nullptr ? shared_->find_pipeline(type, version, accepts) : nullptr;
}

std::shared_ptr<const Kernel> KernelStore::find_kernel(PassTypeId type, uint64_t version) const {
  const auto pipeline = find_pipeline(type, version, [](const Pipeline&) { return true; });
  return pipeline != nullptr ? pipeline->kernel : nullptr;
}

std::shared_ptr<const Pipeline> KernelStore::find(PassTypeId type, uint64_t version,
                                                  std::span<const uint32_t> constants) const {
  return find_pipeline(type, version, [&](const Pipeline& pipeline) {
    return std::ranges::equal(pipeline.constants, constants);
  });
}

void KernelStore::add(std::shared_ptr<const Pipeline> pipeline) {
  const std::lock_guard lock(mutex_);
  kept_.push_back(std::move(pipeline));
}

void KernelStore::hand_over() noexcept {
  assert(shared_ != nullptr);
  const std::lock_guard lock(mutex_);
  try {
    shared_->take(kept_);
  } catch (const std::bad_alloc&) { // The next graph compiles the kernels again.
  }
}

void KernelStore::take(std::vector<std::shared_ptr<const Pipeline>>& pipelines) {
  const std::lock_guard lock(mutex_);
  std::erase_if(in_use_, [](const InUse& one) { return one.pipeline.expired(); });
  kept_.reserve(kept_.size() + pipelines.size());
  in_use_.reserve(in_use_.size() + pipelines.size());
  for (std::shared_ptr<const Pipeline>& pipeline : pipelines) {
    const Kernel& kernel = *pipeline->kernel;
    const auto is_same = [&](const std::shared_ptr<const Pipeline>& other) {
      return other->kernel->type == kernel.type && other->constants == pipeline->constants;
    };
    // Another thread may have added the same pipeline.
    if (kernel.version != 0)
      in_use_.push_back({kernel.type, kernel.version, pipeline});
    else if (std::none_of(kept_.begin(), kept_.end(), is_same))
      kept_.push_back(std::move(pipeline));
    if (kernel.version == 0) drop_unused(kernel.type);
  }
  pipelines.clear();
}

// Drops the oldest pipelines of a kernel that no executor uses.
void KernelStore::drop_unused(PassTypeId type) {
  const auto is_unused = [&](const std::shared_ptr<const Pipeline>& pipeline) {
    return pipeline->kernel->type == type && pipeline.use_count() == 1;
  };
  for (auto unused = static_cast<size_t>(std::ranges::count_if(kept_, is_unused));
       unused > max_unused; --unused)
    kept_.erase(std::ranges::find_if(kept_, is_unused));
}

} // namespace dermis::vulkan
