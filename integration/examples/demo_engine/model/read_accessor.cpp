#include "integration/examples/demo_engine/model/read_accessor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace demo {
namespace {

constexpr size_t max_elements = size_t{1} << 26;

struct Elements {
  const unsigned char* first = nullptr; // null: all zero, as for glTF accessors without a view
  size_t stride = 0, count = 0;
  int component = 0;
  bool normalized = false;
  // Sparse accessors: the indices of replaced elements, ascending, and their tightly packed values.
  std::vector<uint32_t> replaced;
  const unsigned char* values = nullptr;
  size_t value_stride = 0;

  // Returns null if the element is 0.
  const unsigned char* at(size_t element) const {
    const auto found = std::lower_bound(replaced.begin(), replaced.end(), element);
    if (found != replaced.end() && *found == element)
      return values + static_cast<size_t>(found - replaced.begin()) * value_stride;
    return first == nullptr ? nullptr : first + element * stride;
  }
};

Error reject(const std::string& file, int index, const std::string& why) {
  return {ErrorKind::input, fmt::format("{}: accessor {} {}", file, index, why)};
}

template <class T> T load(const unsigned char* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

// The start of elements in a buffer view, checked to lie inside view and buffer.
struct Range {
  const unsigned char* first = nullptr;
  size_t stride = 0;
};
Result<Range> find_range(const tinygltf::Model& model, const std::string& file, int index,
                         int buffer_view, size_t offset, size_t element, size_t count) {
  if (buffer_view < 0 || static_cast<size_t>(buffer_view) >= model.bufferViews.size())
    return reject(file, index, "refers to a buffer view that does not exist");
  const tinygltf::BufferView& view = model.bufferViews[static_cast<size_t>(buffer_view)];
  if (view.buffer < 0 || static_cast<size_t>(view.buffer) >= model.buffers.size())
    return reject(file, index, "refers to a buffer that does not exist");
  const std::vector<unsigned char>& data = model.buffers[static_cast<size_t>(view.buffer)].data;
  const size_t stride = view.byteStride == 0 ? element : view.byteStride;
  const size_t available = view.byteOffset <= data.size() ? data.size() - view.byteOffset : 0;
  const bool view_fits = view.byteLength <= available;
  const bool starts = offset <= view.byteLength && view.byteLength - offset >= element;
  if (!view_fits || !starts || stride < element || stride > 4096 ||
      (count - 1) > (view.byteLength - offset - element) / stride)
    return reject(file, index, "reaches beyond the end of its buffer");
  return Range{data.data() + view.byteOffset + offset, stride};
}

Result<uint32_t> unsigned_at(const unsigned char* at, int component, const std::string& file,
                             int index) {
  switch (component) {
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
    return uint32_t{*at};
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
    return uint32_t{load<uint16_t>(at)};
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    return load<uint32_t>(at);
  default:
    return reject(file, index, "is used for indices and holds no unsigned integers");
  }
}

// Finds the elements that a sparse accessor replaces, each of `element` bytes.
Result<> find_replaced(const tinygltf::Model& model, const std::string& file, int index,
                       size_t element, Elements& elements) {
  const auto& sparse = model.accessors[static_cast<size_t>(index)].sparse;
  if (sparse.count < 1 || static_cast<size_t>(sparse.count) > elements.count)
    return reject(
        file, index,
        fmt::format("replaces {} elements; expected 1 to {}", sparse.count, elements.count));
  if (sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    return reject(file, index, "begins before its buffer view");
  const int type = sparse.indices.componentType;
  const int bytes = tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(type));
  if (bytes <= 0) return reject(file, index, "has an unknown component type");
  const auto count = static_cast<size_t>(sparse.count);
  const auto where =
      find_range(model, file, index, sparse.indices.bufferView,
                 static_cast<size_t>(sparse.indices.byteOffset), static_cast<size_t>(bytes), count);
  if (!where) return where.error();
  const auto values = find_range(model, file, index, sparse.values.bufferView,
                                 static_cast<size_t>(sparse.values.byteOffset), element, count);
  if (!values) return values.error();
  elements.values = values->first;
  elements.value_stride = values->stride;
  elements.replaced.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const auto one = unsigned_at(where->first + i * where->stride, type, file, index);
    if (!one) return one.error();
    if (*one >= elements.count)
      return reject(file, index,
                    fmt::format("replaces element {}; there are {}", *one, elements.count));
    if (i > 0 && *one <= elements.replaced.back())
      return reject(file, index, "replaces elements that are not in ascending order");
    elements.replaced.push_back(*one);
  }
  return success();
}

Result<Elements> find_elements(const tinygltf::Model& model, const std::string& file, int index,
                               int type) {
  if (index < 0 || static_cast<size_t>(index) >= model.accessors.size())
    return reject(file, index, fmt::format("does not exist; there are {}", model.accessors.size()));
  const tinygltf::Accessor& accessor = model.accessors[static_cast<size_t>(index)];
  if (accessor.type != type)
    return reject(file, index, "has another element type than its use needs");
  if (accessor.count == 0 || accessor.count > max_elements)
    return reject(file, index,
                  fmt::format("has {} elements; expected 1 to {}", accessor.count, max_elements));
  const int components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(type));
  const int bytes =
      tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(accessor.componentType));
  if (components <= 0 || bytes <= 0) return reject(file, index, "has an unknown component type");
  Elements elements;
  elements.count = accessor.count;
  elements.component = accessor.componentType;
  elements.normalized = accessor.normalized;
  const size_t element = static_cast<size_t>(components) * static_cast<size_t>(bytes);
  if (accessor.bufferView >= 0) {
    const auto range = find_range(model, file, index, accessor.bufferView, accessor.byteOffset,
                                  element, elements.count);
    if (!range) return range.error();
    elements.first = range->first;
    elements.stride = range->stride;
  }
  if (accessor.sparse.isSparse)
    if (const auto found = find_replaced(model, file, index, element, elements); !found)
      return found.error();
  return elements;
}

