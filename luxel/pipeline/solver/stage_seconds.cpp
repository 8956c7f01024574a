#include "luxel/pipeline/solver/stage_seconds.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace luxel::pipeline {

nlohmann::json stage_seconds(std::span<const Stage> stages) {
  nlohmann::json seconds = nlohmann::json::object();
  double total = 0;
  for (const Stage& stage : stages) {
    seconds[stage.name] = seconds.value(stage.name, 0.0) + stage.seconds;
    total += stage.seconds;
  }
  seconds["total"] = total;
  return seconds;
}

double seconds_left(double budget_s, std::span<const Stage> stages) {
  if (budget_s <= 0) return INFINITY;
  for (const Stage& stage : stages) budget_s -= stage.seconds;
  return budget_s;
}

}  // namespace luxel::pipeline
