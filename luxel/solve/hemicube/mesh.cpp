#include "luxel/solve/hemicube/mesh.h"

#include <map>

#include "luxel/base/check.h"
#include "luxel/solve/hemicube/bisect.h"
#include "luxel/solve/hemicube/weld.h"

namespace luxel::hemicube {
namespace {

/// Triangles whose longest edge exceeds the goal by less than this stay: cutting them would leave
/// them further below it than they are above.
constexpr double kSlack = 1.19;  // the fourth root of 2

/// Makes the first nodes of the mesh: a regular grid of n^2 triangles on each of an instance's.
struct GridMaker {
  Mesh& mesh;
  const Welded& welded;
  uint32_t n = 1;
  /// Points and vertices on an edge, by its ends (lower number first) and the place from there.
  std::map<std::array<uint32_t, 3>, uint32_t> points, vertices;

  using Ids = std::array<uint32_t, 3>;

  /// The id of place (i, j) of the grid, of corner ids `c`; kNone where it is new.
  static std::array<uint32_t, 3> edge_key(const Ids& c, uint32_t i, uint32_t j, uint32_t n) {
    const std::array<uint32_t, 3> weight{n - i - j, i, j};
    uint32_t a = kNone, b = kNone, along = 0;
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t next = (k + 1) % 3;
      if (weight[(k + 2) % 3] != 0 || (weight[k] == n || weight[next] == n)) continue;
      a = c[k], b = c[next], along = weight[next];
    }
    if (a > b) std::swap(a, b), along = n - along;
    return {a, b, along};
  }

  void add_triangle(uint32_t instance, uint32_t triangle) {
    const uint32_t number = mesh.first_triangle[instance] + triangle;
    const Ids corner = welded.vertex[number];
    const Ids corner_point{mesh.point_of[corner[0]], mesh.point_of[corner[1]],
                           mesh.point_of[corner[2]]};
    rows.assign(n + 1, {});
    for (uint32_t j = 0; j <= n; ++j)
      for (uint32_t i = 0; i + j <= n; ++i)
        rows[j].push_back(place(instance, triangle, corner, corner_point, i, j));
    mesh.first_root.push_back(uint32_t(mesh.nodes.size()));
    for (uint32_t j = 0; j < n; ++j)
      for (uint32_t i = 0; i + j < n; ++i) {
        add_node(instance, triangle, {{{i, j}, {i + 1, j}, {i, j + 1}}});
        if (i + j + 1 < n) add_node(instance, triangle, {{{i + 1, j + 1}, {i, j + 1}, {i + 1, j}}});
      }
  }

  std::vector<std::vector<uint32_t>> rows;  ///< vertices of the triangle at work: rows[j][i]

  using GridPoint = std::array<uint32_t, 2>;

  Barycentric barycentric(GridPoint p) const {
    return {float(p[0]) / float(n), float(p[1]) / float(n)};
  }

  void add_node(uint32_t instance, uint32_t triangle, const std::array<GridPoint, 3>& corners) {
    Node node;
    node.instance = instance, node.triangle = triangle;
    for (size_t k = 0; k < 3; ++k) {
      node.vertex[k] = rows[corners[k][1]][corners[k][0]];
      node.point[k] = mesh.point_of[node.vertex[k]];
      node.at[k] = barycentric(corners[k]);
    }
    mesh.nodes.push_back(node);
  }

  uint32_t new_vertex(uint32_t instance, uint32_t triangle, Barycentric at, uint32_t point) {
    mesh.vertices.push_back({instance, triangle, at});
    mesh.point_of.push_back(point);
    return uint32_t(mesh.vertices.size() - 1);
  }

  uint32_t place(uint32_t instance, uint32_t triangle, const Ids& corner, const Ids& corner_point,
                 uint32_t i, uint32_t j) {
    if (i + j == 0) return corner[0];
    if (i == n) return corner[1];
    if (j == n) return corner[2];
    const Barycentric at = barycentric({i, j});
    const auto new_point = [&] {
      mesh.points.push_back(interpolate(mesh.points[corner_point[0]], mesh.points[corner_point[1]],
                                        mesh.points[corner_point[2]], at));
      return uint32_t(mesh.points.size() - 1);
    };
    if (i > 0 && j > 0 && i + j < n) return new_vertex(instance, triangle, at, new_point());
    const auto point = points.try_emplace(edge_key(corner_point, i, j, n), kNone).first;
    if (point->second == kNone) point->second = new_point();
    const auto vertex = vertices.try_emplace(edge_key(corner, i, j, n), kNone).first;
    if (vertex->second == kNone || mesh.point_of[vertex->second] != point->second)
      vertex->second = new_vertex(instance, triangle, at, point->second);
    return vertex->second;
  }
};

double longest_edge_m(const scene::Triangle3& t) {
  return std::max({length(t.b - t.a), length(t.c - t.b), length(t.a - t.c)});
}

/// So many parts on each edge of an instance's triangles that the smallest of them becomes small
/// enough; the larger ones are cut on.
uint32_t grid_of(const scene::Scene& scene, uint32_t instance, float element_size_m) {
  if (element_size_m <= 0) return 1;
  const size_t count = scene.meshes[scene.instances[instance].mesh].triangles.size();
  double shortest = INFINITY;
  for (uint32_t t = 0; t < count; ++t) {
    const scene::Triangle3 world = scene::world_triangle(scene, instance, t);
    if (scene::area_m2(world) > 0) shortest = std::min(shortest, longest_edge_m(world));
  }
  if (!std::isfinite(shortest)) return 1;
  // A hair of rounding must not make an eleventh part.
  const double parts = std::ceil(shortest / (std::sqrt(2.0) * element_size_m) - 1e-3);
  return uint32_t(std::clamp(parts, 1.0, 4096.0));
}

Status too_many(size_t vertices, const MeshParams& params) {
  if (vertices <= params.max_vertices) return {};
  return fail(ErrorCode::bad_setting,
              "elements of {} m need more than {} vertices; give a larger --element-size, or more "
              "--max-elements",
              params.element_size_m, params.max_vertices);
}

Status cut_to_size(Mesh& mesh, const MeshParams& params, Progress& progress) {
  const double goal = std::sqrt(2.0) * params.element_size_m * kSlack;
  Bisector bisector(mesh);
  // Children come behind their parents, so one pass meets them all.
  for (uint32_t i = 0; i < mesh.nodes.size(); ++i) {
    while (mesh.nodes[i].child == 0 && bisector.longest_edge2(i) > goal * goal &&
           !is_flat(mesh, mesh.nodes[i]))
      bisector.cut(i);
    if (i % 1024 == 0) {
      LUXEL_TRY_STATUS(stopped(progress));
      LUXEL_TRY_STATUS(too_many(mesh.vertices.size(), params));
    }
  }
  return too_many(mesh.vertices.size(), params);
}

}  // namespace

