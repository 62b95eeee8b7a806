#pragma once
// Pass kinds that a host registers: their own storage of names, what is wrong with one, and the file that
// carries them from the host to the tools.

#include "framegraph/model/pass_kind.hpp"
#include "framegraph/text/document.hpp"

#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace dermis {

struct HostKindPort {
  std::string name, doc;
  Usage usage = Usage::sampled_image;
  bool optional = false;
  bool own_texels = false; // see Port::own_texels
};

struct HostKindSetting {
  std::string name, unit, doc;
  SettingType type = SettingType::boolean; // boolean, integer or real
  double default_value = 0.0, minimum = 0.0, maximum = 0.0;
  bool per_frame = false; // as KindSetting::per_frame
};

struct HostKindDeclaration {
  std::string name, doc;
  std::vector<HostKindPort> ports;
  std::vector<HostKindSetting> settings;
  bool side_effects = false;
  bool serves_scattering = false;
};

namespace limits {
inline constexpr size_t host_kinds = 256;     // of one context
inline constexpr size_t host_kind_ports = 32; // the port mask holds no more
inline constexpr size_t host_kind_settings = 32;
inline constexpr double host_kind_value = 1e9; // largest magnitude of a range
} // namespace limits

// What is wrong with a declaration, in words that name the field; no text: nothing.
struct KindProblem {
  DiagnosticId id = DiagnosticId::bad_name;
  std::string text;
};
KindProblem problem_of(const HostKindDeclaration& kind);

// Owns what the PassKinds of its declarations refer to. Must live as long as any registry that they were
// added to.
class HostKinds {
public:
  // The id in `registry`; invalid if the name exists there. `kind` must have no problem.
  KindId add(HostKindDeclaration kind, KindRegistry& registry);
  size_t size() const { return kinds_.size(); }
  const HostKindDeclaration& operator[](size_t i) const { return kinds_[i].declared; }

private:
  struct Kept {
    HostKindDeclaration declared;
    std::vector<Port> ports;
    std::vector<KindSetting> settings;
  };
  std::deque<Kept> kinds_; // their addresses stay
};

// {"dermis_kinds": 1, "kinds": [...]}; same kinds, same bytes.
std::string write_host_kinds(const HostKinds& kinds);
// nullopt with errors in `diagnostics`.
std::optional<std::vector<HostKindDeclaration>> read_host_kinds(const Document& document,
                                                                Diagnostics& diagnostics);

} // namespace dermis
