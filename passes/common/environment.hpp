#pragma once
// What every kernel sees beside its ports (descriptor set 1): frame constants, profiles, kernel tables.
// Layouts mirror shaders/common/environment.glsl; tests compare them with SPIR-V reflection.

#include "framegraph/model/graph.hpp"
#include "passes/common/camera.hpp"
#include "passes/common/profiles/profile.hpp"
#include "passes/common/profiles/radial_table.hpp"
#include "passes/separable/separable_kernel.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dermis::subsurface {

// Bindings of set 1.
enum class EnvironmentSlot : uint32_t {
  frame = 0,
  profiles = 1,
  separable = 2,
  linear_sampler = 3,
  sap = 4,
  radial = 5,
  counters = 6,
  count = 7
};

inline constexpr size_t max_probes = 32; // tiles of a frame

// What subsurface.classify counts in a frame, as words of the counters binding.
struct FrameCounters {
  uint32_t scattering_tiles = 0; // 8x8 tiles with a pixel that scatters further than itself
  uint32_t copied_tiles = 0;     // tiles with subsurface below that
  uint32_t log2_d_sum = 0; // over scattering tiles: counter_log2_steps * (log2 of the largest d in pixels
                           // + counter_log2_shift), rounded down
  uint32_t uniform_tiles =
      0; // of subsurface.classify_uniform_light: would scatter, but the light is the same all around
  // Groups that one dispatch over the tiles of a level of the surface-aware pyramid launches.
  std::array<uint32_t, 9> level_groups{};
  // Of subsurface.allocate_samples: tiles that took one, two and three steps of samples; units that they
  // spend, and that all tiles would.
  std::array<uint32_t, 3> sampled_tiles{};
  uint32_t sample_units = 0, sample_demand = 0;
  uint32_t probe_count = 0; // of subsurface.probe: tiles that it looked at
  // Of subsurface.transmission_stats: over tiles with subsurface, the mean square of the exposed light that
  // comes through, at most 1, in steps of 1 / through_square_steps.
  uint32_t through_steps = 0;
  // Of each probed tile, as bits of floats, the sum of squared errors and the pixels that it was made of,
  // both times the tiles that it stands for.
  std::array<std::array<uint32_t, 2>, max_probes> probes{};
};
inline constexpr float counter_log2_shift = 8;      // d from 1/256 pixel
inline constexpr float counter_log2_steps = 16;     // an octave; the sum of 4 M tiles fits 32 bits
inline constexpr float through_square_steps = 1023; // the sum of 4 M tiles fits 32 bits
// Light that comes through thin parts, root mean square over the tiles with subsurface, exposed luminance.
double transmitted_rms(const FrameCounters& counters);
// Geometric mean of d over the scattering tiles, pixels; 0 where there are none.
double mean_d_px(const FrameCounters& counters);

enum class DepthKind : uint32_t { device = 0, view_units = 1 };

// std140. Lengths on the device are millimetres: fp32 keeps a micrometre at 10 m.
struct FrameConstants {
  int32_t rect[4];      // x, y, width, height of the render rectangle, pixels
  int32_t tiles[2];     // 8x8 tiles of the rectangle, x and y
  uint32_t frame_index; // low 32 bits
  uint32_t flags;       // bit 0: perspective, bit 1: depth is view distance, bit 2: history invalid,
                        // bit 3: the frame before was perspective, bit 4: normal images are left-handed
  float ray_scale[2];   // view x, y = (scale * pixel + offset) * (perspective ? depth : 1); pixel counts from
  float
      ray_offset[2]; // the rectangle's corner, integers at pixel centres; mm (per mm of depth if perspective)
  float depth_decode[4]; // depth mm = (a * value + b) / (c * value + e)
  float depth_unit;      // mm per unit of view distance
  float exposure;
  float jitter[2]; // pixels
  // Of the frame before, where bit 2 of flags is not set:
  float previous_from_view[3][4]; // rows; its view position of what stands still = M * (view position, 1), mm
  float previous_ray_scale[2], previous_ray_offset[2]; // as ray_scale and ray_offset
  int32_t previous_rect[4];
  float previous_jitter[2]; // pixels
  uint32_t sample_units;    // that subsurface.allocate_samples may spend
  float unused;             // rounds to 16 bytes
  int32_t bounds[4]; // x, y, width, height of where subsurface may be, from the rectangle's corner, inside it
  float view_from_world[3][4]; // rows; view position in mm = M * (world position in the host's units, 1)
};
static_assert(sizeof(FrameConstants) == 240);

