// The benchmark mode of [Rodriguez06, section 5.8]: time per vertex against the model's complexity
// and against the hemicube's size.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "bench/validation.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/solve/hemicube/hemicube.h"

namespace luxel::bench {

/// A whole solution of one of the paper's boxes.
struct BoxRun {
  std::string test, scene;
  int hemicube = 64, passes = 10;
  size_t vertices = 0, triangles = 0;
  double seconds = 0;          ///< from the scene to the light: hierarchy, mesh, looking, passes
  hemicube::LookSeconds look;  ///< CPU time
  uint64_t row_bytes = 0;      ///< what the hemicubes saw, kept for the passes
  double mean_irradiance = 0;  ///< mean luminance of E over the vertices [W/m^2]

  double microseconds_per_vertex() const { return 1e6 * seconds / double(vertices); }
  double visibility_share() const { return look.visibility / (look.visibility + look.summation); }
};

/// `device`: what looks; null: the processor. Errors: what the solver says; cancelled.
Result<BoxRun> run_box(std::string test, const scene::Scene& scene, float element_size_m,
                       int hemicube, int passes, Progress& progress,
                       hemicube::LookDevice* device = nullptr);

/// By how much the hemicubes of solve/hemicube err on one exact row of view-factors.csv.
struct FactorErrors {
  std::string name;
  int hemicube = 0;
  double of_mean = 0;  ///< relative, of the mean over the square against the row's F
  double of_one = 0;   ///< relative, root mean square over the points, each against its own F
};
/// `file` is view-factors.csv. Errors: it cannot be read; a row is not there; cancelled.
Result<std::vector<FactorErrors>> measure_hemicube_factors(const std::filesystem::path& file,
                                                           Progress& progress);

struct HemicubePage {
  std::vector<Table> tables;
  std::vector<PageFile> pictures;  ///< images/hemicube-NAME
  std::string csv;                 ///< every run, a row each
  nlohmann::json json;
};
/// All of it, some three minutes on two cores. `shared` is the folder with reference/. Call it
/// before any other parallel work of the process: it measures memory in a child process, which has
/// no threads but its own.
Result<HemicubePage> measure_hemicube(const std::filesystem::path& shared, Progress& progress);

}  // namespace luxel::bench
