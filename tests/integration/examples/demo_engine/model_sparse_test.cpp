// Tests sparse accessors of glTF models.

#include "integration/examples/demo_engine/model/load_model.hpp"
#include "tests/support/test_folder.hpp"
#include "tests/support/text_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <string>

namespace demo {
namespace {

// A buffer of four positions, of four indices 0, 1, 2, 1 in each of three types, and of two values
// that replace positions 1 and 3.
struct ModelSparse : ::testing::Test {
  static constexpr const char* sound =
      R"({ "count": 2, "indices": { "bufferView": 1, "byteOffset": 0, "componentType": 5121 },
           "values": { "bufferView": 2 } })";

  Result<Model> load(const std::string& sparse, const std::string& base = R"("bufferView": 0, )",
                     const std::string& index_sparse = "") const {
    const float positions[] = {0, 0, 0, 9, 9, 9, 0, 1, 0, 8, 8, 8};
    // Bytes, shorts, integers.
    const uint8_t bytes[] = {1, 3, 3, 1, 1, 0, 3, 0, 1, 0, 0, 0, 3, 0, 0, 0};
    const float values[] = {1, 0, 0, 1, 1, 0};
    const uint8_t faces[] = {0, 1, 2, 2, 1, 0, 0, 3};
    std::string buffer(reinterpret_cast<const char*>(positions), sizeof positions);
    buffer.append(reinterpret_cast<const char*>(bytes), sizeof bytes);
    buffer.append(reinterpret_cast<const char*>(values), sizeof values);
    buffer.append(reinterpret_cast<const char*>(faces), sizeof faces);
    std::ofstream(folder / "sparse.bin", std::ios::binary) << buffer;
    const std::string path = (folder / "sparse.gltf").string();
    std::ofstream(path)
        << R"({ "asset": { "version": "2.0" },
      "buffers": [{ "uri": "sparse.bin", "byteLength": 96 }],
      "bufferViews": [{ "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 16 },
        { "buffer": 0, "byteOffset": 64, "byteLength": 24 }, { "buffer": 0, "byteOffset": 88, "byteLength": 8 }],
      "accessors": [{ )" +
               base + R"("componentType": 5126, "count": 4, "type": "VEC3", "sparse": )" + sparse +
               R"( }, { "bufferView": 3, "componentType": 5121, "count": 6, "type": "SCALAR")" +
               index_sparse + R"( }],
      "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
      "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }] })";
    ModelOptions options;
    options.mesh = path;
    return load_model(options);
  }

  const dermis::test::TestFolder folder;
};

TEST_F(ModelSparse, ElementsAreReplaced) {
  for (const char* type :
       {R"("byteOffset": 0, "componentType": 5121)", R"("byteOffset": 4, "componentType": 5123)",
        R"("byteOffset": 8, "componentType": 5125)"}) {
    const auto model =
        load(dermis::test::replaced(sound, R"("byteOffset": 0, "componentType": 5121)", type));
    ASSERT_TRUE(model) << type << model.error().text;
    EXPECT_EQ(bounds_of(model->mesh).high - bounds_of(model->mesh).low, glm::vec3(1, 1, 0)) << type;
  }
}

TEST_F(ModelSparse, NoBufferView_OtherElementsAreZero) {
  const auto model = load(sound, "");
  ASSERT_TRUE(model) << model.error().text;
  const glm::vec3 first = model->mesh.vertices[0].position;
  EXPECT_EQ(model->mesh.vertices[2].position, first);
  EXPECT_EQ(model->mesh.vertices[1].position - first, glm::vec3(1, 0, 0));
  EXPECT_EQ(model->mesh.vertices[3].position - first, glm::vec3(1, 1, 0));
}

TEST_F(ModelSparse, IndicesAreReplaced) {
  // Elements 1 and 3 of 0, 1, 2, 2, 1, 0 become 3 and 1: bytes 3 and 1 of the second view.
  const auto model = load(sound, R"("bufferView": 0, )", R"(, "sparse": { "count": 2,
    "indices": { "bufferView": 1, "componentType": 5121 }, "values": { "bufferView": 1, "byteOffset": 2 } })");
  ASSERT_TRUE(model) << model.error().text;
  EXPECT_THAT(model->mesh.indices, ::testing::ElementsAre(0, 3, 2, 1, 1, 0));
  const auto beyond = load(sound, R"("bufferView": 0, )", R"(, "sparse": { "count": 1,
    "indices": { "bufferView": 1, "componentType": 5121 }, "values": { "bufferView": 2, "byteOffset": 2 } })");
  ASSERT_FALSE(beyond);
  EXPECT_THAT(beyond.error().text, ::testing::HasSubstr("there are 4 vertices"));
}

TEST_F(ModelSparse, InvalidSparseAccessorsAreRejected) {
  const struct {
    const char *from, *to, *says;
  } cases[] = {
      {R"("count": 2)", R"("count": 0)", "replaces 0 elements"},
      {R"("count": 2)", R"("count": -1)", "replaces -1 elements"},
      {R"("count": 2)", R"("count": 5)", "replaces 5 elements; expected 1 to 4"},
      {R"("count": 2)", R"("count": 3)", "beyond the end"}, // Count of the values.
      // Indices 3, 3.
      {R"("bufferView": 1, "byteOffset": 0)", R"("bufferView": 1, "byteOffset": 1)", "ascending"},
      // Indices 3, 1.
      {R"("bufferView": 1, "byteOffset": 0)", R"("bufferView": 1, "byteOffset": 2)", "ascending"},
      {R"("bufferView": 1, "byteOffset": 0)", R"("bufferView": 2, "byteOffset": 2)",
       "replaces element 128"},
      {R"("bufferView": 1, "byteOffset": 0)", R"("bufferView": 1, "byteOffset": 15)",
       "beyond the end"},
      {R"("bufferView": 1, "byteOffset": 0)", R"("bufferView": 1, "byteOffset": 2147483647)",
       "beyond the end"},
      {R"("bufferView": 1, "byteOffset": 0)", R"("bufferView": 1, "byteOffset": -1)",
       "begins before"},
      {R"("bufferView": 1, "byteOffset": 0)", R"("bufferView": 7, "byteOffset": 0)",
       "does not exist"},
      {R"("bufferView": 1, "byteOffset": 0)", R"("bufferView": -1, "byteOffset": 0)",
       "does not exist"},
      {R"("componentType": 5121)", R"("componentType": 5126)", "no unsigned integers"},
      {R"("componentType": 5121)", R"("componentType": 77)", "component type"},
      {R"("bufferView": 2)", R"("bufferView": 7)", "does not exist"},
      {R"("bufferView": 2)", R"("bufferView": 2, "byteOffset": -12)", "begins before"},
      {R"("bufferView": 2)", R"("bufferView": 2, "byteOffset": 4)", "beyond the end"},
  };
  for (const auto& one : cases) {
    const auto model = load(dermis::test::replaced(sound, one.from, one.to));
    ASSERT_FALSE(model) << one.to;
    EXPECT_EQ(model.error().kind, ErrorKind::input) << one.to;
    EXPECT_THAT(model.error().text, ::testing::HasSubstr(one.says)) << one.to;
  }
}

} // namespace
} // namespace demo
