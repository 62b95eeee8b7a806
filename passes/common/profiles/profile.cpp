#include "passes/common/profiles/profile.hpp"

#include "framegraph/text/reader.hpp"
#include "passes/common/profiles/burley_profile.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::subsurface {

namespace {

constexpr std::string_view model_names[] = {"burley", "dipole", "artist"};
constexpr std::string_view scaling_names[] = {"searchlight", "diffuse_surface"};

struct ModelKey {
  std::string_view key;
  ProfileModel model;
};
constexpr ModelKey model_keys[] = {
    {"dmfp_mm", ProfileModel::burley},
    {"mfp_mm", ProfileModel::burley},
    {"scaling", ProfileModel::burley},
    {"albedo", ProfileModel::burley},
    {"sigma_a_per_mm", ProfileModel::dipole},
    {"sigma_s_prime_per_mm", ProfileModel::dipole},
    {"eta", ProfileModel::dipole},
    {"falloff", ProfileModel::artist},
    {"strength", ProfileModel::artist},
};

std::string_view name_of(ProfileModel model) {
  return model_names[static_cast<size_t>(model)];
}

// Converts a mean free path inside the material to the one on the surface that gives the same d.
void read_burley(const Document& document, ObjectReader& reader, Profile& profile,
                 Diagnostics& diagnostics) {
  const NodeId dmfp = document.find(reader.node(), "dmfp_mm"),
               mfp = document.find(reader.node(), "mfp_mm");
  const NodeId scaling_key = document.find(reader.node(), "scaling");
  const bool inside = mfp.valid();
  std::array<double, 3> length{};
  if (inside)
    reader.numbers("mfp_mm", length, 0.0, largest_mfp_mm);
  else
    reader.numbers("dmfp_mm", length, 0.0, largest_dmfp_mm);
  reader.numbers("albedo", profile.albedo, 0.0, 1.0);
  const bool diffuse = reader.word("scaling", scaling_names, Need::optional).value_or(0) == 1;
  if (inside && dmfp.valid()) {
    reader.has("dmfp_mm");
    diagnostics
        .add(DiagnosticId::profile_keys, document.where(mfp),
             "'dmfp_mm' and 'mfp_mm' both define the distance that light travels; give only one")
        .related.emplace_back(document.where(dmfp), "the other key is here");
  } else if (!inside && scaling_key.valid()) {
    diagnostics.add(DiagnosticId::profile_keys, document.where(scaling_key),
                    "'scaling' is only allowed with 'mfp_mm', not with 'dmfp_mm'");
  }
  for (size_t c = 0; c < 3; ++c) {
    const double a = profile.albedo[c];
    const double s = diffuse ? burley_scaling_diffuse(a) : burley_scaling_searchlight(a);
    profile.dmfp_mm[c] = inside ? length[c] / s * burley_scaling_dmfp(a) : length[c];
  }
}

// Returns false if the object has keys of two models.
bool read_numbers_into(const Document& document, ObjectReader& reader, Profile& profile,
                       Diagnostics& diagnostics) {
  const uint64_t errors = diagnostics.errors();
  profile.model =
      static_cast<ProfileModel>(reader.word("model", model_names, Need::optional).value_or(0));
  for (const ModelKey& known : model_keys) {
    const NodeId node = document.find(reader.node(), known.key);
    if (known.model == profile.model || !node.valid()) continue;
    reader.has(known.key);
    diagnostics.add(
        DiagnosticId::profile_keys, document.where(node),
        fmt::format("'{}' belongs to the model \"{}\", but this profile's model is \"{}\"",
                    known.key, name_of(known.model), name_of(profile.model)));
  }
  switch (profile.model) {
  case ProfileModel::burley:
    read_burley(document, reader, profile, diagnostics);
    break;
  case ProfileModel::dipole:
    reader.numbers("sigma_a_per_mm", profile.sigma_a, min_coefficient, largest_coefficient);
    reader.numbers("sigma_s_prime_per_mm", profile.sigma_s_prime, min_coefficient,
                   largest_coefficient);
    profile.eta =
        reader.number("eta", 1.0, largest_eta, Need::optional).value_or(dipole_default_eta);
    break;
  case ProfileModel::artist:
    reader.numbers("falloff", profile.falloff, 0.0, largest_falloff);
    reader.numbers("strength", profile.strength, 0.0, 1.0);
    break;
  }
  return diagnostics.errors() == errors;
}

std::string three(const std::array<double, 3>& values) {
  return fmt::format("[{}, {}, {}]", values[0], values[1], values[2]);
}

} // namespace

