// docs/guide/gallery.md: pictures of default bakes at eye level, then the numbers, then path-traced
// pictures beside them.
#include "bench/gallery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <span>

#include "bench/baked_picture.h"
#include "bench/bench.h"
#include "bench/gallery_scenes.h"
#include "bench/timing.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/render/exposure.h"
#include "luxel/pipeline/settings/quality.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/scene/shapes.h"

namespace luxel::bench {
namespace {

const display::DrawParams kPicture{.width = 960, .height = 540};
/// The pictures that are compared: small, so that many paths fall into each pixel.
const display::DrawParams kCompared{.width = 320, .height = 180};
/// Two independent pictures get so many paths per pixel at a time, until FLIP between both, which
/// is noise of the paths, is no more than kNoise, or they have kMostPaths each.
constexpr int kPathsAtOnce = 256, kMostPaths = 5 * kPathsAtOnce;
constexpr double kNoise = 0.03;
/// Pixels between the two pictures.
constexpr int kGap = 4;

std::string stem_of(const GalleryScene& scene) {
  return std::filesystem::path(scene.file).stem().string();
}

std::span<const GalleryView> views_of(const GalleryScene& scene) {
  const auto none = std::ranges::find(scene.views, 0.0f, &GalleryView::fov_y_deg);
  return {scene.views.begin(), none};
}

/// Names of pictures, after "gallery-".
std::string picture_of(const std::string& scene, size_t view) {
  return scene + (view == 0 ? "" : fmt::format("-{}", view + 1)) + ".jpg";
}
std::string pair_of(const std::string& scene) { return scene + "-paths.png"; }

scene::Camera camera_of(const GalleryView& view) {
  return {.name = "",
          .world_from_camera = scene::look_at(view.eye, view.look_at, view.up),
          .fov_y_rad = view.fov_y_deg * kPi / 180};
}

image::Image8 side_by_side(const image::Image& left, const image::Image& right) {
  image::Image both(left.width + kGap + right.width, left.height, 3);
  for (int y = 0; y < left.height; ++y) {
    for (int x = 0; x < both.width; ++x) both.set_rgb(x, y, Rgb{1, 1, 1});
    for (int x = 0; x < left.width; ++x) both.set_rgb(x, y, left.rgb(x, y));
    for (int x = 0; x < right.width; ++x) both.set_rgb(left.width + kGap + x, y, right.rgb(x, y));
  }
  return image::to_srgb8(both);
}

/// A scene's row of gallery.csv. Seconds are those of processors.
struct Row {
  std::string scene;
  int pages = 0, width = 0, height = 0, paths = 0;  ///< paths per pixel
  double bake_seconds = 0, path_seconds = 0, flip = 0, flip_of_paths = 0;
};

Result<pipeline::Bake> bake_by_default(const std::filesystem::path& file, Progress& progress) {
  pipeline::BakeSettings settings;
  settings.scene = file, settings.output = std::filesystem::temp_directory_path();
  settings.threads = thread_count();
  pipeline::set_quality(
      pipeline::Quality::good, [](std::string_view) { return false; }, settings);
  return pipeline::bake_scene(settings, progress);
}

/// Two pictures of a view, by independent paths.
struct PathPictures {
  std::array<image::Image, 2> picture;
  int paths = 0;     ///< per pixel, of each
  double noise = 0;  ///< FLIP between both
};

/// The mean of `a`, which counts n times, and `b`. With n = 0 `a` may be empty.
image::Image mean_of(const image::Image& a, float n, const image::Image& b) {
  image::Image out(b.width, b.height, 3);
  for (int y = 0; y < b.height; ++y)
    for (int x = 0; x < b.width; ++x)
      out.set_rgb(x, y, n > 0 ? (a.rgb(x, y) * n + b.rgb(x, y)) / (n + 1) : b.rgb(x, y));
  return out;
}

Result<PathPictures> trace_pictures(const scene::Scene& scene, const trace::RayTracer& tracer,
                                    const scene::Camera& camera, float exposure,
                                    Progress& progress) {
  PathPictures out;
  for (uint64_t round = 0; out.paths == 0 || (out.noise > kNoise && out.paths < kMostPaths);
       ++round) {
    for (size_t k = 0; k < 2; ++k) {
      const reference::PathParams params{.samples = kPathsAtOnce, .seed = 1 + k + 2 * round};
      LUXEL_TRY(const reference::Picture more,
                reference::radiance_by_paths(scene, tracer, camera, kCompared.width,
                                             kCompared.height, params, progress));
      out.picture[k] = mean_of(out.picture[k], float(round), more.radiance);
    }
    out.paths += kPathsAtOnce;
    out.noise = mean_flip(on_screen(out.picture[0], exposure), on_screen(out.picture[1], exposure));
  }
  return out;
}

/// A scene on the page: its row, pictures of its views, and the first view beside paths.
struct Shown {
  Row row;
  std::vector<PageFile> files;
};

Result<Shown> show_scene(const GalleryScene& scene, const std::filesystem::path& file,
                         Progress& progress) {
  Shown out;
  Row& row = out.row;
  row.scene = stem_of(scene);
  const std::clock_t start = std::clock();
  LUXEL_TRY(const pipeline::Bake bake, bake_by_default(file, progress));
  row.bake_seconds = processor_seconds_since(start);
  row.pages = int(bake.lightmaps.size());
  row.width = bake.lightmaps[0].width, row.height = bake.lightmaps[0].height;
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(bake.scene));
  const auto draw = [&](const scene::Camera& camera, const display::DrawParams& size) {
    return draw_baked(bake, tracer, camera, bake.light.irradiance, size, progress);
  };

