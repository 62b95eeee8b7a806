#include "integration/examples/demo_engine/model/parse_gltf.hpp"

#include "framegraph/text/file_roots.hpp"
#include "framegraph/text/limits.hpp"
#include "integration/examples/demo_engine/files.hpp"
#include "integration/examples/demo_engine/model/decompress.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <climits>
#include <cstring>
#include <exception>
#include <filesystem>
#include <string_view>

namespace demo {
namespace {

namespace fs = std::filesystem;

// State for tinygltf's callbacks, which look up files next to the model.
struct GltfFiles {
  const tinygltf::Model& model;
  fs::path folder;
  std::vector<fs::path> roots;
  std::string rejected; // the first name outside of the allowed folders, and why
};

bool file_exists(const std::string& name, void* user) {
  auto& files = *static_cast<GltfFiles*>(user);
  const dermis::PlacedFile placed = dermis::place_file(files.folder, name, files.roots);
  if (!placed.problem.empty()) {
    if (files.rejected.empty())
      files.rejected = fmt::format("'{}' is not read: {}; --root declares further folders", name,
                                   placed.problem);
    return false;
  }
  std::error_code ignored;
  return fs::is_regular_file(placed.path, ignored);
}

std::string as_it_is(const std::string& name, void*) {
  return name;
}

bool read_whole(std::vector<unsigned char>* out, std::string* error, const std::string& name,
                void* user) {
  const auto& files = *static_cast<const GltfFiles*>(user);
  const dermis::PlacedFile placed = dermis::place_file(files.folder, name, files.roots);
  auto bytes = read_binary_file(placed.path.string(), max_model_bytes);
  if (!bytes) {
    if (error != nullptr) *error += bytes.error().text;
    return false;
  }
  const auto* first = reinterpret_cast<const unsigned char*>(bytes->data());
  out->assign(first, first + bytes->size());
  return true;
}

// Keeps images encoded; decode_texture decodes them on demand. tinygltf 2.7 returns views of
// buffers without a check of their end.
bool keep_encoded(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void* user) {
  const tinygltf::Model& model = static_cast<const GltfFiles*>(user)->model;
  image->as_is = true;
  if (image->bufferView >= 0) {
    const tinygltf::BufferView& view = model.bufferViews[static_cast<size_t>(image->bufferView)];
    const size_t held = model.buffers[static_cast<size_t>(view.buffer)].data.size();
    if (view.byteLength > INT_MAX || view.byteOffset > held ||
        view.byteLength > held - view.byteOffset)
      return true;
  }
  image->image.assign(bytes, bytes + size);
  return true;
}

// Returns "" if the chunks are valid. tinygltf 2.7 accepts a chunk that is eight bytes longer than
// the file.
std::string wrong_chunks(std::span<const std::byte> bytes) {
  constexpr size_t header = 12, chunk_header = 8;
  if (bytes.size() < header + chunk_header) return "it ends within its header";
  const auto word = [&](size_t at) {
    uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return uint64_t{value};
  };
  const uint64_t length = word(8), json_end = header + chunk_header + word(header);
  if (length > bytes.size() || json_end > length) return "its first chunk reaches beyond its end";
  if (json_end == length) return "";
  if (length - json_end < chunk_header || word(json_end) > length - json_end - chunk_header)
    return "its second chunk reaches beyond its end";
  return "";
}

// Returns the depth of nested objects and arrays of any text, because tinygltf parses recursively.
uint32_t nesting_of(std::string_view text) {
  uint32_t depth = 0, deepest = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string && c == '\\')
      ++i;
    else if (c == '"')
      in_string = !in_string;
    else if (!in_string && (c == '{' || c == '['))
      deepest = std::max(deepest, ++depth);
    else if (!in_string && (c == '}' || c == ']') && depth > 0)
      --depth;
  }
  return deepest;
}

using Json = nlohmann::json;

bool is_read(std::string_view extension) {
  return extension == "KHR_mesh_quantization" || extension == "KHR_texture_transform" ||
         (reads_meshopt && extension == meshopt_extension) ||
         (reads_draco && extension == draco_extension);
}

