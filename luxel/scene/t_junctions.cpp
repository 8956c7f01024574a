#include "luxel/scene/t_junctions.h"

#include <algorithm>
#include <map>
#include <optional>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/scene/cut_mesh.h"
#include "luxel/scene/pieces.h"

namespace luxel::scene {
namespace {

/// A piece has new edges, on which there may be more.
constexpr int kMostPasses = 8;

/// A vertex of the scene.
struct WorldVertex {
  Vec3 at;
  uint32_t instance = 0, vertex = 0;
};

double along(DVec3 p, size_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }
double along(const WorldVertex& v, size_t axis) { return along(to_double(v.at), axis); }

/// Vertices, found by the box around them: sorted along each axis.
class SortedVertices {
 public:
  explicit SortedVertices(std::vector<WorldVertex> all) {
    for (size_t axis = 0; axis < 3; ++axis) {
      by_axis_[axis] = all;
      std::ranges::stable_sort(by_axis_[axis], [&](const WorldVertex& p, const WorldVertex& q) {
        return along(p, axis) < along(q, axis);
      });
    }
  }

  /// Those between two places along the axis that has fewest of them there.
  std::span<const WorldVertex> between(DVec3 a, DVec3 b, double margin) const {
    std::span<const WorldVertex> best = by_axis_[0];
    for (size_t axis = 0; axis < 3; ++axis) {
      const double lower = std::min(along(a, axis), along(b, axis)) - margin;
      const double upper = std::max(along(a, axis), along(b, axis)) + margin;
      const auto& all = by_axis_[axis];
      const auto begin = std::ranges::lower_bound(
          all, lower, {}, [&](const WorldVertex& v) { return along(v, axis); });
      const auto end =
          std::upper_bound(begin, all.end(), upper,
                           [&](double x, const WorldVertex& v) { return x < along(v, axis); });
      if (size_t(end - begin) < best.size()) best = {begin, end};
    }
    return best;
  }

 private:
  std::array<std::vector<WorldVertex>, 3> by_axis_;
};

/// The vertices that lie on an edge, and where: as a share of it from its lower end on.
struct OnEdge {
  float share = 0;
  uint32_t place = kNone;        ///< the same for all triangles at the edge
  std::optional<Vec3> position;  ///< object space, of a vertex of the same mesh
};

/// Divides the triangles of one mesh.
class EdgeDivider {
 public:
  explicit EdgeDivider(Mesh& mesh) : mesh_(mesh), writer_(mesh) {}

  /// on_edge[k]: in the order of their shares, on the edge from corner k to the next. Edges are
  /// divided in the order of their places, so that both sides of a sheet are alike.
  void divide(uint32_t triangle, const std::array<std::vector<OnEdge>, 3>& on_edge) {
    const Corners whole = mesh_.triangles[triangle];
    std::array<size_t, 3> order{0, 1, 2};
    std::ranges::sort(
        order, [&](size_t p, size_t q) { return is_before(ends(whole, p), ends(whole, q)); });
    std::vector<Corners> pieces{whole};
    for (const size_t k : order) {
      if (on_edge[k].empty()) continue;
      const auto [low, high] = ends(whole, k);
      std::vector<uint32_t> line{low};
      for (const OnEdge& v : on_edge[k]) line.push_back(vertex(low, high, v));
      line.push_back(high);
      if (low != whole[k]) std::ranges::reverse(line);
      fan(line, pieces);
    }
    writer_.replace(triangle, pieces);
  }

  std::vector<uint32_t> finish() { return writer_.finish(); }

 private:
  using Ends = std::pair<uint32_t, uint32_t>;

  Ends ends(const Corners& c, size_t k) const {
    const uint32_t a = c[k], b = c[(k + 1) % 3];
    return is_lower(mesh_.positions[a], mesh_.positions[b]) ? Ends(a, b) : Ends(b, a);
  }
  bool is_before(const Ends& p, const Ends& q) const {
    const Vec3 a = mesh_.positions[p.first], b = mesh_.positions[q.first];
    if (!(a == b)) return is_lower(a, b);
    return is_lower(mesh_.positions[p.second], mesh_.positions[q.second]);
  }

