#include "integration/examples/demo_engine/scene/read_scene.hpp"

#include "framegraph/text/file_roots.hpp"
#include "framegraph/text/reader.hpp"
#include "framegraph/text/suggest.hpp"
#include "integration/examples/demo_engine/scene/read_curve.hpp"
#include "integration/examples/demo_engine/scene/scene_state.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>

namespace demo {
namespace {

using dermis::DiagnosticId;
using dermis::Diagnostics;
using dermis::Document;
using dermis::Need;
using dermis::NodeId;
using dermis::ObjectReader;
using std::string_view;

constexpr int64_t format_version = 1;
constexpr size_t max_lights = 8, max_objects = 256, max_profiles = 255, max_cuts = 256;
constexpr ValueRange places = {-1000.0, 1000.0}; // metres
constexpr ValueRange degrees = {-3600.0, 3600.0};
constexpr ValueRange intensities = {0.0, 1e6};

constexpr std::array<string_view, 2> projections = {"perspective", "orthographic"};
constexpr std::array<string_view, 3> light_types = {"directional", "point", "spot"};
constexpr std::array<string_view, 8> shapes = {"bust",   "ear",   "knot", "candle",
                                               "sphere", "plane", "box",  "model"};
constexpr std::array<string_view, 6> patterns = {"plain", "skin",    "jade",
                                                 "wax",   "plaster", "checker"};

struct SceneReader {
  const Document& document;
  Diagnostics& diagnostics;
  Scene& scene;
  std::filesystem::path folder;
  std::vector<std::filesystem::path> roots; // folders below which profiles may be read
  bool profiles_read = true; // false: unknown names of profiles are no errors of their own

  static bool always_equal(const Curve<glm::dvec3>& a, const Curve<glm::dvec3>& b) {
    return a.keys.size() == 1 && b.keys.size() == 1 && a.amplitude == 0 && b.amplitude == 0 &&
           a.keys.front().value == b.keys.front().value;
  }

  void curve(ObjectReader& object, string_view key, const ValueRange& range, Need need,
             auto& out) const {
    read_curve(object, key, range, need, document, diagnostics, out);
  }
  static void color(ObjectReader& object, string_view key, double maximum, glm::dvec3& out) {
    std::array<double, 3> rgb{};
    if (object.numbers(key, rgb, 0.0, maximum, Need::optional)) out = {rgb[0], rgb[1], rgb[2]};
  }
  static void number(ObjectReader& object, string_view key, double minimum, double maximum,
                     double& out) {
    if (const auto value = object.number(key, minimum, maximum, Need::optional)) out = *value;
  }

  void read_profiles(NodeId list) {
    for (const NodeId node : dermis::children(document, list)) {
      ObjectReader object(document, node, fmt::format("profile {}", scene.profiles.size()),
                          diagnostics);
      const auto name = object.name("name");
      const auto file = object.string("file");
      SceneProfile profile;
      if (object.finish()) {
        const dermis::PlacedFile placed = dermis::place_file(folder, *file, roots);
        if (!placed.problem.empty())
          diagnostics.add(DiagnosticId::outside_root, document.where(document.find(node, "file")),
                          fmt::format("profile '{}' is not read: {}", *file, placed.problem));
        profile = {std::string(*name), placed.path.string()};
      }
      for (const SceneProfile& other : scene.profiles)
        if (!profile.name.empty() && other.name == profile.name)
          diagnostics.add(DiagnosticId::scene_profile, document.where(node),
                          fmt::format("two profiles are called '{}'", profile.name));
      scene.profiles.push_back(profile);
    }
  }

