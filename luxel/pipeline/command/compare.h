// Two pictures or two bakes held against each other: what `luxel compare` does.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/image/compare.h"
#include "luxel/image/display_measures.h"
#include "luxel/pipeline/render/picture.h"

namespace luxel::pipeline {

/// Settings of `luxel compare`.
struct CompareSettings {
  std::filesystem::path a, b;                   ///< files, or folders of bakes; b is the reference
  std::optional<std::filesystem::path> report;  ///< folder for report.html
  std::optional<double> exposure;               ///< for the display values; unset: chosen from b
};

/// Differences of `a` from `b`.
struct Compared {
  image::Difference difference;         ///< of linear light
  double psnr_db = 0;                   ///< 8-bit pictures: of display values, peak 255
  double relative_p95 = 0;              ///< 95th percentile of the pixels' relative RMS error
  double flip = 0;                      ///< mean over covered pixels, LDR- or HDR-FLIP
  double flip_p95 = 0;                  ///< 95th percentile over covered pixels
  std::array<double, 3> share_above{};  ///< of pixels, per image::kDifferenceLevels
  double exposure = 1;                  ///< both were tone mapped with; 1 for 8-bit pictures
  bool hdr = false;
  std::filesystem::path report;  ///< the file written, or empty
  std::vector<std::string> warnings;
};

/// The numbers, and the pictures that they were taken from.
struct Measured {
  Compared numbers;
  image::Mask covered;
  image::Image8 shown_a, shown_b;  ///< display values
  image::Image flip;               ///< per pixel
  image::Image relative;           ///< relative RMS error per pixel
};

/// Measures two pictures in memory. Errors: sizes or channels that differ, values that are not
/// finite, no pixel covered in common, one picture of light and one of display values, an exposure
/// for display values; cancelled.
Result<Measured> measure(const Picture& a, const Picture& b, std::optional<double> exposure,
                         Progress& progress);

/// Reads, measures and writes the report. Errors: those of measure(), unreadable files, settings
/// out of range, an unwritable folder.
Result<Compared> compare(const CompareSettings& settings, Progress& progress);

/// A measure that `luxel compare` can hold against a limit. All are 0 for equal pictures.
struct Limited {
  std::string_view flag;  ///< "--max-flip"
  std::string_view key;   ///< in JSON: "flip"
  std::string_view name;  ///< in sentences: "FLIP"
  double (*of)(const Compared&);
};
/// All of them, the one that matters most first.
std::span<const Limited> limited_measures();

/// A limit that was given: `measure` counts limited_measures(). A measure without a number (of a
/// black reference) is above every limit.
struct Limit {
  size_t measure = 0;
  double most = 0;
};
/// The measure is at most as large as its limit.
bool holds(const Limit& limit, const Compared& compared);

/// One line: "pass: FLIP 0.01 (at most 0.05)", or the most important measures where nothing was
/// asked for. "fail" when a limit does not hold.
std::string verdict(const Compared& compared, std::span<const Limit> limits);

/// The object of `luxel compare --json`. What is infinite or undefined is null.
nlohmann::json to_json(const Compared& compared);

}  // namespace luxel::pipeline