// std430, one per profile id 0..255; entry 0 and undeclared ids have d = 0: light passes through.
struct ProfileEntry {
  float d_mm[3];          // shape parameter per channel
  float d_max_mm;         // of the widest channel
  uint32_t widest;        // channel index
  uint32_t separable_row; // first row of its separable kernels; 0xffffffff: none were made
  uint32_t radial_row;    // first row of its radial table; 0xffffffff: Burley's closed forms
  uint32_t sap_table;     // first of its pyramid tables; 0: the shared ones, which are Burley's
  float direct[3];        // share of light that never scatters
  float unused;           // rounds the entry to 48 bytes
};
static_assert(sizeof(ProfileEntry) == 48);
inline constexpr uint32_t profile_capacity = 256;
inline constexpr uint32_t no_separable_row = 0xffffffffu;
inline constexpr uint32_t no_radial_row = 0xffffffffu;

struct FrameInput {
  uint32_t rect_x = 0, rect_y = 0, rect_width = 0, rect_height = 0;
  std::array<int32_t, 4> bounds{}; // as FrameConstants::bounds
  // Right-handed, clip_from_view without jitter. The previous one has its jitter, as the frame before was
  // rendered; where the previous matrices are no projection, history counts as invalid.
  CameraMatrices camera;
  Handedness handedness = Handedness::right; // of the view space of normal images
  std::array<double, 2> jitter_px{};
  double metres_per_unit = 1.0;
  DepthKind depth_kind = DepthKind::device;
  float exposure = 1.0f;
  uint64_t frame_index = 0;
  bool history_invalid = false;
  uint32_t sample_units = UINT32_MAX; // as FrameConstants::sample_units
  // Rectangle (width 0: none) and jitter of the previous frame.
  uint32_t previous_x = 0, previous_y = 0, previous_width = 0, previous_height = 0;
  std::array<double, 2> previous_jitter_px{};
};

// False if the matrix is not an axis-aligned perspective or orthographic projection of a right-handed view
// space, or a number is not finite; then `out` is unchanged. Allocates nothing. Thread: any.
bool fill_frame_constants(const FrameInput& input, FrameConstants& out);

struct NumberedProfile {
  uint32_t id = 0; // 1..255
  Profile profile;
};

// profile_capacity entries. Ids outside 1..255 are ignored. Tables of a profile are expected where
// make_separable_table, make_radial_table and make_sap_tables put them for the same list.
std::vector<ProfileEntry> make_profile_table(std::span<const NumberedProfile> profiles, bool with_separable);
// For each profile in order the fitted rows (make_separable_rows), then the published kernel's
// (make_jimenez_rows); one row of zeros if there are none. About .1 s a profile.
std::vector<SeparableRow> make_separable_table(std::span<const NumberedProfile> profiles);
// Does the graph have a pass that reads the separable table?
bool uses_separable(const Graph& graph, const PassTypeRegistry& pass_types);

// Radial tables of the profiles that are not Burley's, in order; one row of zeros if there are none.
std::vector<RadialRow> make_radial_table(std::span<const NumberedProfile> profiles);

// Which of the pyramids' tables a graph's passes read.
struct PyramidUse {
  bool surface = false; // base and smooth: the surface-aware pyramid
  bool plain = false;
  bool operator==(const PyramidUse&) const = default;
};
PyramidUse pyramid_use(const Graph& graph, const PassTypeRegistry& pass_types);
// Tables of make_sap_table (sap_weights.hpp): the shared ones, base, smooth, plain; then for each profile
// that is not Burley's, in order, those of red, green and blue for base, for smooth and for plain. What is
// not used is 0; a single zero where nothing is. About .1 s a shared table and the same for each channel of
// another profile.
std::vector<float> make_sap_tables(PyramidUse use, std::span<const NumberedProfile> profiles);

} // namespace dermis::subsurface
