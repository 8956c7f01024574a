#include "luxel/solve/matrix/patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_set>

#include "luxel/base/check.h"
#include "luxel/base/disjoint_sets.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/facet.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/surface_points.h"
#include "luxel/transport/covers.h"

namespace luxel::matrix {
namespace {

/// A point of the scene with all that patches are grouped by and made of.
struct Sample {
  PatchPoint at;
  uint32_t material = 0;
  float area_m2 = 0;
  Rgb reflectance, emission;
};

using OpenBacks = std::optional<std::vector<std::vector<uint8_t>>>;

/// True where light gets behind a surface and is reflected there.
bool has_open_back(const scene::Scene& scene, const scene::SurfacePoint& p,
                   const OpenBacks& open_backs) {
  const uint32_t m = scene.instances[p.instance].mesh;
  const scene::Mesh& mesh = scene.meshes[m];
  if (!scene::reflects_from_behind(scene.materials[mesh.triangle_material[p.triangle]]))
    return false;
  return !open_backs || (!(*open_backs)[m].empty() && (*open_backs)[m][p.triangle]);
}

/// Points spread evenly. Each stands for its part of the exact area of its instance's material, so
/// that a small lamp has the power it has. Both sides of double-sided surfaces have points, where
/// params.open_backs does not say that one lies inside a solid.
std::vector<Sample> spread(const scene::Scene& scene, const PatchParams& params) {
  std::vector<scene::SurfacePoint> points = scene::points_uniform_in_area(
      scene, params.count * size_t(params.points_per_patch), params.seed);
  const auto key = [&](uint32_t instance, uint32_t triangle) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
    return uint64_t(instance) << 32 | mesh.triangle_material[triangle];
  };
  // The area of each surface (instance and material), and its points.
  struct Surface {
    double area_m2 = 0;
    size_t points = 0;
    float largest_m2 = 0;
    scene::SurfacePoint middle;  // of its largest triangle
  };
  std::unordered_map<uint64_t, Surface> surfaces;
  std::vector<uint64_t> order;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t) {
      const float area = scene::area_m2(scene::world_triangle(scene, i, t));
      const auto [entry, is_new] = surfaces.try_emplace(key(i, t));
      if (is_new) order.push_back(key(i, t));
      Surface& s = entry->second;
      s.area_m2 += double(area);
      if (area > s.largest_m2) s.largest_m2 = area, s.middle = {i, t, {1.0f / 3, 1.0f / 3}};
    }
  for (const scene::SurfacePoint& p : points) ++surfaces[key(p.instance, p.triangle)].points;
  // A surface that no point fell on gets one.
  for (const uint64_t k : order)
    if (Surface& s = surfaces[k]; s.points == 0 && s.largest_m2 > 0)
      points.push_back(s.middle), ++s.points;
  // Samples on the front, and on the back of double-sided surfaces.
  std::vector<Sample> out;
  for (const scene::SurfacePoint& p : points) {
    const scene::Facet facet = scene::facet_of(scene, p.instance, p.triangle);
    const Vec3 normal = facet.front;
    if (dot(normal, normal) == 0 || !scene::is_solid_at(scene, p)) continue;
    const uint64_t k = key(p.instance, p.triangle);
    const Surface& surface = surfaces[k];
    const auto side = [&](Vec3 n) { return PatchPoint{scene::off_surface(facet, p.at, n), n}; };
    Sample sample{side(normal), uint32_t(k), float(surface.area_m2 / double(surface.points)),
                  scene::reflectance_at(scene, p), scene::emission_at(scene, p) * kPi};
    out.push_back(sample);
    if (!scene::material_at(scene, p).double_sided || !has_open_back(scene, p, params.open_backs))
      continue;
    sample.at = side(-normal);
    out.push_back(sample);
  }
  return out;
}

