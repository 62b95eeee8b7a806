#include "integration/examples/demo_engine/model/decompress.hpp"

#include "integration/examples/demo_engine/model/parse_gltf.hpp"

#include <fmt/format.h>

#ifdef DEMO_MESHOPT
#include <meshoptimizer.h>
#endif
#ifdef DEMO_DRACO
#include <draco/compression/decode.h>
#endif

#include <cstring>

namespace demo {
namespace {

#if defined(DEMO_MESHOPT) || defined(DEMO_DRACO)
struct Decoding {
  tinygltf::Model& model;
  const std::string& path;
  uint64_t decoded = 0; // bytes

  Error reject(const std::string& what, const std::string& why) const {
    return {ErrorKind::input, fmt::format("{}: {}: {}", path, what, why)};
  }

  // Limits the decoded bytes, because both formats compress so well that a small file could exhaust
  // the memory.
  bool has_space(uint64_t bytes) {
    if (bytes > max_model_bytes - decoded) return false;
    decoded += bytes;
    return true;
  }

  // Returns null if the range is not inside the buffer.
  const unsigned char* range(size_t buffer, size_t offset, size_t length) const {
    if (buffer >= model.buffers.size()) return nullptr;
    const std::vector<unsigned char>& data = model.buffers[buffer].data;
    return offset <= data.size() && length <= data.size() - offset ? data.data() + offset : nullptr;
  }

