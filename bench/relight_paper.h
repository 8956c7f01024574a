// The figures of [Shcherbakov17] on our patches: how form factors are distributed, what BC1 loses,
// how fast and how small it is.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "bench/validation.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/solve/matrix/bc1.h"

namespace luxel::bench {

/// Shares of all that was counted, in cells from `first` on, `step` wide.
struct Histogram {
  double first = 0, step = 1;
  std::vector<double> share;
};

/// By how much decoded entries differ from those of K, all channels.
struct EntryError {
  double mean = 0, largest = 0, total = 0;
  double relative = 0;  ///< the total over the sum of all entries
};

/// Median milliseconds of one update.
struct UpdateTimes {
  std::array<double, 5> single{};  ///< 1 to 5 products with F in float
  double half = 0;                 ///< 5 products with F in half floats
  double colour = 0;               ///< 5 products with F^c in float
  double reflections = 0;          ///< one product with K in float
  double bc1 = 0;                  ///< one product with K as bc1
};

/// Results to compare with the paper: K of five bounces between patches of the Cornell box.
struct PaperRuns {
  size_t patches = 0;
  double reflections_s = 0, bc1_s = 0;          ///< to make K, and bc1 of it
  Histogram factors;                            ///< of log10 F, where patches see each other
  Histogram small_factors;                      ///< of F
  double below = 0;                             ///< the share of entries of F below 0.005
  Histogram logarithms, bytes;                  ///< of the rest, of all channels
  std::vector<float> kept;                      ///< shares kept
  std::vector<EntryError> of_kept;              ///< as in the paper
  std::vector<EntryError> of_kept_default;      ///< by our changes
  std::array<EntryError, 3> of_order;           ///< as it is, rows, rows and columns
  std::array<EntryError, 3> of_order_shuffled;  ///< the same from patches in no order
  UpdateTimes ms;
  uint64_t single_bytes = 0, half_bytes = 0, colour_bytes = 0, bc1_bytes = 0;
  std::vector<Vec3> light;                         ///< positions of a point light
  std::vector<double> paper_error, default_error;  ///< per light: relative RMS error of E
};

/// Errors: cancelled, and what the solver says.
Result<PaperRuns> run_paper(size_t patches, Progress& progress);

struct PaperTables {
  std::vector<Table> tables;
  std::vector<PageFile> pictures;  ///< images/relight-paper-NAME
  nlohmann::json json;
};

/// All of it for about so many patches (the paper: about 4,000), some three minutes on two cores.
Result<PaperTables> measure_paper(size_t patches, Progress& progress);

}  // namespace luxel::bench
