#include "integration/examples/demo_engine/model/load_model.hpp"
#include "integration/examples/demo_engine/model/load_texture.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/test_folder.hpp"
#include "tests/support/text_file.hpp"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <span>
#include <string_view>

namespace demo {
namespace {

using dermis::HasAll;
using dermis::HasSubstr;
using dermis::test::read_text;
using dermis::test::replaced;

struct ModelFile : ::testing::Test {
  std::string write(const std::string& name, const std::string& bytes) const {
    const std::string path = (folder / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  // Returns a file with one triangle; `indices` and `accessor` replace parts of the file.
  std::string triangle(const std::string& indices = "[0, 1, 2]", const std::string& accessor = "",
                       const std::string& nodes = R"([{ "mesh": 0 }])") const {
    const float positions[] = {0, 0, 0, 1, 0, 0, 0, 2, 0};
    std::string buffer(reinterpret_cast<const char*>(positions), sizeof(positions));
    for (const char digit : indices)
      if (digit >= '0' && digit <= '9')
        buffer += std::string(1, static_cast<char>(digit - '0')) + '\0';
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

  static Error rejected(const ModelOptions& options) {
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

  const dermis::test::TestFolder folder;
};

TEST_F(ModelFile, TriangleIsScaledAndCentred) {
  ModelOptions options = only(triangle());
  options.height_metres = 0.5;
  const auto model = load_model(options);
  ASSERT_TRUE(model) << model.error().text;
  const Bounds bounds = bounds_of(model->mesh);
  EXPECT_NEAR(bounds.high.y, 0.25f, 1e-6f);
  EXPECT_NEAR(bounds.low.y, -0.25f, 1e-6f);
  EXPECT_NEAR(bounds.high.x, 0.125f, 1e-6f);
  // Generated if the file has no normals.
  EXPECT_NEAR(model->mesh.vertices[0].normal.z, 1.0f, 1e-6f);
  EXPECT_THAT(model->credits, testing::ElementsAre("by nobody"));
}

TEST_F(ModelFile, NotAGltf_IsReported) {
  const Error error = rejected(only(write("cat.glb", "\x89PNG and so on")));
  EXPECT_EQ(error.kind, ErrorKind::input);
  EXPECT_THAT(error.text, HasAll("cat.glb", "not a glTF file"));
  EXPECT_THAT(rejected(only(write("empty.glb", ""))).text, HasSubstr("not a glTF file"));
  EXPECT_THAT(rejected(only(write("short.glb", "glTF\x02"))).text, HasSubstr("damaged"));
  EXPECT_THAT(rejected(only(write("bad.gltf", "{ \"asset\": "))).text, HasSubstr("damaged"));
  EXPECT_THAT(rejected(only((folder / "absent.glb").string())).text,
              HasSubstr("the file does not exist"));
  EXPECT_THAT(rejected(only(folder.path().string())).text, HasSubstr("not a regular file"));
}

TEST_F(ModelFile, OtherVersionsAreRejectedByName) {
  const std::string whole = read_text(triangle());
  const auto with_asset = [&](const std::string& asset) {
    return only(write("version.gltf", replaced(whole, R"("version": "2.0")", asset)));
  };
  EXPECT_THAT(rejected(with_asset(R"("version": "1.0")")).text,
              HasSubstr("asset.version is '1.0'"));
  EXPECT_THAT(rejected(with_asset(R"("version": "3.0")")).text,
              HasSubstr("asset.version is '3.0'"));
  EXPECT_THAT(rejected(with_asset(R"("version": "20.0")")).text,
              HasSubstr("asset.version is '20.0'"));
  EXPECT_THAT(rejected(with_asset(R"("version": 2.0)")).text,
              HasSubstr("asset.version is not a string"));
  EXPECT_THAT(rejected(with_asset(R"("generator": "a")")).text,
              HasSubstr("asset.version is missing"));
  EXPECT_THAT(rejected(with_asset(R"("version": "3.1", "minVersion": "3.0")")).text,
              HasSubstr("3.1"));
  EXPECT_THAT(rejected(with_asset(R"("version": "2.1", "minVersion": "3.0")")).text,
              HasSubstr("asset.minVersion is '3.0'"));
  EXPECT_TRUE(load_model(with_asset(R"("version": "2.1", "minVersion": "2.0")")));
}

TEST_F(ModelFile, RequiredExtensionsAreRejectedByName) {
  const std::string whole = read_text(triangle());
  const auto with = [&](const std::string& more) {
    return only(write("required.gltf", replaced(whole, R"("scene": 0)", R"("scene": 0, )" + more)));
  };
  EXPECT_THAT(
      rejected(with(R"("extensionsRequired": ["KHR_texture_basisu", "ACME_spheres"])")).text,
      HasAll("'KHR_texture_basisu'", "'ACME_spheres'"));
  EXPECT_TRUE(load_model(with(R"("extensionsUsed": ["ACME_spheres"])")));
}

// Builds a model of floats and of the text after its buffers. Accessors take three floats per
// element, one accessor after another; the first has the positions.
struct Pieces {
  std::vector<float> floats;
  uint32_t vertices = 4;
  std::string primitives = R"([{ "attributes": { "POSITION": 0 } }])";
  std::string nodes = R"([{ "mesh": 0 }])";
};

Mesh mesh_of(const ModelFile& test, const Pieces& pieces) {
  const std::string size = std::to_string(pieces.floats.size() * sizeof(float));
  test.write("pieces.bin", {reinterpret_cast<const char*>(pieces.floats.data()),
                            pieces.floats.size() * sizeof(float)});
  std::string accessors;
  for (size_t at = 0; at + 3 * pieces.vertices <= pieces.floats.size(); at += 3 * pieces.vertices)
    accessors += (at == 0 ? "" : ",") +
                 (R"({ "bufferView": 0, "componentType": 5126, "type": "VEC3", "byteOffset": )" +
                  std::to_string(at * sizeof(float)) + R"(, "count": )" +
                  std::to_string(pieces.vertices) + "}");
  const auto model = load_model(ModelFile::only(test.write(
      "pieces.gltf",
      R"({ "asset": { "version": "2.0" }, "buffers": [{ "uri": "pieces.bin", "byteLength": )" +
          size + R"( }], "bufferViews": [{ "buffer": 0, "byteLength": )" + size +
          R"( }], "accessors": [)" + accessors + R"(], "meshes": [{ "primitives": )" +
          pieces.primitives + R"( }], "nodes": )" + pieces.nodes +
          R"(, "scenes": [{ "nodes": [0] }] })")));
  if (model) return model->mesh;
  ADD_FAILURE() << model.error().text;
  return {};
}

TEST_F(ModelFile, StripsAndFansAreTriangles) {
  Pieces pieces;
  pieces.floats = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  pieces.primitives = R"([{ "attributes": { "POSITION": 0 }, "mode": 5 }])";
  EXPECT_THAT(mesh_of(*this, pieces).indices, testing::ElementsAre(0, 1, 2, 1, 3, 2));
  pieces.floats = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  pieces.primitives = R"([{ "attributes": { "POSITION": 0 }, "mode": 6 }])";
  const Mesh fan = mesh_of(*this, pieces);
  EXPECT_THAT(fan.indices, testing::ElementsAre(1, 2, 0, 2, 3, 0));
  for (const Vertex& vertex : fan.vertices)
    EXPECT_NEAR(vertex.normal.z, 1.0f, 1e-6f);
}

// Returns the smallest cosine between face normals and vertex normals: 1 for a flat mesh.
float facing(const Mesh& mesh) {
  float worst = 1.0f;
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Vertex &a = mesh.vertices[mesh.indices[i]], &b = mesh.vertices[mesh.indices[i + 1]],
                 &c = mesh.vertices[mesh.indices[i + 2]];
    const glm::vec3 face =
        glm::normalize(glm::cross(b.position - a.position, c.position - a.position));
    for (const Vertex* vertex : {&a, &b, &c})
      worst = std::min(worst, glm::dot(face, vertex->normal));
  }
  return worst;
}

TEST_F(ModelFile, MirroredNodesKeepTheirFacing) {
  Pieces pieces;
  pieces.floats = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  for (const char* attributes : {R"("POSITION": 0)", R"("POSITION": 0, "NORMAL": 1)"})
    for (const char* scale : {"[1, 1, 1]", "[-1, 1, 1]", "[1, -2, 1]", "[-1, -1, 1]"}) {
      pieces.primitives = std::string(R"([{ "mode": 5, "attributes": { )") + attributes + "} }]";
      pieces.nodes = std::string(R"([{ "mesh": 0, "scale": )") + scale + "}]";
      const Mesh mesh = mesh_of(*this, pieces);
      EXPECT_GT(facing(mesh), 0.99f) << attributes << scale;
      EXPECT_NEAR(mesh.vertices[0].normal.z, 1.0f, 1e-6f) << attributes << scale;
    }
  // A mirror in the parent and a mirror in the child cancel.
  pieces.nodes =
      R"([{ "children": [1], "scale": [-1, 1, 1] }, { "mesh": 0, "scale": [-1, 1, 1] }])";
  EXPECT_GT(facing(mesh_of(*this, pieces)), 0.99f);
}

TEST_F(ModelFile, MirroredTangentsKeepTheirBitangent) {
  const float rows[] = {0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 1,
                        0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1};
  write("triangle.bin", {reinterpret_cast<const char*>(rows), sizeof(rows)});
  for (const bool mirrored : {false, true}) {
    const std::string scale = mirrored ? "-1" : "1";
    const auto model = load_model(only(write(
        "tangents.gltf", R"({ "asset": { "version": "2.0" }, "buffers": [{ "uri": "triangle.bin",
        "byteLength": 120 }], "bufferViews": [{ "buffer": 0, "byteLength": 120 }], "accessors": [
        { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
        { "bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC3" },
        { "bufferView": 0, "byteOffset": 72, "componentType": 5126, "count": 3, "type": "VEC4" }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1, "TANGENT": 2 } }] }],
        "nodes": [{ "mesh": 0, "scale": [)" +
                             scale + R"(, 1, 1] }], "scenes": [{ "nodes": [0] }] })")));
    ASSERT_TRUE(model) << model.error().text;
    const Vertex& vertex = model->mesh.vertices[0];
    EXPECT_EQ(vertex.tangent.x, mirrored ? -1.0f : 1.0f);
    const glm::vec3 bitangent =
        vertex.tangent.w * glm::cross(vertex.normal, glm::vec3(vertex.tangent));
    EXPECT_NEAR(bitangent.y, 1.0f, 1e-6f) << mirrored;
  }
}

TEST_F(ModelFile, PrimitiveWithoutNormals_ChangesNoOther) {
  Pieces pieces;
  const float s = 0.6f, c = 0.8f; // Normals that differ from every face normal.
  pieces.floats = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, s, 0, c, s, 0, c, s, 0, c, s, 0, c};
  pieces.primitives = R"([{ "mode": 5, "attributes": { "POSITION": 0, "NORMAL": 1 } },
                          { "mode": 5, "attributes": { "POSITION": 0 } }])";
  const Mesh mesh = mesh_of(*this, pieces);
  ASSERT_EQ(mesh.vertices.size(), 8u);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(mesh.vertices[i].normal.x, s, 1e-6f);
    EXPECT_NEAR(mesh.vertices[i + 4].normal.z, 1.0f, 1e-6f);
  }
}