// Returns "" for a supported version of glTF, else the fault in `asset`.
std::string version_error(const Json& file) {
  const auto asset = file.find("asset");
  if (asset == file.end() || !asset->is_object() || !asset->contains("version"))
    return "asset.version is missing; expected 2.0";
  for (const char* key : {"version", "minVersion"}) {
    const auto found = asset->find(key);
    if (found == asset->end()) continue;
    if (!found->is_string()) return fmt::format("asset.{} is not a string; expected \"2.0\"", key);
    const std::string& text = found->get_ref<const std::string&>();
    const bool digits =
        text.size() > 2 && text.find_first_not_of("0123456789", 2) == std::string::npos;
    const bool read = text.starts_with("2.") && digits;
    const bool needs_more = key == std::string_view("minVersion") && text != "2.0";
    if (!read || needs_more)
      return fmt::format(
          "asset.{} is '{}', which is not supported; expected 2.0: export the model as glTF 2.0",
          key, text);
  }
  return "";
}

// Returns "" if all required extensions are supported.
std::string unknown_extensions(const Json& file) {
  const auto required = file.find("extensionsRequired");
  if (required == file.end()) return "";
  if (!required->is_array()) return "extensionsRequired is not an array";
  std::string unknown;
  for (const Json& name : *required) {
    if (!name.is_string()) return "extensionsRequired holds something that is not a string";
    const std::string& text = name.get_ref<const std::string&>();
    if (is_read(text)) continue;
    unknown += fmt::format("{}'{}'", unknown.empty() ? "" : ", ", text);
  }
  if (unknown.empty()) return "";
  return fmt::format(
      "the file requires {}, which this build does not read; export the model without it", unknown);
}

// Escapes '+' in names, which tinygltf 2.7 decodes as a space; this is correct only for web forms.
bool keep_plus_signs(Json& file) {
  bool changed = false;
  for (const char* key : {"buffers", "images"}) {
    const auto list = file.find(key);
    if (list == file.end() || !list->is_array()) continue;
    for (Json& one : *list) {
      const auto uri = one.is_object() ? one.find("uri") : one.end();
      if (!one.is_object() || uri == one.end() || !uri->is_string()) continue;
      auto& name = uri->get_ref<std::string&>();
      if (name.starts_with("data:") || name.find('+') == std::string::npos) continue;
      for (size_t at = name.find('+'); at != std::string::npos; at = name.find('+', at))
        name.replace(at, 1, "%2B");
      changed = true;
    }
  }
  return changed;
}

// Gives fallback buffers for readers without meshoptimizer one byte: they may have no bytes, which
// tinygltf 2.7 rejects, and are never read.
bool fill_fallbacks(Json& file) {
  const auto buffers = file.find("buffers");
  if (!reads_meshopt || buffers == file.end() || !buffers->is_array()) return false;
  bool changed = false;
  for (Json& buffer : *buffers) {
    if (!buffer.is_object() || buffer.contains("uri") || !buffer.contains("extensions")) continue;
    const Json& extensions = buffer["extensions"];
    if (!extensions.is_object() || !extensions.contains(meshopt_extension)) continue;
    const Json& meshopt = extensions[meshopt_extension];
    if (!meshopt.is_object() || meshopt.value("fallback", Json()) != Json(true)) continue;
    buffer["uri"] = "data:application/octet-stream;base64,AA==";
    buffer["byteLength"] = 1;
    changed = true;
  }
  return changed;
}

// Removes "indices" from primitives with Draco compression, and returns whether there were any.
// Their accessor has no bufferView, which tinygltf 2.7 rejects; decompress() adds the indices
// again.
bool drop_packed_indices(Json& file) {
  const auto meshes = file.find("meshes");
  if (!reads_draco || meshes == file.end() || !meshes->is_array()) return false;
  bool changed = false;
  for (Json& mesh : *meshes) {
    const auto primitives = mesh.is_object() ? mesh.find("primitives") : mesh.end();
    if (!mesh.is_object() || primitives == mesh.end() || !primitives->is_array()) continue;
    for (Json& primitive : *primitives) {
      if (!primitive.is_object() || !primitive.contains("extensions")) continue;
      const Json& extensions = primitive["extensions"];
      if (extensions.is_object() && extensions.contains(draco_extension))
        changed = primitive.erase("indices") > 0 || changed;
    }
  }
  return changed;
}

