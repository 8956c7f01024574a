#include "luxel/solve/hemicube/receivers.h"

#include <algorithm>

#include "luxel/base/parallel.h"

namespace luxel::hemicube {
namespace {

/// The distance into its triangles at which a vertex at the rim is looked at, in parts of their
/// size: see make_receivers; and in parts of the way to the nearest opposite edge, at most.
constexpr float kInset = 0.1f, kMostInset = 0.5f;

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

/// What is known of a vertex from the triangles around it.
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

std::vector<Fan> fans_of(const Mesh& mesh, std::span<const uint32_t> leaves,
                         std::span<const LeafEdge> edges) {
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

void place_vertices(const scene::Scene& scene, const Mesh& mesh, std::span<const Fan> fans,
                    transport::Elements& e) {
  parallel_for(mesh.vertices.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const transport::SmoothPoint at = transport::smooth_point(scene, mesh.vertices[i]);
      e.position[i] = at.start, e.normal[i] = at.normal;
      e.geometric_normal[i] = at.geometric_normal;
      const Fan& fan = fans[i];
      if (!fan.at_rim || !(fan.inset_m() > 0)) continue;
      const Vec3 along = fan.inwards - at.geometric_normal * dot(fan.inwards, at.geometric_normal);
      e.position[i] += normalize(along) * fan.inset_m();
    }
  });
}

void place_triangles(const scene::Scene& scene, const Mesh& mesh, std::span<const uint32_t> leaves,
                     transport::Elements& e) {
  parallel_for(leaves.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const scene::SurfacePoint centroid = scene_point(mesh.nodes[leaves[i]], {1 / 3.0f, 1 / 3.0f});
      const transport::SmoothPoint at = transport::smooth_point(scene, centroid);
      e.position[i] = at.start, e.normal[i] = at.normal;
      e.geometric_normal[i] = at.geometric_normal;
    }
  });
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

}  // namespace

Receivers make_receivers(const scene::Scene& scene, const Mesh& mesh, ElementKind kind) {
  Receivers r;
  r.kind = kind;
  r.leaves = leaves(mesh);
  r.leaf_of_node.assign(mesh.nodes.size(), kNone);
  for (uint32_t i = 0; i < r.leaves.size(); ++i) r.leaf_of_node[r.leaves[i]] = i;
  const size_t count = kind == ElementKind::vertex ? mesh.vertices.size() : r.leaves.size();
  transport::Elements& e = r.elements;
  e.position.resize(count), e.normal.resize(count), e.geometric_normal.resize(count);
  e.reflectance.resize(count), r.area_m2.resize(count);
  const std::vector<LeafEdge> edges = sorted_edges(mesh, r.leaves);
  if (kind == ElementKind::vertex)
    place_vertices(scene, mesh, fans_of(mesh, r.leaves, edges), e);
  else
    place_triangles(scene, mesh, r.leaves, e);
  average_reflectances(scene, mesh, r);
  r.neighbours = neighbours_of(edges, kind, count);
  return r;
}

}  // namespace luxel::hemicube
