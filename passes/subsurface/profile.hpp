#pragma once
// A subsurface profile: how far light of each channel travels under a surface, in millimetres, as artists and
// measurements give it. Read from configs/profiles/*.json.

#include "framegraph/text/document.hpp"

#include <array>
#include <optional>
#include <string>

namespace dermis::subsurface {

struct Profile {
  std::string name;
  std::array<double, 3> dmfp_mm{}; // diffuse mean free path on the surface, mm; 0: no scattering
  std::array<double, 3> albedo{};  // diffuse reflectance of the material, 0..1; never the texture's
  std::string source;              // where the numbers come from
  std::array<double, 3> d_mm{};    // shape parameter dmfp / s(albedo), mm (Christensen & Burley 2015, eq. 8)
  int widest = 0;                  // channel with the largest d (not dmfp)
};

inline constexpr double largest_dmfp_mm = 1e6; // a kilometre: beyond any use, inside fp32
inline constexpr int64_t profile_format_version = 1;

// Fills d_mm and widest from dmfp_mm and albedo.
void derive(Profile& profile);

// Strict: "dermis_profile": 1, "name", "dmfp_mm" and "albedo" (three numbers each), "source". nullopt with
// located errors. Thread: any.
std::optional<Profile> read_profile(const Document& document, Diagnostics& diagnostics);
// The object's "dmfp_mm" and "albedo" alone, for files that hold a profile inline; `what` names it in
// messages.
std::optional<Profile> read_inline_profile(const Document& document, NodeId object, std::string what,
                                           Diagnostics& diagnostics);

} // namespace dermis::subsurface
