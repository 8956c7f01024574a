// Refinement by what interpolants show, after that by what links carry. [Hardt96, section 4.4.2]
#pragma once

#include "luxel/solve/hierarchical/light_mesh.h"

namespace luxel::hierarchical {

struct RepresentParams {
  /// The error that interpolants may have over an element of the unit's area [W/m^2]; nothing: a
  /// quarter of that of links.
  std::optional<double> eps;
  int max_rounds = 8;
  size_t max_elements = 1u << 20;
  /// Time for everything, from the call on. When it is short, refinement ends early, and less is
  /// fed back. The first and the last mesh are made all the same.
  double seconds = INFINITY;
  /// Seconds of the caller's own work after it. Progress is told of them, too.
  double later_seconds = 0;
};

/// Steps that there was no time for.
struct LeftOut {
  bool refinement = false, feedback = false;
};

/// The light mesh, after dividing leaves as long as their interpolants are off: the root of the sum
/// of squares of each triangle's error, at its middle, times the triangle's area over the unit, is
/// held against eps. The thesis takes the largest error alone, which divides on and on along
/// whatever edge of a shadow the mesh does not follow; here short edges count for little. Triangles
/// whose six samples lie on a plane are not looked at. Light of earlier rounds is kept, so each
/// costs only what it divides. The smaller eps is, the more exact is light at points; it is no
/// smaller than what that can tell. In the end the solution learns from the interpolants
/// (feedback.h), and the last mesh is made from what it is then. `left_out`: what there was no time
/// for; may be null. Errors: cancelled.
Result<LightMesh> represent(Solution& solution, const scene::Scene& scene,
                            const trace::RayTracer& tracer, const MeshParams& mesh_params,
                            const RepresentParams& params, Progress& progress,
                            LeftOut* left_out = nullptr);

/// One round of represent().
struct Round {
  LightMesh mesh;      ///< of the leaves there were
  size_t divided = 0;  ///< leaves whose interpolants were off
};
/// Divides the leaves whose interpolants are off, once, and feeds nothing back. `known` is what
/// earlier rounds found by the same light. Errors: cancelled; the solution is as it was.
Result<Round> represent_once(Solution& solution, const scene::Scene& scene,
                             const trace::RayTracer& tracer, const MeshParams& mesh_params,
                             const RepresentParams& params, Known& known, Progress& progress);

/// The error of each interpolant at the middle of its triangle [W/m^2]. Errors: cancelled.
Result<std::vector<float>> measure_error(const Solution& solution, const scene::Scene& scene,
                                         const trace::RayTracer& tracer, const PointParams& params,
                                         const LightMesh& mesh, Progress& progress);

}  // namespace luxel::hierarchical