  int add_buffer(std::vector<unsigned char> data) {
    tinygltf::Buffer buffer;
    buffer.data = std::move(data);
    model.buffers.push_back(std::move(buffer));
    return static_cast<int>(model.buffers.size()) - 1;
  }
};

// Returns a whole number of an extension; `otherwise` if absent, and a value above every limit if
// invalid.
size_t number_of(const tinygltf::Value& extension, const char* key, size_t otherwise) {
  if (!extension.Has(key)) return otherwise;
  const tinygltf::Value& value = extension.Get(key);
  if (!value.IsNumber()) return SIZE_MAX;
  const double number = value.GetNumberAsDouble();
  return number >= 0.0 && number <= static_cast<double>(max_model_bytes)
             ? static_cast<size_t>(number)
             : SIZE_MAX;
}

std::string text_of(const tinygltf::Value& extension, const char* key, const char* otherwise) {
  const tinygltf::Value& value = extension.Get(key);
  return value.IsString() ? value.Get<std::string>() : otherwise;
}
#endif

#ifdef DEMO_MESHOPT
Result<> decode_view(Decoding& decoding, size_t index, const tinygltf::Value& extension) {
  const std::string what = fmt::format("{} of buffer view {}", meshopt_extension, index);
  const size_t length = number_of(extension, "byteLength", SIZE_MAX);
  const size_t stride = number_of(extension, "byteStride", SIZE_MAX);
  const size_t count = number_of(extension, "count", SIZE_MAX);
  const std::string mode = text_of(extension, "mode", "none"),
                    filter = text_of(extension, "filter", "NONE");
  const unsigned char* from = decoding.range(number_of(extension, "buffer", SIZE_MAX),
                                             number_of(extension, "byteOffset", 0), length);
  if (from == nullptr) return decoding.reject(what, "reaches beyond the end of its buffer");
  const bool vertices = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES";
  if (!vertices && !triangles && mode != "INDICES")
    return decoding.reject(what,
                           "mode is '" + mode + "'; expected ATTRIBUTES, TRIANGLES or INDICES");
  const bool stride_fits =
      vertices ? stride > 0 && stride <= 256 && stride % 4 == 0 : stride == 2 || stride == 4;
  if (!stride_fits)
    return decoding.reject(what, vertices ? "byteStride is not a multiple of 4 up to 256"
                                          : "byteStride is not 2 or 4");
  if (count == 0 || count > max_model_bytes || !decoding.has_space(uint64_t{count} * stride) ||
      (triangles && count % 3 != 0))
    return decoding.reject(what, "count is not a number of elements that can be read");
  const bool octahedral = filter == "OCTAHEDRAL", quaternion = filter == "QUATERNION";
  const bool exponential = filter == "EXPONENTIAL";
  if ((!octahedral && !quaternion && !exponential && filter != "NONE") ||
      (!vertices && filter != "NONE") || (octahedral && stride != 4 && stride != 8) ||
      (quaternion && stride != 8))
    return decoding.reject(what, "filter '" + filter + "' does not fit its mode and byteStride");

  std::vector<unsigned char> data(count * stride);
  const int failed = vertices ? meshopt_decodeVertexBuffer(data.data(), count, stride, from, length)
                     : triangles
                         ? meshopt_decodeIndexBuffer(data.data(), count, stride, from, length)
                         : meshopt_decodeIndexSequence(data.data(), count, stride, from, length);
  if (failed != 0) return decoding.reject(what, "the compressed bytes are damaged");
  if (octahedral) meshopt_decodeFilterOct(data.data(), count, stride);
  if (quaternion) meshopt_decodeFilterQuat(data.data(), count, stride);
  if (exponential) meshopt_decodeFilterExp(data.data(), count, stride);
  tinygltf::BufferView& view = decoding.model.bufferViews[index];
  view.byteOffset = 0;
  view.byteLength = data.size();
  view.byteStride = vertices ? stride : 0;
  view.buffer = decoding.add_buffer(std::move(data));
  return success();
}
#endif

#ifdef DEMO_DRACO
int add_accessor(Decoding& decoding, std::vector<unsigned char> data, size_t count, int type,
                 int component) {
  tinygltf::BufferView view;
  view.byteLength = data.size();
  view.buffer = decoding.add_buffer(std::move(data));
  decoding.model.bufferViews.push_back(view);
  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(decoding.model.bufferViews.size()) - 1;
  accessor.count = count;
  accessor.type = type;
  accessor.componentType = component;
  decoding.model.accessors.push_back(accessor);
  return static_cast<int>(decoding.model.accessors.size()) - 1;
}

// Decodes vertices to floats, the format of the final mesh.
Result<int> decode_attribute(Decoding& decoding, const std::string& what, const draco::Mesh& mesh,
                             const std::string& name, size_t id) {
  const draco::PointAttribute* attribute =
      id < UINT32_MAX ? mesh.GetAttributeByUniqueId(static_cast<uint32_t>(id)) : nullptr;
  if (attribute == nullptr)
    return decoding.reject(
        what, fmt::format("{} is attribute {}, which the compressed mesh lacks", name, id));
  const int width = name.starts_with("TEXCOORD_") ? 2 : name == "TANGENT" ? 4 : 3;
  const size_t points = mesh.num_points();
  if (!decoding.has_space(points * static_cast<uint64_t>(width) * sizeof(float)))
    return decoding.reject(what, "the mesh is too large");
  std::vector<unsigned char> data(points * static_cast<size_t>(width) * sizeof(float));
  for (size_t i = 0; i < points; ++i) {
    float values[4] = {};
    const draco::AttributeValueIndex at =
        attribute->mapped_index(draco::PointIndex(static_cast<uint32_t>(i)));
    if (at.value() >= attribute->size() ||
        !attribute->ConvertValue<float>(at, static_cast<int8_t>(width), values))
      return decoding.reject(what, fmt::format("{} cannot be read at vertex {}", name, i));
    std::memcpy(data.data() + i * static_cast<size_t>(width) * sizeof(float), values,
                static_cast<size_t>(width) * sizeof(float));
  }
  const int type = width == 2   ? TINYGLTF_TYPE_VEC2
                   : width == 3 ? TINYGLTF_TYPE_VEC3
                                : TINYGLTF_TYPE_VEC4;
  return add_accessor(decoding, std::move(data), points, type, TINYGLTF_COMPONENT_TYPE_FLOAT);
}

Result<> decode_primitive(Decoding& decoding, const std::string& what,
                          tinygltf::Primitive& primitive, const tinygltf::Value& extension) {
  const size_t view_index = number_of(extension, "bufferView", SIZE_MAX);
  if (view_index >= decoding.model.bufferViews.size())
    return decoding.reject(what, "refers to a buffer view that does not exist");
  const tinygltf::BufferView& view = decoding.model.bufferViews[view_index];
  const unsigned char* from = view.buffer < 0 ? nullptr
                                              : decoding.range(static_cast<size_t>(view.buffer),
                                                               view.byteOffset, view.byteLength);
  if (from == nullptr) return decoding.reject(what, "reaches beyond the end of its buffer");
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(from), view.byteLength);
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok() || decoded.value() == nullptr)
    return decoding.reject(what, fmt::format("the compressed mesh is damaged: {}",
                                             decoded.status().error_msg_string()));
  const draco::Mesh& mesh = *decoded.value();
  const tinygltf::Value& attributes = extension.Get("attributes");
  if (!attributes.IsObject() || !attributes.Has("POSITION"))
    return decoding.reject(what, "has no positions");
  for (const std::string& name : attributes.Keys()) {
    if (name != "POSITION" && name != "NORMAL" && name != "TANGENT" &&
        !name.starts_with("TEXCOORD_"))
      continue; // other attributes are not rendered
    auto accessor =
        decode_attribute(decoding, what, mesh, name, number_of(attributes, name.c_str(), SIZE_MAX));
    if (!accessor) return accessor.error();
    primitive.attributes[name] = *accessor;
  }
  const size_t indices = size_t{mesh.num_faces()} * 3;
  if (!decoding.has_space(indices * sizeof(uint32_t)))
    return decoding.reject(what, "the mesh is too large");
  std::vector<unsigned char> data(indices * sizeof(uint32_t));
  for (uint32_t face = 0; face < mesh.num_faces(); ++face)
    for (uint32_t corner = 0; corner < 3; ++corner) {
      const uint32_t index = mesh.face(draco::FaceIndex(face))[corner].value();
      std::memcpy(data.data() + (face * size_t{3} + corner) * sizeof index, &index, sizeof index);
    }
  primitive.indices = add_accessor(decoding, std::move(data), indices, TINYGLTF_TYPE_SCALAR,
                                   TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  return success();
}
#endif

} // namespace

Result<> decompress([[maybe_unused]] tinygltf::Model& model,
                    [[maybe_unused]] const std::string& path) {
#if defined(DEMO_MESHOPT) || defined(DEMO_DRACO)
  Decoding decoding{model, path};
#endif
#ifdef DEMO_MESHOPT
  for (size_t i = 0; i < model.bufferViews.size(); ++i) {
    const auto found = model.bufferViews[i].extensions.find(meshopt_extension);
    if (found == model.bufferViews[i].extensions.end()) continue;
    if (auto done = decode_view(decoding, i, found->second); !done) return done;
  }
#endif
#ifdef DEMO_DRACO
  for (size_t m = 0; m < model.meshes.size(); ++m)
    for (size_t p = 0; p < model.meshes[m].primitives.size(); ++p) {
      tinygltf::Primitive& primitive = model.meshes[m].primitives[p];
      const auto found = primitive.extensions.find(draco_extension);
      if (found == primitive.extensions.end()) continue;
      const std::string what = fmt::format("{} of mesh {}, primitive {}", draco_extension, m, p);
      if (auto done = decode_primitive(decoding, what, primitive, found->second); !done)
        return done;
    }
#endif
  return success();
}

} // namespace demo