  // 1. The views, each with the exposure that luxel render gives it.
  for (size_t k = 0; k < views_of(scene).size(); ++k) {
    LUXEL_TRY(const image::Image drawn, draw(camera_of(scene.views[k]), kPicture));
    const image::Image seen = on_screen(drawn, pipeline::exposure_factor({}, drawn));
    out.files.push_back({picture_of(row.scene, k), jpeg_of(image::to_srgb8(seen))});
  }

  // 2. The first view by paths, as bright as that of the bake.
  if (scene.is_noisy) return out;
  const scene::Camera camera = camera_of(scene.views[0]);
  LUXEL_TRY(const image::Image drawn, draw(camera, kCompared));
  const float exposure = pipeline::exposure_factor({}, drawn);
  const std::clock_t begin = std::clock();
  LUXEL_TRY(const PathPictures traced,
            trace_pictures(bake.scene, tracer, camera, exposure, progress));
  row.path_seconds = processor_seconds_since(begin);
  const image::Image baked = on_screen(drawn, exposure);
  const image::Image paths = on_screen(mean_of(traced.picture[0], 1, traced.picture[1]), exposure);
  row.flip = mean_flip(baked, paths), row.flip_of_paths = traced.noise;
  row.paths = 2 * traced.paths;
  out.files.push_back(png_file(pair_of(row.scene), side_by_side(baked, paths)));
  return out;
}

constexpr std::string_view kColumns =
    "scene,pages,width,height,paths,bake_cpu_s,path_cpu_s,flip,flip_of_paths";

std::string csv_of(std::span<const Row> rows) {
  std::string text = std::string(kColumns) + "\n";
  for (const Row& r : rows)
    text += fmt::format("{},{},{},{},{},{:.1f},{:.1f},{:.4f},{:.4f}\n", r.scene, r.pages, r.width,
                        r.height, r.paths, r.bake_seconds, r.path_seconds, r.flip, r.flip_of_paths);
  return text;
}

/// The rows of an earlier gallery.csv; none where there is no such file.
std::vector<Row> rows_of(const std::filesystem::path& csv) {
  std::ifstream in(csv);
  std::string line;
  std::vector<Row> rows;
  std::getline(in, line);
  while (in && std::getline(in, line)) {
    Row r;
    char name[64];
    if (std::sscanf(line.c_str(), "%63[^,],%d,%d,%d,%d,%lf,%lf,%lf,%lf", name, &r.pages, &r.width,
                    &r.height, &r.paths, &r.bake_seconds, &r.path_seconds, &r.flip,
                    &r.flip_of_paths) == 9)
      r.scene = name, rows.push_back(r);
  }
  return rows;
}

void replace(const Row& row, std::vector<Row>& rows) {
  const auto found = std::ranges::find(rows, row.scene, &Row::scene);
  if (found == rows.end())
    rows.push_back(row);
  else
    *found = row;
}

/// The page of the rows, in the order of kGallery.
std::string page_of(std::span<const Row> rows) {
  std::vector<std::vector<std::string>> bakes, paths;
  std::string pictures, pairs;
  for (const GalleryScene& scene : kGallery) {
    const std::string name = stem_of(scene);
    const auto r = std::ranges::find(rows, name, &Row::scene);
    if (r == rows.end()) continue;
    const std::string size = fmt::format("{} x {}", r->width, r->height);
    bakes.push_back({name, r->pages == 1 ? size : fmt::format("{} pages of {}", r->pages, size),
                     fmt::format("{:.0f}", r->bake_seconds)});
    pictures += fmt::format("## {}\n\n{}\n\n", name, scene.credit);
    for (size_t k = 0; k < views_of(scene).size(); ++k)
      pictures += fmt::format("![{}](../images/gallery-{})\n\n", name, picture_of(name, k));
    if (scene.is_noisy) continue;
    paths.push_back({name, fmt::format("{}", r->paths), fmt::format("{:.0f}", r->path_seconds),
                     fmt::format("{:.3f}", r->flip), fmt::format("{:.3f}", r->flip_of_paths)});
    pairs +=
        fmt::format("![{}: baked, path traced](../images/gallery-{})\n\n", name, pair_of(name));
  }
  std::string page = fmt::format(
      "# Gallery\n\n"
      "`luxel bake SCENE -o OUT` baked these scenes, without any other option. The pictures show "
      "them lit by their lightmaps alone. A scene without light gets the daylight that luxel adds "
      "by default. The scenes are not part of luxel. `luxel bench gallery` wrote this page.\n\n"
      "{}"
      "## The bakes in numbers\n\n"
      "*Seconds* are processor seconds of the whole bake, on an {}.\n\n{}\n"
      "## Beside path tracing\n\n"
      "Left: the bake. Right: the same view by path tracing, with the same exposure. FLIP is the "
      "difference that a person sees who flips between both pictures, from 0 to 1 "
      "([compare.md](../method/compare.md)). *Noise of the paths* is FLIP between two pictures of "
      "half as many paths; the picture on the right is their mean. Scenes whose paths need too "
      "long to lose their noise are not here.\n\n{}\n{}",
      pictures, machine_name(), markdown_table({"scene", "lightmap", "seconds of the bake"}, bakes),
      markdown_table(
          {"scene", "paths per pixel", "seconds of the paths", "FLIP", "noise of the paths"},
          paths),
      pairs);
  page = wrapped(page);
  while (page.ends_with("\n\n")) page.pop_back();
  return page;
}

nlohmann::json json_of(std::span<const Row> rows) {
  nlohmann::json out = nlohmann::json::array();
  for (const Row& r : rows)
    out.push_back({{"scene", r.scene},
                   {"pages", r.pages},
                   {"width", r.width},
                   {"height", r.height},
                   {"paths", r.paths},
                   {"bake_cpu_seconds", r.bake_seconds},
                   {"path_cpu_seconds", r.path_seconds},
                   {"flip", r.flip},
                   {"flip_of_paths", r.flip_of_paths}});
  return out;
}

}  // namespace

Result<Page> make_gallery(const std::filesystem::path& shared, std::string_view only,
                          const std::filesystem::path& earlier, Progress& progress) {
  Page page;
  std::vector<Row> rows = only.empty() ? std::vector<Row>() : rows_of(earlier);
  for (const GalleryScene& scene : kGallery) {
    const std::string name = stem_of(scene);
    const auto file = shared / "scenes" / scene.file;
    if ((!only.empty() && only != name) || !std::filesystem::exists(file)) continue;
    LUXEL_TRY(Shown shown, show_scene(scene, file, progress));
    replace(shown.row, rows);
    std::ranges::move(shown.files, std::back_inserter(page.files));
  }
  if (page.files.empty())
    return fail(ErrorCode::bad_setting, "no scene of the gallery{} lies in {}",
                only.empty() ? "" : fmt::format(" with the name {}", only),
                (shared / "scenes").string());
  page.markdown = page_of(rows), page.csv = csv_of(rows), page.json = json_of(rows);
  return page;
}

}  // namespace luxel::bench