TEST_F(ModelFile, SkinnedMeshesAreRejectedByName) {
  const std::string path = triangle(
      "[0, 1, 2]", "", R"([{ "mesh": 0, "skin": 0, "name": "torso" }, { "name": "joint" }])");
  const std::string whole =
      replaced(read_text(path), R"("scene": 0)", R"("scene": 0, "skins": [{ "joints": [1] }])");
  EXPECT_THAT(rejected(only(write("skin.gltf", whole))).text, HasAll("node 0 'torso'", "skin"));
}

TEST_F(ModelFile, IndicesBeyondTheVerticesAreRejected) {
  EXPECT_THAT(rejected(only(triangle("[0, 1, 3]"))).text,
              HasSubstr("holds index 3; there are 3 vertices"));
}

TEST_F(ModelFile, AccessorsBeyondTheirBufferAreRejected) {
  EXPECT_THAT(rejected(only(triangle("[0, 1, 2]", R"(, "byteOffset": 8)"))).text,
              HasSubstr("beyond the end"));
  EXPECT_THAT(rejected(only(triangle("[0, 1, 2]", R"(, "byteOffset": 18446744073709551600)"))).kind,
              ErrorKind::input);
}

TEST_F(ModelFile, NodeCyclesAreRejected) {
  EXPECT_THAT(
      rejected(only(triangle("[0, 1, 2]", "", R"([{ "children": [1] }, { "children": [0] }])")))
          .text,
      HasSubstr("node 0 has two parents, or is its own ancestor"));
}

