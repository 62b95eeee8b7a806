#include "passes/subsurface/profile.hpp"

#include "framegraph/text/reader.hpp"
#include "passes/subsurface/burley_profile.hpp"

#include <algorithm>

namespace dermis::subsurface {

namespace {

void read_numbers_into(ObjectReader& reader, Profile& profile) {
  reader.numbers("dmfp_mm", profile.dmfp_mm, 0.0, largest_dmfp_mm);
  reader.numbers("albedo", profile.albedo, 0.0, 1.0);
}

} // namespace

void derive(Profile& profile) {
  for (size_t c = 0; c < 3; ++c)
    profile.d_mm[c] = burley_d_from_dmfp(profile.dmfp_mm[c], profile.albedo[c]);
  profile.widest =
      static_cast<int>(std::max_element(profile.d_mm.begin(), profile.d_mm.end()) - profile.d_mm.begin());
}

std::optional<Profile> read_profile(const Document& document, Diagnostics& diagnostics) {
  if (!expect_kind(document, document.root(), "a profile file", NodeKind::object, diagnostics) ||
      !check_version(document, "dermis_profile", profile_format_version, diagnostics))
    return std::nullopt;
  Profile profile;
  ObjectReader reader(document, document.root(), "profile", diagnostics);
  reader.has("dermis_profile");
  if (const auto name = reader.string("name")) profile.name = *name;
  read_numbers_into(reader, profile);
  if (const auto source = reader.string("source")) profile.source = *source;
  if (!reader.finish()) return std::nullopt;
  derive(profile);
  return profile;
}

std::optional<Profile> read_inline_profile(const Document& document, NodeId object, std::string what,
                                           Diagnostics& diagnostics) {
  Profile profile;
  ObjectReader reader(document, object, std::move(what), diagnostics);
  reader.any("id");
  read_numbers_into(reader, profile);
  if (!reader.finish()) return std::nullopt;
  profile.name = "inline";
  derive(profile);
  return profile;
}

} // namespace dermis::subsurface
