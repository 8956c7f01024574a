#include "bench/timing.h"

#include <algorithm>

#include "luxel/validate/prepared.h"

namespace luxel::bench {
namespace {

double median(std::vector<double>& values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

}  // namespace

std::vector<double> time_in_turn(const std::vector<std::function<void()>>& tasks, int rounds) {
  constexpr int kWarmUp = 2;
  std::vector<std::vector<double>> ms(tasks.size());
  for (int round = -kWarmUp; round < rounds; ++round)
    for (size_t k = 0; k < tasks.size(); ++k) {
      tasks[k]();
      const auto start = Clock::now();
      tasks[k]();
      if (round >= 0) ms[k].push_back(1e3 * seconds_since(start));
    }
  std::vector<double> out;
  for (std::vector<double>& values : ms) out.push_back(median(values));
  return out;
}

std::vector<Stage> stages_from(const Progress& progress, size_t first) {
  std::vector<Stage> out;
  const std::vector<Stage> all = progress.stages();
  for (size_t k = first; k < all.size(); ++k) {
    const auto same =
        std::find_if(out.begin(), out.end(), [&](const Stage& s) { return s.name == all[k].name; });
    if (same == out.end())
      out.push_back(all[k]);
    else
      same->seconds += all[k].seconds;
  }
  return out;
}

}  // namespace luxel::bench