// The lowest normalised value has no positive counterpart; glTF maps it to -1, as the next value.
float signed_component(int value, bool normalized, float one) {
  return normalized ? std::max(static_cast<float>(value) / one, -1.0f) : static_cast<float>(value);
}

float component_at(const Elements& elements, size_t element, uint32_t component) {
  const unsigned char* at = elements.at(element);
  if (at == nullptr) return 0.0f;
  switch (elements.component) {
  case TINYGLTF_COMPONENT_TYPE_FLOAT:
    return load<float>(at + 4 * component);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
    return static_cast<float>(at[component]) / (elements.normalized ? 255.0f : 1.0f);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
    return static_cast<float>(load<uint16_t>(at + 2 * component)) /
           (elements.normalized ? 65535.0f : 1.0f);
  case TINYGLTF_COMPONENT_TYPE_BYTE:
    return signed_component(load<int8_t>(at + component), elements.normalized, 127.0f);
  case TINYGLTF_COMPONENT_TYPE_SHORT:
    return signed_component(load<int16_t>(at + 2 * component), elements.normalized, 32767.0f);
  default: // read_floats rejects other types
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

Result<std::vector<float>> read_floats(const tinygltf::Model& model, const std::string& file,
                                       int index, int type, uint32_t width) {
  auto elements = find_elements(model, file, index, type);
  if (!elements) return elements.error();
  if (!holds_floats(elements->component))
    return reject(file, index,
                  fmt::format("has the component type {}; expected floats, bytes or shorts",
                              elements->component));
  std::vector<float> values(elements->count * width);
  for (size_t i = 0; i < elements->count; ++i) {
    for (uint32_t c = 0; c < width; ++c) {
      const float value = component_at(*elements, i, c);
      if (!std::isfinite(value))
        return reject(file, index,
                      fmt::format("holds a number that is not finite at element {}", i));
      values[i * width + c] = value;
    }
  }
  return values;
}

Result<std::vector<uint32_t>> read_indices(const tinygltf::Model& model, const std::string& file,
                                           int index, uint32_t limit) {
  auto elements = find_elements(model, file, index, TINYGLTF_TYPE_SCALAR);
  if (!elements) return elements.error();
  std::vector<uint32_t> values(elements->count);
  for (size_t i = 0; i < elements->count; ++i) {
    if (const unsigned char* at = elements->at(i)) {
      const auto value = unsigned_at(at, elements->component, file, index);
      if (!value) return value.error();
      values[i] = *value;
    }
    if (values[i] >= limit)
      return reject(file, index,
                    fmt::format("holds index {}; there are {} vertices", values[i], limit));
  }
  return values;
}

} // namespace demo
