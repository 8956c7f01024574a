#include "bench/parallel_rays.h"

#include <algorithm>
#include <bit>

#include "luxel/base/random.h"
#include "luxel/base/vectorize.h"
#include "luxel/scene/sides.h"

#ifdef __clang__  // & keeps loops over lanes free of branches
#pragma clang diagnostic ignored "-Wbitwise-instead-of-logical"
#endif

namespace luxel::bench {
namespace {

/// A little larger than the box: rounding leaves nothing out.
void set_box(const Box3& box, size_t lane, BoxLanes& out) {
  const Vec3 middle = box.centre(), half = (box.upper - box.lower) * 0.5f;
  for (int axis = 0; axis < 3; ++axis) {
    out.middle[size_t(axis)][lane] = middle[axis];
    out.half[size_t(axis)][lane] = half[axis] * 1.00001f + 1e-6f;
  }
}

struct FlatTriangle {
  scene::Triangle3 corners;
  scene::SurfacePoint id;
  bool mirrored = false;

  Vec3 middle() const { return (corners.a + corners.b + corners.c) * (1 / 3.0f); }
};

/// The first of the two sides of one sheet stands for both.
std::vector<FlatTriangle> flat_triangles(const scene::Scene& scene) {
  std::vector<FlatTriangle> out;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    const scene::Mesh& mesh = scene.meshes[instance.mesh];
    const bool mirrored = determinant(instance.world_from_object) < 0;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
      if (mesh.other_side.empty() || mesh.other_side[t] >= t)
        out.push_back({scene::world_triangle(scene, i, t), {i, t, {}}, mirrored});
  }
  return out;
}

/// Halves them along the longest side until 16 are left.
void split(std::span<FlatTriangle> all, std::vector<std::span<FlatTriangle>>& out) {
  if (all.size() <= kLane) {
    if (!all.empty()) out.push_back(all);
    return;
  }
  Box3 box;
  for (const FlatTriangle& t : all) box.extend(t.middle());
  const Vec3 size = box.upper - box.lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const size_t half = (all.size() + kLane - 1) / kLane / 2 * kLane;
  std::nth_element(all.begin(), all.begin() + std::ptrdiff_t(half), all.end(),
                   [axis](const FlatTriangle& a, const FlatTriangle& b) {
                     return a.middle()[axis] < b.middle()[axis];
                   });
  split(all.first(half), out), split(all.subspan(half), out);
}

/// Returns the box around them.
Box3 fill_group(const scene::Scene& scene, std::span<const FlatTriangle> from, TriangleGroup& out) {
  out.corner = {}, out.count = uint32_t(from.size());
  Box3 box;
  for (size_t k = 0; k < from.size(); ++k) {
    size_t row = 0;
    for (const Vec3 p : {from[k].corners.a, from[k].corners.b, from[k].corners.c}) {
      for (int axis = 0; axis < 3; ++axis) out.corner[row++][k] = p[axis];
      box.extend(p);
    }
    out.id[k] = from[k].id;
    if (from[k].mirrored) out.mirrored |= 1u << k;
    if (scene::lets_light_through(scene::material_at(scene, from[k].id)))
      out.lets_light_through |= 1u << k;
  }
  return box;
}

/// Axes in which a place is seen: across the direction, and along it. `origin` lies near the rays.
struct View {
  Vec3 across, up, along, origin;
};

/// Extents of boxes along a view's axes.
struct SeenBoxes {
  alignas(64) Lanes left, right, low, high, near, far;
};

/// The rays of a bundle, as they are seen, and what they have met so far.
struct SeenRays {
  size_t packets = 0;
  SeenBoxes boxes;
  float left, right, low, high, near;  ///< of all
  alignas(64) std::array<Lanes, kLane> x, y, z, t;
  alignas(64) std::array<IntLanes, kLane> met;  ///< triangle; -1: nothing
};

// All that meet_all() calls becomes a part of it: it is compiled for several processors.

/// The middle along an axis of the view, less and plus half of what the box covers.
[[gnu::always_inline]] inline void see_box_along(const BoxLanes& boxes, Vec3 axis, Vec3 origin,
                                                 Lanes& lower, Lanes& upper) {
  const float ax = std::abs(axis.x), ay = std::abs(axis.y), az = std::abs(axis.z);
  for (size_t i = 0; i < kLane; ++i) {
    const float middle = (boxes.middle[0][i] - origin.x) * axis.x +
                         (boxes.middle[1][i] - origin.y) * axis.y +
                         (boxes.middle[2][i] - origin.z) * axis.z;
    const float half = boxes.half[0][i] * ax + boxes.half[1][i] * ay + boxes.half[2][i] * az;
    lower[i] = middle - half, upper[i] = middle + half;
  }
}

[[gnu::always_inline]] inline void see_boxes(const BoxLanes& boxes, const View& v, SeenBoxes& out) {
  see_box_along(boxes, v.across, v.origin, out.left, out.right);
  see_box_along(boxes, v.up, v.origin, out.low, out.high);
  see_box_along(boxes, v.along, v.origin, out.near, out.far);
}

/// 16 places.
[[gnu::always_inline]] inline void see_places(const float* x, const float* y, const float* z,
                                              const View& v, float* across, float* up,
                                              float* along) {
  for (size_t i = 0; i < kLane; ++i) {
    const float px = x[i] - v.origin.x, py = y[i] - v.origin.y, pz = z[i] - v.origin.z;
    across[i] = px * v.across.x + py * v.across.y + pz * v.across.z;
    up[i] = px * v.up.x + py * v.up.y + pz * v.up.z;
    along[i] = px * v.along.x + py * v.along.y + pz * v.along.z;
  }
}

[[gnu::always_inline]] inline void see_rays(const RayStarts& starts, const View& view,
                                            SeenRays& out) {
  out.packets = (starts.count + kLane - 1) / kLane;
  see_boxes(starts.boxes, view, out.boxes);
  out.left = *std::ranges::min_element(out.boxes.left);
  out.right = *std::ranges::max_element(out.boxes.right);
  out.low = *std::ranges::min_element(out.boxes.low);
  out.high = *std::ranges::max_element(out.boxes.high);
  out.near = *std::ranges::min_element(out.boxes.near);
  for (size_t p = 0; p < out.packets; ++p) {
    see_places(starts.x.data() + p * kLane, starts.y.data() + p * kLane,
               starts.z.data() + p * kLane, view, out.x[p].data(), out.y[p].data(),
               out.z[p].data());
    out.t[p].fill(INFINITY), out.met[p].fill(-1);
  }
}

[[gnu::always_inline]] inline float least(float a, float b) { return a < b ? a : b; }
[[gnu::always_inline]] inline float most(float a, float b) { return a > b ? a : b; }

/// An edge that two triangles share has the same function in both, but for its sign: no ray slips
/// through between them.
[[gnu::always_inline]] inline void see_group(const TriangleGroup& group, const View& view,
                                             const SeenRays& rays, ProjectedGroup& out) {
  alignas(64) std::array<Lanes, 9> p;
  for (size_t corner = 0; corner < 9; corner += 3)
    see_places(group.corner[corner].data(), group.corner[corner + 1].data(),
               group.corner[corner + 2].data(), view, p[corner].data(), p[corner + 1].data(),
               p[corner + 2].data());
  for (size_t i = 0; i < kLane; ++i) {
    const float x0 = p[0][i], y0 = p[1][i], z0 = p[2][i], x1 = p[3][i], y1 = p[4][i], z1 = p[5][i],
                x2 = p[6][i], y2 = p[7][i], z2 = p[8][i];
    // Each edge is the one opposite of the corner of its number.
    const float a0 = y1 - y2, b0 = x2 - x1, c0 = x1 * y2 - x2 * y1;
    const float a1 = y2 - y0, b1 = x0 - x2, c1 = x2 * y0 - x0 * y2;
    const float a2 = y0 - y1, b2 = x1 - x0, c2 = x0 * y1 - x1 * y0;
    const float area = a1 * b2 - a2 * b1, sign = area < 0 ? -1.0f : 1.0f;
    out.row[0][i] = a0 * sign, out.row[1][i] = b0 * sign, out.row[2][i] = c0 * sign;
    out.row[3][i] = a1 * sign, out.row[4][i] = b1 * sign, out.row[5][i] = c1 * sign;
    out.row[6][i] = a2 * sign, out.row[7][i] = b2 * sign, out.row[8][i] = c2 * sign;
    const float s1 = (z1 - z0) / area, s2 = (z2 - z0) / area;
    out.row[9][i] = a1 * s1 + a2 * s2, out.row[10][i] = b1 * s1 + b2 * s2;
    out.row[11][i] = c1 * s1 + c2 * s2 + z0;
    out.left[i] = least(least(x0, x1), x2), out.right[i] = most(most(x0, x1), x2);
    out.low[i] = least(least(y0, y1), y2), out.high[i] = most(most(y0, y1), y2);
    out.near[i] = least(least(z0, z1), z2), out.far[i] = most(most(z0, z1), z2);
    out.faces_away[i] = area > 0;
    out.is_seen[i] = (area != 0) & (out.left[i] <= rays.right) & (out.right[i] >= rays.left) &
                     (out.low[i] <= rays.high) & (out.high[i] >= rays.low) &
                     (out.far[i] > rays.near);
  }
}

/// Where a ray meets a projected triangle.
[[gnu::always_inline]] inline Barycentric place_in(const ProjectedGroup& g, size_t k, float x,
                                                   float y) {
  const auto edge = [&](size_t e) {
    return g.row[e][k] * x + g.row[e + 1][k] * y + g.row[e + 2][k];
  };
  const float e1 = edge(3), e2 = edge(6), over = 1 / (edge(0) + e1 + e2);
  return {e1 * over, e2 * over};
}

/// Takes back which of a packet's rays meet a triangle that lets some through.
[[gnu::noinline]] void let_some_through(const TriangleGroups& triangles, const ProjectedGroup& g,
                                        size_t k, const SeenRays& rays, size_t packet,
                                        IntLanes& meets) {
  for (size_t i = 0; i < kLane; ++i) {
    if (!meets[i]) continue;
    const float x = rays.x[packet][i], y = rays.y[packet][i];
    scene::SurfacePoint at = triangles.groups[g.group].id[k];
    at.at = place_in(g, k, x, y);
    const float coverage = scene::passage_at(*triangles.scene, at).coverage;
    const uint64_t bits = uint64_t(std::bit_cast<uint32_t>(x)) << 32 | std::bit_cast<uint32_t>(y);
    if (coverage < 1 && unit_float(uint32_t(hash64(bits, at.triangle) >> 32)) >= coverage)
      meets[i] = 0;
  }
}

/// Holds one triangle, `number` of all that are seen, against a packet.
[[gnu::always_inline]] inline void meet_packet(const TriangleGroups& triangles,
                                               const ProjectedGroup& g, size_t k, int32_t number,
                                               size_t packet, SeenRays& rays) {
  const auto& r = g.row;
  const float a0 = r[0][k], b0 = r[1][k], c0 = r[2][k], a1 = r[3][k], b1 = r[4][k], c1 = r[5][k];
  const float a2 = r[6][k], b2 = r[7][k], c2 = r[8][k], a = r[9][k], b = r[10][k], c = r[11][k];
  const float near = g.near[k], far = g.far[k];
  const float* x = rays.x[packet].data();
  const float* y = rays.y[packet].data();
  const float* z = rays.z[packet].data();
  float* __restrict best = rays.t[packet].data();
  int32_t* __restrict met = rays.met[packet].data();
  alignas(64) Lanes t;
  alignas(64) IntLanes meets;
  for (size_t i = 0; i < kLane; ++i) {
    const float e0 = x[i] * a0 + y[i] * b0 + c0, e1 = x[i] * a1 + y[i] * b1 + c1;
    const float e2 = x[i] * a2 + y[i] * b2 + c2;
    // A triangle that is seen from its edge has a steep depth.
    t[i] = least(most(x[i] * a + y[i] * b + c, near), far) - z[i];
    meets[i] = (e0 >= 0) & (e1 >= 0) & (e2 >= 0) & (t[i] > 0) & (t[i] < best[i]);
  }
  if (triangles.groups[g.group].lets_light_through >> k & 1)
    let_some_through(triangles, g, k, rays, packet, meets);
  for (size_t i = 0; i < kLane; ++i) {
    best[i] = meets[i] ? t[i] : best[i];
    met[i] = meets[i] ? number : met[i];
  }
}

/// Holds a group against all packets. `first` is the number of its first triangle.
[[gnu::always_inline]] inline void meet_group(const TriangleGroups& triangles,
                                              const ProjectedGroup& g, size_t first,
                                              SeenRays& rays) {
  for (size_t k = 0; k < triangles.groups[g.group].count; ++k) {
    if (!g.is_seen[k]) continue;
    const float left = g.left[k], right = g.right[k], low = g.low[k], high = g.high[k],
                far = g.far[k];
    alignas(64) IntLanes covers;
    for (size_t i = 0; i < kLane; ++i)
      covers[i] = (rays.boxes.left[i] <= right) & (rays.boxes.right[i] >= left) &
                  (rays.boxes.low[i] <= high) & (rays.boxes.high[i] >= low) &
                  (rays.boxes.near[i] < far);
    for (size_t packet = 0; packet < rays.packets; ++packet)
      if (covers[packet]) meet_packet(triangles, g, k, int32_t(first + k), packet, rays);
  }
}

LUXEL_WIDE_VECTOR_CLONES
void meet_all(const TriangleGroups& triangles, const RayStarts& starts, const View& view,
              ParallelBuffers& buffers, SeenRays& rays) {
  see_rays(starts, view, rays);
  buffers.count = 0;
  SeenBoxes boxes;
  for (size_t g = 0; g < triangles.groups.size(); ++g) {
    if (g % kLane == 0) see_boxes(triangles.boxes[g / kLane], view, boxes);
    const size_t i = g % kLane;
    if (boxes.left[i] > rays.right || boxes.right[i] < rays.left || boxes.low[i] > rays.high ||
        boxes.high[i] < rays.low || boxes.far[i] < rays.near)
      continue;
    ProjectedGroup& seen = buffers.seen[buffers.count];
    seen.group = uint32_t(g);
    see_group(triangles.groups[g], view, rays, seen);
    meet_group(triangles, seen, buffers.count++ * kLane, rays);
  }
}

}  // namespace