  uint32_t vertex(uint32_t low, uint32_t high, const OnEdge& v) {
    const auto [found, added] = vertex_.emplace(std::array{low, high, v.place}, 0u);
    if (!added) return found->second;
    found->second = append_between(mesh_, low, high, v.share);
    if (v.position) mesh_.positions[found->second] = *v.position;
    return found->second;
  }

  /// Divides the piece at an edge of the triangle into a fan around its third corner.
  static void fan(const std::vector<uint32_t>& line, std::vector<Corners>& pieces) {
    for (Corners& piece : pieces)
      for (size_t k = 0; k < 3; ++k) {
        if (piece[k] != line.front() || piece[(k + 1) % 3] != line.back()) continue;
        const uint32_t apex = piece[(k + 2) % 3];
        piece = {line[0], line[1], apex};
        for (size_t i = 1; i + 1 < line.size(); ++i) pieces.push_back({line[i], line[i + 1], apex});
        return;
      }
  }

  Mesh& mesh_;
  PieceWriter writer_;
  std::map<std::array<uint32_t, 3>, uint32_t> vertex_;  ///< by both ends and the place
};

/// One pass over a scene.
class JunctionCloser {
 public:
  JunctionCloser(Scene& scene, const std::vector<Uncut>& before)
      : scene_(scene),
        before_(before),
        tolerance_(kOnEdge * double(world_bounds(scene).diagonal())),
        all_(vertices(false)),
        new_(vertices(true)) {}

  /// Divides what it has to of an instance. Returns as PieceWriter::finish().
  std::vector<uint32_t> close(uint32_t i) {
    std::vector<uint8_t> has_any(mesh_of(i).triangles.size());
    parallel_for(has_any.size(), 1024, [&](size_t begin, size_t end) {
      for (size_t t = begin; t < end; ++t) has_any[t] = !is_empty(find(i, uint32_t(t)));
    });
    if (std::ranges::count(has_any, 1) == 0) return {};
    EdgeDivider divider(own_mesh(scene_, i));
    for (uint32_t t = 0; t < has_any.size(); ++t)
      if (has_any[t]) divider.divide(t, find(i, t));
    return divider.finish();
  }

 private:
  const Mesh& mesh_of(uint32_t instance) const {
    return scene_.meshes[scene_.instances[instance].mesh];
  }
  Vec3 world(uint32_t instance, uint32_t vertex) const {
    return transform_point(scene_.instances[instance].world_from_object,
                           mesh_of(instance).positions[vertex]);
  }

  /// Those that triangles have.
  std::vector<WorldVertex> vertices(bool new_ones) const {
    std::vector<WorldVertex> out;
    for (uint32_t i = 0; i < scene_.instances.size(); ++i) {
      const Mesh& mesh = mesh_of(i);
      std::vector<uint8_t> is_used(mesh.positions.size());
      for (const Corners& corners : mesh.triangles)
        for (const uint32_t v : corners) is_used[v] = 1;
      for (uint32_t v = new_ones ? before_[i].vertices : 0; v < is_used.size(); ++v)
        if (is_used[v]) out.push_back({world(i, v), i, v});
    }
    return out;
  }

  using OnEdges = std::array<std::vector<OnEdge>, 3>;
  static bool is_empty(const OnEdges& e) { return e[0].empty() && e[1].empty() && e[2].empty(); }

  OnEdges find(uint32_t i, uint32_t triangle) const {
    const Corners& c = mesh_of(i).triangles[triangle];
    OnEdges out;
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = c[k], b = c[(k + 1) % 3];
      if (is_flat_over(i, a, b, c[(k + 2) % 3])) continue;
      out[k] = on_edge(i, a, b, is_within(i, triangle, a, b) ? all_ : new_);
    }
    return out;
  }