bool is_flat(const Mesh& mesh, const Node& node) {
  const Vec3 a = mesh.points[node.point[0]];
  const Vec3 n = cross(mesh.points[node.point[1]] - a, mesh.points[node.point[2]] - a);
  return !(dot(n, n) > 0);
}

Result<Mesh> make_mesh(const scene::Scene& scene, const MeshParams& params, Progress& progress) {
  progress.begin("mesh", 0);
  Welded welded = weld(scene);
  Mesh mesh;
  mesh.points = std::move(welded.points);
  mesh.vertices = std::move(welded.vertices);
  mesh.point_of = std::move(welded.point_of);
  mesh.first_triangle = scene::first_triangles(scene);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    mesh.grid.push_back(grid_of(scene, i, params.element_size_m));
    GridMaker maker{mesh, welded, mesh.grid.back(), {}, {}, {}};
    const uint32_t count = mesh.first_triangle[i + 1] - mesh.first_triangle[i];
    LUXEL_TRY_STATUS(too_many(size_t(count) * maker.n * maker.n / 2, params));
    for (uint32_t t = 0; t < count; ++t) maker.add_triangle(i, t);
  }
  mesh.first_root.push_back(uint32_t(mesh.nodes.size()));
  mesh.triangle_count = mesh.nodes.size();
  LUXEL_TRY_STATUS(too_many(mesh.vertices.size(), params));
  if (params.element_size_m > 0) LUXEL_TRY_STATUS(cut_to_size(mesh, params, progress));
  return mesh;
}

std::vector<uint32_t> leaves(const Mesh& mesh) {
  std::vector<uint32_t> out;
  out.reserve(mesh.triangle_count);
  for (uint32_t i = 0; i < mesh.nodes.size(); ++i)
    if (mesh.nodes[i].child == 0) out.push_back(i);
  return out;
}

namespace {

Vec2 uv(Barycentric b) { return {b.u, b.v}; }

uint32_t root_at(const Mesh& mesh, const scene::SurfacePoint& p) {
  const uint32_t n = mesh.grid[p.instance];
  const uint32_t first = mesh.first_root[mesh.first_triangle[p.instance] + p.triangle];
  if (n == 1) return first;
  const float x = std::max(0.0f, p.at.u) * float(n), y = std::max(0.0f, p.at.v) * float(n);
  const uint32_t j = std::min(uint32_t(y), n - 1);
  const uint32_t i = std::min(uint32_t(x), n - 1 - j);
  const bool upper = i + j + 1 < n && (x - float(i)) + (y - float(j)) > 1;
  return first + j * (2 * n - j) + 2 * i + (upper ? 1 : 0);
}

}  // namespace

MeshPoint locate(const Mesh& mesh, const scene::SurfacePoint& p) {
  uint32_t index = root_at(mesh, p);
  const Vec2 x = uv(p.at);
  while (mesh.nodes[index].child != 0) {
    const Node& node = mesh.nodes[index];
    const Node& first = mesh.nodes[node.child];
    // The cut runs from the first part's corner 1 to its corner 2; that part lies to its left.
    const Vec2 from = uv(first.at[1]), to = uv(first.at[2]);
    index = node.child + (cross(to - from, x - from) >= 0 ? 0 : 1);
  }
  const Node& node = mesh.nodes[index];
  const Vec2 a = uv(node.at[0]), e1 = uv(node.at[1]) - a, e2 = uv(node.at[2]) - a, d = x - a;
  const float area = cross(e1, e2);
  const float u = std::clamp(cross(d, e2) / area, 0.0f, 1.0f);
  return {index, {u, std::clamp(cross(e1, d) / area, 0.0f, 1.0f - u)}};
}

scene::SurfacePoint scene_point(const Node& node, Barycentric at) {
  const auto mix = [&](float a, float b, float c) { return interpolate(a, b, c, at); };
  return {node.instance,
          node.triangle,
          {mix(node.at[0].u, node.at[1].u, node.at[2].u),
           mix(node.at[0].v, node.at[1].v, node.at[2].v)}};
}

}  // namespace luxel::hemicube