RayStarts ray_starts(std::span<const Vec3> origins) {
  RayStarts out;
  out.count = origins.size();
  for (size_t packet = 0; packet < kLane; ++packet) {
    Box3 box;
    for (size_t i = packet * kLane; i < (packet + 1) * kLane; ++i) {
      const Vec3 o = origins[std::min(i, origins.size() - 1)];
      out.x[i] = o.x, out.y[i] = o.y, out.z[i] = o.z;
      box.extend(o);
    }
    set_box(box, packet, out.boxes);
  }
  return out;
}

TriangleGroups triangle_groups(const scene::Scene& scene) {
  std::vector<FlatTriangle> all = flat_triangles(scene);
  std::vector<std::span<FlatTriangle>> parts;
  split(all, parts);
  TriangleGroups out{&scene, {}, {}};
  out.groups.resize(parts.size());
  out.boxes.resize((parts.size() + kLane - 1) / kLane);
  for (size_t g = 0; g < parts.size(); ++g)
    set_box(fill_group(scene, parts[g], out.groups[g]), g % kLane, out.boxes[g / kLane]);
  return out;
}

void parallel_hits(const TriangleGroups& triangles, const RayStarts& starts, Vec3 direction,
                   ParallelBuffers& buffers, trace::Hit* hits, size_t stride) {
  const Frame frame = frame_around(direction);
  const View view{
      frame.tangent, frame.bitangent, frame.normal, {starts.x[0], starts.y[0], starts.z[0]}};
  buffers.seen.resize(triangles.groups.size());
  SeenRays rays;
  meet_all(triangles, starts, view, buffers, rays);
  for (size_t i = 0; i < starts.count; ++i) {
    trace::Hit& hit = hits[i * stride];
    const size_t packet = i / kLane, lane = i % kLane;
    const int32_t met = rays.met[packet][lane];
    hit = {};
    if (met < 0) continue;
    const ProjectedGroup& seen = buffers.seen[size_t(met) / kLane];
    const size_t k = size_t(met) % kLane;
    const TriangleGroup& group = triangles.groups[seen.group];
    const bool mirrored = (group.mirrored >> k & 1) != 0;
    hit = {rays.t[packet][lane], group.id[k].instance, group.id[k].triangle,
           place_in(seen, k, rays.x[packet][lane], rays.y[packet][lane]),
           (seen.faces_away[k] != 0) != mirrored};
    if (hit.back_face)
      if (const auto other = scene::other_side_of(*triangles.scene, hit.point()))
        hit.triangle = other->triangle, hit.at = other->at, hit.back_face = false;
  }
}

}  // namespace luxel::bench
