// From the light of one bounce to that of all.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "luxel/solve/matrix/cluster_tree.h"
#include "luxel/solve/matrix/form_factors.h"

namespace luxel::matrix {

/// A few hundred clusters that stand in for the scene where late bounces are concerned.
struct CoarseScene {
  std::vector<uint32_t> cluster_of;  ///< per patch
  std::vector<float> area_m2;        ///< per cluster
  /// Per channel: mean irradiance on cluster S from the second to all further bounces of power q_T
  /// that the clusters reflect, count x count, column (T) by column [1/m^2].
  std::array<std::vector<float>, 3> response;

  size_t count() const { return area_m2.size(); }
};

/// About `clusters` of them, and more where patches of a cluster see different things. `factors`
/// are reciprocal.
CoarseScene make_coarse_scene(const FormFactors& factors, const ClusterTree& tree,
                              std::span<const float> area_m2, std::span<const Rgb> reflectance,
                              size_t clusters);

/// E = F B for the patches; must not allocate.
using Multiply = std::function<void(std::span<const Rgb> radiosity, std::span<Rgb> irradiance)>;

/// Light that patches send on their own, and what they reflect of the rest.
struct Sent {
  std::span<const Rgb> radiosity;    ///< what patches send on their own: B_e + rho D [W/m^2]
  std::span<const Rgb> reflectance;  ///< per patch
  std::span<const float> area_m2;    ///< per patch
  int bounces = -1;                  ///< products; < 0: all
};

/// Room for a solution.
struct BounceScratch {
  std::vector<Rgb> first, radiosity, gathered;  ///< per patch
  std::vector<Rgb> power, late;                 ///< per cluster
};
/// Allocates for one solution at a time.
BounceScratch make_bounce_scratch(size_t patches, size_t clusters);

/// Irradiance of the patches [W/m^2] after `sent.bounces` products, at least 0 of them:
/// E_1 = F B_0,  E_k = F (B_0 + rho E_(k-1)). Looks at no area. Allocates nothing.
void count_bounces(const Multiply& multiply, const Sent& sent, std::span<Rgb> irradiance,
                   BounceScratch& scratch);

/// Irradiance of the patches [W/m^2] after all bounces, by `sweeps` products, at least 1. What is
/// still missing after a sweep is reflected between the clusters without end, and one more sweep
/// makes it smooth: a two-grid iteration for equations of the second kind [Atkinson76;
/// Hackbusch81], which loses far less per sweep than a bounce brings. Two sweeps are enough for a
/// room; more where neighbouring patches see different rooms. `sent.bounces` does not count.
/// Allocates nothing.
void all_bounces(const Multiply& multiply, const CoarseScene& coarse, const Sent& sent, int sweeps,
                 std::span<Rgb> irradiance, BounceScratch& scratch);

/// Steps of all_bounces, between which the caller multiplies; none allocates.
/// After the product of `sent.radiosity`, which is scratch.first.
void begin_sweeps(std::span<Rgb> irradiance, BounceScratch& scratch);
/// Before each further product, of scratch.radiosity.
void foresee(const CoarseScene& coarse, const Sent& sent, std::span<Rgb> irradiance,
             BounceScratch& scratch);
/// After it; its result is scratch.gathered.
void end_sweep(std::span<Rgb> irradiance, BounceScratch& scratch);

}  // namespace luxel::matrix
