// Tests names in dermis_graph_desc.unbound and .formats without a slot in the graph.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <cstring>
#include <filesystem>
#include <set>

namespace dermis::abi_test {
namespace {

struct Message {
  dermis_severity severity;
  std::string name, text;
};

// A device with ray tracing, so that every shipped graph compiles.
VKAPI_ATTR void VKAPI_CALL all_features(VkPhysicalDevice device, VkPhysicalDeviceFeatures2* out) {
  reinterpret_cast<PFN_vkGetPhysicalDeviceFeatures2>(
      NullDevice::loader()(nullptr, "vkGetPhysicalDeviceFeatures2"))(device, out);
  for (auto* next = static_cast<VkBaseOutStructure*>(out->pNext); next != nullptr;
       next = next->pNext) {
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR)
      reinterpret_cast<VkPhysicalDeviceAccelerationStructureFeaturesKHR*>(next)
          ->accelerationStructure = VK_TRUE;
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR)
      reinterpret_cast<VkPhysicalDeviceRayQueryFeaturesKHR*>(next)->rayQuery = VK_TRUE;
  }
}
VKAPI_ATTR VkResult VKAPI_CALL ray_extensions(VkPhysicalDevice, const char*, uint32_t* count,
                                              VkExtensionProperties* out) {
  *count = 2;
  if (out == nullptr) return VK_SUCCESS;
  std::strcpy(out[0].extensionName, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME);
  std::strcpy(out[1].extensionName, VK_KHR_RAY_QUERY_EXTENSION_NAME);
  return VK_SUCCESS;
}
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL load_with_rays(VkInstance instance, const char* name) {
  if (std::strcmp(name, "vkGetPhysicalDeviceFeatures2") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&all_features);
  if (std::strcmp(name, "vkEnumerateDeviceExtensionProperties") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&ray_extensions);
  return NullDevice::loader()(instance, name);
}

struct UnboundNames : ::testing::Test {
  NullHost host;
  std::vector<Message> logged;

  static void DERMIS_CALL log(void* user, const dermis_message* message) {
    static_cast<UnboundNames*>(user)->logged.push_back(
        {message->severity, message->code_name, message->text});
  }
  void SetUp() override {
    dermis_context_desc desc = host.context_desc();
    desc.flags |= DERMIS_CONTEXT_RAY_QUERY;
    desc.get_instance_proc_addr = load_with_rays;
    desc.log = log;
    desc.log_user = this;
    ASSERT_OK(host.make_context(desc));
  }
  dermis_graph create(const std::string& path, const std::vector<const char*>& unbound,
                      const std::vector<dermis_slot_format>& formats = {}) {
    logged.clear();
    const std::string text = read_text(path);
    dermis_profile profile = skin_profile();
    dermis_graph_desc desc = graph_desc(text, path.c_str(), 64);
    desc.profiles = &profile;
    desc.profile_count = 1;
    desc.unbound = unbound.data();
    desc.unbound_count = static_cast<uint32_t>(unbound.size());
    desc.formats = formats.data();
    desc.format_count = static_cast<uint32_t>(formats.size());
    dermis_graph graph = nullptr;
    EXPECT_OK(dermis_graph_create(host.context, &desc, &graph, nullptr)) << path;
    return graph;
  }
  std::vector<Message> about_slots() const {
    std::vector<Message> out;
    for (const Message& message : logged)
      if (message.name == "host_names_no_slot" || message.name == "host_names_other_slots")
        out.push_back(message);
    return out;
  }
};

TEST_F(UnboundNames, OneListForShippedGraphs_GivesNoWarning) {
  const std::vector<std::string> paths = dermis::shipped::graph_files();
  ASSERT_GE(paths.size(), 16u);
  std::set<std::string> optional, required;
  for (const std::string& path : paths) {
    const dermis_graph graph = create(path, {});
    for (const dermis_slot& slot : slots_of(graph))
      (slot.required ? required : optional).insert(slot.name);
    dermis_graph_destroy(graph);
  }
  std::vector<const char*> unbound;
  for (const std::string& name : optional)
    if (required.count(name) == 0) unbound.push_back(name.c_str());
  ASSERT_GE(unbound.size(), 4u);
  for (const std::string& path : paths) {
    dermis_graph_destroy(create(path, unbound));
    const std::vector<Message> said = about_slots();
    EXPECT_LE(said.size(), 1u) << path;
    for (const Message& message : said)
      EXPECT_EQ(message.severity, DERMIS_SEVERITY_NOTE) << path << ": " << message.text;
  }
}

TEST_F(UnboundNames, UnknownNames_GiveOneNote) {
  dermis_slot_format format = slot_format("importance", VK_FORMAT_R8_UNORM);
  host.graph = create("configs/graphs/burley.json", {"albedo", "velocity", "sampling"}, {format});
  const std::vector<Message> said = about_slots();
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].severity, DERMIS_SEVERITY_NOTE);
  EXPECT_THAT(said[0].text, HasAll("'velocity'", "'sampling'", "'importance'", "'burley'",
                                   "'lighting'", "'albedo'"));
}

TEST_F(UnboundNames, Misspelt_IsAWarningWithASuggestion) {
  dermis_slot_format format = slot_format("Depth", VK_FORMAT_R32_SFLOAT);
  host.graph = create("configs/graphs/burley.json", {"albdo", "velocity"}, {format});
  std::string warnings;
  for (const Message& message : about_slots())
    if (message.severity == DERMIS_SEVERITY_WARNING) warnings += message.text + "\n";
  EXPECT_THAT(warnings,
              AllOf(HasSubstr("'albdo'"), HasSubstr("did you mean 'albedo'?"), HasSubstr("'Depth'"),
                    HasSubstr("did you mean 'depth'?"), Not(HasSubstr("velocity"))));
}

} // namespace
} // namespace dermis::abi_test
