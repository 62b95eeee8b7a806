#include "integration/tools/null_device/null_device.hpp"

#include "integration/tools/null_device/state.hpp"

#include <cstring>

namespace dermis {
namespace {

PFN_vkVoidFunction any_function(const char* name);

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_proc_addr(VkDevice, const char* name) {
  return any_function(name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_proc_addr(VkInstance, const char* name) {
  return any_function(name);
}

PFN_vkVoidFunction any_function(const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&get_device_proc_addr);
  if (const auto function = command_function(name)) return function;
  if (const auto function = object_function(name)) return function;
  return query_function(name);
}

} // namespace

NullDeviceState::~NullDeviceState() {
  for (NullObject* object : alive)
    delete object;
}

VkResult count_creation(NullDeviceState& state) {
  const std::lock_guard lock(state.mutex);
  ++state.creations;
  if (state.failing_creation == 0 || --state.failing_creation != 0) return VK_SUCCESS;
  return state.failure;
}

NullObject* add_object(NullDeviceState& state, uint64_t memory_bytes) {
  auto object = std::make_unique<NullObject>();
  object->bytes = memory_bytes;
  const std::lock_guard lock(state.mutex);
  state.memory_bytes += memory_bytes;
  state.alive.insert(object.get());
  return object.release();
}

void remove_object(NullDeviceState& state, NullObject* object) {
  const std::lock_guard lock(state.mutex);
  if (state.alive.erase(object) == 0) return; // null, or not of this device
  state.memory_bytes -= object->bytes;
  delete object;
}

PFN_vkVoidFunction find_entry(const NullEntry* entries, size_t count, const char* name) {
  for (size_t i = 0; i < count; ++i)
    if (std::strcmp(entries[i].name, name) == 0) return entries[i].function;
  return nullptr;
}

NullDevice::NullDevice() : state_(std::make_unique<NullDeviceState>()) {}

NullDevice::~NullDevice() = default;

PFN_vkGetInstanceProcAddr NullDevice::loader() {
  return &get_instance_proc_addr;
}

VkInstance NullDevice::instance() const {
  return reinterpret_cast<VkInstance>(state_.get());
}

VkPhysicalDevice NullDevice::physical() const {
  return reinterpret_cast<VkPhysicalDevice>(state_.get());
}

VkDevice NullDevice::device() const {
  return reinterpret_cast<VkDevice>(state_.get());
}

VkCommandBuffer NullDevice::command_buffer() const {
  return reinterpret_cast<VkCommandBuffer>(state_.get());
}

VkImage NullDevice::make_image() {
  return reinterpret_cast<VkImage>(add_object(*state_));
}

VkImageView NullDevice::make_view() {
  return reinterpret_cast<VkImageView>(add_object(*state_));
}

uint64_t NullDevice::commands() const {
  return state_->commands;
}

uint64_t NullDevice::dispatches() const {
  return state_->dispatches;
}

uint64_t NullDevice::barriers() const {
  return state_->barriers;
}

uint64_t NullDevice::buffer_copies() const {
  return state_->buffer_copies;
}

void NullDevice::make_discrete() {
  state_->discrete = true;
}
void NullDevice::make_discrete_with_full_bar() {
  state_->discrete = state_->full_bar = true;
}

uint64_t NullDevice::descriptor_writes() const {
  return state_->descriptor_writes;
}

uint64_t NullDevice::pipelines() const {
  return state_->pipelines;
}

uint64_t NullDevice::alive() const {
  const std::lock_guard lock(state_->mutex);
  return state_->alive.size();
}

uint64_t NullDevice::memory_bytes() const {
  const std::lock_guard lock(state_->mutex);
  return state_->memory_bytes;
}

uint64_t NullDevice::creations() const {
  const std::lock_guard lock(state_->mutex);
  return state_->creations;
}

void NullDevice::set_queue_flags(VkQueueFlags flags) {
  state_->queue_flags = flags;
}

void NullDevice::fail_queries(VkResult result) {
  state_->query_failure = result;
}

void NullDevice::fail_creation(uint64_t creation, VkResult result) {
  const std::lock_guard lock(state_->mutex);
  state_->failing_creation = creation;
  state_->failure = result;
}

} // namespace dermis
