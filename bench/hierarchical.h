// luxel bench hierarchical: the office of [Hardt96, section 7.1], exactness, growth.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "bench/validation.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::bench {

/// n x n cells of 3 m with a desk, a chair and a lamp each, in one hall; 86 n^2 + 12 triangles.
scene::Scene open_plan_office(int n);

/// Against the path tracer, against rays at points, energy, and what linear functions are for.
Result<std::vector<Table>> hierarchical_judged(Progress& progress);

struct HierarchicalPage {
  std::vector<Table> tables;
  std::vector<PageFile> pictures;
  std::string csv;
  nlohmann::json json;
};
/// Some minutes on two cores. Errors: what the solver says; cancelled.
Result<HierarchicalPage> measure_hierarchical(const std::filesystem::path& shared,
                                              Progress& progress);

}  // namespace luxel::bench
