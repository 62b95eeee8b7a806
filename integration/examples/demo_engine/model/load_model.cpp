#include "integration/examples/demo_engine/model/load_model.hpp"

#include "integration/examples/demo_engine/files.hpp"
#include "integration/examples/demo_engine/model/load_texture.hpp"
#include "integration/examples/demo_engine/model/parse_gltf.hpp"
#include "integration/examples/demo_engine/model/read_accessor.hpp"

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cmath>

namespace demo {
namespace {

constexpr size_t max_vertices = size_t{1} << 25;
constexpr size_t max_indices = size_t{1} << 26; // of all instances
constexpr uint32_t deepest_node = 256;
constexpr std::string_view head_scan = "LeePerrySmith";
constexpr const char* head_scan_credit = "\"Infinite, 3D Head Scan\" by Lee Perry-Smith "
                                         "(www.triplegangers.com), licensed under CC BY 3.0";

glm::dmat4 local_matrix(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
  glm::dmat4 m(1.0);
  if (node.translation.size() == 3) m = glm::translate(m, glm::make_vec3(node.translation.data()));
  if (node.rotation.size() == 4)
    m *= glm::mat4_cast(
        glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]));
  if (node.scale.size() == 3) m = glm::scale(m, glm::make_vec3(node.scale.data()));
  return m;
}

// Returns three indices per triangle, from a list, a strip or a fan of vertices. Every second
// triangle of a strip is flipped.
std::vector<uint32_t> as_triangles(std::vector<uint32_t> indices, int mode) {
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    indices.resize(indices.size() - indices.size() % 3);
    return indices;
  }
  std::vector<uint32_t> triangles;
  for (size_t i = 0; i + 2 < indices.size(); ++i) {
    const size_t odd = i % 2;
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
      triangles.insert(triangles.end(), {indices[i + 1], indices[i + 2], indices[0]});
    else
      triangles.insert(triangles.end(), {indices[i], indices[i + 1 + odd], indices[i + 2 - odd]});
  }
  return triangles;
}

// The part of a mesh that one primitive contributed.
struct Part {
  size_t first_vertex, vertices, first_index, indices;
  bool has_normals, has_tangents;
};

void compute_in(Mesh& mesh, const Part& part, void (*compute)(Mesh&)) {
  const auto vertices = mesh.vertices.begin() + static_cast<ptrdiff_t>(part.first_vertex);
  const auto indices = mesh.indices.begin() + static_cast<ptrdiff_t>(part.first_index);
  Mesh own{{vertices, vertices + static_cast<ptrdiff_t>(part.vertices)},
           {indices, indices + static_cast<ptrdiff_t>(part.indices)}};
  for (uint32_t& index : own.indices)
    index -= static_cast<uint32_t>(part.first_vertex);
  compute(own);
  std::copy(own.vertices.begin(), own.vertices.end(), vertices);
}

// Placement of a map on a mesh: the set of coordinates and their KHR_texture_transform.
struct MapPlace {
  int set = 0;
  glm::dvec2 offset{0.0}, scale{1.0};
  double rotation = 0.0;
  bool operator==(const MapPlace&) const = default;

  glm::vec2 operator()(const glm::vec2& uv) const {
    const glm::dvec2 scaled = scale * glm::dvec2(uv);
    const double c = std::cos(rotation), s = std::sin(rotation);
    return glm::vec2(c * scaled.x + s * scaled.y + offset.x,
                     c * scaled.y - s * scaled.x + offset.y);
  }
};

template <class TextureInfo> MapPlace place_of(const TextureInfo& info) {
  MapPlace place;
  place.set = info.texCoord;
  const auto found = info.extensions.find("KHR_texture_transform");
  if (found == info.extensions.end()) return place;
  const auto number = [](const tinygltf::Value& value, double& out) {
    if (value.IsNumber() && std::isfinite(value.GetNumberAsDouble()))
      out = value.GetNumberAsDouble();
  };
  const auto pair = [&](const char* key, glm::dvec2& out) {
    const tinygltf::Value& value = found->second.Get(key);
    if (!value.IsArray() || value.ArrayLen() != 2) return;
    number(value.Get(0), out.x);
    number(value.Get(1), out.y);
  };
  pair("offset", place.offset);
  pair("scale", place.scale);
  number(found->second.Get("rotation"), place.rotation);
  if (found->second.Get("texCoord").IsInt())
    place.set = found->second.Get("texCoord").GetNumberAsInt();
  return place;
}

