#pragma once
// Camera: converts a projection matrix to the few numbers with which the reference and the kernels
// reconstruct positions.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace dermis::subsurface {

// A 4x4 matrix, row-major (m[4 * row + column]). It multiplies column vectors: clip = M * view.
using Matrix4 = std::array<double, 16>;

Matrix4 multiply(const Matrix4& a, const Matrix4& b);
// Returns nullopt if the last row is not 0 0 0 1, or if the rest is singular.
std::optional<Matrix4> invert_affine(const Matrix4& m);

// View space: x right, y up, the camera looks along -z, in metres. Depth is the distance along the
// view axis in metres, > 0. Pixel (i, j) counts from the upper left corner of the render rectangle.
// Its centre has the view position
//   x = (scale_x * i + offset_x) * k,  y = (scale_y * j + offset_y) * k,  z = -depth,
//   k = perspective ? depth : 1.
struct PixelRays {
  double scale_x = 1, offset_x = 0;  // metres per pixel (at depth 1 m if perspective)
  double scale_y = -1, offset_y = 0; // negative: pixel rows go down, y goes up
  bool perspective = false;
};

// View depth in metres from a depth buffer's value: depth = (a * value + b) / (c * value + e).
// Works for standard, reversed and infinite projections.
struct DepthDecode {
  double a = 0, b = 0, c = 0, e = 1;
};

// Handedness of a host's view space, which has x to the right and y up. The camera looks along -z
// in a right-handed view space and along +z in a left-handed view space.
enum class Handedness : uint8_t { right, left };

// The host's matrices of a frame and of the previous frame. Both clip_from_view exclude the jitter,
// or both include it.
struct CameraMatrices {
  Matrix4 clip_from_view{}, view_from_world{}, previous_clip_from_view{},
      previous_view_from_world{};
};

// The reason why a host's matrices cannot be used; text_of() describes it.
enum class CameraFault : uint8_t {
  none,
  no_projection,
  no_depth,               // the depth row maps all points to one depth
  stored_by_columns,      // as GLM and shaders store matrices
  declared_left,          // and clip_from_view has w = -z
  declared_right,         // and clip_from_view has w = z
  previous_right,         // the frame is left-handed, and previous_clip_from_view has w = -z
  previous_left,          // the frame is right-handed, and previous_clip_from_view has w = z
  behind_camera,          // depth 0..1 is behind the camera
  previous_behind_camera, // depth 0..1 of previous_clip_from_view is behind the camera
};

// Mirrors the matrices of a left-handed view space along z, because all other functions expect
// right-handed matrices. The sign of the w row gives the handedness of a perspective projection (w
// = -z: right, w = z: left). An orthographic projection has the handedness `declared`; nullopt
// means right. An invalid previous projection is ignored. A fault leaves the matrices unchanged.
// Allocates nothing. Thread: any.
CameraFault to_right_handed(CameraMatrices& matrices, std::optional<Handedness> declared,
                            Handedness& found);

// Returns a static sentence without a full stop; "" for none.
std::string_view text_of(CameraFault fault);

// Returns the projection for view positions with negated z.
Matrix4 with_mirrored_view(const Matrix4& clip_from_view);

// Returns the rays of a w x h rectangle onto which clip space [-1, 1]^2 maps (Vulkan: y down, so
// m[1][1] < 0 for a camera that is not flipped). `clip_from_view` excludes the jitter; `jitter_px`
// is the shift of the picture by the jitter (+x right, +y down). The matrix is in host units;
// `metres_per_unit` converts them to metres. Returns nullopt if the matrix is not an axis-aligned
// perspective or orthographic projection of a right-handed view space with finite entries, or if a
// size or the unit is not positive.
std::optional<PixelRays> pixel_rays(const Matrix4& clip_from_view, uint32_t width, uint32_t height,
                                    double metres_per_unit, std::array<double, 2> jitter_px);

// Returns the decoder of a depth attachment written with this matrix and Vulkan's depth range 0..1.
DepthDecode depth_decode(const Matrix4& clip_from_view, double metres_per_unit);

// Returns orthographic rays with square pixels of `pitch_m` metres, centred on the view axis.
PixelRays orthographic_rays(uint32_t width, uint32_t height, double pitch_m);

} // namespace dermis::subsurface
