#include "integration/demo_engine/model/read_accessor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace demo {
namespace {

constexpr size_t most_elements = size_t{1} << 26;

struct Elements {
  const unsigned char* first = nullptr; // null: all zero, as glTF has it for accessors without a view
  size_t stride = 0, count = 0;
  int component = 0;
  bool normalized = false;
};

Error refuse(const std::string& file, int index, const std::string& why) {
  return {ErrorKind::input, fmt::format("{}: accessor {} {}", file, index, why)};
}

Result<Elements> find_elements(const tinygltf::Model& model, const std::string& file, int index, int type) {
  if (index < 0 || static_cast<size_t>(index) >= model.accessors.size())
    return refuse(file, index, fmt::format("does not exist; there are {}", model.accessors.size()));
  const tinygltf::Accessor& accessor = model.accessors[static_cast<size_t>(index)];
  if (accessor.type != type) return refuse(file, index, "has another element type than its use needs");
  if (accessor.count == 0 || accessor.count > most_elements)
    return refuse(file, index,
                  fmt::format("has {} elements; expected 1 to {}", accessor.count, most_elements));
  if (accessor.sparse.isSparse) return refuse(file, index, "is sparse, which is not supported");
  const int components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(type));
  const int bytes = tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(accessor.componentType));
  if (components <= 0 || bytes <= 0) return refuse(file, index, "has an unknown component type");
  Elements elements;
  elements.count = accessor.count;
  elements.component = accessor.componentType;
  elements.normalized = accessor.normalized;
  if (accessor.bufferView < 0) return elements;
  if (static_cast<size_t>(accessor.bufferView) >= model.bufferViews.size())
    return refuse(file, index, "refers to a buffer view that does not exist");
  const tinygltf::BufferView& view = model.bufferViews[static_cast<size_t>(accessor.bufferView)];
  if (view.buffer < 0 || static_cast<size_t>(view.buffer) >= model.buffers.size())
    return refuse(file, index, "refers to a buffer that does not exist");
  const std::vector<unsigned char>& data = model.buffers[static_cast<size_t>(view.buffer)].data;
  const size_t element = static_cast<size_t>(components) * static_cast<size_t>(bytes);
  elements.stride = view.byteStride == 0 ? element : view.byteStride;
  const size_t room = view.byteOffset <= data.size() ? data.size() - view.byteOffset : 0;
  const bool view_fits = view.byteLength <= room;
  const bool starts =
      accessor.byteOffset <= view.byteLength && view.byteLength - accessor.byteOffset >= element;
  if (!view_fits || !starts || elements.stride < element || elements.stride > 4096 ||
      (elements.count - 1) > (view.byteLength - accessor.byteOffset - element) / elements.stride)
    return refuse(file, index, "reaches beyond the end of its buffer");
  elements.first = data.data() + view.byteOffset + accessor.byteOffset;
  return elements;
}

template <class T> T load(const unsigned char* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

// The lowest normalised value has no opposite: glTF has it stand for -1 as the next one does.
float signed_component(int value, bool normalized, float one) {
  return normalized ? std::max(static_cast<float>(value) / one, -1.0f) : static_cast<float>(value);
}

float component_at(const Elements& elements, size_t element, uint32_t component) {
  if (elements.first == nullptr) return 0.0f;
  const unsigned char* at = elements.first + element * elements.stride;
  switch (elements.component) {
  case TINYGLTF_COMPONENT_TYPE_FLOAT:
    return load<float>(at + 4 * component);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
    return static_cast<float>(at[component]) / (elements.normalized ? 255.0f : 1.0f);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
    return static_cast<float>(load<uint16_t>(at + 2 * component)) / (elements.normalized ? 65535.0f : 1.0f);
  case TINYGLTF_COMPONENT_TYPE_BYTE:
    return signed_component(load<int8_t>(at + component), elements.normalized, 127.0f);
  case TINYGLTF_COMPONENT_TYPE_SHORT:
    return signed_component(load<int16_t>(at + 2 * component), elements.normalized, 32767.0f);
  default: // refused by read_floats
    return 0.0f;
  }
}

bool holds_floats(int component_type) {
  switch (component_type) {
  case TINYGLTF_COMPONENT_TYPE_FLOAT:
  case TINYGLTF_COMPONENT_TYPE_BYTE:
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
  case TINYGLTF_COMPONENT_TYPE_SHORT:
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
    return true;
  default:
    return false;
  }
}

} // namespace

Result<std::vector<float>> read_floats(const tinygltf::Model& model, const std::string& file, int index,
                                       int type, uint32_t width) {
  auto elements = find_elements(model, file, index, type);
  if (!elements) return elements.error();
  if (!holds_floats(elements->component))
    return refuse(
        file, index,
        fmt::format("has the component type {}; expected floats, bytes or shorts", elements->component));
  std::vector<float> values(elements->count * width);
  for (size_t i = 0; i < elements->count; ++i) {
    for (uint32_t c = 0; c < width; ++c) {
      const float value = component_at(*elements, i, c);
      if (!std::isfinite(value))
        return refuse(file, index, fmt::format("holds a number that is not finite at element {}", i));
      values[i * width + c] = value;
    }
  }
  return values;
}

Result<std::vector<uint32_t>> read_indices(const tinygltf::Model& model, const std::string& file, int index,
                                           uint32_t limit) {
  auto elements = find_elements(model, file, index, TINYGLTF_TYPE_SCALAR);
  if (!elements) return elements.error();
  std::vector<uint32_t> values(elements->count);
  for (size_t i = 0; i < elements->count; ++i) {
    const unsigned char* at = elements->first ? elements->first + i * elements->stride : nullptr;
    if (at != nullptr) {
      switch (elements->component) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        values[i] = *at;
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        values[i] = load<uint16_t>(at);
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        values[i] = load<uint32_t>(at);
        break;
      default:
        return refuse(file, index, "is used for indices and holds no unsigned integers");
      }
    }
    if (values[i] >= limit)
      return refuse(file, index, fmt::format("holds index {}; there are {} vertices", values[i], limit));
  }
  return values;
}

} // namespace demo
