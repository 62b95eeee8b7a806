#pragma once
// Holds a declared graph as read from a file: names are resolved to indices, and every value has
// its source location. Pure data; read_graph.hpp reads it and compile/ compiles it.

#include "framegraph/model/format_list.hpp"
#include "framegraph/model/ids.hpp"
#include "framegraph/model/pass_type.hpp"
#include "framegraph/text/diagnostic.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dermis {

struct Rational {
  int64_t numerator = 1, denominator = 1; // denominator > 0
};

enum class Rounding : uint8_t { ceil, floor };

// Width and height of an image: rational multiples of the view, of the view in square pixels
// (pixel_grid.hpp) or of another resource, or absolute texels. value = align_up(round(base *
// factor), align), at least 1.
struct SizeExpression {
  enum class Base : uint8_t { view, resource, fixed, square_view } base = Base::view;
  ResourceId resource;
  Rational x, y; // factors; for `fixed`: sizes with denominator 1
  Rounding rounding = Rounding::ceil;
  uint32_t align = 1;
  uint32_t border = 0; // images: texels added on every side after rounding and alignment
};

// Acceleration structures are imports without size or format, read by ray queries.
enum class ResourceType : uint8_t { image, buffer, acceleration_structure };
std::string_view type_name(ResourceType type);   // "buffer"
std::string_view type_phrase(ResourceType type); // "a buffer"
// imported: the memory belongs to the host
enum class Origin : uint8_t { imported, transient };

struct HistoryDeclaration {
  uint32_t frames = 0; // 0: no history; N: `name@-1` .. `name@-N` can be read
  enum class First : uint8_t { discard, clear } first = First::discard;
  enum class OnCut : uint8_t { invalidate, keep } on_cut = OnCut::invalidate;
  enum class OnResize : uint8_t { invalidate, rescale } on_resize = OnResize::invalidate;
};

// Members that every compile reads come first.
struct ResourceDeclaration {
  FormatList formats;
  // Images: size. Buffers: element count = x * y + extra_elements; for imports the minimum that the
  // host binds.
  SizeExpression size;
  uint32_t mips = 1; // 0: full chain
  uint32_t layers = 1;
  uint32_t stride = 0; // buffers: bytes per element
  ResourceType type = ResourceType::image;
  Origin origin = Origin::transient;
  bool exported = false;       // the host receives its last version
  bool optional = false;       // import or export that the host may leave unbound
  uint64_t extra_elements = 0; // buffers
  HistoryDeclaration history;
  std::string name;
  std::string note;
  SourceLocation where;
};

// Requirements of one option of a choice; if empty, the option is always available.
struct OptionNeeds {
  Features features = 0;           // of the device
  std::vector<ResourceId> imports; // optional imports that the host must bind
};

struct SettingDeclaration {
  std::string name;
  SettingType type = SettingType::integer;
  SettingValue default_value;
  double minimum = 0.0, maximum = 0.0;
  std::vector<std::string> options; // for enumeration and choice
  std::vector<OptionNeeds> needs;   // by option; empty: all are available on every device
  bool by_budget = false;           // a choice that the library makes
  std::string unit, note;
  SourceLocation where;
};

// Node of a `when` expression. Nodes form a pool; leaves refer to settings or literals.
struct Expression {
  enum class Op : uint8_t {
    literal,
    setting,
    logical_not,
    logical_and,
    logical_or,
    equal,
    not_equal,
    less,
    less_equal,
    greater,
    greater_equal,
    in
  } op = Op::literal;
  SettingValue literal;
  SettingId setting;
  ExpressionId left, right;
  std::vector<SettingValue> list; // for `in`
};

// Mips and layers of an image, counted from 0: `name#1..3[0]`.
struct ImageRange {
  uint8_t first_mip = 0, mips = 0;      // mips 0: to the last
  uint16_t first_layer = 0, layers = 0; // layers 0: to the last

  constexpr bool whole() const {
    return first_mip == 0 && mips == 0 && first_layer == 0 && layers == 0;
  }
};

// Says in which frames a pass reads the resource bound to a port. `name@-N` is valid once N
// frames have been written since the history began or was cut. Validity is known only when a frame
// is recorded; no plan depends on it.
enum class ReadWhen : uint8_t { always, history_valid, history_invalid };

struct PortBinding {
  uint32_t port = 0; // index into PassType::ports
  ResourceId resource;
  uint32_t frames_back = 0; // 0: this frame; 1: `name@-1`
  // history_invalid: the port reads this binding if the history of the previous binding, at the
  // same port, is not valid.
  ReadWhen when = ReadWhen::always;
  ImageRange range; // images that the graph owns
};

struct SettingBinding {
  uint32_t setting = 0; // index into PassType::settings
  SettingId from;       // valid: follows the graph's setting "$name"; else `literal` applies
  SettingValue literal;
  SourceLocation where;
};

// If the pass is off, readers of `output` get `instead`.
struct PassThrough {
  ResourceId output, instead;
  SourceLocation where;
};

struct Ordering {
  PassId after;
  std::string reason; // never empty
  SourceLocation where;
};

// Members that every compile reads come first.
struct PassDeclaration {
  PassTypeId type;
  ExpressionId when;  // invalid: always on
  bool async = false; // may run concurrently with other passes if there are two queues
  // into Graph::bindings: reads, then writes
  uint32_t first_binding = 0, read_count = 0, write_count = 0;
  std::vector<Ordering> after;
  std::vector<PassThrough> otherwise;
  std::vector<SettingBinding> settings;
  std::string name;
  std::string note;
  SourceLocation where;
  // Reason why the pass is off for all setting values: the graph has no scattering profile. `when`
  // is then never true.
  enum class Absence : uint8_t {
    none,
    no_profile, // its pass type serves scattering
    no_input    // `missing` is only written by passes that are off without a profile
  };
  Absence absence = Absence::none;
  ResourceId missing;
};

struct Graph {
  std::string name;
  Features features = 0; // device features that the whole graph requires
  SourceLocation requires_where;
  std::vector<SettingDeclaration> settings;
  std::vector<ResourceDeclaration> resources; // in file order: imports, then resources
  std::vector<Expression> expressions;
  std::vector<PassDeclaration> passes; // in file order, which determines the versions of a resource
  bool names_ranges = false;           // some port names mips or layers
  // Bindings of all passes. Compiling reads `bindings`; their source locations are stored
  // separately.
  std::vector<PortBinding> bindings;
  std::vector<SourceLocation> binding_places;

  std::span<const PortBinding> bindings_of(const PassDeclaration& pass) const {
    return {bindings.data() + pass.first_binding, size_t{pass.read_count} + pass.write_count};
  }
  std::span<const PortBinding> reads(const PassDeclaration& pass) const {
    return bindings_of(pass).first(pass.read_count);
  }
  std::span<const PortBinding> writes(const PassDeclaration& pass) const {
    return bindings_of(pass).subspan(pass.read_count);
  }
  // `binding` must be an element of `bindings`.
  const SourceLocation& place_of(const PortBinding& binding) const {
    return binding_places[static_cast<size_t>(&binding - bindings.data())];
  }
  // Adds a binding of the pass that was bound last: first all reads, then all writes.
  void bind(PassDeclaration& pass, PortSide side, const PortBinding& binding, SourceLocation where);
};

} // namespace dermis
