#include "luxel/trace/vulkan/driver_hierarchy.h"

#include <gtest/gtest.h>

#include <bit>
#include <set>

#include "luxel/scene/procedural.h"

namespace luxel::trace {
namespace {

/// A sphere that stands twice, and one with a mask that stands once.
scene::Scene three_spheres() {
  scene::Scene scene = scene::inward_sphere(1, 3, {0.5f, 0.5f, 0.5f}, {});
  scene.instances.push_back({"other", 0, translation({3, 0, 0})});
  scene.meshes.push_back(scene.meshes[0]);
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].alpha_mode = scene::AlphaMode::mask, scene.materials[1].alpha = 0.1f;
  for (uint32_t t = 0; t < scene.meshes[1].triangle_material.size(); t += 3)
    scene.meshes[1].triangle_material[t] = 1;
  scene.instances.push_back({"third", 1, translation({0, 5, 0})});
  return scene;
}

// Parts are small; each triangle is in one of them, those that let light through behind the others;
// and each instance knows where its part and its numbers begin.
TEST(DriverHierarchy, HasEachTriangleOnce) {
  const scene::Scene scene = three_spheres();
  const std::vector<uint32_t> first = scene::first_triangles(scene);
  const auto made = driver_hierarchy(scene, 0, 100);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(made->has_instances);
  size_t end = made->places.size();
  EXPECT_GT(made->parts.size(), 2 * 1280u / 100);
  for (const DriverPart& part : made->parts) {
    EXPECT_EQ(part.first, end);
    EXPECT_LE(part.end - part.first, 100u);
    for (uint32_t k = part.first; k < part.end; ++k)
      EXPECT_EQ(made->triangles[k].see_through != 0, k >= part.first_open);
    end = part.end;
  }
  EXPECT_EQ(made->triangles.size(), end);
  std::set<uint32_t> numbers;
  for (size_t i = 0; i < made->places.size(); ++i) {
    EXPECT_EQ(made->places[i].instanceCustomIndex, i);
    const DriverPart& part = made->parts[made->places[i].accelerationStructureReference];
    const auto instance = std::bit_cast<DriverInstance>(made->triangles[i]);
    EXPECT_EQ(instance.first, part.first);
    EXPECT_EQ(instance.first_open, part.first_open);
    const bool is_shared = instance.instance != scene::kNone;
    EXPECT_EQ(made->places[i].transform.matrix[0][3], is_shared ? 3 * float(instance.instance) : 0);
    EXPECT_EQ(instance.first_number, is_shared ? first[instance.instance] : 0);
    for (uint32_t k = part.first; k < part.end; ++k)
      EXPECT_TRUE(numbers.insert(made->triangles[k].number + instance.first_number).second);
  }
  EXPECT_EQ(numbers.size(), 3 * 1280u);
  EXPECT_EQ(*numbers.rbegin(), 3 * 1280u - 1);
}

}  // namespace
}  // namespace luxel::trace