  void read_camera(NodeId node) {
    ObjectReader object(document, node, "the camera", diagnostics);
    Camera& camera = scene.camera;
    camera.orthographic = object.word("projection", projections, Need::optional).value_or(0) == 1;
    curve(object, "position", places, Need::required, camera.position);
    curve(object, "target", places, Need::required, camera.target);
    if (camera.orthographic)
      curve(object, "height", {1e-4, 1000.0}, Need::required, camera.height);
    else
      curve(object, "vertical_fov", {1.0, 150.0}, Need::required, camera.vertical_fov);
    number(object, "pixel_aspect", 0.125, 8.0, camera.pixel_aspect);
    number(object, "near", 1e-4, 100.0, camera.near_plane);
    number(object, "far", 1e-3, 1e5, camera.far_plane);
    const bool read = object.finish();
    if (read && always_equal(camera.position, camera.target))
      diagnostics.add(DiagnosticId::scene_range, document.where(node),
                      "the camera's position and target are equal, so it has no direction");
    if (read && camera.near_plane >= camera.far_plane)
      diagnostics.add(
          DiagnosticId::scene_range, document.where(node),
          fmt::format("the camera's near plane ({} m) must be nearer than its far plane ({} m)",
                      camera.near_plane, camera.far_plane));
  }

  void read_cuts(NodeId list) {
    for (const NodeId node : dermis::children(document, list)) {
      const auto seconds =
          dermis::read_number(document, node, fmt::format("cut {}", scene.cuts.size()), 0.0,
                              longest_seconds, diagnostics);
      if (!seconds) return;
      if (!scene.cuts.empty() && *seconds <= scene.cuts.back())
        diagnostics.add(
            DiagnosticId::scene_range, document.where(node),
            fmt::format("cut {} is at {} s; times ascend", scene.cuts.size(), *seconds));
      scene.cuts.push_back(*seconds);
    }
  }

  void read_light(NodeId node) {
    ObjectReader object(document, node, fmt::format("light {}", scene.lights.size()), diagnostics);
    Light light;
    light.type = static_cast<LightType>(object.word("type", light_types).value_or(0));
    curve(object, "position", places, Need::required, light.position);
    if (light.type != LightType::point)
      curve(object, "target", places, Need::required, light.target);
    color(object, "color", 1.0, light.color);
    curve(object, "intensity", intensities, Need::required, light.intensity);
    if (light.type == LightType::spot) {
      number(object, "angle", 1.0, 170.0, light.angle);
      number(object, "penumbra", 0.1, 90.0, light.penumbra);
    }
    if (light.type == LightType::directional) number(object, "extent", 0.01, 1000.0, light.extent);
    light.shadow = object.boolean("shadow", Need::optional).value_or(true);
    if (object.finish() && light.type != LightType::point &&
        always_equal(light.position, light.target))
      diagnostics.add(DiagnosticId::scene_range, document.where(node),
                      fmt::format("the position and target of light {} are equal, so it has no "
                                  "direction",
                                  scene.lights.size()));
    scene.lights.push_back(light);
  }

  void read_object(NodeId node) {
    ObjectReader object(document, node, fmt::format("object {}", scene.objects.size()),
                        diagnostics);
    Object made;
    if (const auto name = object.name("name", Need::optional)) made.name = *name;
    made.shape = static_cast<Shape>(object.word("shape", shapes).value_or(0));
    curve(object, "position", places, Need::optional, made.position);
    curve(object, "rotation", degrees, Need::optional, made.rotation);
    std::array<double, 3> scale{1.0, 1.0, 1.0};
    object.numbers("scale", scale, 1e-4, 1e4, Need::optional);
    made.scale = {scale[0], scale[1], scale[2]};
    color(object, "albedo", 1.0, made.albedo);
    number(object, "roughness", 0.05, 1.0, made.roughness);
    number(object, "reflectance", 0.0, 1.0, made.reflectance);
    number(object, "emission", 0.0, 16.0, made.emission);
    made.pattern =
        static_cast<Pattern>(object.word("pattern", patterns, Need::optional).value_or(0));
    made.casts_shadow = object.boolean("shadow", Need::optional).value_or(true);
    if (const auto name = object.string("profile", Need::optional)) {
      for (uint32_t i = 0; i < scene.profiles.size(); ++i)
        if (scene.profiles[i].name == *name) made.profile = i + 1;
      if (made.profile == 0 && profiles_read) {
        std::vector<std::string_view> known;
        for (const SceneProfile& one : scene.profiles)
          known.push_back(one.name);
        diagnostics.add(DiagnosticId::scene_profile, document.where(document.find(node, "profile")),
                        fmt::format("there is no profile '{}'; the scene lists {}", *name,
                                    known.empty() ? "none" : dermis::list_words(known)));
      }
    }
    object.finish();
    scene.objects.push_back(made);
  }

