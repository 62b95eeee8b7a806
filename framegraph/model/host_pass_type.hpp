#pragma once
// Stores and checks pass types that a host registers, and reads and writes the file that passes
// them to the tools.

#include "framegraph/model/pass_type.hpp"
#include "framegraph/text/document.hpp"

#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace dermis {

struct HostPassTypePort {
  std::string name, doc;
  Usage usage = Usage::sampled_image;
  bool optional = false;
  bool own_texels = false;         // see Port::own_texels
  bool internally_ordered = false; // see Port::internally_ordered
};

struct HostPassTypeSetting {
  std::string name, unit, doc;
  SettingType type = SettingType::boolean; // boolean, integer or real
  double default_value = 0.0, minimum = 0.0, maximum = 0.0;
  bool per_frame = false; // see PassTypeSetting::per_frame
};

struct HostPassTypeDeclaration {
  std::string name, doc;
  std::vector<HostPassTypePort> ports;
  std::vector<HostPassTypeSetting> settings;
  bool side_effects = false;
  bool serves_scattering = false;
};

namespace limits {
inline constexpr size_t host_pass_types = 256;     // per context
inline constexpr size_t host_pass_type_ports = 32; // limited by the port mask
inline constexpr size_t host_pass_type_settings = 32;
inline constexpr double host_pass_type_value = 1e9; // largest magnitude in a range
} // namespace limits

// Describes what is wrong with a declaration and names the field. Empty text: no problem.
struct PassTypeProblem {
  DiagnosticId id = DiagnosticId::bad_name;
  std::string text;
};
PassTypeProblem problem_of(const HostPassTypeDeclaration& type);

// Owns the data that the added PassTypes refer to. Must live as long as any registry that they were
// added to.
class HostPassTypes {
public:
  // Returns the id in `registry`; invalid if the name is taken. problem_of(type) must be empty.
  PassTypeId add(HostPassTypeDeclaration type, PassTypeRegistry& registry);
  size_t size() const { return pass_types_.size(); }
  const HostPassTypeDeclaration& operator[](size_t i) const { return pass_types_[i].declared; }

private:
  struct Kept {
    HostPassTypeDeclaration declared;
    std::vector<Port> ports;
    std::vector<PassTypeSetting> settings;
  };
  static PassTypeId add_kept(Kept& kept, PassTypeRegistry& registry);

  std::deque<Kept> pass_types_; // a deque, so that addresses stay valid
};

// Returns {"dermis_pass_types": 2, "pass_types": [...]}. Equal pass types give equal bytes.
std::string write_host_pass_types(const HostPassTypes& pass_types);
// Returns nullopt with errors in `diagnostics`.
std::optional<std::vector<HostPassTypeDeclaration>> read_host_pass_types(const Document& document,
                                                                         Diagnostics& diagnostics);

} // namespace dermis
