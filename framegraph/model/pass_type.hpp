#pragma once
// The signature of a pass type: its ports, its settings and how it is dispatched. This one declaration is the
// source of descriptor layouts, push constants, GLSL binding headers, schema and documentation.

#include "framegraph/model/ids.hpp"
#include "framegraph/model/vocabulary.hpp"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace dermis {

struct Port {
  std::string_view name;
  Usage usage = Usage::sampled_image;
  bool optional = false;
  std::string_view glsl_type; // images: "texture2D", "utexture2D", "image2D", "uimage2D", updated ones that
                              // the kernel never loads "writeonly image2D"; buffers: the element type
  std::string_view doc;
  std::span<const Format> formats = {}; // formats the shader can work with; empty = any the resource declares
  // Each invocation reads only the texels or elements that it alone writes, and reads each before it writes
  // it. The pass may then write what this port reads. A port that updates needs it for no access of its own.
  bool own_texels = false;
};

// Whether a kernel can use images of this format at the port: one of Port::formats, or without these any
// whose components have the type of `glsl_type`. Depth formats cannot be written.
bool works_with(const Port& port, Format format);

enum class SettingType : uint8_t { boolean, integer, real, enumeration, choice };

// A value of a setting. Enumerations and choices are held as the index of the option.
struct SettingValue {
  SettingType type = SettingType::integer;
  int64_t integer = 0; // boolean (0/1), integer, enumeration, choice
  double real = 0.0;   // real
};

struct PassTypeSetting {
  std::string_view name;
  SettingType type = SettingType::integer;
  SettingValue default_value;
  double minimum = 0.0, maximum = 0.0;            // inclusive; for integer and real
  std::span<const std::string_view> options = {}; // for enumeration
  std::string_view unit;                          // "px", "mm", "taps", or "" when dimensionless
  std::string_view doc;
  bool per_frame = false; // its value may differ from frame to frame and from view to view: a weight or a
                          // threshold. False: all frames of a compiled graph run with one value
};

enum class DispatchShape : uint8_t {
  over_view,        // one 8x8 group per tile of the render rectangle
  over_tiles,       // indirect: one group per listed tile, from the port with usage indirect_arguments
  over_tile_grid,   // one 64-invocation group per 64 tiles of the render rectangle
  over_tile_blocks, // one 64-invocation group per 4x4 tiles of the render rectangle
  over_written,     // one 8x8 group per 8x8 texels of the first image that the pass type writes
  single_group,     // one group
  none,             // not a dispatch (clear)
  host              // the host records it
};

// What a kernel reads or writes at one of its ports, however many passes stand before it: an image of at
// least a texel for each square of `square` pixels of the view, or a buffer of `bytes` for each of them and
// `more`.
struct PortNeed {
  std::string_view port;
  uint32_t square = 0, bytes = 0, more = 0; // square 0: `more` alone
};

// How much of a frame is in a history that a pass mixes it into.
struct HistoryWeight {
  enum class By : uint8_t {
    fraction, // at least the setting
    cap       // 1 part, beside as many of history as the setting says, at most
  };
  std::string_view port;    // that writes the history
  std::string_view setting; // a real number
  By by = By::fraction;
  uint32_t frames = 1; // a texel takes part in one frame of so many, at least
};

struct PassType {
  std::string_view name;   // "subsurface.burley"
  std::string_view shader; // path below shaders/ without ".comp", "" for pass types without one
  std::string_view doc;
  std::span<const Port> ports; // read and written, in binding order: port i is binding i of set 0
  std::span<const PassTypeSetting>
      settings; // push constants: uint port_mask, then 4 bytes each in this order
  DispatchShape dispatch = DispatchShape::over_view;
  bool side_effects = false;      // never culled
  bool serves_scattering = false; // left out where nothing scatters
  // over_tiles: the integer setting that says which entry of the arguments counts, 16 bytes each; "": the
  // first.
  std::string_view arguments_entry = "";
  std::span<const PortNeed> needs =
      {}; // also of ports that the pass type does not have; without one: any size
  std::span<const std::string_view> one_of = {}; // optional ports of which at least one has to be bound
  Features features = 0;                         // that its kernel needs of the device
  std::span<const HistoryWeight> mixes = {};     // without one: a history holds the last frame only
};

// The pass types a graph may use. Order of registration is the order of PassTypeId; names are unique.
class PassTypeRegistry {
public:
  PassTypeId add(const PassType& type); // invalid id if the name exists
  PassTypeId find(std::string_view name) const;
  const PassType& operator[](PassTypeId id) const { return pass_types_[id.value]; }
  uint32_t size() const { return static_cast<uint32_t>(pass_types_.size()); }

private:
  std::vector<PassType> pass_types_;
};

// A kind may have a port to read and one to write under the same name (`guide@-1` in, `guide` out). Ports
// that update stand on the writing side.
enum class PortSide : uint8_t { read, write };
PortSide side_of(const Port& port);

// Index of a port or setting by name; -1 when the pass type has none of that name. Without a side: the first.
int find_port(const PassType& type, std::string_view name);
int find_port(const PassType& type, std::string_view name, PortSide side);
int find_setting(const PassType& type, std::string_view name);

bool is_one_of(const PassType& type, uint32_t port); // of PassType::one_of

} // namespace dermis
