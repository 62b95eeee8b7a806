#include "integration/demo_engine/model/load_model.hpp"
#include "integration/demo_engine/model/load_texture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace demo {
namespace {

using testing::HasSubstr;

// A folder of its own for each test, gone afterwards.
struct ModelFile : testing::Test {
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder = std::filesystem::temp_directory_path() /
             (std::string("dermis_model_") + info->name() + "_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::string write(const std::string& name, const std::string& bytes) const {
    const std::string path = (folder / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  // One triangle; `indices` and `accessor` exchange pieces of the file.
  std::string triangle(const std::string& indices = "[0, 1, 2]", const std::string& accessor = "",
                       const std::string& nodes = R"([{ "mesh": 0 }])") const {
    const float positions[] = {0, 0, 0, 1, 0, 0, 0, 2, 0};
    std::string buffer(reinterpret_cast<const char*>(positions), sizeof(positions));
    for (const char digit : indices)
      if (digit >= '0' && digit <= '9') buffer += std::string(1, static_cast<char>(digit - '0')) + '\0';
    write("triangle.bin", buffer);
    return write("triangle.gltf", R"({ "asset": { "version": "2.0", "copyright": "by nobody" },
      "buffers": [{ "uri": "triangle.bin", "byteLength": )" +
                                      std::to_string(buffer.size()) + R"( }],
      "bufferViews": [{ "buffer": 0, "byteLength": 36 }, { "buffer": 0, "byteOffset": 36, "byteLength": 6 }],
      "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" )" +
                                      accessor + R"( },
        { "bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR" }],
      "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
      "nodes": )" + nodes + R"(, "scenes": [{ "nodes": [0] }], "scene": 0 })");
  }

  static Error refused(const ModelOptions& options) {
    auto model = load_model(options);
    if (model) {
      ADD_FAILURE() << "the model was accepted";
      return {};
    }
    return model.error();
  }
  static ModelOptions only(const std::string& mesh) {
    ModelOptions options;
    options.mesh = mesh;
    return options;
  }

  std::filesystem::path folder;
};

TEST_F(ModelFile, ATriangleIsScaledToItsHeightAroundItsMiddle) {
  ModelOptions options = only(triangle());
  options.height_metres = 0.5;
  const auto model = load_model(options);
  ASSERT_TRUE(model) << model.error().text;
  const Bounds bounds = bounds_of(model->mesh);
  EXPECT_NEAR(bounds.high.y, 0.25f, 1e-6f);
  EXPECT_NEAR(bounds.low.y, -0.25f, 1e-6f);
  EXPECT_NEAR(bounds.high.x, 0.125f, 1e-6f);
  EXPECT_NEAR(model->mesh.vertices[0].normal.z, 1.0f, 1e-6f); // made where the file has none
  EXPECT_THAT(model->credits, testing::ElementsAre("by nobody"));
}

TEST_F(ModelFile, WhatIsNoGltfIsCalledSo) {
  const Error error = refused(only(write("cat.glb", "\x89PNG and so on")));
  EXPECT_EQ(error.kind, ErrorKind::input);
  EXPECT_THAT(error.text, HasSubstr("cat.glb"));
  EXPECT_THAT(error.text, HasSubstr("not a glTF file"));
  EXPECT_THAT(refused(only(write("empty.glb", ""))).text, HasSubstr("not a glTF file"));
  EXPECT_THAT(refused(only(write("short.glb", "glTF\x02"))).text, HasSubstr("damaged"));
  EXPECT_THAT(refused(only(write("bad.gltf", "{ \"asset\": "))).text, HasSubstr("damaged"));
  EXPECT_THAT(refused(only((folder / "absent.glb").string())).text, HasSubstr("no such file"));
  EXPECT_THAT(refused(only(folder.string())).text, HasSubstr("not a regular file"));
}

TEST_F(ModelFile, IndicesBeyondTheVerticesAreRefused) {
  EXPECT_THAT(refused(only(triangle("[0, 1, 3]"))).text, HasSubstr("holds index 3; there are 3 vertices"));
}

TEST_F(ModelFile, AccessorsBeyondTheirBufferAreRefused) {
  EXPECT_THAT(refused(only(triangle("[0, 1, 2]", R"(, "byteOffset": 8)"))).text, HasSubstr("beyond the end"));
  EXPECT_THAT(refused(only(triangle("[0, 1, 2]", R"(, "byteOffset": 18446744073709551600)"))).kind,
              ErrorKind::input);
}

TEST_F(ModelFile, NodesInACircleAreRefused) {
  EXPECT_THAT(refused(only(triangle("[0, 1, 2]", "", R"([{ "children": [1] }, { "children": [0] }])"))).text,
              HasSubstr("circle"));
}

TEST_F(ModelFile, ASceneWithoutTrianglesIsRefused) {
  EXPECT_THAT(refused(only(triangle("[0, 1, 2]", "", R"([{ "name": "lamp" }])"))).text,
              HasSubstr("no triangles"));
}

TEST_F(ModelFile, MapsThatAreNoImagesAreNamed) {
  ModelOptions options = only(triangle());
  options.albedo = write("albedo.png", "no image at all");
  EXPECT_THAT(refused(options).text, HasSubstr("albedo.png"));
}

TEST_F(ModelFile, AHeightIsAPositiveLength) {
  ModelOptions options = only(triangle());
  for (const double height : {-1.0, std::nan(""), 1e9}) {
    options.height_metres = height;
    EXPECT_EQ(refused(options).kind, ErrorKind::usage) << height;
  }
}

TEST_F(ModelFile, EveryTruncationOfAFileIsRefusedOrRead) {
  const std::string path = triangle();
  std::ifstream stream(path, std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(stream)), {});
  for (size_t size = 0; size < whole.size(); size += 7) {
    const auto model = load_model(only(write("cut.gltf", whole.substr(0, size))));
    if (!model) {
      EXPECT_EQ(model.error().kind, ErrorKind::input);
    }
  }
}

TEST(Texture, RowsAreTurnedUpsideDown) {
  Texture texture{1, 3, std::vector<std::byte>(12)};
  for (int i = 0; i < 12; ++i)
    texture.texels[static_cast<size_t>(i)] = std::byte(i);
  flip_rows(texture);
  EXPECT_EQ(texture.texels[0], std::byte{8});
  EXPECT_EQ(texture.texels[4], std::byte{4});
  EXPECT_EQ(texture.texels[11], std::byte{3});
}

} // namespace
} // namespace demo
