// Milliseconds that can be compared, and where seconds went.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "luxel/base/clock.h"
#include "luxel/base/progress.h"

namespace luxel::bench {

/// Median milliseconds of each task over `rounds` of all in turn, so that a machine that slows down
/// does so to all. Each runs once just before it is timed: the caches hold its memory, as they do
/// frame after frame.
std::vector<double> time_in_turn(const std::vector<std::function<void()>>& tasks, int rounds);

/// The stages of `progress` from number `first` on, those of one name as one, in the order of their
/// first.
std::vector<Stage> stages_from(const Progress& progress, size_t first);

}  // namespace luxel::bench
