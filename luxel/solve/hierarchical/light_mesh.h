// Irradiance as a smooth function: quadratic over triangles that follow the strongest
// discontinuities. [Hardt96, chapters 3 and 5]
#pragma once

#include "luxel/solve/hierarchical/dsets.h"
#include "luxel/solve/hierarchical/known_light.h"

namespace luxel::hierarchical {

/// R(s, t) = A s^2 + 2B s t + 2C s + D t^2 + 2E t + F over a triangle, s and t the weights of its
/// second and third corner: {A, 2B, 2C, D, 2E, F}. [Hardt96, eq. 3.1]
using Interpolant = std::array<Rgb, 6>;
/// From values at (0, 0), (1/2, 0), (1, 0), (1/2, 1/2), (0, 1), (0, 1/2). [Hardt96, section 3.3]
Interpolant interpolant_of(const std::array<Rgb, 6>& value);
/// R(s, t) as above [W/m^2].
inline Rgb value_of(const Interpolant& r, float s, float t) {
  return (r[0] * s + r[1] * t + r[2]) * s + (r[3] * t + r[4]) * t + r[5];
}

struct LightTriangle {
  std::array<uint32_t, 3> vertex{};  ///< counter-clockwise from the front
  uint32_t face = 0;
  uint32_t leaf = 0;  ///< of the tree's elements
  /// Per edge, from corner k on: whether it lies on an active discontinuity.
  std::array<bool, 3> edge_is_line{};
};

/// A mesh without T-vertices: within a face no vertex lies on another triangle's edge, nor where
/// faces meet along an edge.
struct LightMesh {
  std::vector<DVec3> vertices;
  std::vector<LightTriangle> triangles;    ///< by leaf
  std::vector<uint32_t> first_of_element;  ///< per element of the tree, its triangles; one extra
  std::vector<Interpolant> interpolant;    ///< per triangle, E [W/m^2]
  uint64_t samples = 0;                    ///< points whose light of faces was computed
  size_t lines = 0;                        ///< active pieces
};

/// The centroid of a triangle [m].
inline DVec3 middle_of(const LightMesh& mesh, const LightTriangle& t) {
  return (mesh.vertices[t.vertex[0]] + mesh.vertices[t.vertex[1]] + mesh.vertices[t.vertex[2]]) *
         (1.0 / 3);
}

struct MeshParams {
  bool discontinuities = true;
  DiscontinuityParams discontinuity;
  PointParams point = {.tolerance = 5e-4};
};

/// Triangulates all leaves and builds their interpolants. Errors: cancelled.
Result<LightMesh> make_light_mesh(const Solution& solution, const scene::Scene& scene,
                                  const trace::RayTracer& tracer, const MeshParams& params,
                                  Progress& progress);
/// Triangulates all leaves, without discontinuities. The light of a triangle is the mean of its
/// leaf, ElementLight::irradiance. Errors: cancelled.
Result<LightMesh> make_flat_mesh(const Solution& solution, const scene::Scene& scene,
                                 const trace::RayTracer& tracer, Progress& progress);
/// Data that meshes of one scene share: light at places, and discontinuities. Discontinuities keep
/// the geometric part of their weight, and the radiometric one follows the light there is [Hardt96,
/// sections 5.4 and 5.5.8].
struct Known {
  KnownLight light;
  std::vector<std::optional<std::vector<Discontinuity>>> of_face;  ///< what was looked for
};
/// Triangulates and interpolates as above, with what earlier meshes found. Errors: cancelled.
Result<LightMesh> make_light_mesh(const Solution& solution, const scene::Scene& scene,
                                  const trace::RayTracer& tracer, const MeshParams& params,
                                  Known& known, Progress& progress);

/// The triangle that holds a place of a face, or the nearest one of its leaf.
struct MeshPoint {
  uint32_t triangle = 0;
  float s = 0, t = 0;
};
/// Where a place of a face lies in the mesh; clamped into the triangle. Nothing in a mesh without
/// triangles: all faces are smaller than the rounding of the scene's coordinates.
std::optional<MeshPoint> locate(const Solution& solution, const LightMesh& mesh, uint32_t face,
                                DVec3 place);

/// E at a surface point of the scene [W/m^2], never negative.
Rgb irradiance_at(const Solution& solution, const LightMesh& mesh, const scene::Scene& scene,
                  const scene::SurfacePoint& p);

}  // namespace luxel::hierarchical
