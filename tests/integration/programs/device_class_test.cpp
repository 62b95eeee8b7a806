// Tests which built-in calibration a device starts from.

#include "integration/abi/chooser.hpp"

#include <gtest/gtest.h>

namespace dermis {
namespace {

TEST(DeviceClass, FollowsTheKindOfDevice) {
  EXPECT_EQ(abi::device_class(VK_PHYSICAL_DEVICE_TYPE_CPU), choice::DeviceClass::cpu);
  EXPECT_EQ(abi::device_class(VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU),
            choice::DeviceClass::large_gpu);
  for (const VkPhysicalDeviceType type :
       {VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU, VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU,
        VK_PHYSICAL_DEVICE_TYPE_OTHER})
    EXPECT_EQ(abi::device_class(type), choice::DeviceClass::small_gpu);
  EXPECT_NE(abi::make_chooser(choice::DeviceClass::large_gpu).calibration.device,
            abi::make_chooser(choice::DeviceClass::cpu).calibration.device);
}

} // namespace
} // namespace dermis
