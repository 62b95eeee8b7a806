#pragma once
// Defines the signature of a pass type: its ports, settings and dispatch. This declaration is the
// only source of descriptor layouts, push constants, GLSL binding headers, schema and
// documentation.

#include "framegraph/model/dispatch_rule.hpp"
#include "framegraph/model/ids.hpp"
#include "framegraph/model/vocabulary.hpp"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace dermis {

// Texels that a kernel accesses at a port, within the area that its dispatch covers. Counts of
// bytes use this; compilation does not.
enum class AccessExtent : uint8_t {
  dispatched, // all
  covered,    // pixels to which the graph's effect applies; a dispatch over a list has only these
  flagged,    // covered pixels that another image marks, such as texels with a second layer
  few         // so few that they are not counted
};

// Formats that a port supports while an enumerated setting of the pass has a value.
struct SettingFormats {
  std::string_view setting; // of the pass type; empty: none
  int64_t option = 0;       // its index
  std::span<const Format> formats = {};
};

struct Port {
  std::string_view name;
  Usage usage = Usage::sampled_image;
  bool optional = false;
  // Images: "texture2D", "utexture2D", "image2D" or "uimage2D"; "writeonly image2D" for updated
  // images that the kernel never loads. Buffers: the element type.
  std::string_view glsl_type;
  std::string_view doc;
  // formats that the shader supports; empty: any format that the resource declares
  std::span<const Format> formats = {};
  // True: each invocation reads only the texels or elements that only it writes, and reads each
  // before writing it. The pass may then write what this port reads. Update ports do not need the
  // flag for their own accesses.
  bool own_texels = false;
  AccessExtent extent = AccessExtent::dispatched;
  // Buffers, for counts of bytes: what the kernel accesses per 8x8 texels that the pass writes.
  // 0: the whole buffer.
  uint32_t bytes_per_tile = 0;
  // Only for usages that write without reading. True: the kernel also reads, through this port,
  // what other invocations of the same dispatch wrote. It orders these accesses by itself, and
  // reads nothing that was there before the dispatch. Other ports of the pass must not access the
  // same texels or elements.
  bool internally_ordered = false;
  // Limits `formats` further while a setting has a value.
  SettingFormats formats_while = {};
  bool filtered = false; // the kernel reads the image with linear filtering
};

// Returns whether a kernel supports the format at the port: one of Port::formats, or, if that is
// empty, any format whose components match `glsl_type`. Depth formats cannot be written.
bool works_with(const Port& port, Format format);

// Returns whether a port of the usage may declare Port::internally_ordered.
bool may_order_internally(Usage usage);

enum class SettingType : uint8_t { boolean, integer, real, enumeration, choice };

// A setting's value. Enumerations and choices hold the index of the option.
struct SettingValue {
  SettingType type = SettingType::integer;
  int64_t integer = 0; // boolean (0/1), integer, enumeration, choice
  double real = 0.0;   // real
  bool operator==(const SettingValue&) const = default;
};

struct PassTypeSetting {
  std::string_view name;
  SettingType type = SettingType::integer;
  SettingValue default_value;
  double minimum = 0.0, maximum = 0.0;            // inclusive; for integer and real
  std::span<const std::string_view> options = {}; // for enumeration
  std::string_view unit;                          // "px", "mm", "taps"; "" if dimensionless
  std::string_view doc;
  // True: the value may differ between frames and views, e.g. a weight or a threshold. False: all
  // frames of a compiled graph use one value.
  bool per_frame = false;
};

// Returns whether the setting is a specialisation constant of the kernel: a switch or an
// enumeration that no frame changes. All others are push constants, because a number has too many
// values for a pipeline each.
bool is_constant(const PassTypeSetting& setting);

// Values of constant_id in kernels. Ids that are not listed are free for other constants.
namespace constant_id {
inline constexpr uint32_t texel_shape = 0; // shaders/common/shape.glsl
// Masks of optional ports, bit i for port i: bound in every frame, bound in some frames.
inline constexpr uint32_t bound_ports = 1, changing_ports = 2;
inline constexpr uint32_t group_lanes = 3; // local_size_x of kernels with one shape
inline constexpr uint32_t pixel_grid = 4;  // of the plan (pixel_grid.hpp)
// Whether the device allows wide groups, and local_size_x of kernels that use them.
inline constexpr uint32_t wide_group = 5, wide_lanes = 6;
inline constexpr uint32_t tile_lanes = 7;     // local_size_x of shaders/sap/sap_rounds.glsl
inline constexpr uint32_t first_setting = 16; // PassType::settings[i] has the id first_setting + i
} // namespace constant_id

// Minimum size of the resource at one port, independent of the number of passes. Image: one texel
// per square of `square` x `square` pixels of the view. Buffer: `bytes` per such square, plus
// `more` bytes.
struct PortNeed {
  std::string_view port;
  uint32_t square = 0, bytes = 0, more = 0; // square 0: only `more` bytes
};

// Describes how a pass blends the current frame into a history.
struct HistoryWeight {
  enum class By : uint8_t {
    fraction, // the frame's weight is at least the setting
    cap       // the frame has weight 1, the history at most the setting
  };
  std::string_view port;    // port that writes the history
  std::string_view setting; // a real setting
  By by = By::fraction;
  uint32_t frames = 1; // a texel is updated at least once in this number of frames
};

struct PassType {
  std::string_view name; // "subsurface.burley"
  // path below shaders/ without ".comp"; "" for pass types without a shader
  std::string_view shader;
  std::string_view doc;
  std::span<const Port> ports; // in binding order: port i is binding i of set 0
  // Specialisation constants if is_constant(). Push constants: uint port_mask, then 4 bytes for
  // each other setting in this order.
  std::span<const PassTypeSetting> settings;
  DispatchRule dispatch = {};
  bool side_effects = false;      // never culled
  bool serves_scattering = false; // removed if nothing scatters
  // For an indirect dispatch: name of the integer setting that selects the 16-byte entry of the
  // arguments;
  // "": entry 0.
  std::string_view arguments_entry = "";
  // may name ports that the pass type lacks; a port without an entry accepts any size
  std::span<const PortNeed> needs = {};
  // optional ports of which at least one must be bound
  std::span<const std::string_view> one_of = {};
  Features features = 0;                     // device features that the kernel needs
  std::span<const HistoryWeight> mixes = {}; // empty: a history only holds the last frame
};

// Holds the pass types that a graph may use. PassTypeId follows the order of registration; names
// are unique.
class PassTypeRegistry {
public:
  PassTypeId add(const PassType& type); // returns an invalid id if the name exists
  PassTypeId find(std::string_view name) const;
  const PassType& operator[](PassTypeId id) const { return pass_types_[id.value]; }
  uint32_t size() const { return static_cast<uint32_t>(pass_types_.size()); }

private:
  std::vector<PassType> pass_types_;
};

// A pass type may have one port to read and one to write with equal names (`guide@-1` in, `guide`
// out). Update ports belong to the write side.
enum class PortSide : uint8_t { read, write };
PortSide side_of(const Port& port);

// Return the index of a port or setting by name, or -1. Without a side, the first port with that
// name.
int find_port(const PassType& type, std::string_view name);
int find_port(const PassType& type, std::string_view name, PortSide side);
int find_setting(const PassType& type, std::string_view name);

// Returns the size of the push constants of the pass type's kernel.
uint32_t push_constant_bytes(const PassType& type);

// Returns whether the port is listed in PassType::one_of.
bool is_one_of(const PassType& type, uint32_t port);

} // namespace dermis
