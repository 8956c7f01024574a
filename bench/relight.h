// Cost and errors of relighting: codecs, sizes, preparation, and the path tracer's word.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "bench/relight_paper.h"
#include "bench/validation.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::bench {

/// A codec that holds the Cornell box's light.
struct CodecRun {
  std::string codec, setting;
  size_t patches = 0;
  uint64_t bytes = 0;
  double ms = 0;      ///< median: from what patches send to E of all bounces
  double error = 0;   ///< matrix::usual_error
  double make_s = 0;  ///< from the factors
  /// Products of F^c, plainly iterated, that err by no more.
  int products = 0;
};

struct CodecRuns {
  size_t patches = 0;
  int rays = 0;  ///< per patch
  std::vector<CodecRun> runs;
  /// The yardstick: a matrix of patches x patches x 3 floats, and one product with it.
  uint64_t colour_bytes = 0;
  double colour_ms = 0;

  /// Factors by which a run is smaller than the yardstick, faster than one product, which is the
  /// cost of all bounces where K is stored, and faster than iterating F^c.
  double smaller(const CodecRun& r) const { return double(colour_bytes) / double(r.bytes); }
  double faster(const CodecRun& r) const { return colour_ms / r.ms; }
  double faster_than_iterated(const CodecRun& r) const { return r.products * colour_ms / r.ms; }
};
/// Errors: cancelled, and what the solver says.
Result<CodecRuns> run_codecs(Progress& progress);

/// The hierarchy of so many patches of the Cornell box.
struct SizeRun {
  size_t patches = 0;
  int rays = 0;    ///< per patch
  int sweeps = 2;  ///< as many as leave less than 0.5 %
  uint64_t bytes = 0;
  double ms = 0, error = 0;  ///< as of CodecRun
  std::vector<Stage> stages;
};
/// block_error is the same for all. Errors: cancelled, and what the solver says.
Result<std::vector<SizeRun>> run_sizes(Progress& progress);
/// HierarchicalParams::block_error of run_sizes.
extern const float kSizesBlockError;

/// A point light, and how far the relighter's indirect light is from the truth.
struct JudgedLight {
  Vec3 position;
  double relative = 0;    ///< root mean square error over that of the light
  double resolution = 0;  ///< what cannot be told from 0: two standard errors of its square
  double per_point = 0;   ///< as Agreement::relative_rmse
  double bias = 0;        ///< signed, over the mean
  double noise = 0;       ///< the judge's own, over the root mean square of the light
};

struct JudgedRelight {
  std::string scene;
  size_t patches = 0, points = 0;
  int paths = 0;                                    ///< of the judge, per point
  double codec_error = 0, largest_codec_error = 0;  ///< usual, and seldom exceeded
  std::vector<Stage> stages;                        ///< of the preparation
  std::vector<JudgedLight> lights;
};

struct JudgeSettings {
  size_t points = 1024;  ///< spread evenly over the area
  int paths = 2048;      ///< per point, half of them per independent answer
  size_t lights = 10;
  size_t patches = 8192;
};
/// Lights stand at random in the air of the scene, whose own light is not looked at. Errors: no air
/// is found, cancelled, and what the solvers say.
Result<JudgedRelight> judge_relight(std::string name, scene::Scene scene,
                                    const JudgeSettings& settings, Progress& progress);

struct JudgedScenes {
  std::vector<JudgedRelight> runs;
  std::vector<std::string> missing;  ///< scenes that are not on this machine
};

struct RelightRuns {
  PaperTables paper;
  CodecRuns codecs;
  std::vector<SizeRun> sizes;
  JudgedScenes judged;
};

struct RelightPage {
  std::vector<Table> tables;
  std::vector<PageFile> pictures;  ///< images/relight-NAME
  std::string csv;                 ///< codecs and sizes, a row each
  nlohmann::json json;
};
/// Tables, plots and numbers of finished runs.
RelightPage page_of(RelightRuns runs);
/// The tables and numbers of the judged scenes.
void append(const JudgedScenes& judged, RelightPage& page);

/// All of it, some seven minutes on two cores. `shared` is the folder with scenes/. Errors: those
/// of what is measured.
Result<RelightPage> measure_relight(const std::filesystem::path& shared, Progress& progress);

/// The comparison with the path tracer alone, in the scene of a name. Errors: no such name; those
/// of judge_relight(); a file that cannot be read.
Result<RelightPage> measure_relight_in(const std::filesystem::path& shared,
                                       const std::string& scene, Progress& progress);

}  // namespace luxel::bench
