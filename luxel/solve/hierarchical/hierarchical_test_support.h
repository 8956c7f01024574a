// Small scenes and whole solutions for the tests of this room.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>

#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/solve/hierarchical/solve.h"

namespace luxel::hierarchical::testing {

inline void add_polygon(scene::Scene& scene, const std::string& name,
                        const std::vector<DVec3>& corners, uint32_t material) {
  scene::Mesh mesh;
  mesh.name = name;
  for (size_t k = 1; k + 1 < corners.size(); ++k)
    scene::add_triangle(mesh, to_float(corners[0]), to_float(corners[k]), to_float(corners[k + 1]),
                        material);
  scene::place(scene, std::move(mesh));
}

/// A floor of 5 m, a square lamp 2.5 m above it, and 1 m above it a screen whose edge is x = 0.25
/// m.
inline scene::Scene lamp_and_screen(float lamp_half_m, float radiance) {
  scene::Scene scene;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  const uint32_t lamp =
      scene::add_material(scene, "lamp", {0, 0, 0}, {radiance, radiance, radiance});
  scene::add_rectangle(scene, {-2.5f, 2.5f, -2.5f, 2.5f}, 0, true, gray);
  scene::add_rectangle(scene, {-lamp_half_m, lamp_half_m, -lamp_half_m, lamp_half_m}, 2.5f, false,
                       lamp);
  scene::add_rectangle(scene, {-1.5f, 0.25f, -1, 1}, 1, true, gray);
  return scene;
}

/// A scene with what its solution needs; it stays where it was made.
struct Solved {
  scene::Scene scene;
  std::optional<trace::RayTracer> tracer;
  Solution solution;
};

inline std::unique_ptr<Solved> solved(scene::Scene scene, const SolveParams& params = {}) {
  auto out = std::make_unique<Solved>();
  out->scene = std::move(scene);
  out->tracer = *trace::RayTracer::build(out->scene);
  Progress progress;
  auto solution = solve(out->scene, *out->tracer, params, progress);
  EXPECT_TRUE(solution) << solution.error().message;
  if (solution) out->solution = std::move(*solution);
  return out;
}

/// A tree of whole faces, without cuts.
inline Tree tree_of(const Faces& faces) {
  std::vector<std::vector<Polygon>> pieces;
  for (const Face& face : faces.faces) pieces.push_back({face.corners});
  return make_tree(pieces);
}

inline size_t leaf_count(const Tree& tree) {
  size_t count = 0;
  for (const Element& e : tree.elements) count += e.is_leaf();
  return count;
}

}  // namespace luxel::hierarchical::testing
