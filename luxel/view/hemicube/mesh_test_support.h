// Helpers for tests of the workshop: meshes of scenes, and their vertices.
#pragma once

#include <gtest/gtest.h>

#include "luxel/light/lights.h"
#include "luxel/view/hemicube/live_hemicube.h"

namespace luxel::view::testing {

/// A mesh of a scene, as the solver would make it, cut to this size [m].
inline std::shared_ptr<const LightMesh> mesh_in(scene::Scene scene, float element_size_m = 0) {
  auto read = std::make_shared<ReadScene>();
  read->scene = std::move(scene);
  read->tracer.emplace(*trace::RayTracer::build(read->scene));
  Progress progress;
  auto mesh = hemicube::make_mesh(read->scene, {element_size_m}, progress);
  EXPECT_TRUE(mesh);
  hemicube::Receivers receivers =
      hemicube::make_receivers(read->scene, *mesh, hemicube::ElementKind::vertex);
  hemicube::Emission emission = hemicube::choose_emission(light::collect_lights(read->scene));
  return std::make_shared<LightMesh>(
      LightMesh{std::move(read), std::move(*mesh), std::move(receivers), std::move(emission), {}});
}

/// The vertex at a place; the test fails where there is none.
inline uint32_t vertex_at(const LightMesh& mesh, Vec3 place) {
  for (uint32_t v = 0; v < mesh.mesh.vertices.size(); ++v)
    if (length(mesh.mesh.points[mesh.mesh.point_of[v]] - place) < 1e-5f) return v;
  ADD_FAILURE() << "there is no vertex";
  return 0;
}

}  // namespace luxel::view::testing