  void read_root() {
    ObjectReader object(document, document.root(), "the scene", diagnostics);
    object.has("dermis_scene"); // its value was checked before
    if (const auto name = object.name("name")) scene.name = *name;
    number(object, "frames_per_second", 1.0, 1000.0, scene.frames_per_second);
    number(object, "exposure", 1e-6, 1e6, scene.exposure);
    color(object, "background", 1000.0, scene.background);
    color(object, "sky", 1000.0, scene.sky);
    color(object, "ground", 1000.0, scene.ground);
    const NodeId profiles = object.array("profiles", 0, max_profiles, Need::optional);
    const NodeId camera = object.object("camera");
    const NodeId cuts = object.array("cuts", 0, max_cuts, Need::optional);
    const NodeId lights = object.array("lights", 0, max_lights, Need::optional);
    const NodeId objects = object.array("objects", 1, max_objects);
    object.finish();
    profiles_read = profiles.valid() || !document.find(document.root(), "profiles").valid();
    const size_t problems = diagnostics.list.size();
    if (profiles.valid()) read_profiles(profiles);
    profiles_read = profiles_read && diagnostics.list.size() == problems;
    if (camera.valid()) read_camera(camera);
    if (cuts.valid()) read_cuts(cuts);
    if (lights.valid())
      for (const NodeId node : dermis::children(document, lights))
        read_light(node);
    uint32_t layers = 0;
    for (const Light& light : scene.lights)
      layers += shadow_layers_of(light);
    if (layers > max_shadow_layers)
      diagnostics.add(
          DiagnosticId::scene_range, document.where(lights),
          fmt::format(
              "the lights need {} shadow maps (6 a point light, 1 each other); at most {} fit",
              layers, max_shadow_layers));
    if (objects.valid())
      for (const NodeId node : dermis::children(document, objects))
        read_object(node);
  }
};

std::optional<Scene> read_scene_document(const std::string& name, const Document& document,
                                         Diagnostics& diagnostics,
                                         std::span<const std::string> roots) {
  if (!dermis::check_version(document, "dermis_scene", format_version, diagnostics))
    return std::nullopt;
  const uint32_t errors = diagnostics.count(dermis::Severity::error);
  Scene scene;
  SceneReader reader{document,
                     diagnostics,
                     scene,
                     std::filesystem::path(name).parent_path(),
                     {dermis::home_of(name)}};
  reader.roots.insert(reader.roots.end(), roots.begin(), roots.end());
  reader.read_root();
  if (diagnostics.count(dermis::Severity::error) != errors) return std::nullopt;
  return scene;
}

} // namespace

std::optional<Scene> read_scene(const std::string& path, Diagnostics& diagnostics,
                                std::span<const std::string> roots) {
  const auto document = dermis::read_document(path, diagnostics);
  return document ? read_scene_document(path, *document, diagnostics, roots) : std::nullopt;
}

std::optional<Scene> parse_scene(const std::string& name, std::string text,
                                 Diagnostics& diagnostics, std::span<const std::string> roots) {
  const auto document = dermis::parse_document(name, std::move(text), diagnostics);
  return document ? read_scene_document(name, *document, diagnostics, roots) : std::nullopt;
}

} // namespace demo
