#include "bench/large_scenes.h"

#include "luxel/base/random.h"
#include "luxel/scene/grid.h"
#include "luxel/scene/place_camera.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::bench {
namespace {

constexpr float kSide_m = 100;

/// Waves of half the length and a little less than half the height of those before.
float height_m(float x, float z) {
  float sum = 0, height = 4, length = 40;
  for (int octave = 0; octave < 6; ++octave) {
    const float k = 2 * kPi / length, turn = 0.9f * float(octave);
    const float u = std::cos(turn) * x + std::sin(turn) * z;
    const float v = std::cos(turn) * z - std::sin(turn) * x;
    sum += height * std::sin(k * u + 1.7f * float(octave)) * std::sin(k * v);
    height *= 0.42f, length *= 0.5f;
  }
  return sum;
}

scene::Scene under_the_sky(std::string name) {
  scene::Scene out;
  out.name = std::move(name);
  out.background = {0.5f, 0.6f, 0.8f};
  scene::PunctualLight sun;
  sun.name = "sun";
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.intensity = {6, 5.5f, 5};
  sun.direction = normalize(Vec3{1, -1, 0.4f});
  sun.angular_radius_rad = 0.00465f;
  out.lights.push_back(sun);
  return out;
}

/// A ball whose surface rises and falls.
scene::Mesh rock(int levels) {
  scene::Mesh mesh = scene::inward_sphere(1, levels, {0.5f, 0.5f, 0.5f}, {}).meshes.front();
  mesh.name = "rock";
  mesh.normals.clear();
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);  // seen from outside
  for (Vec3& p : mesh.positions)
    p = p * (1 + 0.02f * height_m(9 * p.x + 5 * p.y, 9 * p.z - 4 * p.y));
  return mesh;
}

}  // namespace

scene::Scene hills(int quads) {
  scene::Scene out = under_the_sky("hills");
  scene::Mesh mesh;
  mesh.name = "hills";
  const float step = kSide_m / float(quads);
  for (int j = 0; j <= quads; ++j)
    for (int i = 0; i <= quads; ++i) {
      const float x = step * float(i), z = step * float(j);
      mesh.positions.push_back({x, height_m(x, z), z});
    }
  scene::add_grid_triangles(mesh, quads);
  mesh.triangle_material.assign(mesh.triangles.size(),
                                scene::add_material(out, "grass", {0.3f, 0.4f, 0.2f}));
  scene::place(out, std::move(mesh));
  scene::place_camera(out, "above", {50, 40, 130}, {50, 0, 50}, 0.8f, 1.5f);
  return out;
}

scene::Scene rocks(int levels, int copies) {
  scene::Scene out = under_the_sky("rocks");
  const uint32_t sand = scene::add_material(out, "sand", {0.5f, 0.45f, 0.35f});
  scene::add_rectangle(out, {0, kSide_m, 0, kSide_m}, 0, true, sand);
  scene::Mesh mesh = rock(levels);
  mesh.triangle_material.assign(mesh.triangles.size(),
                                scene::add_material(out, "stone", {0.4f, 0.4f, 0.42f}));
  out.meshes.push_back(std::move(mesh));
  const uint32_t stored = uint32_t(out.meshes.size() - 1);
  RandomStream random{5};
  for (int k = 0; k < copies; ++k) {
    const float turn = 2 * kPi * random.next(), size = 1 + 3 * random.next();
    const float c = size * std::cos(turn), s = size * std::sin(turn);
    scene::Instance instance;
    instance.name = "rock " + std::to_string(k + 1);
    instance.mesh = stored;
    instance.world_from_object =
        from_columns({c, 0, -s}, {0, size, 0}, {s, 0, c},
                     {kSide_m * random.next(), 0.4f * size, kSide_m * random.next()});
    out.instances.push_back(std::move(instance));
  }
  scene::place_camera(out, "above", {50, 25, 130}, {50, 0, 50}, 0.8f, 1.5f);
  return out;
}

}  // namespace luxel::bench