TEST_F(ModelFile, NodesWithTwoParentsAreRejected) {
  std::string nodes = "[";
  for (int i = 1; i <= 60; ++i)
    nodes += fmt::format("{{ \"children\": [{0}, {0}] }}, ", i);
  EXPECT_THAT(rejected(only(triangle("[0, 1, 2]", "", nodes + R"({ "mesh": 0 }])"))).text,
              HasSubstr("node 60 has two parents"));
}

// An instance has 3 * 2^20 indices; 22 instances have more than 2^26.
TEST_F(ModelFile, IndicesOfAllInstancesAreLimited) {
  constexpr size_t indices = size_t{3} << 20, corners = 36;
  std::string buffer(corners + indices, '\0'); // all corners are at the origin
  write("many.bin", buffer);
  for (const int instances : {21, 22}) {
    std::string nodes = R"({ "mesh": 0 })", all = "0";
    for (int i = 1; i < instances; ++i) {
      nodes += R"(, { "mesh": 0 })";
      all += fmt::format(", {}", i);
    }
    auto model = load_model(only(write(
        "many.gltf",
        fmt::format(
            R"({{ "asset": {{ "version": "2.0" }}, "buffers": [{{ "uri": "many.bin", "byteLength": {} }}],
      "bufferViews": [{{ "buffer": 0, "byteLength": 36 }}, {{ "buffer": 0, "byteOffset": 36, "byteLength": {} }}],
      "accessors": [{{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }},
        {{ "bufferView": 1, "componentType": 5121, "count": {}, "type": "SCALAR" }}],
      "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": 0 }}, "indices": 1 }}] }}],
      "nodes": [{}], "scenes": [{{ "nodes": [{}] }}], "scene": 0 }})",
            buffer.size(), indices, indices, nodes, all))));
    EXPECT_THAT(model ? "" : model.error().text,
                HasSubstr(instances == 21 ? "" : "more than 67108864 indices"));
  }
}

