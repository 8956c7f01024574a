// Makes charts agree along the edges where the atlas was cut.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::post {

/// A scene edge that lies in the atlas twice, at (a0, a1) and (b0, b1), in texels.
struct Seam {
  Vec2 a0, a1, b0, b1;
  uint32_t triangle_a = atlas::kNone, triangle_b = atlas::kNone;  ///< drawn triangles
};

/// The edges that two triangles share in space with agreeing shading normals (a crease is a real
/// change of light and is left alone) but not in the atlas: those of one instance, whose corners
/// are the same, and those of tiles that lie edge to edge, whole or in part
/// (luxel/post/touching.h).
std::vector<Seam> find_seams(const scene::Scene& scene, const atlas::Atlas& atlas,
                             float max_normal_angle_rad = 0.1f);

/// Limits on the texels that seams join. Without them light would go from one side of a wall to the
/// other. Spans have one entry per texel, or none.
struct SeamTexels {
  /// 1 where its light means nothing, inside of solids: no look-up reads it, and it stays as it is.
  /// Empty: no texel.
  std::span<const uint8_t> hidden = {};
  /// Points whose look-ups read texels with different numbers do not count: light differs there for
  /// good. Empty: all have the same number.
  std::span<const uint32_t> region = {};
};

/// Weights, iterations and texels of stitch_seams().
struct SeamParams {
  float keep_weight = 0.1f;  ///< the pull of a texel towards its own value
  int max_iterations = 200;  ///< of the conjugate gradient
  SeamTexels texels = {};
};

/// The system, in full. Along each seam lie points p, about two per texel of its longer side, two
/// at least. The lookups of the two sides are L_a(p) and L_b(p): bilinear over the texels that
/// carry a sample, weights renormalised, as transport::irradiance_at does. For the change d of the
/// texels under these lookups, of values x,
///
///   sum_p  l_p (L_a(p)(x + d) - L_b(p)(x + d))^2 / m_p^2
///   + keep_weight^2 sum_t d_t^2 / m_t^2        ->  minimum
///
/// l_p is the length of seam that p stands for, in half texels: fine triangles weigh no more than
/// coarse ones. m_p is the mean value around p, plus a thousandth of the mean of all: errors count
/// by what the eye sees, that is relative to the light around. A dark room's seams thus matter as
/// much as those beside the lamp, and where bright touches dark the dark points farther along the
/// seam resist being lit. m_t is the mean of m_p over the points that look t up, the same on both
/// sides of a seam, so that what one side gains the other loses. Points at which one side is black
/// do not count: no light goes on over them. Solved by conjugate gradients on
/// the normal equations, all three channels side by side.
///
/// Changes the values of the texels next to seams so that bilinear lookups from both sides agree
/// (least squares: seam differences at about two points per texel, against staying where they are).
/// Only texels under a seam's bilinear footprint change; the values stay non-negative. [Iwanicki13]
Status stitch_seams(const atlas::TexelMap& map, std::span<const Seam> seams,
                    const SeamParams& params, std::span<Rgb> values, Progress& progress);

/// The change that stitch_seams() makes to `whole`, taken apart for layers of light that add up to
/// it: d is linear in x while the weights stay those of the whole, so each layer gets the d of its
/// own x. Where that would make a layer negative it stays at 0, and the layers no longer add up to
/// the last digit.
Status stitch_layers(const atlas::TexelMap& map, std::span<const Seam> seams,
                     const SeamParams& params, std::span<const Rgb> whole,
                     std::span<std::vector<Rgb>> layers, Progress& progress);

/// The difference between the two sides of seams, over all points of all seams.
struct SeamResidual {
  /// Root mean square of the difference, all channels, over the mean value of all points.
  double rms_over_mean = 0;
  /// Percentiles of |a - b| / m_p, where |.| is the largest channel's and m_p is as above the mean
  /// of both sides and all channels at the point itself, plus a thousandth of the mean of all: the
  /// 95th percentile and the largest.
  double relative_p95 = 0, relative_max = 0;
};
/// Measures `values`, one per texel of the map; nothing is changed.
SeamResidual seam_residual(const atlas::TexelMap& map, std::span<const Seam> seams,
                           std::span<const Rgb> values, const SeamTexels& texels = {});

/// Per texel, the largest relative difference at the points of seams that look it up; 0 elsewhere.
std::vector<float> seam_errors(const atlas::TexelMap& map, std::span<const Seam> seams,
                               std::span<const Rgb> values, const SeamTexels& texels = {});

}  // namespace luxel::post
