#pragma once
// What a pixel sees: from a projection matrix to the few numbers with which truth and kernels rebuild
// positions.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace dermis::subsurface {

// A 4x4 matrix, row-major (m[4 * row + column]); it multiplies column vectors: clip = M * view.
using Matrix4 = std::array<double, 16>;

Matrix4 multiply(const Matrix4& a, const Matrix4& b);
// Empty where the last row is not 0 0 0 1, or the rest cannot be inverted.
std::optional<Matrix4> invert_affine(const Matrix4& m);

// View space: x right, y up, looking down -z, in metres. Depth is the distance along the view axis, metres, >
// 0. Pixel (i, j) counts from the render rectangle's upper left corner; its centre has the view position
//   x = (scale_x * i + offset_x) * k,  y = (scale_y * j + offset_y) * k,  z = -depth,  k = perspective ?
//   depth : 1.
struct PixelRays {
  double scale_x = 1, offset_x = 0;  // metres per pixel (at depth 1 m if perspective)
  double scale_y = -1, offset_y = 0; // negative: pixel rows go down, y goes up
  bool perspective = false;
};

// View depth in metres from a depth buffer's value: depth = (a * value + b) / (c * value + e).
// Serves standard, reversed and infinite projections alike.
struct DepthDecode {
  double a = 0, b = 0, c = 0, e = 1;
};

// View space of a host has x to the right and y up. The camera looks down -z in a right-handed view space and
// along +z in a left-handed one.
enum class Handedness : uint8_t { right, left };

// The matrices of a frame and of the frame before, as a host has them. Both clip_from_view exclude the jitter
// or include it.
struct CameraMatrices {
  Matrix4 clip_from_view{}, view_from_world{}, previous_clip_from_view{}, previous_view_from_world{};
};

// Why matrices of a host cannot be used; text_of() says it in words.
enum class CameraFault : uint8_t {
  none,
  no_projection,
  stored_by_columns,      // as GLM and shaders store matrices
  declared_left,          // and clip_from_view has w = -z
  declared_right,         // and clip_from_view has w = z
  previous_right,         // the frame is left-handed, and previous_clip_from_view has w = -z
  previous_left,          // the frame is right-handed, and previous_clip_from_view has w = z
  behind_camera,          // depth 0..1 is behind the camera
  previous_behind_camera, // the same of previous_clip_from_view
};

// Mirrors the matrices of a left-handed view space along z: everything else here works with right-handed
// ones. A perspective projection states its handedness by the sign of its w row (w = -z: right, w = z: left).
// An orthographic one cannot: it has the handedness that is `declared`, right where nothing is. A previous
// projection that is none is not judged. On a fault nothing changes. Allocates nothing. Thread: any.
CameraFault to_right_handed(CameraMatrices& matrices, std::optional<Handedness> declared, Handedness& found);

// One sentence without a full stop; static. "" for none.
std::string_view text_of(CameraFault fault);

// The same projection for view positions whose z has the other sign.
Matrix4 with_mirrored_view(const Matrix4& clip_from_view);

// Rays of a w x h rectangle onto which clip space [-1, 1]^2 maps (Vulkan: y down, so m[1][1] < 0 for a camera
// that is not flipped). `clip_from_view` excludes the jitter; `jitter_px` is how far the picture was shifted
// by it (+x right, +y down). The matrix works in host units, `metres_per_unit` turns them into metres. Empty
// if the matrix is not an axis-aligned perspective or orthographic projection of a right-handed view space
// with finite entries, or a size or the unit is not positive.
std::optional<PixelRays> pixel_rays(const Matrix4& clip_from_view, uint32_t width, uint32_t height,
                                    double metres_per_unit, std::array<double, 2> jitter_px);

// Decoder for a depth attachment written with the same matrix and Vulkan's depth range 0..1.
DepthDecode depth_decode(const Matrix4& clip_from_view, double metres_per_unit);

// Orthographic rays with square pixels of `pitch_m` metres, centred on the view axis.
PixelRays orthographic_rays(uint32_t width, uint32_t height, double pitch_m);

} // namespace dermis::subsurface
