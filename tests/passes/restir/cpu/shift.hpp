#pragma once
// Shift mappings: a path of one pixel becomes a path of another (Werner, Schuessler & Dachsbacher 2024,
// supplement, sections 1 to 4; subsurface.md R1 to R6). Paths are measured by area at x2 and at the light.
// shaders/restir/shift.glsl mirrors these functions under the same names. Pure but for what the scene
// is asked; thread: any.

#include "tests/passes/restir/cpu/random.hpp"
#include "tests/passes/restir/cpu/reservoir.hpp"
#include "tests/passes/restir/cpu/scene.hpp"

namespace dermis::restir {

enum class Shift : uint32_t { reconnection, delayed, hybrid, sequential };
enum class Stage : uint32_t { temporal, spatial_first, spatial_second };

// `sequential` reconnects over time and in the first spatial pass, and replays in the second (R5).
Shift shift_of_stage(Shift shift, Stage stage);

// The hybrid shift reconnects x1 - x2 where this holds at both ends: surfaces that face apart by 60 degrees
// or more, or points 2 max d apart (R4).
bool connectable(const Domain& domain, const Vector3& position, const Vector3& normal);

// Jacobian of reconnection per solid angle (eq. 2): directions x -> v become y -> v, `normal` at v. Per area
// it is 1.
double reconnection_jacobian(const Vector3& x, const Vector3& y, const Vector3& v, const Vector3& normal);
// Jacobian of replayed random numbers per area (eq. 6), the choice among hits included.
double replay_jacobian(double from_density, uint32_t from_hits, double to_density, uint32_t to_hits);

// The target: luminance of the whole integrand, visibility included. 0 without a sample.
double target_of(const Scene& scene, const Domain& domain, const Reservoir& path);
Vector3 contribution_of(const Scene& scene, const Domain& domain, const Reservoir& path);

// Whether inverting finds the hit's index by tracing the probe, or draws it and takes both probes' hits for
// equally many: saves a probe, and is what biases the sequential shift (supplement, section 6).
enum class Index : uint32_t { traced, drawn };

// Finds the random numbers of a sample that `shift` will replay and that has none (it was reconnected
// before), by probabilistic inversion in its own pixel. Once for each sample and pass: what comes after must
// see the same numbers. Where none lead there, hits stays 0 and no replay of it succeeds.
void prepare(const Scene& scene, Shift shift, Index index, const Domain& domain, Reservoir& path,
             Random& random);

struct Shifted {
  Reservoir path;
  double jacobian = 0; // 0: the path has no image
  double target = 0;   // in the new pixel
};
// `shift` is none of a sequence: ask shift_of_stage first.
Shifted shift_path(const Scene& scene, Shift shift, const Domain& from, const Domain& to,
                   const Reservoir& path);

} // namespace dermis::restir