TEST_F(ModelFile, ASceneWithoutTrianglesIsRejected) {
  EXPECT_THAT(rejected(only(triangle("[0, 1, 2]", "", R"([{ "name": "lamp" }])"))).text,
              HasSubstr("no triangles"));
}

TEST_F(ModelFile, MapsThatAreNotImagesAreNamed) {
  ModelOptions options = only(triangle());
  options.albedo = write("albedo.png", "no image at all");
  EXPECT_THAT(rejected(options).text, HasSubstr("albedo.png"));
}

TEST_F(ModelFile, HeightMustBePositive) {
  ModelOptions options = only(triangle());
  for (const double height : {-1.0, std::nan(""), 1e9}) {
    options.height_metres = height;
    EXPECT_EQ(rejected(options).kind, ErrorKind::usage) << height;
  }
}

TEST_F(ModelFile, FilesAreOnlyReadInTheModelsFolder) {
  const std::string whole = read_text(triangle());
  std::filesystem::create_directories(folder / "models");
  std::filesystem::create_symlink(folder.path(), folder / "models" / "link");
  std::filesystem::copy_file(folder / "triangle.bin", folder / "models" / "here.bin");
  const std::string absolute = (folder / "triangle.bin").string();
  for (const std::string& outside :
       {std::string("../triangle.bin"), absolute, std::string("link/triangle.bin"),
        std::string("%2e%2e/triangle.bin"), std::string("../not_there.bin")}) {
    const std::string model = write("models/a.gltf", replaced(whole, "triangle.bin", outside));
    EXPECT_THAT(rejected(only(model)).text, HasSubstr("outside the readable folders")) << outside;
    EXPECT_THAT(rejected(only(model)).text, HasSubstr("--root")) << outside;
  }
  const auto declared =
      load_model(only(write("models/a.gltf", replaced(whole, "triangle.bin", "../triangle.bin"))),
                 {folder.path().string()});
  EXPECT_TRUE(declared) << declared.error().text;
  const auto inside =
      load_model(only(write("models/b.gltf", replaced(whole, "triangle.bin", "here.bin"))));
  EXPECT_TRUE(inside) << inside.error().text;
  // Not in the working folder either, where tinygltf would look.
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  EXPECT_THAT(rejected(only(write("models/c.gltf", whole))).text, HasSubstr("triangle.bin"));
  std::filesystem::current_path(before);
  EXPECT_THAT(rejected(only(write("models/d.gltf",
                                  replaced(whole, "triangle.bin", std::string(5000, 'a')))))
                  .text,
              HasSubstr("too long"));
}

