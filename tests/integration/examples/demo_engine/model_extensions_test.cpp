// Tests models that use glTF extensions.

#include "integration/examples/demo_engine/model/load_model.hpp"
#include "tests/support/test_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#ifdef DEMO_MESHOPT
#include <meshoptimizer.h>
#endif
#ifdef DEMO_DRACO
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#endif

#include <cstdint>
#include <fstream>
#include <string>

namespace demo {
namespace {

struct ModelExtensions : ::testing::Test {
  std::string write(const std::string& name, const std::string& bytes) const {
    const std::string path = (folder / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  static ModelOptions only(const std::string& mesh) {
    ModelOptions options;
    options.mesh = mesh;
    return options;
  }

  const dermis::test::TestFolder folder;
};

TEST_F(ModelExtensions, QuantisedPositionsAreRead) {
  const int16_t shorts[] = {-32767, -32768, 0, 0, 32767, -32767, 0, 0, -32767, 32767, 0, 0};
  const int8_t bytes[] = {-127, -128, 0, 0, 127, -127, 0, 0, -127, 127, 0, 0};
  const auto quantised = [&](const void* data, size_t size, int type,
                             const std::string& normalized) {
    write("quantised.bin", {static_cast<const char*>(data), size});
    const auto model = load_model(only(write(
        "quantised.gltf",
        R"({ "asset": { "version": "2.0" }, "extensionsRequired": ["KHR_mesh_quantization"],
          "buffers": [{ "uri": "quantised.bin", "byteLength": )" +
            std::to_string(size) + R"( }], "bufferViews": [{ "buffer": 0, "byteLength": )" +
            std::to_string(size) + R"(, "byteStride": )" + std::to_string(size / 3) +
            R"( }], "accessors": [{ "bufferView": 0, "componentType": )" + std::to_string(type) +
            R"(, "count": 3, "type": "VEC3", "normalized": )" + normalized + R"( }],
          "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
          "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }] })")));
    EXPECT_TRUE(model) << model.error().text;
    return model ? bounds_of(model->mesh) : Bounds{};
  };
  EXPECT_EQ(quantised(shorts, sizeof(shorts), 5122, "true").high, glm::vec3(1, 1, 0));
  EXPECT_EQ(quantised(shorts, sizeof(shorts), 5122, "false").high, glm::vec3(32767, 32767.5f, 0));
  EXPECT_EQ(quantised(bytes, sizeof(bytes), 5120, "true").high, glm::vec3(1, 1, 0));
  EXPECT_EQ(quantised(bytes, sizeof(bytes), 5120, "false").high, glm::vec3(127, 127.5f, 0));
}

TEST_F(ModelExtensions, TextureTransformsMoveCoordinates) {
  const float rows[] = {0, 0, 0, 1, 0,    0,    0,    2,    0,    0,   0,
                        1, 0, 0, 1, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f};
  write("uv.bin", {reinterpret_cast<const char*>(rows), sizeof(rows)});
  const auto uv = [&](const std::string& transform, const std::string& normal = "") {
    const auto model = load_model(only(
        write("uv.gltf",
              R"({ "asset": { "version": "2.0" }, "extensionsRequired": ["KHR_texture_transform"],
          "buffers": [{ "uri": "uv.bin", "byteLength": 84 }],
          "bufferViews": [{ "buffer": 0, "byteLength": 84 }], "accessors": [
          { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
          { "bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC2" },
          { "bufferView": 0, "byteOffset": 60, "componentType": 5126, "count": 3, "type": "VEC2" }],
          "images": [{ "uri": "none.png" }], "textures": [{ "source": 0 }],
          "materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "extensions":
            { "KHR_texture_transform": )" +
                  transform + "} } }" + normal + R"( }],
          "meshes": [{ "primitives": [{ "material": 0, "attributes":
            { "POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_1": 2 } }] }],
          "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }] })")));
    EXPECT_TRUE(model) << model.error().text;
    return model ? std::pair{model->mesh.vertices[1].uv, model->warnings.size()}
                 : std::pair{glm::vec2(), size_t{0}};
  };
  EXPECT_EQ(uv("{}").first, glm::vec2(1, 0));
  EXPECT_EQ(uv(R"({ "offset": [0.5, 0.25] })").first, glm::vec2(1.5f, 0.25f));
  EXPECT_EQ(uv(R"({ "scale": [2, 3], "offset": [1, 0] })").first, glm::vec2(3, 0));
  const glm::vec2 turned = uv(R"({ "rotation": 1.5707963267948966, "scale": [2, 1] })").first;
  EXPECT_NEAR(turned.x, 0.0f, 1e-6f);
  EXPECT_NEAR(turned.y, -2.0f, 1e-6f);
  EXPECT_EQ(uv(R"({ "texCoord": 1 })").first, glm::vec2(0.5f, 0.5f));
  // The picture does not exist; a normal map with another transform adds one warning.
  EXPECT_EQ(uv("{}").second, 1u);
  EXPECT_EQ(uv(R"({ "scale": [2, 2] })", R"(, "normalTexture": { "index": 0 })").second, 2u);
}

#ifdef DEMO_MESHOPT
TEST_F(ModelExtensions, MeshoptBuffersAreDecoded) {
  const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  const uint32_t indices[] = {0, 1, 2, 1, 3, 2};
  std::vector<unsigned char> vertices(meshopt_encodeVertexBufferBound(4, 12));
  vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), positions, 4, 12));
  std::vector<unsigned char> triangles(meshopt_encodeIndexBufferBound(6, 4));
  triangles.resize(meshopt_encodeIndexBuffer(triangles.data(), triangles.size(), indices, 6));
  std::string bytes(vertices.begin(), vertices.end());
  bytes.append(triangles.begin(), triangles.end());
  const auto load = [&](const std::string& whole, const std::string& count) {
    write("packed.bin", whole);
    const std::string size = std::to_string(vertices.size());
    return load_model(only(
        write("packed.gltf",
              R"({ "asset": { "version": "2.0" }, "extensionsRequired": ["EXT_meshopt_compression"],
          "buffers": [{ "uri": "packed.bin", "byteLength": )" +
                  std::to_string(whole.size()) + R"( },
          { "byteLength": 60, "extensions": { "EXT_meshopt_compression": { "fallback": true } } }],
          "bufferViews": [{ "buffer": 1, "byteLength": 48, "extensions": { "EXT_meshopt_compression":
            { "buffer": 0, "byteLength": )" +
                  size + R"(, "byteStride": 12, "mode": "ATTRIBUTES", "count": )" + count +
                  R"( } } }, { "buffer": 1, "byteOffset": 48, "byteLength": 12, "extensions":
            { "EXT_meshopt_compression": { "buffer": 0, "byteOffset": )" +
                  size + R"(, "byteLength": )" + std::to_string(triangles.size()) +
                  R"(, "byteStride": 2, "mode": "TRIANGLES", "count": 6 } } }],
          "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" }],
          "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
          "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }] })")));
  };
  const auto model = load(bytes, "4");
  ASSERT_TRUE(model) << model.error().text;
  EXPECT_EQ(model->mesh.indices.size(), 6u);
  EXPECT_EQ(bounds_of(model->mesh).high, glm::vec3(0.5f, 0.5f, 0.0f));
  for (size_t at = 0; at < bytes.size(); ++at) { // The indices in damaged bytes are checked, too.
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
    const auto read = load(damaged, "4");
    EXPECT_TRUE(read || read.error().kind == ErrorKind::input) << at;
  }
  bytes[0] = 0;
  for (const auto& wrong :
       {load(bytes, "4"), load(bytes, "0"), load(bytes, "-1"), load(bytes, "1e9")}) {
    ASSERT_FALSE(wrong);
    EXPECT_THAT(wrong.error().text, testing::HasSubstr("EXT_meshopt_compression of buffer view 0"));
  }
}
#endif

#ifdef DEMO_DRACO
TEST_F(ModelExtensions, DracoMeshesAreDecoded) {
  const float corners[2][3][3] = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                  {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int attribute =
      builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (uint32_t i = 0; i < 2; ++i)
    builder.SetAttributeValuesForFace(attribute, draco::FaceIndex(i), corners[i][0], corners[i][1],
                                      corners[i][2]);
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  ASSERT_NE(mesh, nullptr);
  draco::EncoderBuffer packed;
  ASSERT_TRUE(draco::Encoder().EncodeMeshToBuffer(*mesh, &packed).ok());
  std::string bytes(packed.data(), packed.size());
  const auto load = [&](const std::string& id) {
    write("packed.bin", bytes);
    const std::string size = std::to_string(bytes.size());
    return load_model(only(write(
        "packed.gltf",
        R"({ "asset": { "version": "2.0" }, "extensionsRequired": ["KHR_draco_mesh_compression"],
          "buffers": [{ "uri": "packed.bin", "byteLength": )" +
            size + R"( }], "bufferViews": [{ "buffer": 0, "byteLength": )" + size +
            R"( }], "accessors": [{ "componentType": 5126, "count": 4, "type": "VEC3" },
            { "componentType": 5123, "count": 6, "type": "SCALAR" }],
          "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "extensions":
            { "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": { "POSITION": )" +
            id + R"( } } } }] }], "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }] })")));
  };
  const std::string id = std::to_string(mesh->attribute(attribute)->unique_id());
  const auto model = load(id);
  ASSERT_TRUE(model) << model.error().text;
  EXPECT_EQ(model->mesh.indices.size(), 6u);
  EXPECT_EQ(model->mesh.vertices.size(), 4u);
  EXPECT_EQ(bounds_of(model->mesh).high, glm::vec3(0.5f, 0.5f, 0.0f));
  EXPECT_NEAR(model->mesh.vertices[0].normal.z, 1.0f, 1e-6f);
  EXPECT_FALSE(load("77"));
  const std::string whole = bytes;
  for (size_t at = 0; at < whole.size(); ++at) {
    bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x5a);
    const auto read = load(id);
    EXPECT_TRUE(read || read.error().kind == ErrorKind::input) << at;
  }
  bytes.assign(bytes.size(), '\0');
  const auto wrong = load(id);
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().text,
              testing::HasSubstr("KHR_draco_mesh_compression of mesh 0, primitive 0"));
}
#endif

} // namespace
} // namespace demo
