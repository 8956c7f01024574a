#include "luxel/solve/matrix/transfer.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/transport/covers.h"

namespace luxel::matrix {
namespace {

/// Patches count up to this distance, in voxels. pi 1.8^2 = 10 squares lie within on a flat
/// surface, and about eight patches. Fewer leave a plane to noise, more blur light.
constexpr float kReach = 1.8f;
constexpr int kVoxels = 2;
/// Near patches count more: at a third of the reach half as much as at the place. The reach of 1.8
/// with this errs by a tenth less than one of 2.2 without it, against a path tracer in the Cornell
/// box and in a living room with its walled garden (luxel bench relight).
constexpr float kNearness = 10;
/// Patches that face away by more than 60 degrees have light of their own.
constexpr float kAlike = 0.5f;
/// Patches off the plane of the place count less, at this many voxels half as much: another step of
/// the surface has another horizon.
constexpr float kOffPlane = 0.35f;
/// Penalty of a slope, added to the squares that it is fitted to, against noise and extrapolation
/// where patches lie on one side only. By the kernel below, places have a variance of 0.078 in
/// units of the reach; slopes are flattened by 0.001 / (0.078 + 0.001) = 1 %. Ten times as much
/// errs by 2 % more in living_room and the Cornell box (luxel bench relight), a third of it by no
/// less.
constexpr double kStiffness = 0.001;
/// A fit with a weight below this leaves what it was fitted to.
constexpr float kMostNegative = -0.5f;

struct Share {
  uint32_t patch = 0;
  float weight = 0;
};

/// Weight of a patch at a place, before planes are fitted; 0 beyond the reach. Patches that face
/// another way see another part of the scene, as on both sides of a crease: an angle of 30 degrees
/// leaves a third.
float kernel(Vec3 to_patch, float cosine, Vec3 normal, float voxel_m) {
  const float reach_m = kReach * voxel_m;
  const float distance2 = dot(to_patch, to_patch) / (reach_m * reach_m);
  if (distance2 >= 1) return 0;
  const float off = dot(to_patch, normal) / (kOffPlane * voxel_m);
  const float cosine2 = cosine * cosine, cosine4 = cosine2 * cosine2;
  const float part = 1 - distance2;
  return part * part / (1 + kNearness * distance2) * cosine4 * cosine4 /
         (1 + off * off * off * off);
}

/// Weights of a patch's light: kernels first, then those of the plane.
void fit_plane(std::span<const Vec3> centroid, Vec3 position, Vec3 normal, float reach_m,
               std::vector<Share>& shares) {
  const Frame frame = frame_around(normal);
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  const auto powers = [&](uint32_t patch) {
    const Vec3 d = (centroid[patch] - position) / reach_m;
    return Eigen::Vector3d{1, double(dot(d, frame.tangent)), double(dot(d, frame.bitangent))};
  };
  for (const Share& s : shares)
    moments += double(s.weight) * powers(s.patch) * powers(s.patch).transpose();
  const double sum = moments(0, 0);
  for (int k = 1; k < 3; ++k) moments(k, k) += kStiffness * sum;
  const Eigen::Vector3d plane = moments.ldlt().solve(Eigen::Vector3d::UnitX());
  float least = 0, total = 0;
  std::vector<float> fitted;
  for (const Share& s : shares) {
    fitted.push_back(s.weight * float(powers(s.patch).dot(plane)));
    least = std::min(least, fitted.back()), total += fitted.back();
  }
  const bool good = least > kMostNegative && std::abs(total - 1) < 1e-3f;
  for (size_t k = 0; k < shares.size(); ++k)
    shares[k].weight = good ? fitted[k] / total : shares[k].weight / float(sum);
}

/// Buffers of a thread.
struct Scratch {
  std::vector<uint32_t> near;
  std::vector<Share> shares;
};

/// True where most of a few rays from a place meet backs: it lies inside a solid, where no patch
/// is. Places just under a surface that faces the same way are not inside: their light is that
/// surface's.
bool is_inside_solid(const PatchedScene& patched, const trace::RayTracer& tracer, Vec3 position,
                     Vec3 normal) {
  constexpr uint32_t kRays = 32;
  const trace::Hit above = tracer.closest_hit({position, 0, normal, patched.patches.voxel_m});
  if (above.found() && above.back_face) return false;
  const Frame frame = frame_around(normal);
  uint32_t backs = 0;
  for (uint32_t k = 0; k < kRays; ++k) {
    const Vec3 d = frame.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, 1)));
    const trace::Hit hit = tracer.closest_hit({position, 0, d, INFINITY});
    backs += hit.found() && hit.back_face;
  }
  return 2 * backs > kRays;
}

/// A covered place sees nothing, and has no patches of its own: of those around, what is open of it
/// lets their light in.
void find_shares(const PatchedScene& patched, const trace::RayTracer& tracer, Vec3 position,
                 Vec3 normal, Scratch& w) {
  const Patches& patches = patched.patches;
  const float open = open_share(tracer, {position, normal}, patched.locator.grid());
  w.shares.clear();
  patched.locator.near(position, kVoxels, w.near);
  uint32_t nearest = kNone;
  float least = INFINITY;
  for (const uint32_t p : w.near) {
    const float cosine = dot(patches.elements.normal[p], normal);
    if (cosine < kAlike) continue;
    const Vec3 d = patches.centroid[p] - position;
    if (dot(d, d) < least) least = dot(d, d), nearest = p;
    const float weight = kernel(d, cosine, normal, patches.voxel_m);
    const PatchPoint middle{patches.elements.position[p], patches.elements.normal[p]};
    if (weight <= 0 ||
        (open == 1 && !see_each_other(tracer, {position, normal}, middle, patches.voxel_m)))
      continue;
    w.shares.push_back({p, weight});
  }
  if (!w.shares.empty())
    fit_plane(patches.centroid, position, normal, kReach * patches.voxel_m, w.shares);
  else if (nearest != kNone && !is_inside_solid(patched, tracer, position, normal))
    w.shares.push_back({nearest, 1});
  if (open == 0) w.shares.clear();
  for (Share& s : w.shares) s.weight *= open;
}

}  // namespace

Result<Transfer> make_transfer(const PatchedScene& patched, const trace::RayTracer& tracer,
                               const SurfacePoints& points, Progress& progress) {
  LUXEL_CHECK(points.position.size() == points.normal.size());
  std::vector<std::vector<Share>> found(points.position.size());
  progress.begin("transfer", found.size());
  parallel_for(found.size(), 256, [&](size_t begin, size_t end) {
    Scratch w;
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      find_shares(patched, tracer, points.position[i], points.normal[i], w);
      found[i] = w.shares;
    }
    progress.advance(end - begin);
  });
  LUXEL_TRY_STATUS(stopped(progress));
  Transfer out;
  out.first.push_back(0);
  for (std::vector<Share>& shares : found) {
    for (const Share& s : shares) out.patch.push_back(s.patch), out.weight.push_back(s.weight);
    out.first.push_back(uint32_t(out.patch.size()));
    shares = {};
  }
  return out;
}

void transfer(const Transfer& map, std::span<const Rgb> of_patch, std::span<Rgb> of_point) {
  LUXEL_CHECK(of_point.size() == map.size());
  const auto places = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Rgb sum{};
      for (uint32_t k = map.first[i]; k < map.first[i + 1]; ++k)
        sum += of_patch[map.patch[k]] * map.weight[k];
      of_point[i] = max(sum, Rgb{});
    }
  };
  parallel_for(map.size(), 2048, std::ref(places));
}

}  // namespace luxel::matrix
