#include "integration/abi/graph_desc.hpp"

#include "framegraph/text/document.hpp"
#include "framegraph/text/limits.hpp"
#include "passes/sap/sap_tiles.hpp"

#include <algorithm>

namespace dermis::abi {
namespace {

constexpr float largest_pixel_aspect = 1e6f;

static_assert(max_view_side <= subsurface::sap_max_view_side);

// Calls `use(i, element)` for each element of a caller's array. `name`: of the array.
template <class T, class Use>
dermis_result for_each(const Log& log, const char* function, const char* name, const T* items,
                       uint32_t count, const T& defaults, Use use) {
  if (count == 0) return DERMIS_OK;
  if (items == nullptr)
    return bad_argument(log, "{}: {} is NULL and its count is {}", function, name, count);
  for (uint32_t i = 0; i < count; ++i) {
    T item = defaults;
    if (const SizedRead read = read_element(items, i, item); read != SizedRead::ok)
      return rejected_element(log, read, function, name, items, i);
    if (const dermis_result result = use(i, item); result != DERMIS_OK) return result;
  }
  return DERMIS_OK;
}

dermis_result read_profiles(const Log& log, const char* function, const dermis_graph_desc& desc,
                            CompiledGraphInput& input, Diagnostics& diagnostics) {
  return for_each<dermis_profile>(
      log, function, "desc.profiles", desc.profiles, desc.profile_count, DERMIS_PROFILE_INIT,
      [&](uint32_t i, const dermis_profile& profile) {
        const std::string field = fmt::format("{}: desc.profiles[{}]", function, i);
        if (profile.id == 0 || profile.id > largest_profile_id)
          return bad_argument(log, "{}.id is {}, expected 1..{}", field, profile.id,
                              largest_profile_id);
        for (const auto& other : input.profiles)
          if (other.id == profile.id)
            return bad_argument(log, "{}.id is {}, which an earlier entry has already", field,
                                profile.id);
        subsurface::NumberedProfile& added = input.profiles.emplace_back();
        added.id = profile.id;
        return read_profile_source(log, (field + ".source").c_str(), profile.source, added,
                                   diagnostics);
      });
}

dermis_result read_pixel_aspect(const Log& log, const char* function, float aspect,
                                CompiledGraphInput& input) {
  if (!(aspect >= 0 && aspect <= largest_pixel_aspect) ||
      (aspect > 0 && aspect < 1 / largest_pixel_aspect))
    return bad_argument(log, "{}: desc.pixel_aspect is {}, expected 0 or 1/{} .. {}", function,
                        aspect, largest_pixel_aspect, largest_pixel_aspect);
  input.pixel_grid = aspect == 0 ? 0 : pixel_grid(double(aspect));
  return DERMIS_OK;
}

dermis_result read_unbound(const Log& log, const char* function, const dermis_graph_desc& desc,
                           CompiledGraphInput& input) {
  if (desc.unbound_count > 0 && desc.unbound == nullptr)
    return bad_argument(log, "{}: desc.unbound is NULL and its count is {}", function,
                        desc.unbound_count);
  for (uint32_t i = 0; i < desc.unbound_count; ++i) {
    if (desc.unbound[i] == nullptr)
      return bad_argument(log, "{}: desc.unbound[{}] is NULL", function, i);
    input.unbound.emplace_back(desc.unbound[i]);
  }
  return DERMIS_OK;
}

dermis_result read_overlays(const Log& log, const char* function, const dermis_graph_desc& desc,
                            CompiledGraphInput& input) {
  return for_each<dermis_source>(
      log, function, "desc.overlays", desc.overlays, desc.overlay_count, DERMIS_SOURCE_INIT,
      [&](uint32_t i, const dermis_source& source) {
        SourceText overlay;
        const dermis_result result =
            read_source(log, fmt::format("{}: desc.overlays[{}]", function, i).c_str(), source,
                        overlay.name, overlay.text);
        if (overlay.name.empty()) overlay.name = fmt::format("overlay {}", i);
        input.overlays.push_back(std::move(overlay));
        return result;
      });
}

dermis_result read_formats(const Log& log, const char* function, const dermis_graph_desc& desc,
                           CompiledGraphInput& input) {
  return for_each<dermis_slot_format>(
      log, function, "desc.formats", desc.formats, desc.format_count, DERMIS_SLOT_FORMAT_INIT,
      [&](uint32_t i, const dermis_slot_format& given) {
        if (given.name == nullptr)
          return bad_argument(log, "{}: desc.formats[{}].name is NULL", function, i);
        const auto format = format_from_vulkan(static_cast<uint32_t>(given.format));
        if (!format || *format == Format::undefined)
          return bad_argument(
              log,
              "{}: desc.formats[{}].format is VkFormat {}, which no graph can declare (slot '{}')",
              function, i, static_cast<uint32_t>(given.format), given.name);
        const auto same = [&](const auto& other) { return other.slot == given.name; };
        if (std::any_of(input.formats.begin(), input.formats.end(), same))
          return bad_argument(log, "{}: desc.formats[{}] names the slot '{}' again", function, i,
                              given.name);
        input.formats.push_back({given.name, *format});
        return DERMIS_OK;
      });
}

} // namespace

dermis_result read_source(const Log& log, const char* what, const dermis_source& source,
                          std::string& name, std::string& text) {
  if (source.struct_size != sizeof(dermis_source)) // a member of other structs, so it never grows
    return bad_argument(log, "{}.struct_size is {}, expected {}: use DERMIS_SOURCE_INIT", what,
                        source.struct_size, sizeof(dermis_source));
  if (source.text == nullptr) return bad_argument(log, "{}.text is NULL", what);
  if (source.length == 0) return bad_argument(log, "{}.length is 0", what);
  if (source.length > limits::file_bytes)
    return bad_argument(log, "{}.length is {}, at most {} bytes are read", what, source.length,
                        limits::file_bytes);
  name = source.name == nullptr ? "" : source.name;
  text.assign(source.text, source.length);
  return DERMIS_OK;
}

dermis_result read_profile_source(const Log& log, const char* what, const dermis_source& source,
                                  subsurface::NumberedProfile& out, Diagnostics& diagnostics) {
  std::string name, text;
  if (const dermis_result result = read_source(log, what, source, name, text); result != DERMIS_OK)
    return result;
  const auto document = parse_document(name.empty() ? fmt::format("profile {}", out.id) : name,
                                       std::move(text), diagnostics);
  if (!document) return DERMIS_OK;
  if (auto read = subsurface::read_profile(*document, diagnostics)) out.profile = std::move(*read);
  return DERMIS_OK;
}

dermis_result check_view_size(const Log& log, const char* of, uint32_t width, uint32_t height) {
  if (width >= 1 && width <= max_view_side && height >= 1 && height <= max_view_side)
    return DERMIS_OK;
  return bad_argument(log, "{}: the size is {}x{}, expected 1..{} pixels per side", of, width,
                      height, max_view_side);
}

dermis_result read_graph_desc(const Log& log, const char* function, const dermis_graph_desc& desc,
                              CompiledGraphInput& input, Diagnostics& diagnostics) {
  if ((desc.keep & ~DERMIS_KEEP_ALL) != 0)
    return bad_argument(log, "{}: desc.keep is {:#x}, known bits are {:#x}", function, desc.keep,
                        DERMIS_KEEP_ALL);
  const auto replaces = [&](uint32_t part) { return (desc.keep & part) == 0; };
  dermis_result result = DERMIS_OK;
  if (replaces(DERMIS_KEEP_SOURCE))
    result = read_source(log, fmt::format("{}: desc.source", function).c_str(), desc.source,
                         input.source_name, input.source_text);
  if (result == DERMIS_OK && replaces(DERMIS_KEEP_SIZE)) {
    result = check_view_size(log, function, desc.width, desc.height);
    input.width = desc.width;
    input.height = desc.height;
    if (result == DERMIS_OK) result = read_pixel_aspect(log, function, desc.pixel_aspect, input);
  }
  if (result == DERMIS_OK && replaces(DERMIS_KEEP_UNBOUND)) {
    input.unbound.clear();
    result = read_unbound(log, function, desc, input);
  }
  if (result == DERMIS_OK && replaces(DERMIS_KEEP_FORMATS)) {
    input.formats.clear();
    result = read_formats(log, function, desc, input);
  }
  if (replaces(DERMIS_KEEP_MEMORY)) input.max_bytes = desc.max_bytes;
  if (replaces(DERMIS_KEEP_INCLUDE)) {
    input.include = desc.include;
    input.include_user = desc.include_user;
  }
  if (result == DERMIS_OK && replaces(DERMIS_KEEP_OVERLAYS)) {
    input.overlays.clear();
    result = read_overlays(log, function, desc, input);
  }
  if (result == DERMIS_OK && replaces(DERMIS_KEEP_PROFILES)) {
    input.profiles.clear();
    input.tables.reset();
    result = read_profiles(log, function, desc, input, diagnostics);
  }
  return result;
}

} // namespace dermis::abi
