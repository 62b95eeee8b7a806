#pragma once
// Limits the size of input text, so that a hostile file costs bounded memory and time.
// docs/format.md lists the limits.

#include <cstddef>
#include <cstdint>

namespace dermis::limits {

inline constexpr uint64_t file_bytes = 16ull << 20; // checked before the file is read
// one string value, as written between its quotes
inline constexpr size_t string_bytes = 64u << 10;
inline constexpr size_t key_bytes = 256;     // one key; limits the length of JSON pointers
inline constexpr size_t number_bytes = 1024; // one number or word, as written
inline constexpr uint32_t nesting = 64;      // nested objects and arrays
// values in one document, including objects and arrays
inline constexpr size_t nodes = 1u << 18;
// kept per run; further diagnostics are only counted
inline constexpr size_t diagnostics = 200;

inline constexpr size_t graph_files = 64;      // files that one graph is composed of
inline constexpr uint32_t include_nesting = 8; // files that include each other
inline constexpr size_t edits = 1024;          // per overlay
inline constexpr size_t file_name_bytes = 256; // of an included file

inline constexpr size_t name_bytes = 64; // of a graph, pass, resource, setting or option
inline constexpr size_t passes = 4096;
inline constexpr size_t resources = 4096; // imports and resources together
inline constexpr size_t settings = 256;
inline constexpr size_t options = 64;              // per setting
inline constexpr size_t formats = 32;              // per resource
inline constexpr size_t expression_bytes = 4096;   // one `when`
inline constexpr uint32_t expression_nesting = 64; // parentheses and `not`
// steps of the search for everything that a graph's passes may read, for all values of `when`
inline constexpr uint64_t read_search_steps = 1ull << 25;
inline constexpr uint32_t history_frames = 8;
inline constexpr uint32_t image_side = 16384; // absolute sizes and alignments, texels
inline constexpr int64_t size_factor = 65536; // numerator and denominator of a size
inline constexpr uint32_t image_border = 64;  // texels on every side
inline constexpr uint32_t image_mips = 15;    // full chain of image_side
// usual minimum of VkPhysicalDeviceLimits::maxImageArrayLayers
inline constexpr uint32_t image_layers = 2048;
inline constexpr uint32_t image_ranges =
    512; // subresource ranges of one image that ports distinguish
// subresource ranges, counted per port that accesses them
inline constexpr uint32_t range_uses = 1u << 20;
inline constexpr uint32_t buffer_stride = 65536; // bytes per element
inline constexpr int64_t buffer_elements = 1ll << 31;

} // namespace dermis::limits
