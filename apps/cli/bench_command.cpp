// The program luxel-bench, which `luxel bench NAME` starts: it prints the tables in docs/ and
// writes the pages. The folder bench/ has the measurements.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <span>
#include <vector>

#include "apps/cli/cli.h"
#include "apps/cli/print.h"
#include "bench/bench.h"
#include "bench/gallery.h"
#include "bench/growth.h"
#include "bench/hemicube.h"
#include "bench/hierarchical.h"
#include "bench/relight.h"
#include "bench/validation.h"
#include "luxel/base/file.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/parallel.h"

namespace luxel::cli {
namespace {

constexpr const char *kValidation = "validation", *kHemicube = "hemicube", *kRelight = "relight",
                     *kHierarchical = "hierarchical", *kGallery = "gallery", *kStated = "stated",
                     *kGrowth = "growth";

struct BenchOptions {
  Common common;
  std::string name;
  /// gallery, budget, rms: the stem of the only one; relight: its folder's name; growth: a series
  std::string scene;
  bench::StatedParams stated;
  std::string shared;
  std::string output = "docs";
};

std::filesystem::path default_shared() {
  if (const char* folder = std::getenv("LUXEL_SHARED")) return folder;
  return "../shared";
}

/// Writes the files, which lie in one or two folders of `folder`, and images/NAME-*, all of them or
/// none.
Status write_with_pictures(std::vector<OutputFile> files, const std::string& name,
                           std::span<const bench::PageFile> pictures,
                           const std::filesystem::path& folder) {
  OutputFolder first(files.front().path.parent_path()), last(files.back().path.parent_path());
  OutputFolder images(folder / "images");
  for (OutputFolder* made : {&first, &last, &images}) LUXEL_TRY_STATUS(made->make());
  for (const bench::PageFile& file : pictures)
    files.push_back({folder / "images" / (name + "-" + file.name), file.bytes});
  LUXEL_TRY_STATUS(write_files_atomically(files));
  first.keep(), last.keep(), images.keep();
  return {};
}

/// Before work of minutes: whether write_with_pictures() will find its folders writable.
Status try_out_folders(const std::filesystem::path& folder, const char* pages = "bench") {
  LUXEL_TRY_STATUS(OutputFolder(folder / pages).try_out());
  return OutputFolder(folder / "images").try_out();
}

std::filesystem::path csv_of(const BenchOptions& options, const std::string& name) {
  return std::filesystem::path(options.output) / "bench" / (name + ".csv");
}

/// A benchmark that writes a page of docs.
struct BenchPage {
  std::string name;    ///< begins the names of its pictures
  const char* folder;  ///< of the page, in docs
  Result<bench::Page> (*make)(const std::filesystem::path& shared, const BenchOptions& options,
                              Progress& progress);
};
const std::array<BenchPage, 2> kPages{
    {{kValidation, "bench",
      [](const std::filesystem::path& shared, const BenchOptions&, Progress& progress) {
        return bench::validate(shared, progress);
      }},
     {kGallery, "guide",
      [](const std::filesystem::path& shared, const BenchOptions& options, Progress& progress) {
        return bench::make_gallery(shared, options.scene, csv_of(options, kGallery), progress);
      }}}};

/// NAME.md and its pictures.
int write_page(const BenchPage& which, const BenchOptions& options,
               const std::filesystem::path& shared) {
  const ThreadLimit limit(options.common.threads);
  const std::filesystem::path folder = options.output;
  const std::filesystem::path file = folder / which.folder / (which.name + ".md");
  bench::Page page;
  const Status done = run_with_progress(options.common, [&](Progress& progress) -> Status {
    LUXEL_TRY_STATUS(try_out_folders(folder, which.folder));
    LUXEL_TRY(page, which.make(shared, options, progress));
    progress.begin(kWriteStage, 0);
    std::vector<OutputFile> files{text_file(file, page.markdown)};
    if (!page.csv.empty()) files.push_back(text_file(csv_of(options, which.name), page.csv));
    return write_with_pictures(std::move(files), which.name, page.files, folder);
  });
  if (!done) return report(done.error(), options.common);
  if (options.common.json)
    print_json(stdout, page.json);
  else if (!options.common.quiet)
    print_line(stdout, "wrote " + file.string());
  return kDone;
}

/// The plots and the numbers behind them: NAME.csv, images/NAME-*. `Page` is what a
/// measure_ function below gives.
template <class Page>
Status write_plots(const Page& page, const std::string& name, const std::filesystem::path& folder) {
  return write_with_pictures({text_file(folder / "bench" / (name + ".csv"), page.csv)}, name,
                             page.pictures, folder);
}

/// Files are written when it was asked for by name and whole, not with all tables.
/// `measure(shared, progress)` is a measure_ function, which gives a Result<Page>.
template <class Page, class Measure>
int run_page(const BenchOptions& options, const std::string& name,
             const std::filesystem::path& shared, const Measure& measure) {
  const ThreadLimit limit(options.common.threads);
  const std::filesystem::path folder = options.output;
  const bool write = options.name == name && options.scene.empty();
  Page page;
  const Status done = run_with_progress(options.common, [&](Progress& progress) -> Status {
    if (write) LUXEL_TRY_STATUS(try_out_folders(folder));
    LUXEL_TRY(page, measure(shared, progress));
    return write ? write_plots(page, name, folder) : Status{};
  });
  if (!done) return report(done.error(), options.common);
  if (options.common.json) {
    print_json(stdout, page.json);
    return kDone;
  }
  for (const bench::Table& table : page.tables) print_own(stdout, bench::markdown(table) + "\n");
  return kDone;
}

/// All of it, or the comparison with the path tracer in --scene.
int run_relight(const BenchOptions& options, const std::filesystem::path& shared) {
  return run_page<bench::RelightPage>(
      options, kRelight, shared, [&](const std::filesystem::path& folder, Progress& progress) {
        return options.scene.empty() ? bench::measure_relight(folder, progress)
                                     : bench::measure_relight_in(folder, options.scene, progress);
      });
}

/// All of it, or the series in --scene.
int run_growth(const BenchOptions& options) {
  return run_page<bench::GrowthPage>(
      options, kGrowth, {}, [&](const std::filesystem::path&, Progress& progress) {
        return bench::measure_growth(options.scene, options.common.threads, progress);
      });
}

/// Stated errors alone, on other scenes or of one solver.
int run_stated(const BenchOptions& options) {
  const ThreadLimit limit(options.common.threads);
  bench::Section section;
  const Status done = run_with_progress(options.common, [&](Progress& progress) -> Status {
    LUXEL_TRY(section, bench::validate_stated_errors(options.stated, progress));
    return {};
  });
  if (!done) return report(done.error(), options.common);
  if (options.common.json)
    print_json(stdout, section.json);
  else
    print_own(stdout, bench::wrapped(section.markdown) + "\n");
  return kDone;
}

int run_tables(const BenchOptions& options, const std::filesystem::path& shared) {
  for (const bench::Bench& table_of : bench::kBenches) {
    if (options.name != "all" && options.name != table_of.name) continue;
    const auto table = options.scene.empty()
                           ? table_of.run(shared, options.common.threads)
                           : table_of.run_in(shared, options.scene, options.common.threads);
    if (!table) return report(table.error(), options.common);
    if (options.common.json)
      print_json(stdout, table->json);
    else
      print_own(stdout, bench::markdown(*table) + "\n");
  }
  return kDone;
}

bool takes_scene(const std::string& name) {
  const auto is_it = [&](const bench::Bench& b) { return name == b.name && b.run_in; };
  return name == kRelight || name == kGallery || name == kGrowth ||
         std::ranges::any_of(bench::kBenches, is_it);
}

int run_bench(const BenchOptions& options) {
  if (!options.scene.empty() && !takes_scene(options.name))
    return report_usage("--scene belongs to `luxel bench` gallery, relight, budget, rms and growth",
                        options.common);
  const bool of_stated = options.stated.first_seed != 1 || !options.stated.only.empty();
  if (of_stated && options.name != kStated)
    return report_usage("--first-seed and --only belong to `luxel bench stated`", options.common);
  if (options.name == kStated) return run_stated(options);
  if (options.name == kGrowth) return run_growth(options);
  const std::filesystem::path shared =
      options.shared.empty() ? default_shared() : std::filesystem::path(options.shared);
  for (const BenchPage& page : kPages)
    if (options.name == page.name) return write_page(page, options, shared);
  const bool all = options.name == "all";
  // First of all: it measures memory in a child process, which must not miss this one's threads.
  if (options.name == kHemicube || all)
    if (const int code =
            run_page<bench::HemicubePage>(options, kHemicube, shared, bench::measure_hemicube);
        code != kDone || !all)
      return code;
  if (options.name == kRelight || all)
    if (const int code = run_relight(options, shared); code != kDone || !all) return code;
  if (options.name == kHierarchical || all)
    if (const int code = run_page<bench::HierarchicalPage>(options, kHierarchical, shared,
                                                           bench::measure_hierarchical);
        code != kDone || !all)
      return code;
  return run_tables(options, shared);
}

}  // namespace

void register_commands(CLI::App& app, Action& action) {
  CLI::App* bench = app.add_subcommand("bench", kAboutBench);
  auto options = std::make_shared<BenchOptions>();
  std::vector<std::string> names{"all",     kValidation, kStated,       kGallery,
                                 kHemicube, kRelight,    kHierarchical, kGrowth};
  for (const bench::Bench& b : bench::kBenches) names.emplace_back(b.name);
  bench
      ->add_option(
          "NAME", options->name,
          "Table to print, or all; or a page: validation compares luxel with exact solutions and a "
          "path tracer (about an hour), gallery shows bakes with default options (almost an hour), "
          "stated compares stated errors with true ones, growth bakes ever larger lightmaps and "
          "scenes (an hour, 20 GB of memory, 45 GB of disk)")
      ->check(CLI::IsMember(names))
      ->required();
  bench->add_option("--scene", options->scene,
                    "gallery: redo only the scene with this file stem and keep the rest of the "
                    "page. relight: only compare with the path tracer in this scene; write no "
                    "files. budget, rms: only the rows of the scene with this file stem. growth: "
                    "only this series: texels, triangles, copies or large");
  bench
      ->add_option("--first-seed", options->stated.first_seed,
                   "stated: seed of the first of the hundred scenes (default: 1)")
      ->check(whole_number());
  bench
      ->add_option("--only", options->stated.only,
                   "stated: only the rows of this solver or command")
      ->check(CLI::IsMember(bench::stated_error_names()));
  bench->add_option(
      "--shared", options->shared,
      "Folder that holds scenes/ and reference/ (default: $LUXEL_SHARED, else ../shared)");
  bench->add_option("-o,--output", options->output,
                    "validation, gallery, hemicube, relight, hierarchical: write the page or .csv "
                    "to bench/ or guide/ in this folder, and pictures to images/ (default: docs)");
  add_common(*bench, options->common);
  bench->callback([options, &action] { action = [options] { return run_bench(*options); }; });
}

}  // namespace luxel::cli
