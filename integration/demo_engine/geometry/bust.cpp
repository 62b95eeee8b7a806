#include "integration/demo_engine/geometry/bust.hpp"

#include "integration/demo_engine/geometry/surface_nets.hpp"

namespace demo {
namespace {

using glm::vec3;

// All numbers below are a sculptor's: centimetres, chosen by eye against the canon of a 24 cm head
// (eyes at half the height, nose and brow a third of the face each).

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
  float d = ellipsoid(q, vec3(0.0f, 3.6f, -1.0f), vec3(7.3f, 8.3f, 9.2f));
  d = soft_union(d, ellipsoid(q, vec3(0.0f, 3.6f, 3.2f), vec3(6.2f, 5.6f, 5.3f)), 2.5f);  // forehead
  d = soft_union(d, ellipsoid(q, vec3(0.0f, -3.6f, 2.0f), vec3(6.2f, 7.0f, 6.2f)), 2.5f); // face
  d = soft_union(d, round_cone(q, vec3(5.3f, -3.0f, -0.6f), vec3(4.7f, -7.0f, 0.6f), 1.5f, 1.4f),
                 2.2f); // jaw
  d = soft_union(d, round_cone(q, vec3(4.7f, -7.0f, 0.6f), vec3(1.3f, -10.3f, 6.0f), 1.5f, 1.5f), 2.2f);
  d = soft_union(d, ellipsoid(q, vec3(0.0f, -10.5f, 6.7f), vec3(1.9f, 1.5f, 1.5f)), 1.6f);    // chin
  d = soft_union(d, ellipsoid(q, vec3(4.5f, -2.3f, 5.3f), vec3(1.9f, 1.5f, 1.9f)), 2.0f);     // cheekbone
  d = soft_union(d, ellipsoid(q, vec3(3.3f, -5.2f, 5.6f), vec3(1.8f, 2.4f, 1.6f)), 2.0f);     // cheek
  d = soft_difference(d, ellipsoid(q, vec3(7.6f, 1.4f, 4.6f), vec3(1.2f, 2.2f, 2.6f)), 2.0f); // temple
  return d;
}

float with_eyes(float d, const vec3& q) {
  d = soft_union(d, round_cone(q, vec3(1.3f, 2.1f, 7.9f), vec3(4.9f, 2.5f, 6.2f), 0.75f, 0.7f), 1.4f); // brow
  d = soft_difference(d, ellipsoid(q, vec3(3.1f, 0.2f, 8.9f), vec3(2.1f, 1.5f, 2.0f)), 1.1f); // socket
  const vec3 center(3.15f, 0.0f, 6.25f);
  const vec3 e = q - center;
  const float ball = glm::length(e) - 1.22f;
  // Lids: a thicker ball, open along a wedge through the corners of the eye; the outer corner is a little
  // higher.
  const vec3 t = turned_z(e, -0.08f);
  const float lids = ellipsoid(e, vec3(0.0f), vec3(1.62f, 1.45f, 1.45f));
  const float upper = t.y * std::cos(0.36f) - t.z * std::sin(0.36f);
  const float lower = -t.y * std::cos(0.30f) - t.z * std::sin(0.30f);
  const float opening = std::max({upper, lower, 0.2f - t.z});
  const float open_lids = soft_difference(lids, opening, 0.12f);
  d = soft_union(d, open_lids, 0.45f);
  // The fold above the upper lid.
  const float fold =
      torus(e, vec3(0.0f, 0.12f, 0.15f), glm::normalize(vec3(0.0f, 0.80f, -0.62f)), 1.62f, 0.10f);
  if (e.y > 0.2f) d = soft_difference(d, fold, 0.22f);
  d = soft_union(d, ball, 0.06f);
  // Iris and pupil cut into the ball, as carvers do, so that the bust looks at someone.
  const vec3 gaze = glm::normalize(vec3(-0.03f, 0.02f, 1.0f));
  d = soft_difference(d, sphere(e, gaze * 1.30f, 0.23f), 0.08f);
  return d;
}

float with_nose(float d, const vec3& q) {
  d = soft_union(d, round_cone(q, vec3(0.0f, 1.7f, 7.9f), vec3(0.0f, -1.6f, 9.5f), 0.72f, 0.72f),
                 1.1f); // bridge
  float nose = round_cone(q, vec3(0.0f, -1.4f, 9.3f), vec3(0.0f, -3.95f, 10.75f), 0.72f, 0.92f);
  nose = soft_union(nose, ellipsoid(q, vec3(0.45f, -4.05f, 10.75f), vec3(0.62f, 0.66f, 0.66f)), 0.5f); // tip
  nose =
      soft_union(nose, round_cone(q, vec3(0.0f, -4.6f, 10.7f), vec3(0.0f, -5.1f, 8.9f), 0.45f, 0.5f), 0.5f);
  nose = soft_union(nose, ellipsoid(q, vec3(1.35f, -4.45f, 9.35f), vec3(0.78f, 0.80f, 1.15f)), 0.55f); // wing
  nose = soft_union(nose, round_cone(q, vec3(0.6f, 0.4f, 7.8f), vec3(1.1f, -3.6f, 8.6f), 0.7f, 0.7f), 1.2f);
  d = soft_union(d, nose, 0.75f);
  d = soft_difference(
      d, ellipsoid(turned_z(q - vec3(0.80f, -5.15f, 9.85f), 0.35f), vec3(0.0f), vec3(0.36f, 0.55f, 0.75f)),
      0.2f); // nostril
  return d;
}

float upper_lip(const vec3& q) {
  return ellipsoid(turned_z(q - vec3(0.95f, -6.95f, 8.55f), 0.16f), vec3(0.0f), vec3(1.45f, 0.52f, 0.75f));
}

float lower_lip(const vec3& q) {
  return ellipsoid(q, vec3(0.0f, -7.95f, 8.45f), vec3(1.75f, 0.62f, 0.80f));
}

float with_mouth(float d, const vec3& q) {
  d = soft_union(d, ellipsoid(q, vec3(0.0f, -7.0f, 6.2f), vec3(3.1f, 2.5f, 2.4f)), 1.6f);
  d = soft_difference(d, round_cone(q, vec3(0.0f, -5.5f, 9.75f), vec3(0.0f, -6.5f, 9.55f), 0.40f, 0.45f),
                      0.5f);
  float lips = soft_union(upper_lip(q), lower_lip(q), 0.05f);
  d = soft_union(d, lips, 0.35f);
  // The line between the lips dips at its ends and in the middle.
  const float line = -7.42f + 0.10f * std::cos(q.x * 2.4f) - 0.05f * q.x * q.x * 0.25f;
  const vec3 slit(q.x, q.y - line, q.z - 9.35f);
  d = soft_difference(d, ellipsoid(slit, vec3(0.0f), vec3(2.35f, 0.10f, 0.95f)), 0.16f);
  d = soft_difference(d, sphere(q, vec3(2.65f, -7.35f, 8.15f), 0.35f), 0.5f); // corner
  d = soft_difference(d, ellipsoid(q, vec3(0.0f, -9.05f, 9.35f), vec3(1.6f, 0.5f, 0.9f)),
                      0.7f); // below the lip
  return d;
}

// A thin shell: an oval plate with a rolled rim, hollowed towards the front.
float ear(const vec3& q) {
  vec3 p = turned_y(q - vec3(7.45f, -0.9f, -1.1f), 0.42f);
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
  d = soft_union(d, ellipsoid(p, vec3(0.35f, -2.85f, 0.55f), vec3(0.42f, 0.85f, 0.75f)), 0.4f); // lobe
  d = soft_union(d, ellipsoid(p, vec3(0.35f, -0.7f, 1.55f), vec3(0.45f, 0.6f, 0.35f)), 0.35f);  // tragus
  d = soft_difference(d, ellipsoid(p, vec3(0.85f, -0.55f, 0.55f), vec3(0.75f, 1.15f, 0.85f)),
                      0.25f); // concha
  d = soft_difference(d, ellipsoid(p, vec3(0.95f, 1.6f, 0.35f), vec3(0.55f, 0.8f, 0.75f)), 0.25f);
  return d;
}

float torso(const vec3& q) {
  float d = round_cone(q, vec3(0.0f, -7.0f, -2.6f), vec3(0.0f, -18.0f, -4.0f), 5.1f, 5.7f); // neck
  d = soft_union(d, round_cone(q, vec3(5.2f, -6.0f, -2.6f), vec3(1.3f, -18.2f, 1.6f), 1.1f, 0.9f), 1.6f);
  d = soft_union(d, sphere(q, vec3(0.0f, -12.9f, 2.4f), 0.9f), 1.2f); // larynx
  float chest = ellipsoid(q, vec3(0.0f, -29.0f, -4.2f), vec3(17.5f, 12.0f, 9.2f));
  chest =
      soft_union(chest, ellipsoid(q, vec3(15.5f, -24.0f, -4.8f), vec3(5.6f, 5.2f, 5.4f)), 4.0f); // shoulder
  chest = soft_union(chest, round_cone(q, vec3(3.0f, -14.5f, -6.0f), vec3(13.0f, -20.5f, -5.5f), 3.2f, 3.0f),
                     3.5f);
  chest = soft_union(chest, ellipsoid(q, vec3(6.0f, -28.0f, 2.2f), vec3(7.0f, 5.5f, 3.2f)), 3.0f); // breast
  d = soft_union(d, chest, 3.2f);
  d = soft_union(d, round_cone(q, vec3(1.9f, -19.2f, 2.9f), vec3(13.0f, -18.8f, -2.2f), 0.85f, 0.75f),
                 1.1f);                                                    // collar
  d = soft_difference(d, sphere(q, vec3(0.0f, -18.6f, 3.6f), 0.9f), 1.0f); // hollow of the throat
  // The classical cut: an oval that narrows below, hollow arms.
  const float cut = ellipsoid(q, vec3(0.0f, -14.0f, -2.0f), vec3(18.8f, 19.0f, 15.0f));
  d = soft_intersection(d, cut, 0.8f);
  return d;
}

// Foot: a turned stand under the cut.
float foot(const vec3& q) {
  const float across = glm::length(glm::vec2(q.x, q.z + 2.6f));
  const float waist =
      4.2f + 2.6f * smooth_step(-34.0f, -38.5f, q.y) + 2.0f * smooth_step(-33.0f, -30.0f, q.y);
  return soft_intersection(across - waist, std::abs(q.y + 34.0f) - 5.0f, 0.6f) * 0.8f;
}

// How much of a soft mark of `radius` around `center` is felt at q.
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
  const float on_lip =
      smooth_step(0.16f, -0.02f, std::min(upper_lip(q), lower_lip(q)) + 0.05f) * smooth_step(8.2f, 8.6f, q.z);
  const float red = 0.55f * mark(q, vec3(4.2f, -3.2f, 7.0f), vec3(2.3f, 1.9f, 3.0f)) +
                    0.50f * mark(q, vec3(0.0f, -4.3f, 11.0f), vec3(1.9f, 1.4f, 1.6f)) +
                    0.70f * mark(q, vec3(8.4f, -0.8f, -1.5f), vec3(1.2f, 3.6f, 2.6f)) +
                    0.25f * mark(q, vec3(0.0f, -10.8f, 8.0f), vec3(2.2f, 1.2f, 1.6f));
  vec3 tint = glm::mix(vec3(1.0f), vec3(1.02f, 0.74f, 0.70f), std::min(red, 1.0f));
  tint = glm::mix(tint, vec3(0.86f, 0.47f, 0.45f), 0.85f * on_lip);
  const vec3 e = q - vec3(3.15f, 0.0f, 6.25f);
  const float on_ball = smooth_step(1.27f, 1.24f, glm::length(e)) * smooth_step(0.2f, 0.6f, e.z);
  tint = glm::mix(tint, vec3(1.15f, 1.45f, 1.55f), 0.75f * on_ball);
  return {tint, 1.0f + 1.2f * on_lip + 2.0f * on_ball};
}

} // namespace