TEST_F(ModelFile, FileNamesAreReadLiterally) {
  const std::string whole = read_text(triangle());
  const std::string buffer = read_text((folder / "triangle.bin").string());
  for (const auto& [uri, name] : {std::pair<std::string, std::string>{"a%20b.bin", "a b.bin"},
                                  {"a b.bin", "a b.bin"},
                                  {"\xc3\xb6.bin", "\xc3\xb6.bin"},
                                  {"\\u00f6.bin", "\xc3\xb6.bin"},
                                  {"%C3%B6.bin", "\xc3\xb6.bin"},
                                  {"a+b.bin", "a+b.bin"},
                                  {"a%2Bb.bin", "a+b.bin"}}) {
    write(name, buffer);
    const auto model = load_model(only(write("names.gltf", replaced(whole, "triangle.bin", uri))));
    EXPECT_TRUE(model) << uri << ": " << model.error().text;
    std::filesystem::remove(folder / name); // So that no other name finds the file.
  }
}

// Returns a binary glTF of this JSON and chunk; the chunk claims to be `more` bytes longer.
std::string binary(std::string json, const std::string& chunk, uint32_t more = 0) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto word = [](uint64_t value) {
    const auto narrow = static_cast<uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&narrow), 4);
  };
  return "glTF" + word(2) + word(28 + json.size() + chunk.size()) + word(json.size()) + "JSON" +
         json + word(chunk.size() + more) + std::string("BIN\0", 4) + chunk;
}

