// The steps of gather(), by which light and what it is made of grow.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "luxel/solve/gather/budget/light_errors.h"
#include "luxel/solve/gather/budget/rms_round.h"
#include "luxel/solve/gather/gather.h"
#include "luxel/transport/own_side.h"

namespace luxel::gather {

struct TileWatch;

/// The arguments of gather(), and data that follows from them.
struct Request {
  const light::TexelScene& scene;
  const light::LightLayers* layers;
  const GatherParams& params;
  const GatherStores& stores;
  const GatherObserver& observer;
  const transport::OwnSides& sides;
  std::vector<StoredHit> behind{};                      ///< places_behind()
  const light::LightLayers* followed_layers = nullptr;  ///< of followed rays; null: `layers`

  size_t layer_count() const { return layers ? layers->size() : 0; }
  /// True: rounds add rays where light is not known well enough.
  bool adds_rounds() const { return params.max_error > 0 || params.seconds > 0; }
  /// True: rays are kept for later bakes, or were kept by an earlier one. Such rays follow no
  /// guide.
  bool knows_rays_by_number() const { return stores.keep || stores.earlier; }
  /// True: direct light may be looked at more finely than at first.
  bool may_look_finer() const {
    return adds_rounds() || params.more_shadow_rays || params.more_points;
  }
  light::SupersampleParams supersample_params() const {
    return {.points = params.supersample,
            .direct = {.samples = params.direct_samples,
                       .seed = params.seed,
                       .parts = stores.parts,
                       .team = stores.team,
                       .layers = layers}};
  }
};

/// The light so far, and the rays that it is made of.
struct Progressive {
  light::DirectLight direct;
  std::vector<Rgb> direct_before;  ///< direct light of an earlier bake
  light::DirectLevels levels;
  size_t averaged = 0;
  /// Shadow rays of an element's direct light as it was first looked at, on average: at its own
  /// sample, and averaged over points. 0: none was found.
  double shadow_rays_at_sample = 0, shadow_rays_at_points = 0;
  TracedHits hits;
  double rays_per_ray = 1;  ///< an element's ray in the first round, with those that follow it
  Bounced bounced;
  LightErrors errors;
  double of_noise = kOfNoise;  ///< the part of pooled variances that is true; measured for an RMS
  double share_of_direct = 0;  ///< TrueNoise; measured with it
  std::optional<ReadCheck> check;      ///< places at which what rays read is checked
  std::vector<Rgb> first_change;       ///< BounceParams
  double traced_s = 0, bounced_s = 0;  ///< of the last round in which something was traced
  double judged_s = 0;                 ///< to know how far the light of the last round is off
  uint64_t traced_rays = 0, traced_samples = 0;
};

/// Costs of an element's light, by the rays that have been traced.
RayCosts costs_of(const Request& in, const Progressive& light);

/// True: parts of the work so far are left to others, so that its result is not known as a whole.
inline bool has_left_parts(const Request& in) {
  return in.stores.parts && in.stores.parts->parts_left() > 0;
}

/// Direct light, from scratch or from an earlier bake; not averaged where parts are left to others.
/// Errors: cancelled.
Status begin_direct(const Request& in, Progressive& light, Progress& progress);
/// Rays of each element up to so many as `target` says. `watch`: null: nobody. Errors: cancelled,
/// disk full; those of stores.device.
Status trace_round(const Request& in, std::span<const uint16_t> target, Progressive& light,
                   Progress& progress, const TileWatch* watch = nullptr);
/// All bounces of the light of those rays. Errors: cancelled, the file of hits cannot be read.
Status bounce_round(const Request& in, float tolerance, Progressive& light, Progress& progress);
/// Without rounds, and from scratch: looks at direct light more finely where it is not as well
/// known as the rest. Errors: cancelled, the file of hits cannot be read.
Status balance_direct(const Request& in, Progressive& light, Progress& progress);
/// Without rounds, where light will be denoised: rays anew, or more of them, of elements whose
/// light the denoiser would leave mottled. Errors: cancelled, disk full.
Status add_where_grainy(const Request& in, Progressive& light, Progress& progress);
/// Rays that begin anew do so, by the level of each element's guide; 0: they do not. Returns
/// whether any do.
bool begin_anew(std::span<const uint8_t> anew, TracedHits& hits);
/// Places at which what rays read is checked, where that costs little beside the rays. Errors:
/// cancelled, disk full.
Status choose_places(const Request& in, Progressive& light, Progress& progress);
/// Judges how far the light so far is off. Errors: cancelled.
Status judge(const Request& in, Progressive& light, Progress& progress);
/// Gather::answers, when all bounces are known. Errors: cancelled, disk full.
Result<light::Answers> answers_of(const Request& in, const Progressive& light,
                                  std::span<const uint8_t> enclosed, Progress& progress);
/// The light of the rays so far, which are not all, and how well it is known.
Status estimate_round(const Request& in, Progressive& light, Progress& progress);
/// Adds rays where they are needed most. False: there is nothing to add, or no time. Errors:
/// cancelled, disk full.
Result<bool> next_round(const Request& in, double seconds_left, Progressive& light,
                        Progress& progress);

/// Shows the light so far to who watches.
void show(const GatherObserver& observer, const Progressive& light, bool is_last);
/// Memory that hits may still take [bytes].
uint64_t spare_bytes(const GatherStores& stores, const TracedHits& hits);

}  // namespace luxel::gather
