// Shared by the tests of the hemicube solver: small scenes, random cuts, and a solution of a scene.
#pragma once

#include <gtest/gtest.h>

#include "luxel/base/random.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/solve/hemicube/bisect.h"
#include "luxel/solve/hemicube/hemicube.h"

namespace luxel::hemicube::testing {

inline scene::Scene scene_of(scene::Mesh mesh, const Mat34& world_from_object = {}) {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::place(scene, std::move(mesh), world_from_object);
  return scene;
}

/// The square [0, 1]^2 at y = 0, front upwards.
inline scene::Mesh unit_square() {
  scene::Mesh mesh;
  scene::add_quad(mesh, {Vec3{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}, 0);
  return mesh;
}

inline scene::Mesh unit_cube() {
  scene::Mesh mesh;
  scene::add_box(mesh, {0, 0, 0}, {1, 1, 1}, 0);
  return mesh;
}

inline Mesh mesh_of(const scene::Scene& scene, float element_size_m = 0) {
  Progress progress;
  auto mesh = make_mesh(scene, {element_size_m}, progress);
  EXPECT_TRUE(mesh) << mesh.error().message;
  return mesh ? std::move(*mesh) : Mesh{};
}

/// Cuts triangles drawn at random from all that there are by then.
inline void cut_at_random(Mesh& mesh, int times, uint64_t seed) {
  Bisector bisector(mesh);
  RandomStream random{seed};
  for (int i = 0; i < times; ++i) {
    const auto node = uint32_t(random.next() * float(mesh.nodes.size()));
    if (!is_flat(mesh, mesh.nodes[node])) bisector.cut(node);
  }
}

inline Result<Solution> try_to_solve(const scene::Scene& scene, const HemicubeParams& params,
                                     Progress& progress) {
  const auto tracer = trace::RayTracer::build(scene);
  EXPECT_TRUE(tracer);
  return solve(scene, light::collect_lights(scene), *tracer, params, progress);
}

inline Solution solved(const scene::Scene& scene, const HemicubeParams& params) {
  Progress progress;
  auto out = try_to_solve(scene, params, progress);
  EXPECT_TRUE(out) << out.error().message;
  return out ? std::move(*out) : Solution{};
}

}  // namespace luxel::hemicube::testing