/// The grid begins this far outside of the scene's bounds, in voxels. Walls at the bounds, and
/// others at a whole number of voxels from them, then lie inside of voxels: between two, rounding
/// would scatter their points over both. Three numbers, so that no two axes are cut alike in a
/// cube.
constexpr Vec3 kGridInset{0.37f, 0.43f, 0.31f};
/// Groups of less than this part of a patch's area are slivers when voxels are chosen:
/// merge_slivers joins most of them to others, so they are not counted.
constexpr double kSliver = 0.25;
/// Patches of less than this part of the mean area join a neighbour: they cost as much as others
/// and carry little, and rays seldom find them. More would join patches of different light.
constexpr double kSmall = 0.35;
/// No patch becomes larger by that than this many times the mean.
constexpr double kLarge = 1.6;
/// The count of patches may be off by so much, a few percent that no error shows; every attempt
/// cuts the whole scene anew.
constexpr double kFewest = 0.98, kMost = 1.02;
constexpr int kMaxRetries = 3;

VoxelGrid grid_of(const scene::Scene& scene, float voxel_m) {
  const Vec3 inset = kGridInset * voxel_m;
  return {voxel_m, scene::world_bounds(scene).lower - inset};
}

uint32_t main_direction(Vec3 n) {
  const Vec3 size{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  return uint32_t(2 * axis + (n[axis] < 0));
}

/// The size of voxels that cut the samples into about `count` groups of more than a sliver each.
float voxel_for(const scene::Scene& scene, std::span<const Sample> samples, size_t count) {
  double area = 0;
  for (const Sample& s : samples) area += double(s.area_m2);
  const double sliver = kSliver * area / double(count);
  const auto groups = [&](float voxel_m) {
    const VoxelGrid grid = grid_of(scene, voxel_m);
    std::unordered_map<uint64_t, float> areas;
    for (const Sample& s : samples)
      areas[hash64(voxel_of(grid, s.at.position),
                   uint64_t(s.material) << 3 | main_direction(s.at.normal))] += s.area_m2;
    return size_t(std::count_if(areas.begin(), areas.end(),
                                [&](const auto& a) { return double(a.second) > sliver; }));
  };
  // From a side whose square is a patch down to where there are enough groups. Then halving, by
  // ratios: 12 steps find the size to within 2^-12 of the logarithm of the range.
  const Box3 bounds = scene::world_bounds(scene);
  float large = length(bounds.upper - bounds.lower), small = float(std::sqrt(area / double(count)));
  while (groups(small) < count && small > 1e-4f * large) small *= 0.7f;
  if (groups(large) >= count) return large;
  for (int step = 0; step < 12; ++step) {
    const float middle = std::sqrt(small * large);
    (groups(middle) < count ? large : small) = middle;
  }
  return std::sqrt(small * large);
}

/// Samples of a voxel that are alike and see each other.
struct Part {
  uint64_t voxel = 0;
  uint32_t material = 0;
  std::vector<uint32_t> samples;
  PatchPoint middle;  ///< the sample nearest to the centroid, its normal the mean
  float area_m2 = 0;
  bool covered = false;  ///< by something much closer than a voxel
  bool hidden = false;   ///< covered, or inside a solid: no light comes or goes
};

void find_middle(std::span<const Sample> samples, Part& part) {
  Vec3 position{}, normal{};
  part.area_m2 = 0;
  for (const uint32_t s : part.samples) {
    const Sample& sample = samples[s];
    position += sample.at.position * sample.area_m2, normal += sample.at.normal * sample.area_m2;
    part.area_m2 += sample.area_m2;
  }
  const Vec3 centroid = position / std::max(part.area_m2, 1e-30f);
  float least = INFINITY;
  for (const uint32_t s : part.samples) {
    const Vec3 d = samples[s].at.position - centroid;
    if (dot(d, d) < least) least = dot(d, d), part.middle = samples[s].at;
  }
  if (dot(normal, normal) > 0) part.middle.normal = normalize(normal);
}

/// Splits the samples of a voxel [begin, end) of `order`: each joins the first part that it is like
/// and whose first sample it sees. Covered ones keep to themselves.
std::vector<Part> parts_of_voxel(std::span<const Sample> samples, std::span<const uint32_t> order,
                                 const VoxelGrid& grid, const trace::RayTracer& tracer) {
  std::vector<Part> parts;
  for (const uint32_t s : order) {
    const Sample& sample = samples[s];
    const bool covered = is_covered(tracer, sample.at, grid);
    const auto fits = [&](const Part& part) {
      const Sample& seed = samples[part.samples.front()];
      return part.material == sample.material && part.covered == covered &&
             dot(seed.at.normal, sample.at.normal) > kSameDirection &&
             (covered || see_each_other(tracer, sample.at, seed.at, grid.voxel_m));
    };
    auto part = std::find_if(parts.begin(), parts.end(), fits);
    if (part == parts.end()) {
      parts.push_back({voxel_of(grid, sample.at.position), sample.material, {}, {}, 0, covered});
      part = parts.end() - 1;
    }
    part->samples.push_back(s);
  }
  return parts;
}

/// The scene to cut.
struct Source {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const OpenBacks& open_backs;
};

/// True where most of a few rays from a part's samples meet backs that no light gets behind.
bool is_hidden(const Source& source, std::span<const Sample> samples, const Part& part,
               float voxel_m) {
  constexpr uint32_t kRays = 32;
  std::array<trace::Ray, kRays> rays;
  std::array<trace::Hit, kRays> hits;
  for (uint32_t k = 0; k < kRays; ++k) {
    const PatchPoint& p = samples[part.samples[k % part.samples.size()]].at;
    const Vec3 d = frame_around(p.normal).to_world(cosine_hemisphere_sample(sobol_owen_2d(k, 1)));
    rays[k] = {p.position + p.normal * (1e-3f * voxel_m), 0, d, INFINITY};
  }
  source.tracer.closest_hits(rays, hits);
  const auto backs = std::count_if(hits.begin(), hits.end(), [&](const trace::Hit& hit) {
    return hit.found() && hit.back_face &&
           !has_open_back(source.scene, hit.point(), source.open_backs);
  });
  return 2 * size_t(backs) > kRays;
}

Result<std::vector<Part>> make_parts(const Source& source, std::span<const Sample> samples,
                                     const VoxelGrid& grid, Progress& progress) {
  // Samples by voxel.
  std::vector<uint64_t> voxel(samples.size());
  for (size_t s = 0; s < samples.size(); ++s) voxel[s] = voxel_of(grid, samples[s].at.position);
  std::vector<uint32_t> order(samples.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return voxel[a] < voxel[b]; });
  std::vector<size_t> first;
  for (size_t k = 0; k < order.size(); ++k)
    if (k == 0 || voxel[order[k]] != voxel[order[k - 1]]) first.push_back(k);
  first.push_back(order.size());
  // Each voxel's, divided.
  std::vector<std::vector<Part>> found(first.size() - 1);
  progress.begin("patches", found.size());
  parallel_for(found.size(), 64, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end && !progress.cancelled(); ++v) {
      found[v] =
          parts_of_voxel(samples, std::span(order).subspan(first[v], first[v + 1] - first[v]), grid,
                         source.tracer);
      for (Part& part : found[v]) {
        find_middle(samples, part);
        part.hidden = part.covered || is_hidden(source, samples, part, grid.voxel_m);
      }
      progress.advance(1);
    }
  });
  LUXEL_TRY_STATUS(stopped(progress));
  std::vector<Part> parts;
  for (std::vector<Part>& of_voxel : found)
    for (Part& part : of_voxel) parts.push_back(std::move(part));
  return parts;
}