  /// True where a triangle's third corner lies on its edge itself: parts of it would have no area.
  bool is_flat_over(uint32_t i, uint32_t a, uint32_t b, uint32_t apex) const {
    const DVec3 from = to_double(world(i, a)), along_edge = to_double(world(i, b)) - from;
    return length(cross(to_double(world(i, apex)) - from, along_edge)) <=
           2 * tolerance_ * length(along_edge);
  }

  /// True where an edge is not a part of one that there was before.
  bool is_within(uint32_t i, uint32_t triangle, uint32_t a, uint32_t b) const {
    if (before_[i].whole.empty()) return false;
    const Corners& whole = before_[i].whole[triangle];
    for (size_t k = 0; k < 3; ++k) {
      const DVec3 from = to_double(world(i, whole[k]));
      const DVec3 along_edge = normalize(to_double(world(i, whole[(k + 1) % 3])) - from);
      const auto is_on = [&](uint32_t v) {
        return length(cross(to_double(world(i, v)) - from, along_edge)) <= tolerance_;
      };
      if (is_on(a) && is_on(b)) return false;
    }
    return true;
  }

  std::vector<OnEdge> on_edge(uint32_t i, uint32_t a, uint32_t b,
                              const SortedVertices& vertices) const {
    const std::vector<Vec3>& positions = mesh_of(i).positions;
    if (!is_lower(positions[a], positions[b])) std::swap(a, b);
    const DVec3 from = to_double(world(i, a)), to = to_double(world(i, b));
    const double edge = length(to - from);
    if (edge <= 2 * tolerance_) return {};
    const DVec3 direction = (to - from) * (1 / edge);
    std::vector<OnEdge> out;
    const auto all = vertices.between(from, to, tolerance_);
    for (const WorldVertex& v : all) {
      const DVec3 d = to_double(v.at) - from;
      const double s = dot(d, direction);
      if (s <= tolerance_ || s >= edge - tolerance_) continue;
      if (length(d - direction * s) > tolerance_) continue;
      OnEdge on{float(s / edge), 0, std::nullopt};
      if (v.instance == i) on.position = positions[v.vertex];
      out.push_back(on);
    }
    return without_doubles(std::move(out), edge);
  }

  /// One of those that lie at one place, of the mesh itself if there is one.
  std::vector<OnEdge> without_doubles(std::vector<OnEdge> all, double edge) const {
    std::ranges::stable_sort(all, [](const OnEdge& p, const OnEdge& q) {
      return std::pair(p.share, !p.position) < std::pair(q.share, !q.position);
    });
    std::vector<OnEdge> out;
    for (const OnEdge& v : all) {
      if (out.empty() || double(v.share - out.back().share) * edge > tolerance_)
        out.push_back(v), out.back().place = uint32_t(out.size());
      else if (!out.back().position)
        out.back().position = v.position;
    }
    return out;
  }

  Scene& scene_;
  const std::vector<Uncut>& before_;
  double tolerance_;
  SortedVertices all_, new_;
};

}  // namespace

std::vector<std::vector<uint32_t>> close_t_junctions(Scene& scene, std::vector<Uncut> before) {
  LUXEL_CHECK(before.size() == scene.instances.size());
  std::vector<std::vector<uint32_t>> part_of(scene.instances.size());
  for (int pass = 0; pass < kMostPasses; ++pass) {
    JunctionCloser closer(scene, before);
    bool any = false;
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
      auto& whole = before[i].whole;
      std::vector<Corners> was = scene.meshes[scene.instances[i].mesh].triangles;
      const std::vector<uint32_t> parts = closer.close(i);
      if (parts.empty()) continue;
      if (whole.empty()) whole = std::move(was);
      for (const uint32_t t : parts) whole.push_back(Corners(whole[t]));
      part_of[i].insert(part_of[i].end(), parts.begin(), parts.end());
      any = true;
    }
    if (!any) break;
  }
  return part_of;
}

}  // namespace luxel::scene
