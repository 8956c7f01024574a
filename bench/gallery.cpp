// docs/guide/gallery.md: default bakes beside path-traced pictures.
#include "bench/gallery.h"

#include <fmt/format.h>

#include <ctime>

#include "bench/bench.h"
#include "luxel/base/parallel.h"
#include "luxel/display/draw.h"
#include "luxel/display/tone_map.h"
#include "luxel/image/flip.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/settings/quality.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::bench {
namespace {

constexpr int kPictureHeight = 240;
/// Two independent pictures of this many paths per pixel each: their difference says how much of
/// FLIP is noise of the paths.
constexpr int kPathsPerPicture = 192;
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

/// What the bake's own camera sees, drawn from the lightmap's texels as preview.png is.
Result<image::Image> draw_bake(const pipeline::Bake& bake, const trace::RayTracer& tracer,
                               const display::DrawParams& size, Progress& progress) {
  const transport::TexelField field{&bake.atlas, &bake.map, bake.light.irradiance};
  return display::draw(
      bake.scene, tracer, bake.view.camera,
      [&](const scene::SurfacePoint& p) { return transport::irradiance_at(field, p); }, size,
      progress);
}

/// Colours of the screen as light, as FLIP takes them.
image::Image on_screen(const image::Image& radiance, float exposure) {
  image::Image out(radiance.width, radiance.height, 3);
  for (int y = 0; y < radiance.height; ++y)
    for (int x = 0; x < radiance.width; ++x)
      out.set_rgb(x, y, display::compress(radiance.rgb(x, y) * exposure));
  return out;
}

double flip_between(const image::Image& a, const image::Image& b) {
  const image::Image map = image::flip(a, b);
  double sum = 0;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) sum += double(map.at(x, y)[0]);
  return sum / (double(map.width) * map.height);
}

image::Image mean_of(const image::Image& a, const image::Image& b) {
  image::Image out(a.width, a.height, 3);
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) out.set_rgb(x, y, (a.rgb(x, y) + b.rgb(x, y)) * 0.5f);
  return out;
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
};

double processor_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

Result<pipeline::Bake> bake_by_default(const std::filesystem::path& file, Progress& progress) {
  pipeline::BakeSettings settings;
  settings.scene = file, settings.output = std::filesystem::temp_directory_path();
  settings.threads = thread_count();
  pipeline::set_quality(
      pipeline::Quality::good, [](std::string_view) { return false; }, settings);
  return pipeline::bake_scene(settings, progress);
}

/// Two pictures of the bake's view, by independent paths.
Result<std::array<image::Image, 2>> trace_twice(const pipeline::Bake& bake,
                                                const trace::RayTracer& tracer,
                                                const display::DrawParams& size,
                                                Progress& progress) {
  std::array<image::Image, 2> out;
  for (size_t k = 0; k < out.size(); ++k) {
    const reference::PathParams params{.samples = kPathsPerPicture, .seed = 1 + k};
    LUXEL_TRY(reference::Picture picture,
              reference::radiance_by_paths(bake.scene, tracer, bake.view.camera, size.width,
                                           size.height, params, progress));
    out[k] = std::move(picture.radiance);
  }
  return out;
}

Result<Pair> make_pair(const std::filesystem::path& file, Progress& progress) {
  Pair out;
  // Processor seconds: those of a clock on the wall say how busy the machine is.
  const double start = processor_seconds();
  LUXEL_TRY(const pipeline::Bake bake, bake_by_default(file, progress));
  out.bake_seconds = processor_seconds() - start;
  out.pages = int(bake.lightmaps.size());
  out.width = bake.lightmaps[0].width, out.height = bake.lightmaps[0].height;
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(bake.scene));
  display::DrawParams size;
  size.height = kPictureHeight, size.width = kPictureHeight * bake.view.width / bake.view.height;
  LUXEL_TRY(const image::Image drawn, draw_bake(bake, tracer, size, progress));
  const double begin = processor_seconds();
  LUXEL_TRY(const auto halves, trace_twice(bake, tracer, size, progress));
  out.path_seconds = processor_seconds() - begin;
  const float exposure = bake.view.exposure;
  out.bake = on_screen(drawn, exposure);
  out.paths = on_screen(mean_of(halves[0], halves[1]), exposure);
  out.flip = flip_between(out.bake, out.paths);
  out.flip_of_paths = flip_between(on_screen(halves[0], exposure), on_screen(halves[1], exposure));
  return out;
}

