#pragma once
// A subsurface profile: how far light of each channel travels under a surface, in millimetres, as
// specified by artists or measurements. Read from configs/profiles/*.json.

#include "framegraph/text/document.hpp"
#include "passes/common/profiles/shape.hpp"

#include <array>
#include <optional>
#include <string>

namespace dermis::subsurface {

struct Profile {
  std::string name;
  ProfileModel model = ProfileModel::burley;
  // Burley: diffuse mean free path on the surface, mm (0: no scattering), and diffuse reflectance
  // of the material, 0..1 (never the texture's). Dipole: both follow from the coefficients. Artist:
  // unused.
  std::array<double, 3> dmfp_mm{}, albedo{};
  // dipole: absorption and reduced scattering, 1/mm
  std::array<double, 3> sigma_a{}, sigma_s_prime{};
  double eta = dipole_default_eta; // dipole: index of refraction
  // artist: width of the Gaussians, fraction that scatters
  std::array<double, 3> falloff{}, strength{};
  std::string source;           // source of the numbers
  ProfileShape shape_mm{};      // follows from the numbers above; mm
  std::array<double, 3> d_mm{}; // ChannelShape::d, mm
  int widest = 0;               // channel with the largest d (not dmfp)
};

inline constexpr double smallest_dmfp_mm = 1e-6; // below, a channel does not scatter
inline constexpr double largest_dmfp_mm = 1e6;   // 1 km: beyond any use, and within fp32
inline constexpr double largest_mfp_mm = 1e4;
// coefficients of the dipole, 1/mm
inline constexpr double min_coefficient = 1e-5, largest_coefficient = 1e5;
inline constexpr double largest_eta = 3;
inline constexpr double largest_falloff = 1000;
inline constexpr int64_t profile_format_version = 1;

// Fills shape_mm, d_mm and widest from the model's numbers; for the dipole also dmfp_mm and albedo.
void derive(Profile& profile);

// Reads a profile strictly: "dermis_profile": 1, "name", "source" and the numbers of one model
// (docs/profiles.md). Returns nullopt with located errors. Thread: any.
std::optional<Profile> read_profile(const Document& document, Diagnostics& diagnostics);
// Reads only the object's "model" and numbers, for files that contain a profile inline; `what`
// names the profile in messages.
std::optional<Profile> read_inline_profile(const Document& document, NodeId object,
                                           std::string what, Diagnostics& diagnostics);

// Returns the members of a JSON object with the profile's model and numbers, such as "dmfp_mm": [1,
// 2, 3], "albedo": [0.5, 0.5, 0.5]. Reading restores the numbers bit for bit.
std::string profile_members(const Profile& profile);
// Returns one human-readable line: model, dmfp, A and d per channel with their units.
std::string describe_profile(const Profile& profile);

} // namespace dermis::subsurface
