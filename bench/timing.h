// Milliseconds that can be compared, and where seconds went.
#pragma once

#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "luxel/base/progress.h"

namespace luxel::bench {

/// Median milliseconds of each task over `rounds` of all in turn, so that a machine that slows down
/// does so to all. Each runs once just before it is timed: the caches hold its memory, as they do
/// frame after frame.
std::vector<double> time_in_turn(const std::vector<std::function<void()>>& tasks, int rounds);

/// Seconds of all of this process's threads since a call of std::clock(). Those of a clock on the
/// wall say how busy the machine is, too.
inline double processor_seconds_since(std::clock_t start) {
  return double(std::clock() - start) / CLOCKS_PER_SEC;
}

/// The stages of `progress` from number `first` on, those of one name as one, in the order of their
/// first.
std::vector<Stage> stages_from(const Progress& progress, size_t first);

}  // namespace luxel::bench
