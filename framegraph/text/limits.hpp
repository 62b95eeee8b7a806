#pragma once
// What a text may be at most, so that a hostile file costs bounded memory and time. Stated in docs/format.md.

#include <cstddef>
#include <cstdint>

namespace dermis::limits {

inline constexpr uint64_t file_bytes = 16ull << 20; // refused by size before it is read
inline constexpr size_t string_bytes = 64u << 10;   // one string value, as written between its quotes
inline constexpr size_t key_bytes = 256;            // one key; bounds the length of JSON pointers
inline constexpr size_t number_bytes = 1024;        // one number or word, as written
inline constexpr uint32_t nesting = 64;             // objects and arrays inside each other
inline constexpr size_t nodes = 1u << 18;           // values in one document, objects and arrays included
inline constexpr size_t diagnostics = 200;          // kept of one run; the rest is counted only

inline constexpr size_t graph_files = 64;      // that one graph is put together from
inline constexpr uint32_t include_nesting = 8; // files that include each other
inline constexpr size_t edits = 1024;          // of one overlay
inline constexpr size_t file_name_bytes = 256; // of an included file

inline constexpr size_t name_bytes = 64; // of a graph, pass, resource, setting or option
inline constexpr size_t passes = 4096;
inline constexpr size_t resources = 4096; // imports and resources together
inline constexpr size_t settings = 256;
inline constexpr size_t options = 64;              // of one setting
inline constexpr size_t formats = 32;              // of one resource
inline constexpr size_t expression_bytes = 4096;   // one `when`
inline constexpr uint32_t expression_nesting = 64; // parentheses and `not`
inline constexpr uint32_t history_frames = 8;
inline constexpr uint32_t image_side = 16384;    // absolute sizes and alignments, texels
inline constexpr int64_t size_factor = 65536;    // numerator and denominator of a size
inline constexpr uint32_t image_border = 64;     // texels on every side
inline constexpr uint32_t image_mips = 15;       // full chain of image_side
inline constexpr uint32_t image_layers = 2048;   // VkPhysicalDeviceLimits::maxImageArrayLayers, usual minimum
inline constexpr uint32_t image_parts = 512;     // of one image that ports tell apart
inline constexpr uint32_t part_uses = 1u << 20;  // parts of images, counted at each port that sees them
inline constexpr uint32_t buffer_stride = 65536; // bytes an element
inline constexpr int64_t buffer_elements = 1ll << 31;

} // namespace dermis::limits
