// The host pass after Dermis that docs/integration.md describes:
// integration/examples/composite.comp shows equal light whether Dermis or the host multiplies by
// albedo.

#include "tests/integration/abi/dermis_fixture.hpp"
#include "tests/integration/abi/example_shader.hpp"

#include "composite.spv.h" // Needs the types of the headers above.

#include <cmath>

namespace dermis::abi_test {
namespace {

constexpr uint32_t shown_side = 64;

bool is_skin(uint32_t x) {
  return x < shown_side / 2;
}

struct Composite : DermisTest {
  demo::Image make_image(VkFormat format, float value) {
    demo::ImageDesc desc;
    desc.format = format;
    desc.width = desc.height = shown_side;
    desc.usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                 VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    auto image = demo::create_image(*host, desc);
    EXPECT_TRUE(image) << image.error().text;
    const demo::ImageState general{VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                   VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
    const std::vector<float> texels(size_t{shown_side} * shown_side * 4, value);
    EXPECT_TRUE(demo::upload_image(*host, *image, texels, 4, general));
    return image.take();
  }

  // Returns the red channel of the host's picture, by texel; albedo is 0.5 and specular light 0.25.
  std::vector<float> shown(bool bind_albedo, const std::string& result) {
    GraphOptions options = shipped_options("configs/graphs/burley.json");
    // Setting of the combine pass.
    const std::string set = R"("set": { "texturing": "$texturing" } })";
    const size_t at = options.text.rfind(set);
    EXPECT_NE(at, std::string::npos);
    options.text.insert(at + 8, R"("result": ")" + result + R"(", )");
    options.unbound = {"scatter_scale", "scattered_light"};
    if (!bind_albedo) options.unbound.emplace_back("albedo");
    options.formats.emplace_back("lighting", VK_FORMAT_R32G32B32A32_SFLOAT);
    const dermis_graph graph = make_graph(options);
    images.clear();
    make_images(graph);
    fill("material", [](uint32_t x, uint32_t) { return is_skin(x) ? 1.0f : 0.0f; });
    if (bind_albedo) fill("albedo", [](uint32_t, uint32_t) { return 0.5f; });
    // Even on the skin.
    fill("lighting", [](uint32_t x, uint32_t) { return is_skin(x) ? 1.0f : 0.75f; });
    const auto bound = bindings(graph);
    last_frame = 0;
    dermis_frame one = frame(bound);
    EXPECT_OK(record(graph, one));
    const demo::Image albedo = make_image(VK_FORMAT_R32G32B32A32_SFLOAT, 0.5f),
                      specular = make_image(VK_FORMAT_R32G32B32A32_SFLOAT, 0.25f);
    images.insert_or_assign("shown", make_image(VK_FORMAT_R32G32B32A32_SFLOAT, 0.0f));
    const int32_t applied = bind_albedo && result == "color" ? 1 : 0;
    run_example(*host, {composite_spirv,
                        {images.at("lighting").view, images.at("material").view, albedo.view,
                         specular.view},
                        &images.at("shown"),
                        std::as_bytes(std::span(&applied, 1))});
    std::vector<float> red;
    const std::vector<float> all = texels("shown");
    for (size_t i = 0; i < all.size(); i += 4)
      red.push_back(all[i]);
    return red;
  }
};

TEST_F(Composite, AlbedoByHostOrLibrary_GivesEqualLight) {
  const std::vector<float> unbound = shown(false, "color"), light = shown(true, "light"),
                           color = shown(true, "color");
  ASSERT_EQ(unbound.size(), size_t{shown_side} * shown_side);
  for (size_t i = 0; i < unbound.size(); ++i) {
    const float lit = is_skin(static_cast<uint32_t>(i % shown_side)) ? 1.0f : 0.75f;
    // Even light on one material stays even; half floats store it within 2^-11 of its value.
    ASSERT_NEAR(unbound[i], lit * 0.5f + 0.25f, std::ldexp(1.0f, -10)) << i;
    ASSERT_NEAR(light[i], unbound[i], std::ldexp(1.0f, -10)) << i;
    ASSERT_NEAR(color[i], unbound[i], 2.0f / 255) << i; // The bound albedo has 8 bits, in sRGB.
  }
}

} // namespace
} // namespace dermis::abi_test
