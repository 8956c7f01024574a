// The judge: brute-force path tracing. [Kajiya86, Veach95]
//
// Shares with the solvers the scene's facts (reflectance, emission, masks), the ray tracer and the
// places of texels, and nothing else: it samples lights in its own, plain way and never looks into
// a lightmap. docs/method/reference.md has the estimator.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/image/image.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/elements.h"

namespace luxel::reference {

/// The number of paths, and their length.
struct PathParams {
  int samples = 256;  ///< paths per receiver or pixel; at least 1
  int bounces = -1;   ///< reflections to count; < 0: all
  uint64_t seed = 1;
  /// All receivers are one place, without `first`, and have fewer than 2^32 paths together: their
  /// k-th directions, and their k-th points on emitters, lie in as many cells of equal chance, one
  /// in each: a Latin hypercube, whose mean varies no more than that of one independent path less
  /// [Owen97], mostly less. Standard errors stay those of independent paths, and are upper bounds.
  bool is_one_place = false;
};

/// Where irradiance is asked for; three spans of one length. A receiver is a point, or, with
/// `first`, the mean over points [first[i], first[i + 1]), which its paths start at in turn; none
/// is empty.
struct Receivers {
  std::span<const Vec3> position;          ///< world [m]
  std::span<const Vec3> normal;            ///< unit; the cosine is about it
  std::span<const Vec3> geometric_normal;  ///< unit; no light comes from below the plane it spans
  std::span<const uint32_t> first{};       ///< empty, or one entry per receiver and one more
  /// The number of receivers.
  size_t size() const { return first.empty() ? position.size() : first.size() - 1; }
};
/// One receiver per element. It refers to them.
inline Receivers receivers(const transport::Elements& e) {
  return {e.position, e.normal, e.geometric_normal, {}};
}

/// Irradiance E [W/m^2] after all bounces asked for, direct light included.
struct TexelPaths {
  std::vector<Rgb> irradiance;         ///< mean over the paths, per receiver
  std::vector<Rgb> standard_error;     ///< of that mean, per channel
  std::vector<float> luminance_error;  ///< standard error of its luminance
  /// Per receiver, how many first rays met the back of a one-sided, of a double-sided surface.
  std::vector<uint32_t> met_back, met_double_sided_back;
  /// 1 where a receiver lies inside a solid, by the rule of gather: more than half of the first
  /// rays meet backs of one-sided surfaces, or 98 % meet backs.
  std::vector<uint8_t> enclosed;
  uint64_t rays = 0;
  /// Root mean square of luminance_error over the mean luminance.
  double relative_error = 0;
};

/// E at every receiver. Unbiased, but for the rounding of floats. Paths are independent, so the
/// standard error is that of a mean of independent values; it is itself an estimate, and needs some
/// tens of paths to mean something. The same seed gives the same bits for any number of threads,
/// and of members of a team, who share the receivers out. Errors: cancelled, another member of the
/// team gives up.
Result<TexelPaths> irradiance_by_paths(const scene::Scene& scene, const Receivers& receivers,
                                       const trace::RayTracer& tracer, const PathParams& params,
                                       Progress& progress, Team* team = nullptr);

/// Radiance per pixel, 4 channels (A = share of the pixel's rays that show a surface).
struct Picture {
  image::Image radiance;
  std::vector<float> luminance_error;  ///< per pixel, row by row: standard error of the luminance
  uint64_t rays = 0;
  double relative_error = 0;  ///< as in TexelPaths
};

/// The picture of a camera, sampled uniformly over each pixel's square. Back faces of one-sided
/// surfaces are invisible to the camera, as in display::draw; for every other ray they are black.
/// Errors: cancelled.
Result<Picture> radiance_by_paths(const scene::Scene& scene, const trace::RayTracer& tracer,
                                  const scene::Camera& camera, int width, int height,
                                  const PathParams& params, Progress& progress);

}  // namespace luxel::reference
