// The page that shows that luxel is right: docs/bench/validation.md, written by `luxel bench
// validation`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/image/codec.h"

namespace luxel::bench {

/// A picture beside the page: its file is images/validation-NAME.
struct PageFile {
  std::string name;
  std::vector<std::byte> bytes;
};

struct Section {
  std::string markdown;  ///< begins with its heading
  std::vector<PageFile> files;
  nlohmann::json json;
};

/// `shared` is the folder with reference/. Errors: its files are not there, cancelled, and what the
/// solvers say.
Result<Section> validate_view_factors(const std::filesystem::path& shared, Progress& progress);
Result<Section> validate_exact_solutions(const std::filesystem::path& shared, Progress& progress);
Result<Section> validate_agreement(Progress& progress);
Result<Section> validate_cornell_box(Progress& progress);
/// Stated errors to hold against true ones, and the scenes for it.
struct StatedParams {
  uint64_t first_seed = 1;  ///< of a hundred scenes
  std::string only;         ///< one of stated_error_names(); empty: all
};
/// The solvers and commands whose errors validate_stated_errors() holds against the truth.
std::vector<std::string> stated_error_names();
/// Stated errors against true ones; needs no files.
Result<Section> validate_stated_errors(const StatedParams& params, Progress& progress);

struct Page {
  std::string markdown;
  std::string csv;  ///< its numbers for other programs; empty: none
  std::vector<PageFile> files;
  nlohmann::json json;
};
/// All sections, about an hour on two cores. Errors: those of the sections.
Result<Page> validate(const std::filesystem::path& shared, Progress& progress);

/// "| a | b |" lines of a table.
std::string markdown_table(const std::vector<std::string>& columns,
                           const std::vector<std::vector<std::string>>& rows);
/// Breaks lines of prose at 120 characters. Tables, pictures, headings and code stay as they are.
std::string wrapped(std::string_view markdown);
/// A plot as a file of the page.
PageFile svg_file(std::string name, const std::string& svg);
/// A picture as a file of the page.
PageFile png_file(std::string name, const image::Image8& picture);
/// The line that shows a file of the page.
std::string show(const PageFile& file, std::string_view words);

}  // namespace luxel::bench
