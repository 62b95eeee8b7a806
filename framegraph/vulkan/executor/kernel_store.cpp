#include "framegraph/vulkan/kernel_store.hpp"

#include "framegraph/vulkan/executor/state.hpp"

#include <algorithm>
#include <new>

namespace dermis::vulkan {

std::shared_ptr<const Kernel> KernelStore::find(KindId kind, uint64_t version) const {
  const auto is_wanted = [&](const Kernel& kernel) {
    return kernel.kind == kind && kernel.version == version;
  };
  {
    const std::lock_guard lock(mutex_);
    for (const std::shared_ptr<const Kernel>& kernel : kept_)
      if (is_wanted(*kernel)) return kernel;
    for (const std::weak_ptr<const Kernel>& one : in_use_)
      if (std::shared_ptr<const Kernel> kernel = one.lock(); kernel != nullptr && is_wanted(*kernel))
        return kernel;
  }
  return shared_ != nullptr ? shared_->find(kind, version) : nullptr;
}

void KernelStore::add(std::shared_ptr<const Kernel> kernel) {
  const std::lock_guard lock(mutex_);
  kept_.push_back(std::move(kernel));
}

void KernelStore::hand_over() noexcept {
  const std::lock_guard lock(mutex_);
  try {
    shared_->take(kept_);
  } catch (const std::bad_alloc&) { // the next graph compiles them once more
  }
}

void KernelStore::take(std::vector<std::shared_ptr<const Kernel>>& kernels) {
  const std::lock_guard lock(mutex_);
  std::erase_if(in_use_, [](const std::weak_ptr<const Kernel>& one) { return one.expired(); });
  kept_.reserve(kept_.size() + kernels.size());
  in_use_.reserve(in_use_.size() + kernels.size());
  for (std::shared_ptr<const Kernel>& kernel : kernels) {
    const auto is_same = [&](const std::shared_ptr<const Kernel>& other) {
      return other->kind == kernel->kind;
    };
    if (kernel->version == 0 && std::any_of(kept_.begin(), kept_.end(), is_same))
      continue; // of another thread
    if (kernel->version == 0)
      kept_.push_back(std::move(kernel));
    else
      in_use_.emplace_back(kernel);
  }
  kernels.clear();
}

} // namespace dermis::vulkan