/// Slivers join the neighbour of their kind that they see, the nearest one first. Returns a patch
/// per part, numbered in the order of first appearance; kNone for hidden ones.
std::vector<uint32_t> merge_slivers(std::span<const Part> parts, const VoxelGrid& grid,
                                    const trace::RayTracer& tracer, double mean_area_m2) {
  std::vector<PatchLocator::Part> known;
  std::vector<uint64_t> voxel;
  for (uint32_t p = 0; p < parts.size(); ++p)
    known.push_back({parts[p].middle, parts[p].material, p}), voxel.push_back(parts[p].voxel);
  const PatchLocator locator(grid, voxel, known);
  // A forest of parts that are joined; the smallest are asked first.
  std::vector<uint32_t> parent(parts.size()), order(parts.size());
  std::iota(parent.begin(), parent.end(), 0u), std::iota(order.begin(), order.end(), 0u);
  std::vector<double> area(parts.size());
  for (size_t p = 0; p < parts.size(); ++p) area[p] = double(parts[p].area_m2);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return parts[a].area_m2 < parts[b].area_m2; });
  std::vector<uint32_t> near;
  for (const uint32_t p : order) {
    const uint32_t mine = root_of(parent, p);
    if (parts[p].hidden) continue;
    if (area[mine] > kSmall * mean_area_m2) continue;
    // The nearest part that is alike, seen, and leaves the two together small enough.
    const PatchPoint& middle = parts[p].middle;
    locator.near(middle.position, 1, near);
    uint32_t best = kNone;
    float least = INFINITY;
    for (const uint32_t q : near) {
      const Vec3 d = parts[q].middle.position - middle.position;
      if (root_of(parent, q) == mine || parts[q].hidden || parts[q].material != parts[p].material ||
          dot(d, d) >= least || area[root_of(parent, q)] + area[mine] > kLarge * mean_area_m2 ||
          dot(parts[q].middle.normal, middle.normal) < kSameDirection ||
          !see_each_other(tracer, middle, parts[q].middle, grid.voxel_m))
        continue;
      best = root_of(parent, q), least = dot(d, d);
    }
    if (best == kNone) continue;
    parent[mine] = best, area[best] += area[mine];
  }
  // Roots become patches.
  std::vector<uint32_t> number(parts.size(), kNone), patch(parts.size());
  uint32_t count = 0;
  for (uint32_t p = 0; p < parts.size(); ++p) {
    if (parts[p].hidden) {
      patch[p] = kNone;
      continue;
    }
    uint32_t& n = number[root_of(parent, p)];
    if (n == kNone) n = count++;
    patch[p] = n;
  }
  return patch;
}

