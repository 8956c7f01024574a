// The hemicube's elements one by one against the path tracer, where walls meet.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/random.h"
#include "reference/path_tracer.h"
#include "scene/procedural.h"
#include "solve/hemicube/hemicube.h"

namespace luxel::hemicube {
namespace {

struct Judged {
  double worst = 0, rms = 0, noise = 0;
  Vec3 where;
};

/// A solution's elements against paths from the elements' own places.
Judged judged(const scene::Scene& scene, const trace::RayTracer& tracer, const Solution& s,
              std::span<const uint32_t> chosen, int paths) {
  const transport::Elements& e = s.field.receivers.elements;
  std::vector<Vec3> position, normal;
  for (const uint32_t i : chosen) position.push_back(e.position[i]), normal.push_back(e.normal[i]);
  Progress progress;
  const auto truth = reference::irradiance_by_paths(scene, {position, normal, normal}, tracer,
                                                    {paths, -1, 5}, progress);
  EXPECT_TRUE(truth);
  Judged out;
  for (size_t k = 0; k < chosen.size(); ++k) {
    const double exact = double(luminance(truth->irradiance[k]));
    const double error = std::abs(double(luminance(s.field.irradiance[chosen[k]])) / exact - 1);
    out.noise = std::max(out.noise, double(truth->luminance_error[k]) / exact);
    out.rms += error * error / double(chosen.size());
    if (error > out.worst) out.worst = error, out.where = position[k];
  }
  out.rms = std::sqrt(out.rms);
  return out;
}

/// Elements in corners (where three walls meet), on creases and inside faces: all of the first,
/// some of the others.
std::vector<uint32_t> corners_first(const Solution& s, size_t of_each) {
  const Mesh& mesh = s.field.mesh;
  std::vector<int> sides(mesh.points.size());
  for (const uint32_t p : mesh.point_of) ++sides[p];
  std::array<std::vector<uint32_t>, 3> kinds;
  for (uint32_t i = 0; i < s.field.receivers.size(); ++i) {
    int most = 1;
    if (s.field.receivers.kind == ElementKind::vertex)
      most = sides[mesh.point_of[i]];
    else
      for (const uint32_t p : mesh.nodes[s.field.receivers.leaves[i]].point)
        most = std::max(most, sides[p]);
    kinds[size_t(std::clamp(3 - most, 0, 2))].push_back(i);
  }
  std::vector<uint32_t> out;
  RandomStream random{4};
  for (const auto& kind : kinds) {
    EXPECT_FALSE(kind.empty());
    for (size_t k = 0; k < of_each; ++k)
      out.push_back(kind[size_t(random.next() * float(kind.size()))]);
  }
  return out;
}

/// A box of which one wall alone shines.
scene::Scene box_with_one_bright_wall() {
  scene::Scene box = scene::furnace_box({0.5f, 0.5f, 0.5f}, {});
  scene::Material bright = box.materials[0];
  bright.emission = {1, 1, 1};
  box.materials.push_back(bright);
  for (uint32_t t = 0; t < box.meshes[0].triangles.size(); ++t)
    if (scene::front_normal(box, 0, t).y < -0.9f) box.meshes[0].triangle_material[t] = 1;
  return box;
}

// "No artefact in the corners": rows of dark or bright elements where hemicubes are cut by walls.
TEST(SlowCorners, NoElementErrsByMoreThanFivePercent) {
  constexpr int kPaths = 16384;
  for (const auto& [name, scene] :
       {std::pair<const char*, scene::Scene>{"empty Cornell box",
                                             scene::cornell_box(scene::CornellColors::pbrt, false)},
        {"bright wall", box_with_one_bright_wall()}})
    for (const ElementKind kind : {ElementKind::vertex, ElementKind::triangle}) {
      SCOPED_TRACE(name);
      const auto tracer = trace::RayTracer::build(scene);
      HemicubeParams params;
      params.elements = kind, params.max_elements = 4000;
      Progress progress;
      const auto s = solve(scene, transport::collect_lights(scene), *tracer, params, progress);
      ASSERT_TRUE(s) << s.error().message;
      const Judged j = judged(scene, *tracer, *s, corners_first(*s, 16), kPaths);
      std::printf(
          "%-18s %-9s %zu elements: worst %.4f at (%.3f, %.3f, %.3f), rms %.4f, noise %.4f\n", name,
          kind == ElementKind::vertex ? "vertices" : "triangles", s->field.receivers.size(),
          j.worst, double(j.where.x), double(j.where.y), double(j.where.z), j.rms, j.noise);
      EXPECT_LT(j.noise, 0.01);
      EXPECT_LT(j.worst, 0.05);
    }
}

}  // namespace
}  // namespace luxel::hemicube