std::string size_of(const Pair& pair) {
  const std::string size = fmt::format("{} x {}", pair.width, pair.height);
  return pair.pages == 1 ? size : fmt::format("{} pages of {}", pair.pages, size);
}

std::string heading() {
  return fmt::format(
      "# Gallery\n\n"
      "What `luxel bake SCENE -o OUT` gives, without any other option. Left: the bake, drawn from "
      "its lightmap as preview.png is. Right: the same view by path tracing, {} paths per pixel, "
      "with the same exposure. `luxel bench gallery` wrote this page.\n\n"
      "The scenes are not luxel's, and not part of it. A scene without light gets the daylight "
      "that luxel gives by default.\n\n"
      "FLIP is the difference that a person sees who flips between both pictures, from 0 to 1 "
      "([compare.md](../method/compare.md)). *Noise of the paths*: FLIP between two pictures of "
      "{} paths per pixel, whose mean is the one on the right. *Seconds* are those of processors, "
      "on an {}.\n\n",
      2 * kPathsPerPicture, kPathsPerPicture, machine_name());
}

/// Errors: those of the bake, with the scene's name.
Status add_scene(const GalleryScene& scene, const std::filesystem::path& file, Page& page,
                 std::vector<std::vector<std::string>>& rows, Progress& progress) {
  LUXEL_TRY(const Pair pair, make_pair(file, progress));
  const std::string name = stem_of(scene);
  rows.push_back({fmt::format("[{}](#{})", name, name), size_of(pair),
                  fmt::format("{:.0f}", pair.bake_seconds),
                  fmt::format("{:.0f}", pair.path_seconds), fmt::format("{:.3f}", pair.flip),
                  fmt::format("{:.3f}", pair.flip_of_paths)});
  page.files.push_back(png_file(name + ".png", side_by_side(pair.bake, pair.paths)));
  page.markdown +=
      fmt::format("## {}\n\n{}\n\n![{}: baked, path traced](../images/gallery-{}.png)\n\n", name,
                  scene.credit, name, name);
  page.json.push_back({{"scene", name},
                       {"pages", pair.pages},
                       {"width", pair.width},
                       {"height", pair.height},
                       {"bake_cpu_seconds", pair.bake_seconds},
                       {"path_cpu_seconds", pair.path_seconds},
                       {"flip", pair.flip},
                       {"flip_of_paths", pair.flip_of_paths}});
  return {};
}

}  // namespace

Result<Page> make_gallery(const std::filesystem::path& shared, std::string_view only,
                          Progress& progress) {
  Page page;
  page.json = nlohmann::json::array();
  std::vector<std::vector<std::string>> rows;
  for (const GalleryScene& scene : kGallery) {
    if (!only.empty() && only != stem_of(scene)) continue;
    const auto file = shared / "scenes" / scene.file;
    if (!std::filesystem::exists(file)) continue;
    LUXEL_TRY_STATUS(add_scene(scene, file, page, rows, progress));
  }
  if (rows.empty())
    return fail(ErrorCode::bad_setting, "no scene of the gallery{} lies in {}",
                only.empty() ? "" : fmt::format(" with the name {}", only),
                (shared / "scenes").string());
  page.markdown = wrapped(heading() +
                          markdown_table({"scene", "lightmap", "seconds of the bake",
                                          "seconds of the paths", "FLIP", "noise of the paths"},
                                         rows) +
                          "\n" + page.markdown);
  while (page.markdown.ends_with("\n\n")) page.markdown.pop_back();
  return page;
}

}  // namespace luxel::bench
