#pragma once
// Shift mappings: a path of one pixel becomes a path of another pixel (Werner, Schuessler &
// Dachsbacher 2024, supplement, sections 1 to 4; subsurface.md R1 to R6). Paths are measured by
// area at x2 and at the light. shaders/restir/shift.glsl mirrors these functions under the same
// names. Pure except for scene queries; thread: any.

#include "tests/passes/restir/cpu/random.hpp"
#include "tests/passes/restir/cpu/reservoir.hpp"
#include "tests/passes/restir/cpu/scene.hpp"

namespace dermis::restir {

enum class Shift : uint32_t { reconnection, delayed, hybrid, sequential };
enum class Stage : uint32_t { temporal, spatial_first, spatial_second };

// `sequential` reconnects over time and in the first spatial pass, and replays in the second
// spatial pass (R5).
Shift shift_of_stage(Shift shift, Stage stage);

// Returns whether the hybrid shift reconnects x1 - x2, which it does if this holds at both ends:
// the surfaces' normals differ by 60 degrees or more, or the points are 2 max d apart.
bool connectable(const Domain& domain, const Vector3& position, const Vector3& normal);

// Returns the Jacobian of reconnection per solid angle (eq. 2): directions x -> v become y -> v;
// `normal` is at v. Per area the Jacobian is 1.
double reconnection_jacobian(const Vector3& x, const Vector3& y, const Vector3& v,
                             const Vector3& normal);
// Returns the Jacobian of replayed random numbers per area (eq. 6), including the choice among
// hits.
double replay_jacobian(double from_density, uint32_t from_hits, double to_density,
                       uint32_t to_hits);

// Returns the target: luminance of the whole integrand, including visibility. Returns 0 without a
// sample.
double target_of(const Scene& scene, const Domain& domain, const Reservoir& path);
Vector3 contribution_of(const Scene& scene, const Domain& domain, const Reservoir& path);

// Returns whether inversion traces the probe to find the hit's index, or samples the index and
// assumes equal hit counts of both probes. Sampling saves a probe, but biases the sequential shift
// (supplement, section 6).
enum class Index : uint32_t { traced, sampled };

// Finds the random numbers of a sample without numbers (it was reconnected before) that `shift`
// will replay, by probabilistic inversion in its own pixel. Called once per sample and pass: later
// steps must see equal numbers. If no numbers lead to the sample, hits stays 0 and every replay
// fails.
void prepare(const Scene& scene, Shift shift, Index index, const Domain& domain, Reservoir& path,
             Random& random);

struct Shifted {
  Reservoir path;
  double jacobian = 0; // 0: the path has no image.
  double target = 0;   // In the new pixel.
};
// `shift` must not be a sequence; shift_of_stage resolves sequences.
Shifted shift_path(const Scene& scene, Shift shift, const Domain& from, const Domain& to,
                   const Reservoir& path);

} // namespace dermis::restir
