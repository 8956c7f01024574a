// Radiosity maps: Monte Carlo gather per texel. [Moreno05]
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "luxel/base/bytes_per_entry.h"
#include "luxel/base/part_store.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/light/chosen_elements.h"
#include "luxel/light/light_estimate.h"
#include "luxel/light/light_layers.h"
#include "luxel/light/supersample.h"
#include "luxel/light/texel_scene.h"

namespace luxel::gather {

struct Earlier;
class RayDevice;

/// The measure of error that max_error bounds.
enum class ErrorMeasure : uint8_t {
  p95,  ///< what 95 % of elements err by less than, over their light, or over a tenth of the mean
        ///< where they are darker
  rms,  ///< the root mean square error of all elements that are not hidden, over their mean light
};

/// Settings of gather(): rays, bounces of their light, and the error or the time at which it ends.
struct GatherParams {
  int samples = 256;  ///< indirect rays per element; with max_error or seconds, of the first round
  /// > 0: rounds of more samples until the error is below it.
  float max_error = 0;
  ErrorMeasure error_measure = ErrorMeasure::p95;
  /// > 0: rounds of more samples while they, and the bounces, end within so many seconds from the
  /// call. The first round and the first direct light are not cut short. Depends on the machine.
  double seconds = 0;
  int max_samples = 16384;  ///< with max_error or seconds, per element
  int direct_samples = 64;  ///< shadow rays per element towards emissive surfaces
  int supersample = 1;      ///< points per element where direct light varies; 1: none
  /// Without rounds: once rays are traced, so many shadow rays, or points, more that direct light
  /// is known as well as the rest, where that costs at most twice what the rays did.
  bool more_shadow_rays = false, more_points = false;
  /// Without rounds: up to 45 % more rays where the denoiser would leave light mottled; not with
  /// GatherStores::earlier or keep.
  bool more_rays = false;
  int bounces = -1;            ///< < 0: all
  float tolerance = 1e-4f;     ///< see BounceParams
  bool tells_direct = false;   ///< Gather::sources; not with layers
  bool tells_answers = false;  ///< Gather::answers; with all bounces
  uint64_t seed = 1;
};

/// Where gather stores hits and finished parts, and what it finds of an earlier bake.
struct GatherStores {
  uint64_t hit_memory_bytes = UINT64_MAX;      ///< for hits; the rest goes to temporary files
  std::filesystem::path scratch_folder = ".";  ///< where those files are
  /// Where finished parts are kept and found; null: nowhere. With a share of its own, only parts of
  /// that share are worked on, and gather ends when all rays are known.
  PartStore* parts = nullptr;
  PartStore* keep = nullptr;  ///< where rays are kept for later bakes of the scene; null: nowhere
  /// Whose members share the work out, each with `hit_memory_bytes` and files of its own. Not with
  /// device, keep, earlier, a share of the parts, or an observer of estimates. Null: nobody does.
  Team* team = nullptr;
  /// Lights places, traces rays and has their hits; null: the processor. Not with keep, earlier or
  /// light that is told apart.
  RayDevice* device = nullptr;
  Earlier* earlier = nullptr;  ///< is used up; its rounds come first; null: nothing is known
};

/// Callbacks that watch gather().
struct GatherObserver {
  /// Gets the light as it grows: direct light with a guess of the rest, then about twice a second
  /// that of the elements whose rays are traced, and after each round all of it, the last being
  /// what gather() returns. The result is that without it, bit by bit.
  light::OnLightEstimate on_estimate{};
  /// The guess: E per element after all bounces, from its direct part. None: an ambient term
  /// [Cohen88].
  std::function<std::vector<Rgb>(std::span<const Rgb> direct)> guess{};
  /// True: rays of this element should come early. Asked now and then, by threads that trace. None:
  /// they come in order.
  std::function<bool(size_t element)> is_watched{};
  /// Gets the light reflection by reflection when all rays are known, before the last estimate. It
  /// costs a sweep over all of them for each, which changes no bit of what gather() returns.
  light::OnBounce on_bounce{};
  /// Called when every ray is traced: drop_places() may be called on the elements then.
  std::function<void()> on_traced{};
};

/// Light straight from what shines, without any reflection: E per element [W/m^2].
struct SourceLight {
  std::vector<Rgb> punctual;  ///< of point, spot and directional lights
  std::vector<Rgb> others;    ///< of surfaces that shine, of background and environment
};
/// Layers of light that SourceLight takes per element while rays are traced.
inline constexpr size_t kSourceLayers = 3;

/// The result of gather(). Arrays have one value per element.
struct Gather {
  std::vector<Rgb> irradiance;  ///< E per element [W/m^2], after all bounces
  std::vector<Rgb> direct;      ///< the part of it that comes straight from the lights
  /// Estimated variance of the mean's luminance, per element: of the direct part and of the rest.
  std::vector<float> direct_variance, indirect_variance;  ///< indirect: from halves, see Bounced
  std::vector<uint16_t> met_back;  ///< rays per element that met the back of a one-sided surface
  std::vector<uint8_t> enclosed;   ///< per element: 1 inside a solid (transport::is_enclosed)
  std::vector<float> pooled_variance;  ///< of the luminance, per element: pooled_variances
  std::vector<float> errors;           ///< per element: relative_errors, with texel_error
  std::vector<float> gathered_errors;  ///< of the indirect part's noise alone
  float error_p95 = 0;                 ///< 95 of 100 elements err by less: error_p95 of `errors`
  float noise_p95 = 0;                 ///< of their noise alone
  std::vector<uint16_t> samples;       ///< indirect rays per element
  /// With layers, of each: E per element after all bounces. They add up to `irradiance`.
  std::vector<std::vector<Rgb>> layers;
  double layers_shared_out = 0;  ///< LayersBounced::shared_out
  SourceLight sources;  ///< with tells_direct; made of the rays that `irradiance` is made of
  /// With `keep`: direct light as it is in the end, and how finely it was sampled.
  light::DirectLight kept_direct;
  light::DirectLevels kept_levels;
  uint64_t rays = 0;
  uint64_t rays_kept = 0;     ///< TracedHits::rays_kept
  uint64_t supersampled = 0;  ///< elements whose direct light is a mean over points
  int sweeps = 0;
  uint64_t hit_bytes_in_file = 0;
  /// Root mean square error to expect over the mean luminance, of elements that no solid hides: of
  /// the noise (pooled_variances) and of what texels cost (texel_error).
  double relative_error = 0;
  double relative_noise = 0;  ///< of its noise alone
  /// The part that `answers` do not show: what texels cost, and noise that all elements share.
  double relative_unseen = 0;
  /// With tells_answers: the light of some elements anew, by which a caller can judge what it makes
  /// of `irradiance`.
  light::Answers answers;
};

/// While samples are still to come the bounces need not be exact: a hundredth is far below the
/// noise of the rays that are to be added.
inline constexpr float kRoughTolerance = 1e-2f;

inline constexpr uint64_t kEnclosedBytesPerElement = bytes_per_entry(&Gather::enclosed);
/// With more_rays, while elements are chosen: light and noise by a guess, and elements in order.
inline constexpr uint64_t kGrainBytesPerElement =
    bytes_per_entry(&Gather::irradiance, &Gather::direct_variance, &Gather::indirect_variance,
                    &Gather::pooled_variance, &Gather::errors) +
    sizeof(std::pair<uint64_t, uint32_t>);
/// While rays are traced: how many samples each element is to have.
inline constexpr uint64_t kTargetBytesPerElement = bytes_per_entry(&Gather::samples);

/// Direct light, rays, bounces: the chain of docs/method/gather.md. `layers` tells light apart;
/// null: it does not. Errors: cancelled, disk full; with stores.device those of RayDevice; with a
/// share of the parts, ErrorCode::parts_missing where others have theirs to do, or where all rays
/// are known (PartStore::parts_left() is 0 then).
Result<Gather> gather(const light::TexelScene& in, const light::LightLayers* layers,
                      const GatherParams& params, const GatherStores& stores,
                      const GatherObserver& observer, Progress& progress);

}  // namespace luxel::gather
