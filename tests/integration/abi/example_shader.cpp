#include "tests/integration/abi/example_shader.hpp"

#include "integration/examples/demo_engine/render/pipeline.hpp"

#include <gtest/gtest.h>

namespace dermis::abi_test {

void run_example(demo::VulkanHost& host, const ExampleShader& shader) {
  constexpr VkShaderStageFlags compute = VK_SHADER_STAGE_COMPUTE_BIT;
  const auto count = static_cast<uint32_t>(shader.sampled.size());
  std::vector<demo::Binding> bindings(count, {VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, compute});
  bindings.push_back({VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, compute});
  const auto push_bytes = static_cast<uint32_t>(shader.push_constants.size());
  auto layout = demo::create_layout(host, {bindings}, push_bytes, compute);
  ASSERT_TRUE(layout) << layout.error().text;
  VkShaderModuleCreateInfo module_info{};
  module_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  module_info.codeSize = shader.spirv.size_bytes();
  module_info.pCode = shader.spirv.data();
  VkShaderModule module = VK_NULL_HANDLE;
  ASSERT_EQ(host.vk.vkCreateShaderModule(host.device, &module_info, nullptr, &module), VK_SUCCESS);
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module;
  info.stage.pName = "main";
  info.layout = layout->layout.handle;
  VkPipeline pipeline = VK_NULL_HANDLE;
  ASSERT_EQ(
      host.vk.vkCreateComputePipelines(host.device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
      VK_SUCCESS);
  auto pool = demo::create_descriptor_pool(host, 1);
  ASSERT_TRUE(pool) << pool.error().text;
  auto set = demo::allocate_set(host, *pool, layout->sets[0]);
  ASSERT_TRUE(set) << set.error().text;
  for (uint32_t i = 0; i < count; ++i)
    demo::write_image(host, *set, i, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, shader.sampled[i],
                      VK_IMAGE_LAYOUT_GENERAL, VK_NULL_HANDLE);
  demo::write_image(host, *set, count, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, shader.written->view,
                    VK_IMAGE_LAYOUT_GENERAL, VK_NULL_HANDLE);
  const demo::ImageState at_rest{VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                 VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT};
  const demo::ImageState written{VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                 VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
  const auto ran = demo::run_commands(host, [&](VkCommandBuffer commands) -> demo::Result<> {
    demo::transition(host, commands, *shader.written, at_rest, written);
    host.vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    const VkDescriptorSet bound = *set;
    host.vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, info.layout, 0, 1,
                                    &bound, 0, nullptr);
    host.vk.vkCmdPushConstants(commands, info.layout, compute, 0, push_bytes,
                               shader.push_constants.data());
    host.vk.vkCmdDispatch(commands, (shader.written->width + 7) / 8,
                          (shader.written->height + 7) / 8, 1);
    demo::transition(host, commands, *shader.written, written, at_rest);
    return demo::success();
  });
  EXPECT_TRUE(ran) << ran.error().text;
  host.vk.vkDestroyPipeline(host.device, pipeline, nullptr);
  host.vk.vkDestroyShaderModule(host.device, module, nullptr);
}

} // namespace dermis::abi_test
