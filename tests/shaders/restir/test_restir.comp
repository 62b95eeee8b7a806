#version 460
// Evaluates the functions of shaders/restir for case x, one result per row. Rows 0 to 8 are the
// inputs, so that the CPU functions get equal inputs. Rows 17 on merge paths over three sheets of
// surface.
#extension GL_GOOGLE_include_directive : require
#include "common/environment.glsl"
#include "restir/hits.glsl"
#include "restir/reuse.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba32f) uniform writeonly image2D target;
layout(push_constant) uniform push_block { uint port_mask; };

// Sheets z = 0, -0.4, -1, visible from both sides; barycentrics are positions in [-32, 32]^2.
const float sheets[3] = float[3](0.0, -0.4, -1.0);
const float sheet_size = 64.0;

chosen_hit trace_probe(probe_ray ray, uint medium, hit_choice choice) {
  hit_pass pass = first_pass();
  chosen_hit chosen;
  for (bool ended = false; !ended;) {
    for (int sheet = 0; sheet < 3; ++sheet) {
      float way = (sheets[sheet] - ray.origin.z) / ray.direction.z;
      if (!(way > 0.0 && way < ray.reach))
        continue;
      vec2 place = ray.origin.xy + way * ray.direction.xy;
      add_hit(pass, probe_hit(16777217u + uint(sheet), 0xfffffff0u, place / sheet_size + 0.5, way));
    }
    ended = choose_hit(pass, choice, chosen);
  }
  return chosen;
}
surface_point surface_at(uint instance, uint primitive, vec2 barycentrics) {
  vec3 up = vec3(0.0, 0.0, instance == 16777217u ? 1.0 : -1.0);
  return surface_point(vec3((barycentrics - 0.5) * sheet_size, sheets[instance - 16777217u]), up,
                       up, 1u);
}
bool visible(surface_point from, vec3 to) { return from.position.x * to.x < 9.0; }
uint light_count() { return 2u; }
light_source light_at(uint index) {
  if (index == 0u)
    return light_source(vec3(3.0, 2.0, 5.0), light_point, vec3(0.0), 0.5, vec3(0.0), 1.0,
                        vec3(8.0, 9.0, 10.0), 0.5);
  return light_source(vec3(1.0, 1.0, -4.0), light_parallelogram, vec3(2.0, 0.0, 0.0), 0.5,
                      vec3(0.0, 2.0, 0.0), 4.0, vec3(4.0, 3.0, 2.0), 1.0);
}

light_source previous_light_at(uint index) {
  light_source light = light_at(index);
  light.emission = light.emission.brg;
  light.position.x -= 0.5;
  return light;
}

vec3 three(inout random_state random) {
  float x = random_unit(random), y = random_unit(random), z = random_unit(random);
  return vec3(x, y, z);
}

// Returns a pixel that sees the first sheet, oblique to its axes.
scatter_domain pixel_on_sheet(inout random_state random) {
  vec3 at = three(random), tilt = three(random);
  return scatter_domain(vec3(4.0 * at.xy - 2.0, 0.0), normalize(vec3(tilt.xy - 0.5, 0.5)),
                        vec3(1.0, 0.5, 0.25), 1u);
}

// Finds one hit among up to 24, with a few different distances, in no order.
chosen_hit find_listed(uint list, hit_choice choice) {
  hit_pass pass = first_pass();
  chosen_hit chosen;
  for (bool ended = false; !ended;) {
    for (uint i = 0u; i < list % 25u; ++i)
      add_hit(pass, probe_hit(i % 3u, i, vec2(i, 0.0), float((7u * i + list) % 11u)));
    ended = choose_hit(pass, choice, chosen);
  }
  return chosen;
}