// Rewrites parts that tinygltf would misread or reject. Returns whether there were any.
bool prepare(Json& file) {
  if (!file.is_object()) return false;
  const bool names = keep_plus_signs(file), fallbacks = fill_fallbacks(file),
             packed = drop_packed_indices(file);
  return names || fallbacks || packed;
}

// Returns the file with `json` in place of its own JSON.
std::vector<std::byte> with_json(std::span<const std::byte> bytes, const Json& json,
                                 size_t old_size, bool binary) {
  std::string text = json.dump();
  std::vector<std::byte> out;
  const auto append = [&](std::span<const std::byte> more) {
    out.insert(out.end(), more.begin(), more.end());
  };
  if (!binary) {
    append(std::as_bytes(std::span(text)));
    return out;
  }
  constexpr size_t header = 12, chunk_header = 8;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  append(bytes.first(header + chunk_header));
  append(std::as_bytes(std::span(text)));
  append(bytes.subspan(header + chunk_header + old_size));
  const auto whole = static_cast<uint32_t>(out.size()), chunk = static_cast<uint32_t>(text.size());
  std::memcpy(out.data() + 8, &whole, sizeof whole);
  std::memcpy(out.data() + header, &chunk, sizeof chunk);
  return out;
}

} // namespace

Result<tinygltf::Model> parse_gltf(const std::string& path, std::span<const std::byte> bytes,
                                   const std::vector<std::string>& roots) {
  const auto reject = [&](std::string_view why) {
    return Error{ErrorKind::input, fmt::format("{}: {}", path, why)};
  };
  const bool binary = bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  size_t first = 0;
  while (first < text.size() && std::isspace(static_cast<unsigned char>(text[first])) != 0)
    ++first;
  if (!binary && (first == text.size() || text[first] != '{'))
    return reject(
        "this is not a glTF file: it starts neither with 'glTF' (binary) nor with '{' (JSON)");
  if (binary) {
    uint32_t version = 2;
    if (bytes.size() >= 8) std::memcpy(&version, bytes.data() + 4, sizeof version);
    if (version != 2) return reject(fmt::format("binary glTF of version {}; expected 2", version));
    if (const std::string wrong = wrong_chunks(bytes); !wrong.empty())
      return reject("the glTF file is damaged: " + wrong);
    uint32_t json_size = 0;
    std::memcpy(&json_size, bytes.data() + 12, sizeof json_size);
    text = text.substr(20, json_size);
  }
  if (nesting_of(text) > dermis::limits::nesting)
    return reject(
        fmt::format("objects and arrays are nested deeper than {}", dermis::limits::nesting));

  Json json = Json::parse(text, nullptr, false);
  if (json.is_object()) { // otherwise tinygltf reports the fault
    if (const std::string wrong = version_error(json); !wrong.empty()) return reject(wrong);
    if (const std::string unknown = unknown_extensions(json); !unknown.empty())
      return reject(unknown);
  }
  std::vector<std::byte> changed;
  if (prepare(json)) {
    changed = with_json(bytes, json, text.size(), binary);
    bytes = changed;
  }

  tinygltf::Model model;
  GltfFiles files{model, fs::path(path).parent_path(), {fs::path(path).parent_path()}, ""};
  files.roots.insert(files.roots.end(), roots.begin(), roots.end());
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_encoded, &files);
  loader.SetFsCallbacks({file_exists, as_it_is, read_whole, nullptr, &files});
  std::string error, warning;
  const auto size = static_cast<unsigned int>(bytes.size());
  bool loaded = false;
  try {
    // The folder is empty, so that callbacks receive names as in the file.
    loaded =
        binary ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                             reinterpret_cast<const unsigned char*>(bytes.data()),
                                             size, "")
               : loader.LoadASCIIFromString(&model, &error, &warning,
                                            reinterpret_cast<const char*>(bytes.data()), size, "");
  } catch (const std::exception& problem) {
    error = problem.what();
  }
  while (!error.empty() && error.back() == '\n')
    error.pop_back();
  if (!files.rejected.empty()) return reject(files.rejected);
  if (!loaded)
    return reject(
        fmt::format("the glTF file is damaged: {}", error.empty() ? "no reason given" : error));
  try {
    if (auto done = decompress(model, path); !done) return done.error();
  } catch (const std::exception& problem) {
    return reject(fmt::format("the compressed mesh is damaged: {}", problem.what()));
  }
  return model;
}

} // namespace demo