void append_patch(std::span<const Sample> samples, const Part& part, Patches& patches) {
  Rgb reflectance{}, emission{};
  Vec3 centroid{};
  patches.first_point.push_back(uint32_t(patches.points.size()));
  for (const uint32_t s : part.samples) {
    const float share = samples[s].area_m2 / part.area_m2;
    reflectance += samples[s].reflectance * share, emission += samples[s].emission * share;
    centroid += samples[s].at.position * share;
    patches.points.push_back(samples[s].at);
  }
  patches.elements.position.push_back(part.middle.position);
  patches.elements.normal.push_back(part.middle.normal);
  patches.elements.geometric_normal.push_back(part.middle.normal);
  patches.elements.reflectance.push_back(reflectance);
  patches.centroid.push_back(centroid);
  patches.area_m2.push_back(part.area_m2);
  patches.emission.push_back(emission);
  patches.material.push_back(samples[part.samples.front()].material);
}

/// Numbers patches in the order of their tree: neighbours are near each other in memory.
ClusterTree order_by_tree(std::span<const Part> whole) {
  std::vector<Vec3> position, normal;
  for (const Part& part : whole)
    position.push_back(part.middle.position), normal.push_back(part.middle.normal);
  return make_cluster_tree(position, normal, kLeafSize);
}

size_t count_of(std::span<const uint32_t> patch_of_part) {
  size_t count = 0;
  for (const uint32_t p : patch_of_part)
    if (p != kNone) count = std::max(count, size_t(p) + 1);
  return count;
}