vec4 halves(uint a, uint b) { return vec4(a & 0xffffu, a >> 16, b & 0xffffu, b >> 16); }

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, frame.rect.zw)))
    return;
  int row = pixel.y;
  random_state random = random_state(uint(pixel.x), 1u, 0u);
  scatter_domain domain;
  domain.position = 4.0 * three(random) - 2.0;
  domain.normal = normalize(three(random) - 0.5);
  domain.d = 0.1 + three(random);
  domain.medium = 1u;
  if (pixel.x % 8 == 7)
    domain.d.b = 0.0;
  vec3 x2 = domain.position + 6.0 * (three(random) - 0.5);
  vec3 n2 = normalize(three(random) - 0.5);
  vec4 u = vec4(three(random), random_unit(random));
  float u_invert = random_unit(random);
  light_source light;
  light.type = uint(pixel.x) % 4u;
  light.position = 8.0 * three(random) - 4.0;
  if (light.type == light_directional)
    light.position = normalize(light.position);
  light.edge_u = three(random);
  light.edge_v = three(random) - 0.5;
  light.emission = 4.0 * three(random);
  light.area = 0.5 + random_unit(random);
  light.fraction = random_unit(random);
  light.until = 1.0;
  uint place = light_place(random_unit(random), random_unit(random));

  probe_numbers numbers = draw_numbers(domain.d, u);
  probe_ray ray = probe_of(domain, numbers);
  vec4 result = vec4(0.0);
  if (row == 0)
    result = vec4(domain.position, domain.d.r);
  if (row == 1)
    result = vec4(domain.normal, domain.d.g);
  if (row == 2)
    result = vec4(x2, domain.d.b);
  if (row == 3)
    result = vec4(n2, u_invert);
  if (row == 4)
    result = u;
  if (row == 5)
    result = vec4(light.position, light.edge_u.x);
  if (row == 6)
    result = vec4(light.edge_u.yz, light.edge_v.xy);
  if (row == 7)
    result = vec4(light.edge_v.z, light.emission);
  if (row == 8)
    result = vec4(light.area, light.fraction, place & 0xffffu, place >> 16);

  if (row == 9)
    result = vec4(numbers.axis, numbers.channel, numbers.survival, numbers.angle);
  if (row == 10)
    result = vec4(ray.origin, ray.reach);
  if (row == 11)
    result = vec4(ray.direction, picked_hit(numbers.pick, 5u));
  if (row == 12)
    result =
        vec4(scattering_profile(domain.d, length(x2 - domain.position)), probe_pdf(domain, x2, n2));
  if (row == 13) {
    probe_numbers found = numbers;
    bool good = invert_point(domain, x2, n2, u_invert, found);
    result = good ? vec4(found.axis, found.channel, found.survival, found.angle) : vec4(-1.0);
  }
  if (row == 14)
    result = vec4(light_irradiance(light, place, x2, n2, normalize(n2 + vec3(0.1, 0.2, 0.3))),
                  light_density(light));
  if (row == 15)
    result = vec4(light_target(light, place, x2), connectable(domain, x2, n2));
  if (row == 16)
    result = vec4(probe_axis(domain.normal, 1u), search_radius(domain.d, 0.05 * u.x));

  // Paths over the sheets.
  random = random_state(uint(pixel.x), 2u, 0u);
  uint shift = uint(pixel.x) % 3u;
  reuse_settings settings = reuse_settings(shift, uint(pixel.x) / 3u % 2u, confidence_cap);
  scatter_domain here = pixel_on_sheet(random), there = pixel_on_sheet(random),
                 neighbour = pixel_on_sheet(random);
  reservoir own = draw_initial(here, random), history = draw_initial(there, random),
            other = draw_initial(neighbour, random);
  history.confidence = 30.0;
  reservoir merged = merge_temporal(settings, here, own, there, history, random);
  spatial_merge spatial = spatial_begin(here, merged, history.confidence + other.confidence);
  for (int i = 0; i < 5; ++i) {
    if (i == 1)
      spatial_neighbour(spatial, there, history);
    if (i == 3)
      spatial_neighbour(spatial, neighbour, other);
    spatial_move(settings, spatial, random);
  }
  reservoir last = spatial_end(spatial, random);
  if (row == 17)
    result = vec4(has_sample(own) ? own.instance - 16777216u : 0u, own.barycentrics, own.weight);
  if (row == 18)
    result = vec4(own.irradiance, own.density);
  if (row == 19)
    result = vec4(has_sample(merged) ? merged.instance - 16777216u : 0u, merged.barycentrics,
                  merged.weight);
  if (row == 20)
    result = vec4(resolve(here, merged), merged.confidence);
  if (row == 21)
    result =
        vec4(has_sample(last) ? last.instance - 16777216u : 0u, last.barycentrics, last.weight);
  if (row == 22)
    result = vec4(resolve(here, last), last.confidence);
  if (row == 23)
    result = vec4(random_unit(random), random.count, 0.0, 0.0);

  // Words of a reservoir, and the result of unpacking arbitrary words.
  reservoir r = reservoir(16777217u + uint(pixel.x), 0xfffffffeu - uint(pixel.x), u.xy, 0xfedcba98u,
                          place, numbers, 16u, u.z, light.emission, u.w, light.area);
  if (row >= 24 && row < 32) {
    uvec4 words = pack_reservoir(unpack_reservoir(pack_reservoir(r))).words[(row - 24) / 2];
    result = (row & 1) == 0 ? halves(words.x, words.y) : halves(words.z, words.w);
  }
  if (row == 32) {
    packed_reservoir packed_words = pack_reservoir(r);
    uint bad = uint(pixel.x) % 10u; // Indices of the floats among the words.
    uint at = bad < 2u ? 2u + bad : 5u + bad; // Barycentrics; survival to irradiance.
    if (bad > 7u)
      at = 6u + bad; // Weight, confidence.
    // NaN, Inf, -Inf, -1
    uint words[4] = uint[4](0x7fc00000u, 0x7f800000u, 0xff800000u, 0xbf800000u);
    packed_words.words[at / 4u][at % 4u] = words[uint(pixel.x) / 10u % 4u];
    reservoir s = unpack_reservoir(packed_words);
    result = vec4(has_sample(s), s.weight, s.confidence, s.hits);
  }

  // The packed form of a pixel, and the offset of a neighbour.
  if (row == 33 || row == 34 || row == 35) {
    packed_domain kept = pack_domain(domain);
    result = row == 33 ? halves(kept.words[0].x, kept.words[0].w)
                       : halves(kept.words[1].x, kept.words[1].w);
    if (row == 35)
      result = vec4(unpack_domain(kept).normal, unpack_domain(kept).medium);
  }
  if (row == 37 || row == 38) {
    hit_choice choice = hit_by_pick(u.w);
    if (row == 38)
      choice = hit_on_primitive(uint(u.x * 3.0), uint(u.y * 20.0));
    chosen_hit chosen = find_listed(uint(pixel.x), choice);
    result = vec4(chosen.count, chosen.index, 0.0, 0.0);
    if (chosen.index < chosen.count)
      result.zw = vec2(chosen.hit.primitive, chosen.hit.barycentrics.x);
  }
  if (row == 36) {
    random = random_state(uint(pixel.x), 3u, 0u);
    ivec2 near = neighbour_offset(5.0, random);
    result = vec4(near, neighbour_offset(30.0, random));
  }
  imageStore(target, pixel, result);
}
