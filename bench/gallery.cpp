// docs/guide/gallery.md: default bakes beside path-traced pictures.
#include "bench/gallery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <span>

#include "bench/baked_picture.h"
#include "bench/bench.h"
#include "bench/timing.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/settings/quality.h"
#include "luxel/reference/path_tracer.h"

namespace luxel::bench {
namespace {

constexpr int kPictureHeight = 240;
/// Two independent pictures get so many paths per pixel at a time, until FLIP between both, which
/// is noise of the paths, is no more than kNoise, or they have kMostPaths each.
constexpr int kPathsAtOnce = 192, kMostPaths = 2 * kPathsAtOnce;
constexpr double kNoise = 0.05;
/// Pixels between the two pictures.
constexpr int kGap = 4;

struct GalleryScene {
  std::string_view file;    ///< in shared/scenes
  std::string_view credit;  ///< what it is, whose, and its licence
};
constexpr std::array kGallery{
    GalleryScene{"cornell_box/cornell_box.glb", "The Cornell box. By this project, CC0."},
    GalleryScene{"living_room/living_room.glb",
                 "A living room that opens on a walled garden. By Godot Engine contributors, MIT."},
    GalleryScene{"living_room/living_room_lit_uv1.glb",
                 "The living room with a sun in the file and a lightmap layout of its own. By "
                 "Godot Engine contributors, MIT."},
    GalleryScene{"suzanne_room/room.glb",
                 "A room with two doorways and smooth objects. By Godot Engine contributors, MIT."},
    GalleryScene{"tile_game_room/tile_game_room6.glb",
                 "A room of a tile game. By Poimandres (react-three-lightmap), MIT."},
    GalleryScene{"tile_game_room/tile_game_room_lit_uv1.glb",
                 "The tile room with a lamp and a lightmap layout of its own. By Poimandres "
                 "(react-three-lightmap), MIT."},
    GalleryScene{"zdm2/zdm2.glb",
                 "zdm2, a level of Sauerbraten. By Chaseter, Suicizer, I.g( and friends (Godot "
                 "Engine demo projects), CC BY 4.0."},
    GalleryScene{"pandora/pandora.obj",
                 "pandora, a level of Sauerbraten (quadropolis.us/node/4125), CC BY. Its textures "
                 "are missing; colours stand for them."},
    GalleryScene{"kaykit_city/kaykit_city.glb",
                 "Streets of KayKit City Builder Bits. By Kay Lousberg, CC0."},
    GalleryScene{"japanese_bridge_garden/japanese_bridge_garden.glb",
                 "\"Japanese Bridge Garden\" by kristenlee, CC BY 4.0, turned to "
                 "metallic-roughness materials."},
    GalleryScene{"spot_teapot_bunny/spot.obj", "Spot. By Keenan Crane, public domain."},
    GalleryScene{"spot_teapot_bunny/teapot.obj", "The teapot. By Martin Newell."},
    GalleryScene{"spot_teapot_bunny/stanford-bunny.obj",
                 "The bunny. By the Stanford Computer Graphics Laboratory."}};

std::string stem_of(const GalleryScene& scene) {
  return std::filesystem::path(scene.file).stem().string();
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

/// One scene's bake and path-traced picture, as on a screen.
struct Pair {
  image::Image bake, paths;
  double flip = 0, flip_of_paths = 0;
  double bake_seconds = 0, path_seconds = 0;  ///< of processors
  int pages = 0, width = 0, height = 0;       ///< of the lightmap
  int paths_per_pixel = 0;
};

Result<pipeline::Bake> bake_by_default(const std::filesystem::path& file, Progress& progress) {
  pipeline::BakeSettings settings;
  settings.scene = file, settings.output = std::filesystem::temp_directory_path();
  settings.threads = thread_count();
  pipeline::set_quality(
      pipeline::Quality::good, [](std::string_view) { return false; }, settings);
  return pipeline::bake_scene(settings, progress);
}

/// Two pictures of the bake's view, by independent paths.
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

Result<PathPictures> trace_pictures(const pipeline::Bake& bake, const trace::RayTracer& tracer,
                                    const display::DrawParams& size, Progress& progress) {
  PathPictures out;
  for (uint64_t round = 0; out.paths == 0 || (out.noise > kNoise && out.paths < kMostPaths);
       ++round) {
    for (size_t k = 0; k < 2; ++k) {
      const reference::PathParams params{.samples = kPathsAtOnce, .seed = 1 + k + 2 * round};
      LUXEL_TRY(const reference::Picture more,
                reference::radiance_by_paths(bake.scene, tracer, bake.view.camera, size.width,
                                             size.height, params, progress));
      out.picture[k] = mean_of(out.picture[k], float(round), more.radiance);
    }
    out.paths += kPathsAtOnce;
    out.noise = mean_flip(on_screen(out.picture[0], bake.view.exposure),
                          on_screen(out.picture[1], bake.view.exposure));
  }
  return out;
}

Result<Pair> make_pair(const std::filesystem::path& file, Progress& progress) {
  Pair out;
  const std::clock_t start = std::clock();
  LUXEL_TRY(const pipeline::Bake bake, bake_by_default(file, progress));
  out.bake_seconds = processor_seconds_since(start);
  out.pages = int(bake.lightmaps.size());
  out.width = bake.lightmaps[0].width, out.height = bake.lightmaps[0].height;
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(bake.scene));
  display::DrawParams size;
  size.height = kPictureHeight, size.width = kPictureHeight * bake.view.width / bake.view.height;
  LUXEL_TRY(const image::Image drawn,
            draw_baked(bake, tracer, bake.light.irradiance, size, progress));
  const std::clock_t begin = std::clock();
  LUXEL_TRY(const PathPictures traced, trace_pictures(bake, tracer, size, progress));
  out.path_seconds = processor_seconds_since(begin);
  const float exposure = bake.view.exposure;
  out.bake = on_screen(drawn, exposure);
  out.paths = on_screen(mean_of(traced.picture[0], 1, traced.picture[1]), exposure);
  out.flip = mean_flip(out.bake, out.paths);
  out.flip_of_paths = traced.noise, out.paths_per_pixel = 2 * traced.paths;
  return out;
}

std::string heading() {
  return fmt::format(
      "# Gallery\n\n"
      "These scenes were baked by `luxel bake SCENE -o OUT`, without any other option. Left: the "
      "bake, drawn from its lightmap as preview.png is. Right: the same view by path tracing, "
      "with the same exposure. `luxel bench gallery` wrote this page.\n\n"
      "The scenes are not luxel's, and not part of it. A scene without light gets the daylight "
      "that luxel gives by default.\n\n"
      "FLIP is the difference that a person sees who flips between both pictures, from 0 to 1 "
      "([compare.md](../method/compare.md)). *Noise of the paths*: FLIP between two pictures of "
      "half as many paths, whose mean is the one on the right. *Seconds* are those of processors, "
      "on an {}.\n\n",
      machine_name());
}

/// A scene's row of gallery.csv.
struct Row {
  std::string scene;
  int pages = 0, width = 0, height = 0, paths = 0;  ///< paths per pixel
  double bake_seconds = 0, path_seconds = 0, flip = 0, flip_of_paths = 0;
};
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
  std::vector<std::vector<std::string>> cells;
  std::string pictures;
  for (const GalleryScene& scene : kGallery) {
    const std::string name = stem_of(scene);
    const auto r = std::ranges::find(rows, name, &Row::scene);
    if (r == rows.end()) continue;
    const std::string size = fmt::format("{} x {}", r->width, r->height);
    cells.push_back({fmt::format("[{}](#{})", name, name),
                     r->pages == 1 ? size : fmt::format("{} pages of {}", r->pages, size),
                     fmt::format("{:.0f}", r->bake_seconds), fmt::format("{}", r->paths),
                     fmt::format("{:.0f}", r->path_seconds), fmt::format("{:.3f}", r->flip),
                     fmt::format("{:.3f}", r->flip_of_paths)});
    pictures +=
        fmt::format("## {}\n\n{}\n\n![{}: baked, path traced](../images/gallery-{}.png)\n\n", name,
                    scene.credit, name, name);
  }
  std::string page =
      wrapped(heading() +
              markdown_table({"scene", "lightmap", "seconds of the bake", "paths per pixel",
                              "seconds of the paths", "FLIP", "noise of the paths"},
                             cells) +
              "\n" + pictures);
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
    LUXEL_TRY(const Pair pair, make_pair(file, progress));
    replace({name, pair.pages, pair.width, pair.height, pair.paths_per_pixel, pair.bake_seconds,
             pair.path_seconds, pair.flip, pair.flip_of_paths},
            rows);
    page.files.push_back(png_file(name + ".png", side_by_side(pair.bake, pair.paths)));
  }
  if (page.files.empty())
    return fail(ErrorCode::bad_setting, "no scene of the gallery{} lies in {}",
                only.empty() ? "" : fmt::format(" with the name {}", only),
                (shared / "scenes").string());
  page.markdown = page_of(rows), page.csv = csv_of(rows), page.json = json_of(rows);
  return page;
}

}  // namespace luxel::bench