struct Gathering {
  const tinygltf::Model& file;
  const ModelOptions& options;
  std::string path;
  Model model;
  int material = -1;
  bool is_head_scan = false;
  std::vector<Part> parts;
  uint32_t skipped = 0;
  std::vector<bool> visited = std::vector<bool>(file.nodes.size()); // by node

  const tinygltf::Material* first_material() const {
    const bool there = material >= 0 && static_cast<size_t>(material) < file.materials.size();
    return there ? &file.materials[static_cast<size_t>(material)] : nullptr;
  }

  // Vertices have one pair of texture coordinates: that of maps from separate files, else that of
  // the base colour's map, else that of the normal map.
  MapPlace place_of_maps() const {
    const tinygltf::Material* from = first_material();
    if (from == nullptr || !options.albedo.empty() || !options.normal.empty() ||
        !options.specular.empty())
      return {};
    const tinygltf::TextureInfo& base = from->pbrMetallicRoughness.baseColorTexture;
    return base.index >= 0 ? place_of(base) : place_of(from->normalTexture);
  }

  Result<> add_primitive(const tinygltf::Primitive& primitive, const glm::dmat4& place) {
    const int mode = primitive.mode == -1 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode < TINYGLTF_MODE_POINTS || mode > TINYGLTF_MODE_TRIANGLE_FAN)
      return Error{
          ErrorKind::input,
          fmt::format("{}: a mesh has the primitive mode {}; expected 0 to 6", path, mode)};
    if (mode < TINYGLTF_MODE_TRIANGLES) {
      ++skipped;
      return success();
    }
    const auto attribute = [&](const char* name) {
      const auto found = primitive.attributes.find(name);
      return found == primitive.attributes.end() ? -1 : found->second;
    };
    if (attribute("POSITION") < 0)
      return Error{ErrorKind::input, fmt::format("{}: a mesh has no positions", path)};
    auto positions = read_floats(file, path, attribute("POSITION"), TINYGLTF_TYPE_VEC3, 3);
    if (!positions) return positions.error();
    const size_t count = positions->size() / 3, first = model.mesh.vertices.size();
    if (first + count > max_vertices)
      return Error{ErrorKind::input, fmt::format("{}: more than {} vertices", path, max_vertices)};
    const auto optional_floats = [&](const char* name, int type, uint32_t width,
                                     std::vector<float>& out) -> Result<> {
      if (attribute(name) < 0) return success();
      auto values = read_floats(file, path, attribute(name), type, width);
      if (!values) return values.error();
      if (values->size() != count * width)
        return Error{ErrorKind::input, fmt::format("{}: a mesh has {} positions and {} of {}", path,
                                                   count, values->size() / width, name)};
      out = values.take();
      return success();
    };
    std::vector<float> normals, uvs, tangents;
    if (auto done = optional_floats("NORMAL", TINYGLTF_TYPE_VEC3, 3, normals); !done) return done;
    if (material < 0) material = primitive.material;
    const MapPlace map_place = place_of_maps();
    if (auto done = optional_floats(fmt::format("TEXCOORD_{}", map_place.set).c_str(),
                                    TINYGLTF_TYPE_VEC2, 2, uvs);
        !done)
      return done;
    if (auto done = optional_floats("TANGENT", TINYGLTF_TYPE_VEC4, 4, tangents); !done) return done;
    const glm::dmat3 turn = glm::transpose(glm::inverse(glm::dmat3(place)));
    const bool mirrored = glm::determinant(glm::dmat3(place)) < 0.0;
    for (size_t i = 0; i < count; ++i) {
      Vertex vertex;
      vertex.position = glm::vec3(place * glm::dvec4(glm::make_vec3(&(*positions)[3 * i]), 1.0));
      if (!normals.empty()) {
        const glm::dvec3 normal = turn * glm::dvec3(glm::make_vec3(&normals[3 * i]));
        if (glm::length(normal) > 0.0) vertex.normal = glm::vec3(glm::normalize(normal));
      }
      if (!uvs.empty()) vertex.uv = map_place(glm::make_vec2(&uvs[2 * i]));
      if (!tangents.empty()) {
        const glm::dvec3 tangent = glm::dmat3(place) * glm::dvec3(glm::make_vec3(&tangents[4 * i]));
        if (glm::length(tangent) > 0.0)
          vertex.tangent = glm::vec4(glm::vec3(glm::normalize(tangent)),
                                     (tangents[4 * i + 3] < 0.0f) != mirrored ? -1.0f : 1.0f);
      }
      model.mesh.vertices.push_back(vertex);
    }
    // glTF requires that tangents without normals are ignored.
    Part part{first,
              count,
              model.mesh.indices.size(),
              0,
              !normals.empty(),
              !normals.empty() && !tangents.empty()};
    if (auto done = add_indices(primitive, mode, part, mirrored); !done) return done;
    parts.push_back(part);
    return success();
  }

  // A mirrored triangle would face the other way, so two of its corners are swapped.
  Result<> add_indices(const tinygltf::Primitive& primitive, int mode, Part& part, bool mirrored) {
    const auto first = static_cast<uint32_t>(part.first_vertex),
               count = static_cast<uint32_t>(part.vertices);
    std::vector<uint32_t> indices(count);
    for (uint32_t i = 0; i < count; ++i)
      indices[i] = i;
    if (primitive.indices >= 0) {
      auto read = read_indices(file, path, primitive.indices, count);
      if (!read) return read.error();
      indices = read.take();
    }
    indices = as_triangles(std::move(indices), mode);
    if (indices.size() > max_indices - model.mesh.indices.size())
      return Error{ErrorKind::input,
                   fmt::format("{}: more than {} indices of triangles", path, max_indices)};
    if (mirrored)
      for (size_t i = 0; i < indices.size(); i += 3)
        std::swap(indices[i + 1], indices[i + 2]);
    for (const uint32_t index : indices)
      model.mesh.indices.push_back(first + index);
    part.indices = indices.size();
    return success();
  }

  Result<> add_node(int index, const glm::dmat4& parent, uint32_t depth) {
    if (index < 0 || static_cast<size_t>(index) >= file.nodes.size())
      return Error{ErrorKind::input, fmt::format("{}: node {} does not exist", path, index)};
    if (depth > deepest_node)
      return Error{ErrorKind::input,
                   fmt::format("{}: nodes are nested deeper than {}", path, deepest_node)};
    if (visited[static_cast<size_t>(index)])
      return Error{
          ErrorKind::input,
          fmt::format("{}: node {} has two parents, or is its own ancestor; glTF requires trees",
                      path, index)};
    visited[static_cast<size_t>(index)] = true;
    const tinygltf::Node& node = file.nodes[static_cast<size_t>(index)];
    const glm::dmat4 place = parent * local_matrix(node);
    if (node.mesh >= 0) {
      if (static_cast<size_t>(node.mesh) >= file.meshes.size())
        return Error{ErrorKind::input, fmt::format("{}: mesh {} does not exist", path, node.mesh)};
      if (node.skin >= 0)
        return Error{
            ErrorKind::input,
            fmt::format(
                "{}: node {}{} has a skin, and skinned meshes are not posed; export the model "
                "with its pose applied and without a skin",
                path, index, node.name.empty() ? "" : " '" + node.name + "'")};
      const tinygltf::Mesh& mesh = file.meshes[static_cast<size_t>(node.mesh)];
      is_head_scan = is_head_scan || mesh.name == head_scan;
      for (const tinygltf::Primitive& primitive : mesh.primitives)
        if (auto done = add_primitive(primitive, place); !done) return done;
    }
    for (const int child : node.children)
      if (auto done = add_node(child, place, depth + 1); !done) return done;
    return success();
  }
};

