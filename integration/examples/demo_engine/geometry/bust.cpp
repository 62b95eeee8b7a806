#include "integration/examples/demo_engine/geometry/bust.hpp"

#include "integration/examples/demo_engine/geometry/surface_nets.hpp"

namespace demo {
namespace {

using glm::vec3;

// All numbers below are in centimetres, chosen by eye after the canon of a 24 cm head (eyes at half
// the height, nose and brow a third of the face each).

vec3 turned_y(const vec3& p, float radians) {
  const float c = std::cos(radians), s = std::sin(radians);
  return {c * p.x + s * p.z, p.y, -s * p.x + c * p.z};
}

vec3 turned_x(const vec3& p, float radians) {
  const float c = std::cos(radians), s = std::sin(radians);
  return {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
}

vec3 turned_z(const vec3& p, float radians) {
  const float c = std::cos(radians), s = std::sin(radians);
  return {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
}

float skull(const vec3& q) {
  float d = ellipsoid(q, vec3(0.0f, 3.4f, -1.0f), vec3(7.2f, 8.1f, 9.2f));
  // forehead
  d = soft_union(d, ellipsoid(q, vec3(0.0f, 3.2f, 3.2f), vec3(6.1f, 5.5f, 5.3f)), 2.5f);
  d = soft_union(d, ellipsoid(q, vec3(0.0f, -3.6f, 2.0f), vec3(6.2f, 7.0f, 6.3f)), 2.5f); // face
  d = soft_union(d, round_cone(q, vec3(5.0f, -2.6f, -0.6f), vec3(4.6f, -6.9f, 0.6f), 1.6f, 1.4f),
                 2.4f); // jaw
  d = soft_union(d, round_cone(q, vec3(4.6f, -6.9f, 0.6f), vec3(1.3f, -10.2f, 6.0f), 1.5f, 1.5f),
                 2.4f);
  d = soft_union(d, ellipsoid(q, vec3(0.0f, -10.4f, 6.7f), vec3(1.8f, 1.4f, 1.5f)), 1.8f); // chin
  // cheekbone
  d = soft_union(d, ellipsoid(q, vec3(4.3f, -2.5f, 4.9f), vec3(1.7f, 1.3f, 1.9f)), 2.6f);
  d = soft_union(d, ellipsoid(q, vec3(3.2f, -5.0f, 5.7f), vec3(1.9f, 2.6f, 1.7f)), 2.4f); // cheek
  // temple
  d = soft_difference(d, ellipsoid(q, vec3(7.9f, 1.4f, 4.6f), vec3(1.2f, 2.2f, 2.6f)), 2.4f);
  return d;
}

float with_eyes(float d, const vec3& q) {
  // brow
  d = soft_union(d, round_cone(q, vec3(1.2f, 2.0f, 7.9f), vec3(4.9f, 2.3f, 6.1f), 0.75f, 0.6f),
                 1.6f);
  // socket
  d = soft_difference(d, ellipsoid(q, vec3(3.1f, 0.3f, 8.8f), vec3(2.1f, 1.35f, 1.9f)), 1.2f);
  // Closed lids over the ball. They meet below its middle in a line that falls towards the outer
  // corner.
  const vec3 e = q - vec3(3.15f, 0.0f, 6.3f);
  d = soft_union(d, ellipsoid(e, vec3(0.0f), vec3(1.60f, 1.32f, 1.40f)), 0.5f);
  const float line = -0.46f - 0.05f * e.x + 0.085f * e.x * e.x;
  d = soft_difference(
      d, ellipsoid(vec3(e.x, e.y - line, e.z - 1.30f), vec3(0.0f), vec3(1.62f, 0.055f, 0.30f)),
      0.14f);
  // The upper lid protrudes slightly over the lower lid.
  d = soft_union(d,
                 ellipsoid(vec3(e.x, e.y - line - 0.13f, e.z - 1.17f + 0.16f * e.x * e.x),
                           vec3(0.0f), vec3(1.40f, 0.11f, 0.14f)),
                 0.12f);
  const float fold =
      torus(e, vec3(0.0f, 0.10f, 0.10f), glm::normalize(vec3(0.0f, 0.86f, -0.50f)), 1.52f, 0.05f);
  if (e.y > 0.2f) d = soft_difference(d, fold, 0.28f); // above the upper lid
  return d;
}

float with_nose(float d, const vec3& q) {
  // Bridge and back form one wedge: a ridge in front, with flanks that run into the cheeks.
  d = soft_union(d, round_cone(q, vec3(0.0f, 1.9f, 7.7f), vec3(0.0f, -3.2f, 8.0f), 0.9f, 1.5f),
                 1.5f);
  float nose = round_cone(q, vec3(0.0f, 1.2f, 8.25f), vec3(0.0f, -3.85f, 10.65f), 0.62f, 0.86f);
  // tip
  nose =
      soft_union(nose, ellipsoid(q, vec3(0.40f, -4.0f, 10.70f), vec3(0.62f, 0.64f, 0.66f)), 0.5f);
  nose = soft_union(
      nose, round_cone(q, vec3(0.0f, -4.55f, 10.6f), vec3(0.0f, -5.05f, 8.9f), 0.42f, 0.5f), 0.5f);
  // wing
  nose =
      soft_union(nose, ellipsoid(q, vec3(1.25f, -4.40f, 9.35f), vec3(0.74f, 0.76f, 1.15f)), 0.7f);
  d = soft_union(d, nose, 1.0f);
  d = soft_difference(d,
                      ellipsoid(turned_z(q - vec3(0.76f, -5.08f, 9.8f), 0.35f), vec3(0.0f),
                                vec3(0.34f, 0.5f, 0.7f)),
                      0.25f); // nostril
  return d;
}

float upper_lip(const vec3& q) {
  return ellipsoid(turned_z(q - vec3(0.85f, -6.93f, 8.28f), 0.20f), vec3(0.0f),
                   vec3(1.45f, 0.46f, 0.62f));
}

float lower_lip(const vec3& q) {
  return ellipsoid(q, vec3(0.0f, -7.78f, 8.22f), vec3(1.80f, 0.56f, 0.66f));
}

// Returns the height of the line between the lips, which dips in the middle and at the corners.
float mouth_line(float x) {
  return -7.36f + 0.07f * std::cos(x * 2.6f) - 0.02f * x * x;
}

float with_mouth(float d, const vec3& q) {
  d = soft_union(d, ellipsoid(q, vec3(0.0f, -7.0f, 6.1f), vec3(3.3f, 2.7f, 2.55f)), 1.8f);
  d = soft_difference(
      d, round_cone(q, vec3(0.0f, -5.6f, 9.45f), vec3(0.0f, -6.3f, 9.30f), 0.34f, 0.38f), 0.5f);
  d = soft_union(d, soft_union(upper_lip(q), lower_lip(q), 0.15f), 0.8f);
  const vec3 slit(q.x, q.y - mouth_line(q.x), q.z - 9.0f + 0.10f * q.x * q.x);
  d = soft_difference(d, ellipsoid(slit, vec3(0.0f), vec3(2.40f, 0.06f, 0.42f)), 0.30f);
  d = soft_difference(d, sphere(q, vec3(2.55f, -7.38f, 8.45f), 0.22f), 0.7f); // corner
  d = soft_difference(d, ellipsoid(q, vec3(0.0f, -8.95f, 9.25f), vec3(1.6f, 0.5f, 0.9f)),
                      0.9f); // below the lip
  return d;
}

// Returns a thin shell: an oval plate with a rolled rim, hollow towards the front.
float ear(const vec3& q) {
  vec3 p = turned_y(q - vec3(6.75f, -0.9f, -1.0f), 0.42f);
  p = turned_x(p, -0.14f);
  const float oval = glm::length(glm::vec2(p.y / 3.15f, p.z / (1.85f + 0.22f * p.y / 3.15f)));
  float d = ellipsoid(p, vec3(0.25f, 0.0f, 0.0f), vec3(0.42f, 3.0f, 1.8f));
  // Rim: distance to the oval's outline, opened at the lower front.
  const float outline = (oval - 0.93f) * 1.9f;
  const float bow = p.x - 0.62f + 0.25f * oval;
  const float rim = std::sqrt(outline * outline + bow * bow) - 0.27f;
  const float front = smooth_step(0.6f, 1.6f, p.z) * smooth_step(0.5f, -1.0f, p.y);
  d = soft_union(d, rim + 0.6f * front, 0.25f);
  const float fold = torus(p, vec3(0.55f, 0.15f, 0.25f), vec3(1.0f, 0.0f, 0.0f), 1.15f, 0.22f);
  d = soft_union(d, fold + 1.2f * smooth_step(-0.2f, 0.8f, p.z), 0.25f);
  // lobe
  d = soft_union(d, ellipsoid(p, vec3(0.35f, -2.85f, 0.55f), vec3(0.42f, 0.85f, 0.75f)), 0.4f);
  // tragus
  d = soft_union(d, ellipsoid(p, vec3(0.35f, -0.7f, 1.55f), vec3(0.45f, 0.6f, 0.35f)), 0.35f);
  d = soft_union(d, ellipsoid(p, vec3(-0.35f, -0.4f, 0.7f), vec3(0.7f, 1.9f, 0.9f)), 0.5f); // root
  d = soft_difference(d, ellipsoid(p, vec3(0.85f, -0.55f, 0.55f), vec3(0.75f, 1.15f, 0.85f)),
                      0.25f); // concha
  d = soft_difference(d, ellipsoid(p, vec3(0.95f, 1.6f, 0.35f), vec3(0.55f, 0.8f, 0.75f)), 0.25f);
  return d;
}

float torso(const vec3& q) {
  float d = round_cone(q, vec3(0.0f, -7.0f, -2.6f), vec3(0.0f, -18.0f, -4.0f), 5.1f, 5.7f); // neck
  d = soft_union(d, round_cone(q, vec3(5.2f, -6.0f, -2.6f), vec3(1.3f, -18.2f, 1.6f), 1.1f, 0.9f),
                 1.6f);
  d = soft_union(d, sphere(q, vec3(0.0f, -12.9f, 2.4f), 0.9f), 1.2f); // larynx
  float chest = ellipsoid(q, vec3(0.0f, -29.0f, -4.2f), vec3(17.5f, 12.0f, 9.2f));
  // shoulder
  chest = soft_union(chest, ellipsoid(q, vec3(15.5f, -24.0f, -4.8f), vec3(5.6f, 5.2f, 5.4f)), 4.0f);
  chest = soft_union(
      chest, round_cone(q, vec3(3.0f, -14.5f, -6.0f), vec3(13.0f, -20.5f, -5.5f), 3.2f, 3.0f),
      3.5f);
  // breast
  chest = soft_union(chest, ellipsoid(q, vec3(6.0f, -28.0f, 2.2f), vec3(7.0f, 5.5f, 3.2f)), 3.0f);
  d = soft_union(d, chest, 3.2f);
  d = soft_union(d, round_cone(q, vec3(1.9f, -19.3f, 2.2f), vec3(12.0f, -18.9f, -2.6f), 0.8f, 0.6f),
                 2.2f);                                                    // collar
  d = soft_difference(d, sphere(q, vec3(0.0f, -18.6f, 3.6f), 0.9f), 1.0f); // hollow of the throat
  // The classical cut: an oval that narrows below, with hollow arms.
  const float cut = ellipsoid(q, vec3(0.0f, -14.0f, -2.0f), vec3(18.8f, 19.0f, 15.0f));
  d = soft_intersection(d, cut, 0.8f);
  return d;
}

// Returns the distance of the foot, a turned base under the cut.
float foot(const vec3& q) {
  const float across = glm::length(glm::vec2(q.x, q.z + 2.6f));
  const float waist =
      4.2f + 2.6f * smooth_step(-34.0f, -38.5f, q.y) + 2.0f * smooth_step(-33.0f, -30.0f, q.y);
  return soft_intersection(across - waist, std::abs(q.y + 34.0f) - 5.0f, 0.6f) * 0.8f;
}

// Returns the strength at q of a soft mark around `center`.
float mark(const vec3& q, const vec3& center, const vec3& radii) {
  const float r = glm::length((q - center) / radii);
  return std::exp(-r * r);
}

struct Paint {
  vec3 tint;
  float gloss;
};

Paint paint_at(const vec3& p) {
  const vec3 q(std::abs(p.x), p.y, p.z);
  const float on_lip = smooth_step(0.16f, -0.02f, std::min(upper_lip(q), lower_lip(q)) + 0.05f) *
                       smooth_step(7.6f, 8.1f, q.z);
  const float red = 0.55f * mark(q, vec3(4.2f, -3.2f, 7.0f), vec3(2.3f, 1.9f, 3.0f)) +
                    0.50f * mark(q, vec3(0.0f, -4.3f, 11.0f), vec3(1.9f, 1.4f, 1.6f)) +
                    0.70f * mark(q, vec3(7.8f, -0.8f, -1.5f), vec3(1.3f, 3.6f, 2.6f)) +
                    0.25f * mark(q, vec3(0.0f, -10.8f, 8.0f), vec3(2.2f, 1.2f, 1.6f));
  vec3 tint = glm::mix(vec3(1.0f), vec3(1.02f, 0.74f, 0.70f), std::min(red, 1.0f));
  tint = glm::mix(tint, vec3(0.86f, 0.47f, 0.45f), 0.85f * on_lip);
  // Brows, and the shade of lashes along the line of the lids.
  const float brow = round_cone(q, vec3(1.5f, 2.05f, 8.6f), vec3(4.8f, 2.55f, 6.6f), 0.28f, 0.12f);
  tint = glm::mix(tint, vec3(0.50f, 0.42f, 0.38f), 0.85f * smooth_step(0.40f, 0.0f, brow));
  const vec3 e = q - vec3(3.15f, 0.0f, 6.3f);
  const float lash =
      std::abs(e.y + 0.46f + 0.05f * e.x - 0.085f * e.x * e.x) / 0.12f + std::abs(e.x) / 1.9f;
  tint = glm::mix(tint, vec3(0.45f, 0.36f, 0.33f),
                  0.8f * smooth_step(1.0f, 0.3f, lash) * smooth_step(0.6f, 1.0f, e.z));
  return {tint, 1.0f + 1.2f * on_lip};
}

} // namespace

float bust_distance(const vec3& p) {
  const vec3 q(std::abs(p.x), p.y, p.z);
  float d = torso(q);
  if (p.y > -19.0f) {
    float head = skull(q);
    head = with_mouth(with_nose(with_eyes(head, q), q), q);
    head = soft_union(head, ear(q), 0.6f);
    d = soft_union(d, head, 1.6f);
  }
  return std::min(d, foot(p));
}

Mesh make_bust(float spacing) {
  constexpr float occlusion_reach = 3.0f; // covers sockets, nostrils and the shade under the chin
  // Places planes densely at the features and sparsely on the shoulders.
  const auto graded = [&](float fine_low, float fine_high, float fine, float coarse) {
    return [=](float at) {
      const float away = std::max({fine_low - at, at - fine_high, 0.0f});
      return spacing * std::min(coarse, fine + 0.12f * away);
    };
  };
  GridPlanes planes;
  const std::vector<float> right = place_planes(0.0f, 21.0f, graded(-4.0f, 8.2f, 0.18f, 0.8f));
  for (size_t i = right.size(); i-- > 1;)
    planes.x.push_back(-right[i]);
  planes.x.insert(planes.x.end(), right.begin(), right.end());
  planes.y = place_planes(-40.0f, 13.0f, graded(-8.3f, 0.5f, 0.14f, 0.9f));
  planes.z = place_planes(-14.5f, 12.5f, graded(7.2f, 11.0f, 0.17f, 0.5f));
  Mesh mesh = mesh_field(bust_distance, planes, occlusion_reach);
  for (Vertex& vertex : mesh.vertices) {
    const Paint paint = paint_at(vertex.position);
    vertex.tint = paint.tint;
    vertex.gloss = paint.gloss;
    vertex.position *= 0.01f;
  }
  return mesh;
}

} // namespace demo
