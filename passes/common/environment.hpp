#pragma once
// Bindings that every kernel sees in addition to its ports (descriptor set 1): frame constants,
// profiles, kernel tables. Layouts mirror shaders/common/environment.glsl; tests compare them with
// SPIR-V reflection.

#include "framegraph/model/graph.hpp"
#include "framegraph/model/pixel_grid.hpp"
#include "passes/common/camera.hpp"
#include "passes/common/dispatch.hpp"
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

// Counters of a frame, as words of the counters binding. subsurface.classify writes them unless
// noted otherwise.
struct FrameCounters {
  uint32_t scattering_tiles = 0; // 8x8 tiles with a pixel that scatters further than itself
  uint32_t copied_tiles = 0;     // tiles with subsurface that scatters no further than a pixel
  // Over scattering tiles: counter_log2_steps * (log2 of the largest d in pixels +
  // counter_log2_shift), rounded down.
  uint32_t log2_d_sum = 0;
  // Written by subsurface.classify_uniform_light: tiles that would scatter, but have uniform light
  // all around.
  uint32_t uniform_tiles = 0;
  // Groups that one dispatch over the tiles of a level of the surface-aware pyramid launches.
  std::array<uint32_t, 9> level_groups{};
  // Written by subsurface.allocate_samples: tiles that took one, two and three steps of samples;
  // units that they spend, and that all tiles would spend.
  std::array<uint32_t, 3> sampled_tiles{};
  uint32_t sample_units = 0, sample_demand = 0;
  uint32_t probe_count = 0; // written by subsurface.probe: number of probed tiles
  // Written by subsurface.transmission_stats: the mean square, over tiles with subsurface, of the
  // exposed transmitted light, at most 1, in steps of 1 / through_square_steps.
  uint32_t through_steps = 0;
  // Written by subsurface.classify with the setting `relief`: the sum of relief_of (relief.glsl)
  // over pixels of scattering tiles in steps of 1 / relief_steps, and the number of these pixels.
  uint32_t relief_sum = 0, relief_pixels = 0;
  // For each probed tile, as bits of floats: the sum of squared errors and the number of pixels in
  // this sum, both times the number of tiles that the tile represents.
  std::array<std::array<uint32_t, 2>, max_probes> probes{};
  // The same sum for the light before scattering.
  std::array<uint32_t, max_probes> probed_unscattered{};
  // The same sum for the result of subsurface.separable with 25 taps.
  std::array<uint32_t, max_probes> probed_separable{};
};
inline constexpr float counter_log2_shift = 8;      // d from 1/256 pixel
inline constexpr float counter_log2_steps = 16;     // per octave; the sum of 4 M tiles fits 32 bits
inline constexpr float through_square_steps = 1023; // the sum of 4 M tiles fits 32 bits
inline constexpr float relief_steps = 255;          // the sum of 4 pixels of 4 M tiles fits 32 bits
// Returns the mean relief (reference/relief.hpp), 0 to 1; -1: not counted.
double mean_relief(const FrameCounters& counters);
// Returns the root mean square of transmitted light over the tiles with subsurface, in exposed
// luminance.
double transmitted_rms(const FrameCounters& counters);
// Returns the geometric mean of d over the scattering tiles, pixels; 0 without scattering tiles.
double mean_d_px(const FrameCounters& counters);

enum class DepthKind : uint32_t { device = 0, view_units = 1 };

// Bit of FrameConstants::flags: kernels read no history.
inline constexpr uint32_t no_previous_frame = 4;
// Bit of FrameConstants::flags: the frame's error is probed, whatever the interval between probed
// frames.
inline constexpr uint32_t always_probed = 32;

// Frame constants in std140. Lengths on the device are in millimetres: fp32 resolves a micrometre
// at 10 m.
struct FrameConstants {
  int32_t rect[4];      // x, y, width, height of the render rectangle, pixels
  int32_t tiles[2];     // 8x8 tiles of the rectangle, x and y
  uint32_t frame_index; // low 32 bits
  // bit 0: perspective, bit 1: depth is view depth, bit 2: history invalid, bit 3: the frame
  // before was perspective, bit 4: normal images are left-handed, bit 5: always_probed
  uint32_t flags;
  // View x, y = (scale * pixel + offset) * (perspective ? depth : 1), in mm (per mm of depth if
  // perspective). `pixel` counts from the rectangle's corner; integers are pixel centres.
  float ray_scale[2];
  float ray_offset[2];
  float depth_decode[4]; // depth mm = (a * value + b) / (c * value + e)
  float depth_unit;      // mm per unit of view depth
  float exposure;
  float jitter[2]; // pixels
  // The previous frame, down to previous_jitter; valid if bit 2 of flags is not set.
  // Rows of M: the view position (mm) in the previous frame of a static point = M * (view position,
  // 1).
  float previous_from_view[3][4];
  // same convention as ray_scale and ray_offset
  float previous_ray_scale[2], previous_ray_offset[2];
  int32_t previous_rect[4];
  float previous_jitter[2]; // pixels
  uint32_t sample_units;    // units that subsurface.allocate_samples may spend
  uint32_t view_frame;      // 1 in a cut, and one more in each further frame of the view
  // x, y, width, height of the area that may have subsurface, relative to the rectangle's corner
  // and inside the rectangle
  int32_t bounds[4];
  // Rows of M: view position (mm) = M * (world position in the host's units, 1).
  float view_from_world[3][4];
};
static_assert(sizeof(FrameConstants) == 240);

