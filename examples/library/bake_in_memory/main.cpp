// Bakes a scene that the program builds itself, and writes its lightmap and a picture.
//
//     bake_in_memory FOLDER
#include <cstdio>
#include <filesystem>

#include "luxel/base/file.h"
#include "luxel/base/shown_text.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/scene/shapes.h"

using namespace luxel;

/// A floor of 4 m x 4 m with a white block and a red wall on it, under a lamp of 1 m x 1 m.
static scene::Scene room() {
  scene::Scene scene;
  scene.name = "room";
  const uint32_t white = scene::add_material(scene, "white", {0.8f, 0.8f, 0.8f});
  const uint32_t red = scene::add_material(scene, "red", {0.8f, 0.1f, 0.1f});
  const uint32_t lamp =
      scene::add_material(scene, "lamp", {0, 0, 0}, {10, 9, 8});  // L [W/(sr m^2)]
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, white);
  scene::add_rectangle(scene, {-0.5f, 0.5f, -0.5f, 0.5f}, 3, false, lamp);
  scene::Mesh block, wall;
  scene::add_box(block, {-0.4f, 0, -0.4f}, {0.4f, 0.8f, 0.4f}, white);
  scene::add_quad(wall, {{{-2, 0, -2}, {-2, 0, 2}, {-2, 2, 2}, {-2, 2, -2}}}, red);
  scene::place(scene, block);
  scene::place(scene, wall);
  return scene;
}

static Status run(const std::filesystem::path& folder) {
  pipeline::BakeSettings settings;  // as luxel bake has them; docs/options.md
  settings.resolution = 64, settings.samples = 64;
  settings.output = folder;  // temporary files
  Progress progress;         // another thread may read it, or cancel
  LUXEL_TRY(const pipeline::Bake bake, pipeline::bake_scene(room(), settings, progress));
  for (const std::string& warning : bake.warnings) std::printf("%s\n", warning.c_str());

  // E [W/m^2] of each texel that lies on a surface; bake.map says where.
  double mean = 0;
  for (const Rgb e : bake.light.irradiance) mean += luminance(e);
  std::printf("%zu texels, mean %.3f W/m^2\n", bake.light.irradiance.size(),
              mean / double(bake.light.irradiance.size()));

  std::filesystem::create_directories(folder);
  LUXEL_TRY(const std::vector<std::byte> exr, image::encode_exr(bake.lightmaps.front()));
  LUXEL_TRY_STATUS(write_file_atomically(folder / "lightmap.exr", exr));
  return write_file_atomically(folder / "preview.png", image::encode_png(bake.preview));
}

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "give a folder for lightmap.exr and preview.png\n"), 2;
  const Status done = run(argv[1]);
  if (!done)
    return std::fprintf(stderr, "%s\n", luxel::short_message(done.error().message).c_str()), 1;
}
