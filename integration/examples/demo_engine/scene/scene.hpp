#pragma once
// The content of a scene over time. Metres, seconds, degrees; x right, y up, right-handed; colours
// are linear Rec. 709.

#include "integration/examples/demo_engine/scene/curve.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace demo {

struct Camera {
  bool orthographic = false;
  Curve<glm::dvec3> position{glm::dvec3(0, 0, 1)}, target{glm::dvec3(0, 0, 0)};
  Curve<double> vertical_fov{25.0}; // degrees; perspective
  Curve<double> height{1.0};        // height of the view in metres; orthographic
  double pixel_aspect = 1.0;        // width / height of a pixel
  double zoom = 1.0;                // the view is narrower by this factor
  double near_plane = 0.05, far_plane = 20.0;
};

enum class LightType : uint8_t { directional, point, spot };

// A light. An intensity of 1 gives a white diffuse surface that faces the light a radiance of 1:
// anywhere for a directional light, at a distance of 1 m for the others.
struct Light {
  LightType type = LightType::directional;
  Curve<glm::dvec3> position{glm::dvec3(0, 1, 0)}, target{glm::dvec3(0, 0, 0)};
  glm::dvec3 color{1.0};
  Curve<double> intensity{1.0};
  double angle = 40.0;   // full cone, degrees; spot
  double penumbra = 4.0; // width of the soft edge, degrees
  double extent = 1.0;   // half size of the shadowed square around target, metres; directional
  bool shadow = true;
};

enum class Shape : uint8_t { bust, ear, knot, candle, sphere, plane, box, model };
// values as in gbuffer.frag
enum class Pattern : uint32_t { plain, skin, jade, wax, plaster, checker };

struct Object {
  std::string name;
  Shape shape = Shape::sphere;
  Curve<glm::dvec3> position, rotation; // rotation: degrees about x, then y, then z
  glm::dvec3 scale{1.0};
  uint32_t profile = 0; // 0 = none, else 1 + index into Scene::profiles
  glm::dvec3 albedo{0.8};
  double roughness = 0.5, reflectance = 0.04;
  double emission = 0.0; // factor on albedo
  Pattern pattern = Pattern::plain;
  bool casts_shadow = true;
};

struct SceneProfile {
  std::string name, file; // path as it can be opened
};

struct Scene {
  std::string name;
  double frames_per_second = 25.0;
  double exposure = 1.0;
  // sky, ground: ambient light from above and below
  glm::dvec3 background{0.0}, sky{0.0}, ground{0.0};
  std::vector<SceneProfile> profiles; // at most 255
  Camera camera;
  std::vector<double> cuts;    // seconds, ascending, at most 256: the camera jumps at these times
  std::vector<Light> lights;   // at most 8
  std::vector<Object> objects; // at most 256
};

} // namespace demo
