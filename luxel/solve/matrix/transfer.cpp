#include "luxel/solve/matrix/transfer.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/transport/covers.h"

namespace luxel::matrix {
namespace {

/// How far patches count, in voxels; pi 2.2^2 = 15 squares lie within on a flat surface, and about
/// twelve patches. Fewer leave a plane to noise, more blur light.
constexpr float kReach = 2.2f;
constexpr int kVoxels = 2;
/// Patches that face away by more than 60 degrees have light of their own.
constexpr float kAlike = 0.5f;
/// Patches off the plane of the place count less, at this many voxels hardly: another step of the
/// surface has another horizon.
constexpr float kOffPlane = 0.7f;
/// What a slope costs beside the squares that it is fitted to, against noise and extrapolation
/// where patches lie on one side only. By the kernel below, places have a variance of 1/8 in units
/// of the reach; slopes are flattened by 0.02 / (1/8 + 0.02) = 14 %, which changes nothing in the
/// middle of patches that lie around evenly.
constexpr double kStiffness = 0.02;
/// A fit with a weight below this leaves what it was fitted to.
constexpr float kMostNegative = -0.5f;

struct Share {
  uint32_t patch = 0;
  float weight = 0;
};

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

/// What a thread needs.
struct Scratch {
  std::vector<uint32_t> near;
  std::vector<Share> shares;
};

/// A covered place sees nothing, and has no patches of its own: of those around, what is open of it
/// lets their light in.
void find_shares(const PatchedScene& patched, const trace::RayTracer& tracer, Vec3 position,
                 Vec3 normal, Scratch& w) {
  const Patches& patches = patched.patches;
  const float open = open_share(tracer, {position, normal}, patched.locator.grid());
  const float reach_m = kReach * patches.voxel_m;
  w.shares.clear();
  patched.locator.near(position, kVoxels, w.near);
  uint32_t nearest = kNone;
  float least = INFINITY;
  for (const uint32_t p : w.near) {
    if (dot(patches.elements.normal[p], normal) < kAlike) continue;
    const Vec3 d = patches.centroid[p] - position;
    const float off = dot(d, normal) / (kOffPlane * patches.voxel_m);
    const float part = 1 - dot(d, d) / (reach_m * reach_m);
    if (dot(d, d) < least) least = dot(d, d), nearest = p;
    const PatchPoint middle{patches.elements.position[p], patches.elements.normal[p]};
    if (part <= 0 ||
        (open == 1 && !see_each_other(tracer, {position, normal}, middle, patches.voxel_m)))
      continue;
    w.shares.push_back({p, part * part / (1 + off * off * off * off)});
  }
  if (!w.shares.empty())
    fit_plane(patches.centroid, position, normal, reach_m, w.shares);
  else if (nearest != kNone)
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