void derive(Profile& profile) {
  for (size_t c = 0; c < 3; ++c) {
    ChannelShape& shape = profile.shape_mm[c];
    switch (profile.model) {
    case ProfileModel::burley:
      if (profile.dmfp_mm[c] < smallest_dmfp_mm) profile.dmfp_mm[c] = 0;
      shape = burley_shape(burley_d_from_dmfp(profile.dmfp_mm[c], profile.albedo[c]));
      break;
    case ProfileModel::dipole:
      shape = dipole_shape(profile.sigma_a[c], profile.sigma_s_prime[c], profile.eta);
      profile.dmfp_mm[c] = 1 / shape.dipole.sigma_tr;
      profile.albedo[c] = dipole_albedo(profile.sigma_a[c], profile.sigma_s_prime[c], profile.eta);
      break;
    case ProfileModel::artist:
      shape = artist_shape(artist_width(profile.falloff[c]), profile.strength[c]);
      break;
    }
    profile.d_mm[c] = shape.d;
  }
  profile.widest = static_cast<int>(std::max_element(profile.d_mm.begin(), profile.d_mm.end()) -
                                    profile.d_mm.begin());
}

std::optional<Profile> read_profile(const Document& document, Diagnostics& diagnostics) {
  if (!expect_kind(document, document.root(), "a profile file", NodeKind::object, diagnostics) ||
      !check_version(document, "dermis_profile", profile_format_version, diagnostics))
    return std::nullopt;
  Profile profile;
  ObjectReader reader(document, document.root(), "profile", diagnostics);
  reader.has("dermis_profile");
  if (const auto name = reader.string("name")) profile.name = *name;
  const bool good = read_numbers_into(document, reader, profile, diagnostics);
  if (const auto source = reader.string("source")) profile.source = *source;
  if (!reader.finish() || !good) return std::nullopt;
  derive(profile);
  return profile;
}

std::optional<Profile> read_inline_profile(const Document& document, NodeId object,
                                           std::string what, Diagnostics& diagnostics) {
  Profile profile;
  ObjectReader reader(document, object, std::move(what), diagnostics);
  reader.any("id");
  const bool good = read_numbers_into(document, reader, profile, diagnostics);
  if (!reader.finish() || !good) return std::nullopt;
  profile.name = "inline";
  derive(profile);
  return profile;
}

std::string profile_members(const Profile& profile) {
  switch (profile.model) {
  case ProfileModel::dipole:
    return fmt::format(
        R"("model": "dipole", "sigma_a_per_mm": {}, "sigma_s_prime_per_mm": {}, "eta": {})",
        three(profile.sigma_a), three(profile.sigma_s_prime), profile.eta);
  case ProfileModel::artist:
    return fmt::format(R"("model": "artist", "falloff": {}, "strength": {})",
                       three(profile.falloff), three(profile.strength));
  case ProfileModel::burley:
    break;
  }
  return fmt::format(R"("dmfp_mm": {}, "albedo": {})", three(profile.dmfp_mm),
                     three(profile.albedo));
}

std::string describe_profile(const Profile& profile) {
  const auto row = [](const std::array<double, 3>& v) {
    return fmt::format("{:.3g} {:.3g} {:.3g}", v[0], v[1], v[2]);
  };
  std::string text = fmt::format("{} ({})", profile.name, name_of(profile.model));
  if (profile.model == ProfileModel::artist)
    text += fmt::format(": falloff {}, strength {}", row(profile.falloff), row(profile.strength));
  else
    text += fmt::format(": dmfp {} mm, A {}", row(profile.dmfp_mm), row(profile.albedo));
  return text + fmt::format(", d {} mm", row(profile.d_mm));
}

} // namespace dermis::subsurface
