#include "luxel/solve/hemicube/receivers.h"

#include <algorithm>

#include "luxel/base/parallel.h"
#include "luxel/transport/elements_at.h"

namespace luxel::hemicube {
namespace {

/// The distance into its triangles at which a vertex at the rim is looked at, in parts of their
/// size: see make_receivers; and in parts of the way to the nearest opposite edge, at most.
constexpr float kInset = 0.1f, kMostInset = 0.5f;
/// Walls count as near within this part of the inset, before them and behind their faces. Beside a
/// corner's bisector both rims are nearer than the inset, by 0.7 in a right angle.
constexpr float kAtFoot = 0.5f;
/// A step off a wall is free where nothing else stands within this part of it.
constexpr float kFree = 0.98f;
/// Ways to look for walls: one is within 23 degrees of a wall's normal.
constexpr uint32_t kWays = 8;
/// A wall's face is at more than 60 degrees to the surface, as creases are (weld.cpp), and no
/// ceiling that lies on it.
constexpr float kLeastWall = -0.9f, kMostWall = 0.5f;

/// An edge of a leaf, by its vertices.
struct LeafEdge {
  uint32_t low = 0, high = 0, leaf = 0;
  friend auto operator<=>(const LeafEdge&, const LeafEdge&) = default;
};

std::vector<LeafEdge> sorted_edges(const Mesh& mesh, std::span<const uint32_t> leaves) {
  std::vector<LeafEdge> edges;
  edges.reserve(3 * leaves.size());
  for (uint32_t i = 0; i < leaves.size(); ++i) {
    const auto& v = mesh.nodes[leaves[i]].vertex;
    for (size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(v[k], v[(k + 1) % 3]);
      edges.push_back({low, high, i});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// Calls visit(first, last) for every edge with the range of its triangles.
template <class Visit>
void for_each_edge(std::span<const LeafEdge> edges, const Visit& visit) {
  for (size_t i = 0; i < edges.size();) {
    size_t end = i + 1;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high)
      ++end;
    visit(edges.subspan(i, end - i));
    i = end;
  }
}

Neighbours neighbours_of(std::span<const LeafEdge> edges, ElementKind kind, size_t count) {
  std::vector<std::array<uint32_t, 2>> pairs;
  for_each_edge(edges, [&](std::span<const LeafEdge> at) {
    if (kind == ElementKind::vertex) {
      pairs.push_back({at[0].low, at[0].high});
      pairs.push_back({at[0].high, at[0].low});
    } else {
      for (const LeafEdge& a : at)
        for (const LeafEdge& b : at)
          if (a.leaf != b.leaf) pairs.push_back({a.leaf, b.leaf});
    }
  });
  std::sort(pairs.begin(), pairs.end());
  Neighbours out;
  out.first.assign(count + 1, 0);
  for (const auto& [from, to] : pairs) ++out.first[from + 1], out.element.push_back(to);
  for (size_t i = 0; i < count; ++i) out.first[i + 1] += out.first[i];
  return out;
}

/// Measures of the triangles around a vertex.
struct Fan {
  Vec3 inwards{};                   ///< sum of the corners' bisectors by their angles
  float area_m2 = 0, sizes_m3 = 0;  ///< sums over triangles: of areas, and of areas times legs
  float nearest_edge_m = INFINITY;  ///< of those opposite
  bool at_rim = false;

  /// Light at the vertex counts in each triangle by its area.
  float inset_m() const {
    return area_m2 > 0 ? std::min(kInset * sizes_m3 / area_m2, kMostInset * nearest_edge_m) : 0;
  }
};

/// Rims are known by the edges.
std::vector<Fan> fans_of(const Mesh& mesh, std::span<const uint32_t> leaves,
                         std::span<const LeafEdge> edges = {}) {
  std::vector<Fan> fans(mesh.vertices.size());
  for (const uint32_t leaf : leaves) {
    const Node& node = mesh.nodes[leaf];
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 at = mesh.points[node.point[k]];
      const Vec3 to_next = mesh.points[node.point[(k + 1) % 3]] - at;
      const Vec3 to_last = mesh.points[node.point[(k + 2) % 3]] - at;
      const Vec3 a = normalize(to_next), b = normalize(to_last);
      Fan& fan = fans[node.vertex[k]];
      fan.inwards += normalize(a + b) * std::acos(std::clamp(dot(a, b), -1.0f, 1.0f));
      const float area2 = length(cross(to_next, to_last));
      if (!(area2 > 0)) continue;
      fan.area_m2 += area2 / 2, fan.sizes_m3 += area2 / 2 * std::sqrt(area2);
      fan.nearest_edge_m = std::min(fan.nearest_edge_m, area2 / length(to_next - to_last));
    }
  }
  for_each_edge(edges, [&](std::span<const LeafEdge> at) {
    if (at.size() == 1) fans[at[0].low].at_rim = fans[at[0].high].at_rim = true;
  });
  return fans;
}

transport::Elements places_of_vertices(const scene::Scene& scene, const Mesh& mesh,
                                       std::span<const Fan> fans) {
  transport::Elements e = transport::elements_at(scene, mesh.vertices);
  for (size_t i = 0; i < fans.size(); ++i) {
    const Fan& fan = fans[i];
    if (!fan.at_rim || !(fan.inset_m() > 0)) continue;
    const Vec3 n = e.geometric_normal[i];
    e.position[i] += normalize(fan.inwards - n * dot(fan.inwards, n)) * fan.inset_m();
  }
  return e;
}

/// Over the triangle: at its centroid where the material has one colour, else the mean over ten
/// points on a triangular grid.
Rgb mean_reflectance(const scene::Scene& scene, const Node& node) {
  const scene::SurfacePoint centroid = scene_point(node, {1 / 3.0f, 1 / 3.0f});
  const scene::Material& material = scene::material_at(scene, centroid);
  const bool coloured = !scene.meshes[scene.instances[node.instance].mesh].colors.empty();
  if (material.base_color_texture.texture == scene::kNone &&
      material.metallic_texture.texture == scene::kNone && !coloured)
    return scene::reflectance_at(scene, centroid);
  constexpr int kRows = 4;
  Rgb sum{};
  int count = 0;
  for (int j = 0; j < kRows; ++j)
    for (int i = 0; i + j < kRows; ++i, ++count) {
      const Barycentric at{(float(i) + 1 / 3.0f) / kRows, (float(j) + 1 / 3.0f) / kRows};
      sum += scene::reflectance_at(scene, scene_point(node, at));
    }
  return sum / float(count);
}

float area_m2(const Mesh& mesh, const Node& node) {
  return scene::area_m2(
      {mesh.points[node.point[0]], mesh.points[node.point[1]], mesh.points[node.point[2]]});
}

/// Areas and reflectances: a vertex has the mean of its triangles', by their areas.
void average_reflectances(const scene::Scene& scene, const Mesh& mesh, Receivers& r) {
  std::vector<Rgb> reflectance(r.leaves.size());
  parallel_for(r.leaves.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      reflectance[i] = mean_reflectance(scene, mesh.nodes[r.leaves[i]]);
  });
  MappedVector<Rgb>& out = r.elements.reflectance;
  for (size_t i = 0; i < r.leaves.size(); ++i) {
    const Node& node = mesh.nodes[r.leaves[i]];
    const float area = area_m2(mesh, node);
    if (r.kind == ElementKind::triangle) {
      out[i] = reflectance[i], r.area_m2[i] = area;
      continue;
    }
    for (const uint32_t v : node.vertex) {
      out[v] += reflectance[i] * (area / 3);
      r.area_m2[v] += area / 3;
    }
  }
  if (r.kind == ElementKind::vertex)
    for (size_t v = 0; v < out.size(); ++v)
      if (r.area_m2[v] > 0)
        // Rounding in a mean must not lift it over the reflectance of surfaces, or light in a white
        // furnace would grow from pass to pass.
        out[v] = min(out[v] / r.area_m2[v],
                     Rgb{scene::kMaxReflectance, scene::kMaxReflectance, scene::kMaxReflectance});
}

/// The face of a wall by which a vertex stands.
struct NearWall {
  Vec3 away;                    ///< from it, along the vertex's own surface
  float distance_m = INFINITY;  ///< of the vertex; < 0: behind it
};

/// The nearest wall on the surface at `from`, by rays across a circle about it: those that start in
/// front of the wall meet its front, wherever `from` itself lies.
NearWall nearest_wall(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from,
                      Vec3 normal, float radius_m) {
  std::array<trace::Ray, kWays> rays;
  std::array<trace::Hit, kWays> hits;
  const Frame frame = frame_around(normal);
  for (uint32_t k = 0; k < kWays; ++k) {
    const float angle = 2 * kPi * (float(k) + 0.5f) / float(kWays);
    const Vec3 d = frame.to_world({std::cos(angle), std::sin(angle), 0});
    rays[k] = {from + d * radius_m, 0, -d, 2 * radius_m};
  }
  tracer.closest_hits(rays, hits);
  NearWall out;
  for (uint32_t k = 0; k < kWays; ++k) {
    if (!hits[k].found()) continue;
    const scene::SurfacePoint at = hits[k].point();
    if (hits[k].back_face && !scene::reflects_from_behind(scene::material_at(scene, at))) continue;
    const Vec3 front = scene::front_normal(scene, at.instance, at.triangle);
    const Vec3 face = hits[k].back_face ? -front : front;
    const float lean = dot(face, normal);
    if (lean < kLeastWall || lean > kMostWall) continue;
    const Vec3 away = normalize(face - normal * lean);
    const float distance_m = dot(rays[k].direction, away) * (radius_m - hits[k].t);
    if (std::abs(distance_m) < std::abs(out.distance_m)) out = {away, distance_m};
  }
  return out;
}

/// `from`, or as far off the walls there as a vertex at a rim. A corner has two of them. In a
/// narrow gap the way off one wall leads through another, and `from` stays.
Vec3 off_walls(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from, Vec3 normal,
               float radius_m) {
  Vec3 to = from;
  for (int walls = 0; walls < 2; ++walls) {
    const NearWall wall = nearest_wall(scene, tracer, to, normal, radius_m);
    if (!(std::abs(wall.distance_m) < kAtFoot * radius_m)) break;
    to += wall.away * (radius_m - wall.distance_m);
    if (tracer.closest_hit({to, 0, -wall.away, kFree * radius_m}).found()) return from;
  }
  return to;
}

}  // namespace

transport::Elements places_of_triangles(const scene::Scene& scene, const Mesh& mesh,
                                        std::span<const uint32_t> leaves) {
  std::vector<scene::SurfacePoint> centroids;
  centroids.reserve(leaves.size());
  for (const uint32_t leaf : leaves)
    centroids.push_back(scene_point(mesh.nodes[leaf], {1 / 3.0f, 1 / 3.0f}));
  return transport::elements_at(scene, centroids);
}

Receivers make_receivers(const scene::Scene& scene, const Mesh& mesh, ElementKind kind) {
  Receivers r;
  r.kind = kind;
  r.leaves = leaves(mesh);
  r.leaf_of_node.assign(mesh.nodes.size(), kNone);
  for (uint32_t i = 0; i < r.leaves.size(); ++i) r.leaf_of_node[r.leaves[i]] = i;
  const size_t count = kind == ElementKind::vertex ? mesh.vertices.size() : r.leaves.size();
  const std::vector<LeafEdge> edges = sorted_edges(mesh, r.leaves);
  r.elements = kind == ElementKind::vertex
                   ? places_of_vertices(scene, mesh, fans_of(mesh, r.leaves, edges))
                   : places_of_triangles(scene, mesh, r.leaves);
  r.elements.reflectance.resize(count), r.area_m2.resize(count);
  average_reflectances(scene, mesh, r);
  r.neighbours = neighbours_of(edges, kind, count);
  return r;
}

void step_off_walls(const scene::Scene& scene, const trace::RayTracer& tracer, const Mesh& mesh,
                    Receivers& receivers) {
  if (receivers.kind != ElementKind::vertex) return;
  const std::vector<Fan> fans = fans_of(mesh, receivers.leaves);
  transport::Elements& e = receivers.elements;
  parallel_for(fans.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (const float inset_m = fans[i].inset_m(); inset_m > 0)
        e.position[i] = off_walls(scene, tracer, e.position[i], e.geometric_normal[i], inset_m);
  });
}

}  // namespace luxel::hemicube