// Returns the file's own map. An unreadable map gives only a warning, since the shape is valid.
Texture own_map(Gathering& gathering, int texture) {
  const tinygltf::Model& file = gathering.file;
  if (texture < 0) return {};
  const auto without = [&](const std::string& why) {
    gathering.model.warnings.push_back(fmt::format("{}: {}", gathering.path, why));
    return Texture{};
  };
  if (static_cast<size_t>(texture) >= file.textures.size())
    return without(fmt::format("texture {} does not exist; its map is left out", texture));
  const tinygltf::Texture& from = file.textures[static_cast<size_t>(texture)];
  if (from.source < 0 || static_cast<size_t>(from.source) >= file.images.size())
    return without(
        fmt::format("texture {} has no picture that can be read{}{}; its map is left out", texture,
                    from.extensions.empty() ? "" : " without ",
                    from.extensions.empty() ? "" : from.extensions.begin()->first));
  const tinygltf::Image& image = file.images[static_cast<size_t>(from.source)];
  const std::string& name = image.uri.empty() ? image.name : image.uri;
  const std::string called =
      fmt::format("image {}{}", from.source, name.empty() ? "" : " '" + name + "'");
  if (image.image.empty() && !image.uri.empty())
    return without(called + " is not there, is empty or cannot be read; its map is left out");
  auto decoded = decode_texture(fmt::format("{}: {}", gathering.path, called),
                                std::as_bytes(std::span(image.image)));
  if (decoded) return decoded.take();
  gathering.model.warnings.push_back(decoded.error().text);
  return {};
}