float bust_distance(const vec3& p) {
  const vec3 q(std::abs(p.x), p.y, p.z);
  float d = torso(q);
  if (p.y > -19.0f) {
    float head = skull(q);
    head = with_mouth(with_nose(with_eyes(head, q), q), q);
    head = soft_union(head, ear(q), 0.45f);
    d = soft_union(d, head, 1.6f);
  }
  return std::min(d, foot(p));
}

Mesh make_bust(float detail) {
  constexpr float occlusion_reach = 3.0f; // sockets, nostrils and the shade under the chin
  // Fine where the features are, coarse on the shoulders.
  const auto graded = [&](float fine_low, float fine_high, float fine, float coarse) {
    return [=](float at) {
      const float away = std::max({fine_low - at, at - fine_high, 0.0f});
      return detail * std::min(coarse, fine + 0.12f * away);
    };
  };
  GridPlanes planes;
  const std::vector<float> right = place_planes(0.0f, 21.0f, graded(-6.0f, 8.6f, 0.16f, 0.55f));
  for (size_t i = right.size(); i-- > 1;)
    planes.x.push_back(-right[i]);
  planes.x.insert(planes.x.end(), right.begin(), right.end());
  planes.y = place_planes(-40.0f, 13.0f, graded(-9.5f, 3.4f, 0.15f, 0.55f));
  planes.z = place_planes(-14.5f, 12.5f, graded(6.0f, 12.0f, 0.15f, 0.30f));
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
