#include "luxel/solve/gather/partial_light.h"

#include "luxel/solve/gather/bounce/sweep.h"

namespace luxel::gather {
namespace {

/// The watcher's own work takes some hundredths of a second, of one of the threads.
constexpr double kBetweenShows_s = 0.5;

}  // namespace

PartialLight::PartialLight(const Request& in, const Progressive& light, std::vector<Rgb> guess,
                           TileQueue& queue)
    : in_(in),
      light_(light),
      queue_(queue),
      sent_(empty_radiosity_map(in.scene.map.resolution)),
      irradiance_(std::move(guess)) {
  fill_radiosity(sent_, in.scene.map, in.scene.elements, light.hits, in.behind, irradiance_);
  prefer_what_is_watched();
}

void PartialLight::take(size_t first, const HitTile& hits) {
  std::vector<Rgb> e;
  uint32_t begin = 0;
  for (size_t k = 0; k < hits.end.size(); ++k) {
    Gathered g;
    gather_round(sent_, std::span(hits.entries).subspan(begin, hits.end[k] - begin), true, g);
    begin = hits.end[k];
    const size_t i = first + k;
    const float n = float(light_.hits.samples[i]);
    e.push_back(source_of(light_.hits, light_.direct.irradiance, i) +
                Rgb{g.sum[0], g.sum[1], g.sum[2]} * (1 / n));
  }
  {
    const std::lock_guard lock(mutex_);
    std::ranges::copy(e, irradiance_.begin() + ptrdiff_t(first));
    done_ += e.size();
  }
  show_now_and_then();
}

void PartialLight::show_now_and_then() {
  if (is_showing_.exchange(true)) return;
  if (seconds_since(last_) >= kBetweenShows_s) show();
  is_showing_ = false;
}

void PartialLight::show() {
  double share = 0;
  {
    const std::lock_guard data(mutex_);
    shown_ = irradiance_;
    share = double(done_) / double(irradiance_.size());
  }
  if (share == 1) return;  // what follows bounces them all
  in_.observer.on_estimate({.irradiance = shown_,
                            .direct = light_.direct.irradiance,
                            .samples = share * in_.params.samples,
                            .share = share});
  prefer_what_is_watched();
  last_ = Clock::now();
}

void PartialLight::prefer_what_is_watched() {
  if (!in_.observer.is_watched) return;
  const size_t n = light_.hits.size();
  queue_.prefer([&](size_t tile) {
    const size_t end = std::min(n, (tile + 1) * kTileElements);
    size_t watched = 0;
    for (size_t i = tile * kTileElements; i < end; ++i) watched += in_.observer.is_watched(i);
    return float(watched) / float(kTileElements);
  });
}

}  // namespace luxel::gather
