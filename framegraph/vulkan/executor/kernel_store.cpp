#include "framegraph/vulkan/kernel_store.hpp"

#include "framegraph/vulkan/executor/state.hpp"

#include <algorithm>
#include <cassert>
#include <new>

namespace dermis::vulkan {

std::shared_ptr<const Kernel> KernelStore::find(PassTypeId type, uint64_t version) const {
  {
    const std::lock_guard lock(mutex_);
    for (const std::shared_ptr<const Kernel>& kernel : kept_)
      if (kernel->type == type && kernel->version == version) return kernel;
    for (const InUse& one : in_use_)
      if (one.type == type && one.version == version)
        if (std::shared_ptr<const Kernel> kernel = one.kernel.lock()) return kernel;
  }
  return shared_ != nullptr ? shared_->find(type, version) : nullptr;
}

void KernelStore::add(std::shared_ptr<const Kernel> kernel) {
  const std::lock_guard lock(mutex_);
  kept_.push_back(std::move(kernel));
}

void KernelStore::hand_over() noexcept {
  assert(shared_ != nullptr);
  const std::lock_guard lock(mutex_);
  try {
    shared_->take(kept_);
  } catch (const std::bad_alloc&) { // The next graph compiles the kernels again.
  }
}

void KernelStore::take(std::vector<std::shared_ptr<const Kernel>>& kernels) {
  const std::lock_guard lock(mutex_);
  std::erase_if(in_use_, [](const InUse& one) { return one.kernel.expired(); });
  kept_.reserve(kept_.size() + kernels.size());
  in_use_.reserve(in_use_.size() + kernels.size());
  for (std::shared_ptr<const Kernel>& kernel : kernels) {
    const auto is_same = [&](const std::shared_ptr<const Kernel>& other) {
      return other->type == kernel->type;
    };
    // Another thread may have added the same kernel.
    if (kernel->version != 0)
      in_use_.push_back({kernel->type, kernel->version, kernel});
    else if (std::none_of(kept_.begin(), kept_.end(), is_same))
      kept_.push_back(std::move(kernel));
  }
  kernels.clear();
}

} // namespace dermis::vulkan
