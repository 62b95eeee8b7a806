#pragma once
// What was declared: a graph read from a file, with every name resolved to an index and every value still
// knowing where it came from. Pure data; reading it is in read_graph.hpp, compiling it in compile/.

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

// width and height of an image: rational multiples of the view, of another resource, or absolute texels.
// value = align_up(round(base * factor), align); never below 1.
struct SizeExpression {
  enum class Base : uint8_t { view, resource, fixed } base = Base::view;
  ResourceId resource;
  Rational x, y; // factors; for fixed the sizes themselves over 1
  Rounding rounding = Rounding::ceil;
  uint32_t align = 1;
  uint32_t border = 0; // images: texels added on every side, last
};

// Acceleration structures are imports, read by ray queries: without size or format.
enum class ResourceType : uint8_t { image, buffer, acceleration_structure };
std::string_view type_name(ResourceType type);       // "buffer"
std::string_view type_phrase(ResourceType type);     // "a buffer"
enum class Origin : uint8_t { imported, transient }; // imported: memory belongs to the host

struct HistoryDeclaration {
  uint32_t frames = 0; // 0: no history; N: `name@-1` .. `name@-N` may be read
  enum class First : uint8_t { discard, clear } first = First::discard;
  enum class OnCut : uint8_t { invalidate, keep } on_cut = OnCut::invalidate;
  enum class OnResize : uint8_t { invalidate, rescale } on_resize = OnResize::invalidate;
};

struct ResourceDeclaration { // what every compile reads comes first
  FormatList formats;
  // Images; buffers: element count = ceil-size x*y + extra_elements, of imports the least the host binds.
  SizeExpression size;
  uint32_t mips = 1; // 0 = full chain
  uint32_t layers = 1;
  uint32_t stride = 0; // buffers: bytes an element
  ResourceType type = ResourceType::image;
  Origin origin = Origin::transient;
  bool exported = false;       // its last version is handed to the host
  bool optional = false;       // import or export that the host may leave unbound
  uint64_t extra_elements = 0; // buffers
  HistoryDeclaration history;
  std::string name;
  std::string note;
  SourceLocation where;
};

// What an option of a choice needs to be offered; none: always.
struct OptionNeeds {
  Features features = 0;           // of the device
  std::vector<ResourceId> imports; // optional ones that the host has to bind
};

struct SettingDeclaration {
  std::string name;
  SettingType type = SettingType::integer;
  SettingValue default_value;
  double minimum = 0.0, maximum = 0.0;
  std::vector<std::string> options; // enumeration and choice
  std::vector<OptionNeeds> needs;   // by option; empty: all are offered on every device
  bool by_budget = false;           // a choice the library makes
  std::string unit, note;
  SourceLocation where;
};

// `when`: a total, typed expression over settings. Nodes in a pool; leaves refer to settings or literals.
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
struct ImagePart {
  uint8_t first_mip = 0, mips = 0;      // mips 0: to the last
  uint16_t first_layer = 0, layers = 0; // likewise

  constexpr bool whole() const { return first_mip == 0 && mips == 0 && first_layer == 0 && layers == 0; }
};

// In which frames a pass reads what is bound to a port. Whether `name@-N` is valid, N frames having been
// written since it began or was cut, is known when a frame is recorded; no plan depends on it.
enum class ReadWhen : uint8_t { always, history_valid, history_invalid };

struct PortBinding {
  uint32_t port = 0; // index into PassType::ports
  ResourceId resource;
  uint32_t frames_back = 0; // 0: this frame; 1: `name@-1`
  // history_invalid: this is what the port reads where the history of the binding before this one, at the
  // same port, is not valid.
  ReadWhen when = ReadWhen::always;
  ImagePart part; // images that the graph owns
};

struct SettingBinding {
  uint32_t setting = 0; // index into PassType::settings
  SettingId from;       // valid: "$name" of the graph's settings; else the literal
  SettingValue literal;
  SourceLocation where;
};

// When the pass is off, readers of what `output` would have produced get `instead`.
struct PassThrough {
  ResourceId output, instead;
  SourceLocation where;
};

struct Ordering {
  PassId after;
  std::string reason; // never empty
  SourceLocation where;
};

struct PassDeclaration { // what every compile reads comes first
  PassTypeId type;
  ExpressionId when;  // invalid: always
  bool async = false; // may run beside the others, where there are two queues
  uint32_t first_binding = 0, read_count = 0, write_count = 0; // into Graph::bindings: reads, then writes
  std::vector<Ordering> after;
  std::vector<PassThrough> otherwise;
  std::vector<SettingBinding> settings;
  std::string name;
  std::string note;
  SourceLocation where;
  // Why the pass is off whatever the settings are: the graph has no profile. `when` is never true then.
  enum class Absence : uint8_t {
    none,
    no_profile, // its pass type serves scattering
    no_input    // only passes that are off for want of a profile write `missing`
  };
  Absence absence = Absence::none;
  ResourceId missing;
};

struct Graph {
  std::string name;
  Features features = 0; // that the whole graph requires of the device
  SourceLocation requires_where;
  std::vector<SettingDeclaration> settings;
  std::vector<ResourceDeclaration> resources; // imports first, in file order, then resources
  std::vector<Expression> expressions;
  std::vector<PassDeclaration> passes; // in file order: versions of a resource follow it
  bool parts = false;                  // some port names a part of an image; if not, nobody looks for any
  // Of all passes. What compiling looks at lies close together; where it stands in the file lies apart.
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
  // `binding` is one of `bindings`.
  const SourceLocation& place_of(const PortBinding& binding) const {
    return binding_places[static_cast<size_t>(&binding - bindings.data())];
  }
  // Adds what the last pass to be bound reads or writes: first everything that it reads.
  void bind(PassDeclaration& pass, PortSide side, const PortBinding& binding, SourceLocation where);
};

} // namespace dermis