TEST_F(ModelFile, PicturesBeyondTheirBufferAreNotRead) {
  const std::string begin = R"({ "asset": { "version": "2.0" }, "buffers": [{ "byteLength": 48 }],
      "bufferViews": [{ "buffer": 0, "byteLength": 36 }, { "buffer": 0, "byteOffset": )";
  const std::string end =
      R"( }], "images": [{ "bufferView": 1, "mimeType": "image/png" }], "textures": [{ "source": 0 }],
      "materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
      "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
      "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
      "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }], "scene": 0 })";
  const float positions[12] = {0, 0, 0, 1, 0, 0, 0, 2, 0};
  const std::string chunk(reinterpret_cast<const char*>(positions), sizeof(positions));
  for (const char* view :
       {R"(36, "byteLength": 100000)", R"(100000, "byteLength": 12)",
        R"(36, "byteLength": 18446744073709551615)", R"(36, "byteLength": 4294967295)"}) {
    const auto model = load_model(only(write("view.glb", binary(begin + view + end, chunk))));
    if (!model) continue; // Refusal is accepted, too.
    ASSERT_EQ(model->warnings.size(), 1u) << view;
    EXPECT_THAT(model->warnings[0], HasSubstr("not an image"));
  }
}

TEST_F(ModelFile, PicturesThatAreMissingAreNamed) {
  const std::string whole =
      replaced(read_text(triangle()), R"("indices": 1)", R"("indices": 1, "material": 0)");
  const auto warnings = [&](const std::string& texture, const std::string& uri) {
    const auto model = load_model(
        only(write("picture.gltf", replaced(whole, R"("scene": 0)",
                                            R"("scene": 0, "images": [{ "uri": ")" + uri + R"(" }],
          "textures": [{ )" + texture + R"( }], "materials": [{ "pbrMetallicRoughness":
          { "baseColorTexture": { "index": 0 } } }])"))));
    EXPECT_TRUE(model) << model.error().text;
    return model ? model->warnings : std::vector<std::string>{};
  };
  EXPECT_THAT(warnings(R"("source": 0)", "not%20there.png"),
              testing::ElementsAre(HasAll("'not%20there.png'", "not there,")));
  write("text+1.png", "no picture");
  EXPECT_THAT(warnings(R"("source": 0)", "text+1.png"),
              testing::ElementsAre(HasAll("'text", "not an image")));
  EXPECT_THAT(warnings(R"("extensions": { "KHR_texture_basisu": { "source": 0 } })", "text+1.png"),
              testing::ElementsAre(HasSubstr("KHR_texture_basisu")));
}

TEST_F(ModelFile, ChunksBeyondTheEndOfTheFileAreRejected) {
  const std::string json =
      R"({ "asset": { "version": "2.0" }, "buffers": [{ "byteLength": 16 }] })";
  EXPECT_THAT(rejected(only(write("chunk.glb", binary(json, "12345678", 8)))).text,
              HasSubstr("second chunk reaches beyond its end"));
}

TEST_F(ModelFile, DeepNestingIsRejected) {
  const std::string deep = std::string(1000000, '[') + std::string(1000000, ']');
  EXPECT_THAT(rejected(only(write("deep.gltf",
                                  R"({ "asset": { "version": "2.0" }, "extras": )" + deep + "}")))
                  .text,
              HasSubstr("nested deeper than 64"));
}

TEST_F(ModelFile, DamagedFilesAreRejectedOrRead) {
  const std::string text = read_text(triangle());
  const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 2, 0};
  const std::string json = replaced(text, R"("uri": "triangle.bin", )", "");
  const std::string glb = binary(json, std::string(reinterpret_cast<const char*>(positions), 36) +
                                           std::string("\0\0\1\0\2\0\0\0", 8));
  ASSERT_TRUE(load_model(only(write("whole.glb", glb))));
  std::mt19937 random(20);
  uint32_t read = 0;
  constexpr int tries = 4000; // Tries of each kind; 7 s with the address sanitizer.
  for (const std::string& whole : {text, glb})
    for (int i = 0; i < tries; ++i) {
      std::string damaged = whole;
      for (uint32_t changes = 1 + random() % 3; changes > 0; --changes) {
        const size_t at = random() % damaged.size();
        const char* digits = "0123456789-{}[],\"e";
        if (random() % 2 == 0)
          damaged[at] = digits[random() % 18];
        else if (random() % 2 == 0)
          damaged[at] = static_cast<char>(random());
        else
          damaged.insert(at, std::string(1 + random() % 12, '9'));
      }
      const auto model = load_model(only(write("damaged.gltf", damaged)));
      if (model)
        ++read;
      else
        EXPECT_EQ(model.error().kind, ErrorKind::input);
    }
  EXPECT_GT(read, 100u); // Enough damaged files have to be readable.
}

TEST(Texture, OtherFormatsAreNotParsed) {
  for (const char* other : {"GIF89a\1\1", "8BPS", "P6 1 1 255\n123", "#?RADIANCE\n"}) {
    const std::string_view bytes(other);
    const auto texture = decode_texture("a", std::as_bytes(std::span(bytes)));
    ASSERT_FALSE(texture) << other;
    EXPECT_THAT(texture.error().text, HasSubstr("PNG, JPEG, TGA, BMP"));
  }
}

TEST_F(ModelFile, EveryTruncationOfAFileIsRejectedOrRead) {
  const std::string whole = read_text(triangle());
  for (size_t size = 0; size < whole.size(); size += 7) {
    const auto model = load_model(only(write("cut.gltf", whole.substr(0, size))));
    if (!model) {
      EXPECT_EQ(model.error().kind, ErrorKind::input);
    }
  }
}

TEST(Texture, RowsAreFlipped) {
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
