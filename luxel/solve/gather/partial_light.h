// Light while the first rays are traced: tiles that have theirs, and a guess elsewhere.
#pragma once

#include <atomic>
#include <mutex>
#include <span>
#include <vector>

#include "luxel/base/clock.h"
#include "luxel/solve/gather/bounce/radiosity_map.h"
#include "luxel/solve/gather/steps.h"
#include "luxel/solve/gather/trace/tile_watch.h"

namespace luxel::gather {

/// Shows the watcher of `in` what a round brings. Elements whose rays are traced gather once from
/// surfaces that have the guessed light. Used by the threads that trace; `in`, `light` and `queue`
/// outlive it.
class PartialLight {
 public:
  /// `guess`: E per element, after all bounces.
  PartialLight(const Request& in, const Progressive& light, std::vector<Rgb> guess,
               TileQueue& queue);

  /// TileWatch::on_tile.
  void take(size_t first, const HitTile& hits);

 private:
  void show_now_and_then();
  void show();
  void prefer_what_is_watched();

  const Request& in_;
  const Progressive& light_;
  TileQueue& queue_;
  RadiosityMap sent_;
  std::mutex mutex_;  ///< of the two below
  std::vector<Rgb> irradiance_;
  uint64_t done_ = 0;  ///< elements that have their rays
  /// Somebody is in show_now_and_then(), whose the two below are. No mutex: a thread that waits for
  /// a loop of the watcher's may trace another tile meanwhile, and come here again.
  std::atomic<bool> is_showing_{false};
  std::vector<Rgb> shown_;
  Clock::time_point last_ = Clock::now();
};

}  // namespace luxel::gather
