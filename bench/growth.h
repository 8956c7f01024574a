// Time and memory of bakes as maps and scenes grow.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "bench/validation.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"

namespace luxel::bench {

struct GrowthPage {
  std::vector<Table> tables;
  std::vector<PageFile> pictures;  ///< images/growth-NAME
  std::string csv;                 ///< every bake, a row each
  nlohmann::json json;
};

/// Bakes of maps up to 16384 x 16384 texels and of scenes up to ten million triangles: an hour on
/// two cores, 20 GB of memory and 45 GB of the disk. `series`: texels, triangles, copies or large
/// alone; empty: all. Call it before any other parallel work of the process: each bake is a child
/// process, which has no threads but its own. Errors: no such series; those of bakes; cancelled.
Result<GrowthPage> measure_growth(const std::string& series, int threads, Progress& progress);

}  // namespace luxel::bench
