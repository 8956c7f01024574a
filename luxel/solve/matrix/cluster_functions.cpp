#include "luxel/solve/matrix/cluster_functions.h"

#include <algorithm>
#include <cmath>

namespace luxel::matrix {
namespace {

/// A direction in which patches spread by less than this part of the widest is none.
constexpr double kThin = 1e-3;

Ball ball_of(const Cluster& cluster, std::span<const Vec3> position,
             std::span<const float> area_m2) {
  Ball ball;
  float area = 0;
  for (uint32_t i = cluster.first; i < cluster.end; ++i)
    ball.centre += position[i] * area_m2[i], area += area_m2[i];
  ball.centre = ball.centre / std::max(area, 1e-30f);
  for (uint32_t i = cluster.first; i < cluster.end; ++i)
    ball.radius_m = std::max(ball.radius_m, length(position[i] - ball.centre));
  return ball;
}

using Powers = std::array<double, 4>;  ///< of 1, x, y, z
using Gram = std::array<Powers, 4>;    ///< their inner products over a cluster

/// Combinations of the powers that are orthonormal: 1, then the widest directions. Zero where there
/// are none.
std::array<Powers, kFunctions> orthonormal(const Gram& gram) {
  const auto inner = [&](const Powers& f, const Powers& g) {
    double sum = 0;
    for (size_t a = 0; a < 4; ++a)
      for (size_t b = 0; b < 4; ++b) sum += f[a] * gram[a][b] * g[b];
    return sum;
  };
  Gram rest{};  // each power less its part in the functions there are
  for (size_t f = 0; f < 4; ++f) rest[f][f] = 1;
  std::array<Powers, kFunctions> out{};
  double widest = 0;
  for (size_t k = 0; k < kFunctions; ++k) {
    size_t next = k == 0 ? 0 : 1;
    for (size_t f = 2; f < 4 && k > 0; ++f)
      if (inner(rest[f], rest[f]) > inner(rest[next], rest[next])) next = f;
    const double norm2 = inner(rest[next], rest[next]);
    if (k == 1) widest = norm2;
    if (!(norm2 > 0) || (k > 0 && norm2 <= std::max(kThin * widest, 1e-6 * gram[0][0]))) break;
    for (size_t b = 0; b < 4; ++b) out[k][b] = rest[next][b] / std::sqrt(norm2);
    for (Powers& f : rest) {
      const double part = inner(f, out[k]);
      for (size_t b = 0; b < 4; ++b) f[b] -= part * out[k][b];
    }
  }
  return out;
}

struct MomentInput {
  std::span<const Cluster> clusters;
  std::span<const Vec3> position;
  std::span<const float> area_m2;
};

/// The powers of a cluster's patches as its halves' functions see them (a leaf's: themselves), so
/// that its own functions are combinations of those.
std::vector<Powers> powers_of(const MomentInput& in, const Cluster& cluster, const Ball& ball,
                              const std::vector<std::vector<Values>>& all) {
  std::vector<Powers> power(cluster.size());
  for (uint32_t i = cluster.first; i < cluster.end; ++i) {
    const Vec3 d = (in.position[i] - ball.centre) / std::max(ball.radius_m, 1e-30f);
    power[i - cluster.first] = {1, double(d.x), double(d.y), double(d.z)};
  }
  for (uint32_t c = cluster.child; c != 0 && c < cluster.child + 2; ++c) {
    const Cluster& half = in.clusters[c];
    const std::vector<Values>& phi = all[half.depth];
    std::array<Powers, kFunctions> part{};  // of the powers in the half's functions
    for (uint32_t i = half.first; i < half.end; ++i)
      for (size_t a = 0; a < kFunctions; ++a)
        for (size_t f = 0; f < 4; ++f)
          part[a][f] += double(in.area_m2[i]) * double(phi[i][a]) * power[i - cluster.first][f];
    for (uint32_t i = half.first; i < half.end; ++i)
      for (size_t f = 0; f < 4; ++f) {
        double sum = 0;
        for (size_t a = 0; a < kFunctions; ++a) sum += double(phi[i][a]) * part[a][f];
        power[i - cluster.first][f] = sum;
      }
  }
  return power;
}

/// Orthonormal combinations of a cluster's powers, to the functions at its depth.
void add_functions(const MomentInput& in, const Cluster& cluster, std::span<const Powers> power,
                   std::span<Values> phi) {
  Gram gram{};
  for (uint32_t i = 0; i < cluster.size(); ++i)
    for (size_t a = 0; a < 4; ++a)
      for (size_t b = 0; b < 4; ++b)
        gram[a][b] += double(in.area_m2[cluster.first + i]) * power[i][a] * power[i][b];
  const std::array<Powers, kFunctions> function = orthonormal(gram);
  for (uint32_t i = 0; i < cluster.size(); ++i)
    for (size_t a = 0; a < kFunctions; ++a) {
      double sum = 0;
      for (size_t f = 0; f < 4; ++f) sum += function[a][f] * power[i][f];
      phi[cluster.first + i][a] = float(sum);
    }
}

}  // namespace

ClusterFunctions make_functions(std::span<const Cluster> clusters, std::span<const Vec3> position,
                                std::span<const float> area_m2) {
  const MomentInput in{clusters, position, area_m2};
  ClusterFunctions out;
  uint32_t depth = 0;
  for (const Cluster& c : clusters) {
    depth = std::max(depth, c.depth);
    out.ball.push_back(ball_of(c, position, area_m2));
  }
  out.phi.assign(depth + 1, std::vector<Values>(position.size()));
  for (size_t c = clusters.size(); c-- > 0;)  // halves come after what they are halves of
    add_functions(in, clusters[c], powers_of(in, clusters[c], out.ball[c], out.phi),
                  out.phi[clusters[c].depth]);
  return out;
}

std::vector<Hierarchical::Up> make_up(const ClusterFunctions& functions,
                                      std::span<const Cluster> clusters,
                                      std::span<const float> area_m2) {
  std::vector<Hierarchical::Up> up(clusters.size(), Hierarchical::Up{});
  for (const Cluster& parent : clusters) {
    const auto& own = functions.phi[parent.depth];
    for (uint32_t child = parent.child; child != 0 && child < parent.child + 2; ++child) {
      const auto& part = functions.phi[parent.depth + 1];
      for (size_t a = 0; a < kFunctions; ++a)
        for (size_t b = 0; b < kFunctions; ++b)
          for (uint32_t i = clusters[child].first; i < clusters[child].end; ++i)
            up[child][kLanes * b + a] += area_m2[i] * own[i][a] * part[i][b];
    }
  }
  return up;
}

}  // namespace luxel::matrix
