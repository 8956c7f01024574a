// The files in scenes/ are what the procedural scenes write, and read back as the same scenes.
#include <gtest/gtest.h>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/import/import.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/validate.h"
#include "tests/support.h"

namespace luxel {
namespace {

std::filesystem::path scenes_folder() { return std::filesystem::path(LUXEL_SOURCE_DIR) / "scenes"; }

TEST(Scenes, FilesAreUpToDate) {
  for (const auto& file : scene::procedural_scenes()) {
    const auto stored = read_file(scenes_folder() / file.file);
    ASSERT_TRUE(stored) << stored.error().message;
    EXPECT_EQ(*stored, *export_::scene_glb(file.scene))
        << file.file << ": run build/release/bin/luxel_write_scenes scenes";
  }
}

TEST(Scenes, FilesReadBackAsTheSameTrianglesAndLight) {
  for (const auto& file : scene::procedural_scenes()) {
    const auto imported = import::import_scene(scenes_folder() / file.file);
    ASSERT_TRUE(imported) << imported.error().message;
    EXPECT_TRUE(imported->warnings.empty()) << file.file << ": " << imported->warnings.front();
    const auto first = scene::first_triangles(file.scene);
    const auto first_read = scene::first_triangles(imported->scene);
    ASSERT_EQ(first, first_read) << file.file;
    EXPECT_EQ(file.scene.background, imported->scene.background) << file.file;
    for (uint32_t i = 0; i + 1 < first.size(); ++i)
      for (uint32_t t = 0; t < first[i + 1] - first[i]; ++t) {
        const scene::Triangle3 a = scene::world_triangle(file.scene, i, t);
        const scene::Triangle3 b = scene::world_triangle(imported->scene, i, t);
        EXPECT_EQ(a.a, b.a);
        EXPECT_EQ(a.b, b.b);
        EXPECT_EQ(a.c, b.c);
        const scene::SurfacePoint p{i, t, {0.3f, 0.3f}};
        EXPECT_EQ(scene::emission_at(file.scene, p), scene::emission_at(imported->scene, p));
        EXPECT_EQ(scene::reflectance_at(file.scene, p), scene::reflectance_at(imported->scene, p));
        EXPECT_EQ(scene::diffuse_transmittance_at(file.scene, p),
                  scene::diffuse_transmittance_at(imported->scene, p));
      }
  }
}

TEST(Scenes, FilesKeepTheHighlightsThatWereSet) {
  const auto imported = import::import_scene(scenes_folder() / "spheres-and-cube.glb");
  ASSERT_TRUE(imported) << imported.error().message;
  const scene::Scene expected = scene::spheres_and_cube();
  int glossy = 0;
  for (const scene::Material& a : expected.materials)
    for (const scene::Material& b : imported->scene.materials) {
      if (a.name != b.name || !(max_component(a.specular) > 0)) continue;
      ++glossy;
      EXPECT_NEAR(a.sharpness, b.sharpness, 1e-3f * a.sharpness);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(a.specular[k], b.specular[k], 1e-3f);
    }
  EXPECT_EQ(glossy, 2);
}

}  // namespace
}  // namespace luxel