// Profile entry in std430, one per profile id 0..255. Entry 0 and undeclared ids have d = 0: light
// passes through.
struct ProfileEntry {
  float d_mm[3];          // shape parameter per channel
  float d_max_mm;         // shape parameter of the widest channel
  uint32_t widest;        // index of the widest channel
  uint32_t separable_row; // first row of its separable kernels; 0xffffffff: none
  uint32_t radial_row;    // first row of its radial table; 0xffffffff: Burley's closed forms
  uint32_t sap_table;     // first of its pyramid tables; 0: the shared tables, which are Burley's
  float direct[3];        // fraction of light that never scatters
  float unused;           // rounds the entry to 48 bytes
};
static_assert(sizeof(ProfileEntry) == 48);
inline constexpr uint32_t profile_capacity = 256;
inline constexpr uint32_t no_separable_row = 0xffffffffu;
inline constexpr uint32_t no_radial_row = 0xffffffffu;

struct FrameInput {
  uint32_t rect_x = 0, rect_y = 0, rect_width = 0, rect_height = 0;
  std::array<int32_t, 4> bounds{}; // as FrameConstants::bounds
  // Right-handed matrices. clip_from_view excludes the jitter; previous_clip_from_view includes the
  // jitter of the previous frame. History counts as invalid if the previous matrices are no
  // projection.
  CameraMatrices camera;
  Handedness handedness = Handedness::right; // handedness of the view space of normal images
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

// Fills `out`. Returns false if the matrix is not an axis-aligned perspective or orthographic
// projection of a right-handed view space, or if a number is not finite; then `out` is unchanged.
// Allocates nothing. Thread: any.
bool fill_frame_constants(const FrameInput& input, FrameConstants& out);

struct NumberedProfile {
  uint32_t id = 0; // 1..255
  Profile profile;
};
// Returns whether the profile has its own radial and pyramid tables. Profiles of Burley's model,
// which has closed forms, share theirs.
bool has_own_tables(const NumberedProfile& numbered);

// Returns profile_capacity entries. Ignores ids outside 1..255. Expects the tables of a profile at
// the rows where make_kernel_tables (kernel_tables.hpp) places them for the same list.
std::vector<ProfileEntry> make_profile_table(std::span<const NumberedProfile> profiles,
                                             bool with_separable, PixelGrid pixel_grid = 0);
// Returns a profile's fitted rows (make_separable_rows), then the published kernel's
// (make_jimenez_rows): separable_kernel_rows_per_profile rows. Takes about 0.1 s.
std::vector<SeparableRow> make_separable_table(const NumberedProfile& numbered);
// Returns whether the graph has a pass that reads the separable table.
bool uses_separable(const Graph& graph, const PassTypeRegistry& pass_types);

// Returns the radial tables of the profiles that are not Burley's, in order; one row of zeros
// without any.
std::vector<RadialRow> make_radial_table(std::span<const NumberedProfile> profiles);

// The pyramids' tables that a graph's passes read.
struct PyramidUse {
  bool surface = false; // base, smooth and half: the surface-aware pyramid
  bool plain = false;
  PixelGrid pixel_grid = 0; // of the plan
  bool operator==(const PyramidUse&) const = default;
};
PyramidUse pyramid_use(const Graph& graph, const PassTypeRegistry& pass_types);
// Returns the tables of make_sap_table (sap_weights.hpp) that all Burley profiles share, by
// SapVariant: base, smooth, half, plain, for each of sap_shapes(use.pixel_grid). Unused tables are
// 0; the result is a single zero if all are unused. Takes about 0.1 s per table.
std::vector<float> make_shared_sap_tables(PyramidUse use);
// Returns a profile's own tables, which follow the shared ones: those of red, green and blue for
// each variant, for each shape; empty for Burley's model. Takes about 0.1 s per channel.
std::vector<float> make_own_sap_tables(PyramidUse use, const NumberedProfile& numbered);

} // namespace dermis::subsurface