Result<> read_maps(Gathering& gathering, const ModelOptions& options) {
  Model& model = gathering.model;
  if (const tinygltf::Material* from = gathering.first_material(); from != nullptr) {
    const tinygltf::Material& material = *from;
    const std::vector<double>& factor = material.pbrMetallicRoughness.baseColorFactor;
    if (factor.size() >= 3)
      model.albedo_factor = glm::clamp(glm::make_vec3(factor.data()), 0.0, 1.0);
    const auto own = [&](const auto& info, const char* which) -> Texture {
      if (info.index < 0 || place_of(info) == gathering.place_of_maps())
        return own_map(gathering, info.index);
      model.warnings.push_back(
          fmt::format("{}: the {} map has other coordinates or another "
                      "KHR_texture_transform than the other maps and is ignored",
                      gathering.path, which));
      return {};
    };
    if (options.albedo.empty())
      model.albedo = own(material.pbrMetallicRoughness.baseColorTexture, "base colour");
    if (options.normal.empty()) {
      model.normal = own(material.normalTexture, "normal");
      model.normal_scale = material.normalTexture.scale;
    }
  }
  struct SeparateMap {
    const std::string& path;
    Texture& texture;
  };
  for (const SeparateMap& one :
       {SeparateMap{options.albedo, model.albedo}, SeparateMap{options.normal, model.normal},
        SeparateMap{options.specular, model.specular}}) {
    if (one.path.empty()) continue;
    auto texture = load_texture(one.path);
    if (!texture) return texture.error();
    one.texture = texture.take();
    flip_rows(one.texture);
  }
  if (!options.albedo.empty()) model.albedo_factor = glm::dvec3(1.0);
  if (!options.normal.empty()) // flipped rows invert the y component of normals
    for (size_t i = 1; i < model.normal.texels.size(); i += 4)
      model.normal.texels[i] =
          std::byte{static_cast<uint8_t>(255 - static_cast<int>(model.normal.texels[i]))};
  return success();
}

Result<> place_in_middle(Mesh& mesh, const ModelOptions& options) {
  const Bounds bounds = bounds_of(mesh);
  const float height = bounds.high.y - bounds.low.y;
  if (!(height > 0.0f) || !std::isfinite(height))
    return Error{ErrorKind::input, fmt::format("{}: the model has no height", options.mesh)};
  const float scale =
      options.height_metres > 0.0 ? static_cast<float>(options.height_metres) / height : 1.0f;
  const glm::vec3 middle = 0.5f * (bounds.low + bounds.high);
  for (Vertex& vertex : mesh.vertices)
    vertex.position = (vertex.position - middle) * scale;
  return success();
}

} // namespace

Result<Model> load_model(const ModelOptions& options, const std::vector<std::string>& roots) {
  constexpr double tallest = 1000.0;
  if (!std::isfinite(options.height_metres) || options.height_metres < 0.0 ||
      options.height_metres > tallest)
    return Error{ErrorKind::usage,
                 fmt::format("the model's height is {}; expected more than 0 and at most {} metres",
                             options.height_metres, tallest)};
  auto bytes = read_binary_file(options.mesh, max_model_bytes);
  if (!bytes) return bytes.error();
  auto file = parse_gltf(options.mesh, *bytes, roots);
  if (!file) return file.error();
  Gathering gathering{*file, options, options.mesh, {}, -1, false, {}, 0};
  const auto scene = static_cast<size_t>(std::max(file->defaultScene, 0));
  if (scene < file->scenes.size())
    for (const int node : file->scenes[scene].nodes)
      if (auto done = gathering.add_node(node, glm::dmat4(1.0), 0); !done) return done.error();
  if (gathering.model.mesh.indices.empty())
    return Error{ErrorKind::input,
                 fmt::format("{}: the default scene has no triangles", options.mesh)};
  if (auto done = read_maps(gathering, options); !done) return done.error();
  if (auto done = place_in_middle(gathering.model.mesh, options); !done) return done.error();
  for (const Part& part : gathering.parts) {
    if (!part.has_normals) compute_in(gathering.model.mesh, part, compute_normals);
    if (!part.has_tangents) compute_in(gathering.model.mesh, part, compute_tangents);
  }
  if (gathering.skipped > 0)
    gathering.model.warnings.push_back(fmt::format("{}: {} meshes of points or lines were left out",
                                                   options.mesh, gathering.skipped));
  if (!file->asset.copyright.empty()) gathering.model.credits.push_back(file->asset.copyright);
  if (gathering.is_head_scan) gathering.model.credits.emplace_back(head_scan_credit);
  return std::move(gathering.model);
}

} // namespace demo
