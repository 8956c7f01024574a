#include "luxel/pipeline/solver/stage_seconds.h"

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

}  // namespace luxel::pipeline