PatchedScene assemble(std::span<const Sample> samples, std::span<const Part> parts,
                      std::span<const uint32_t> patch_of_part, const VoxelGrid& grid) {
  // The samples of each patch.
  std::vector<Part> whole(count_of(patch_of_part));
  for (size_t p = 0; p < parts.size(); ++p) {
    if (patch_of_part[p] == kNone) continue;
    std::vector<uint32_t>& all = whole[patch_of_part[p]].samples;
    all.insert(all.end(), parts[p].samples.begin(), parts[p].samples.end());
  }
  for (Part& part : whole) find_middle(samples, part);
  // Patches in the order of their tree.
  PatchedScene out;
  out.tree = order_by_tree(whole);
  std::vector<uint32_t> number(whole.size());
  out.patches.voxel_m = grid.voxel_m;
  for (uint32_t k = 0; k < whole.size(); ++k) {
    append_patch(samples, whole[out.tree.order[k]], out.patches);
    number[out.tree.order[k]] = k, out.tree.order[k] = k;
  }
  out.patches.first_point.push_back(uint32_t(out.patches.points.size()));
  // The locator, by which rays find the patches.
  std::vector<PatchLocator::Part> known;
  std::vector<uint64_t> voxel;
  for (size_t p = 0; p < parts.size(); ++p) {
    known.push_back({samples[parts[p].samples.front()].at, parts[p].material,
                     patch_of_part[p] == kNone ? kNone : number[patch_of_part[p]],
                     parts[p].covered});
    voxel.push_back(parts[p].voxel);
  }
  out.locator = PatchLocator(grid, voxel, std::move(known));
  return out;
}

}  // namespace

uint32_t patch_met(const PatchedScene& patched, const scene::Scene& scene,
                   const trace::RayTracer& tracer, const trace::Hit& hit) {
  if (!hit.found() || (hit.back_face && !has_open_back(scene, hit.point(), patched.open_backs)))
    return kNone;
  const scene::Mesh& mesh = scene.meshes[scene.instances[hit.instance].mesh];
  const scene::Facet facet = scene::facet_of(scene, hit.instance, hit.triangle);
  const Vec3 side = hit.back_face ? -facet.front : facet.front;
  return patched.locator.locate(scene::off_surface(facet, hit.at, side), side,
                                mesh.triangle_material[hit.triangle], tracer);
}

Result<PatchedScene> make_patches(const scene::Scene& scene, const trace::RayTracer& tracer,
                                  const PatchParams& params, Progress& progress) {
  LUXEL_CHECK(params.points_per_patch >= 1);
  if (params.count < 1 || params.count > kMaxPatches)
    return fail(ErrorCode::bad_setting, "{} patches are asked for; ask for 1 to {}", params.count,
                kMaxPatches);
  if (scene::first_triangles(scene).back() == 0)
    return fail(ErrorCode::bad_input, "the scene has no triangle to make patches of");
  const std::vector<Sample> samples = spread(scene, params);
  double area = 0;
  for (const Sample& s : samples) area += double(s.area_m2);
  if (samples.empty() || !(area > 0))
    return fail(ErrorCode::bad_input, "the scene's triangles have no area to make patches of");
  // Parts that do not see each other, and slivers that join others, change the count; once or
  // twice more with voxels that much larger or smaller.
  float voxel_m = voxel_for(scene, samples, params.count);
  for (int attempt = 0;; ++attempt) {
    VoxelGrid grid = grid_of(scene, voxel_m);
    grid.cover_m = transport::size_for_covers(scene, tracer, voxel_m);
    LUXEL_TRY(const std::vector<Part> parts,
              make_parts({scene, tracer, params.open_backs}, samples, grid, progress));
    const std::vector<uint32_t> patch =
        merge_slivers(parts, grid, tracer, area / double(params.count));
    const size_t count = count_of(patch);
    if (count == 0)
      return fail(
          ErrorCode::bad_input,
          "every surface of the scene lies inside a solid; are its triangles turned inside out?");
    const double ratio = double(count) / double(params.count);
    if (attempt == kMaxRetries || (ratio > kFewest && ratio < kMost)) {
      PatchedScene out = assemble(samples, parts, patch, grid);
      out.open_backs = params.open_backs;
      return out;
    }
    // Surfaces have as many patches as squares of the voxels' size.
    voxel_m *= float(std::sqrt(std::clamp(ratio, 0.5, 2.0)));
  }
}

}  // namespace luxel::matrix
