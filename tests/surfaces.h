// Queries of tests about the surfaces of a scene.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "luxel/scene/scene.h"

namespace luxel::testing_support {

inline uint32_t instance_named(const scene::Scene& scene, const std::string& name) {
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    if (scene.instances[i].name == name) return i;
  ADD_FAILURE() << "no instance " << name;
  return 0;
}

/// The triangles of all instances, corners counter-clockwise from the front.
inline std::vector<scene::Triangle3> triangles_of(const scene::Scene& scene) {
  std::vector<scene::Triangle3> all;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t)
      all.push_back(scene::world_triangle(scene, i, t));
  return all;
}

inline double total_area(const std::vector<scene::Triangle3>& triangles) {
  double sum = 0;
  for (const scene::Triangle3& t : triangles) sum += double(scene::area_m2(t));
  return sum;
}

/// Closed and consistently wound: every directed edge occurs once, and so does its opposite.
inline void expect_closed(const std::vector<scene::Triangle3>& triangles) {
  using Key = std::tuple<float, float, float>;
  const auto key = [](Vec3 p) { return Key{p.x, p.y, p.z}; };
  std::map<std::pair<Key, Key>, int> edges;
  for (const scene::Triangle3& t : triangles) {
    ++edges[{key(t.a), key(t.b)}];
    ++edges[{key(t.b), key(t.c)}];
    ++edges[{key(t.c), key(t.a)}];
  }
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
}

/// Vertices, by position, in the midst of an edge of some triangle, within a millionth of the
/// scene's diagonal.
inline size_t count_t_junctions(const std::vector<scene::Triangle3>& triangles) {
  Box3 box;
  for (const scene::Triangle3& t : triangles) box.extend(t.a), box.extend(t.b), box.extend(t.c);
  const double near = 1e-6 * double(box.diagonal());
  std::map<std::tuple<float, float, float>, DVec3> places;
  for (const scene::Triangle3& t : triangles)
    for (const Vec3 p : {t.a, t.b, t.c}) places.emplace(std::tuple(p.x, p.y, p.z), to_double(p));
  size_t count = 0;
  for (const auto& place : places) {
    const DVec3 p = place.second;
    const auto is_amidst = [&](Vec3 a, Vec3 b) {
      const DVec3 along = to_double(b) - to_double(a), d = p - to_double(a);
      const double edge = length(along), at = dot(d, along) / edge;
      return at > near && at < edge - near && length(cross(d, along)) <= near * edge;
    };
    count += std::ranges::any_of(triangles, [&](const scene::Triangle3& t) {
      return is_amidst(t.a, t.b) || is_amidst(t.b, t.c) || is_amidst(t.c, t.a);
    });
  }
  return count;
}

/// Volume inside a closed surface by the divergence theorem; positive when it faces outwards.
inline double signed_volume(const std::vector<scene::Triangle3>& triangles) {
  double volume = 0;
  for (const scene::Triangle3& t : triangles) volume += double(dot(t.a, cross(t.b, t.c))) / 6;
  return volume;
}

inline void expect_consistent(const scene::Scene& scene) {
  for (const scene::Mesh& mesh : scene.meshes) {
    EXPECT_EQ(mesh.triangle_material.size(), mesh.triangles.size());
    EXPECT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
    for (const auto& t : mesh.triangles)
      for (const uint32_t v : t) ASSERT_LT(v, mesh.positions.size());
    for (const uint32_t m : mesh.triangle_material) ASSERT_LT(m, scene.materials.size());
  }
  for (const scene::Instance& instance : scene.instances)
    ASSERT_LT(instance.mesh, scene.meshes.size());
  for (const scene::Triangle3& t : triangles_of(scene)) EXPECT_GT(scene::area_m2(t), 0);
}

}  // namespace luxel::testing_support
