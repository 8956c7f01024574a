// A TEXCOORD_1 is kept where it can hold the light, and only there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "luxel/import/import.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/surface_points.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/irradiance_field.h"
#include "tests/courtyard.h"

namespace luxel::testing_support {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

pipeline::BakeSettings settings_at(int resolution, atlas::UvMode uv = atlas::UvMode::automatic) {
  pipeline::BakeSettings s;
  s.resolution = resolution, s.uv = uv;
  s.samples = 64, s.direct_samples = 4;
  return s;
}

pipeline::Bake bake(const scene::Scene& scene, const pipeline::BakeSettings& settings) {
  Progress progress;
  auto bake = pipeline::bake_scene(scene, settings, progress);
  EXPECT_TRUE(bake) << bake.error().message;
  return std::move(*bake);
}

/// Those of the warnings that are about TEXCOORD_1.
std::vector<std::string> about_uv1(const pipeline::Bake& bake) {
  std::vector<std::string> out = bake.warnings;
  std::erase_if(out, [](const std::string& text) { return text.find("TEXCOORD_1") == text.npos; });
  return out;
}

/// Light on one side of an instance, as a bake shows it and as paths find it.
struct Sides {
  double shown_error = 0;  ///< mean of |shown - true| over the mean of the true light
  double shown_over_true = 0;
};

/// `side` 1: the fronts of the scene as it was; -1: their backs.
Sides light_of(const pipeline::Bake& bake, const scene::Scene& scene, uint32_t instance,
               float side) {
  Progress progress;
  const auto points = scene::points_uniform_in_area(
      scene, 400, 7,
      [&](const scene::Scene&, const scene::SurfacePoint& p) { return p.instance == instance; });
  std::vector<Vec3> position, normal;
  for (const scene::SurfacePoint& p : points) {
    normal.push_back(scene::front_normal(scene, p.instance, p.triangle) * side);
    position.push_back(scene::off_surface(scene, p, normal.back()));
  }
  const auto before = trace::RayTracer::build(scene), after = trace::RayTracer::build(bake.scene);
  const auto paths = reference::irradiance_by_paths(scene, {position, normal, normal}, *before,
                                                    {.samples = 256}, progress);
  const transport::TexelField field{&bake.atlas, &bake.map, bake.light.irradiance};
  double difference = 0, shown = 0, truth = 0;
  for (size_t k = 0; k < points.size(); ++k) {
    // Places inside of what stands on others, such as the foot of an arch, are nobody's to see.
    if (paths->enclosed[k]) continue;
    const trace::Hit hit =
        after->closest_hit({position[k] + normal[k] * 1e-3f, 0, -normal[k], INFINITY});
    const double e = double(luminance(transport::irradiance_at(field, hit.point())));
    const double t = double(luminance(paths->irradiance[k]));
    difference += std::abs(e - t), shown += e, truth += t;
  }
  return {difference / truth, shown / truth};
}

// The file calls the visible sides of the arches their backs. Before, they were black.
TEST(KeptUv, ArchesWhoseFrontsLieInTheStoneAreUnwrapped) {
  const scene::Scene scene = courtyard();
  const pipeline::Bake b = bake(scene, settings_at(256));
  EXPECT_FALSE(b.atlas.kept);
  EXPECT_THAT(about_uv1(b), ElementsAre(HasSubstr("TEXCOORD_1 is not kept")));
  // Texels of 5 cm blur shadows and contacts on stones of 10 to 50 cm: a tenth of the light each.
  const Sides arches = light_of(b, scene, kArches, -1);
  EXPECT_LT(arches.shown_error, 0.2);
  EXPECT_NEAR(arches.shown_over_true, 1, 0.08);
  for (const float side : {-1.0f, 1.0f}) {
    const Sides canopy = light_of(b, scene, kCanopy, side);
    EXPECT_LT(canopy.shown_error, 0.2) << side;
    EXPECT_NEAR(canopy.shown_over_true, 1, 0.08) << side;
  }
}

// The wrong light that the test above guards against. --uv keep still gives it.
TEST(KeptUv, KeepShowsTheLightOfTheOtherSide) {
  const scene::Scene scene = courtyard();
  const pipeline::Bake b = bake(scene, settings_at(256, atlas::UvMode::keep));
  EXPECT_TRUE(b.atlas.kept);
  EXPECT_FALSE(b.wrong_in_uv1);
  EXPECT_THAT(about_uv1(b), ElementsAre(HasSubstr("get light on both sides")));
  EXPECT_LT(light_of(b, scene, kArches, -1).shown_over_true, 0.2);
}

// Solids wound as they should be, all called double-sided. The ground has an underside in other
// light, at which nobody looks.
TEST(KeptUv, SolidsOnAGroundKeepTheirs) {
  scene::Scene scene = courtyard({.arches_inside_out = false, .canopy = false});
  const pipeline::Bake b = bake(scene, settings_at(128));
  EXPECT_TRUE(b.atlas.kept);
  ASSERT_TRUE(b.wrong_in_uv1);
  EXPECT_GT(b.wrong_in_uv1->all, 0.05);
  EXPECT_EQ(b.wrong_in_uv1->shown, 0);
  EXPECT_THAT(about_uv1(b), ElementsAre(HasSubstr("seen from behind")));
  scene.materials[0].double_sided = false;
  const pipeline::Bake one_sided = bake(scene, settings_at(128));
  EXPECT_TRUE(one_sided.atlas.kept);
  EXPECT_THAT(about_uv1(one_sided), IsEmpty());
  EXPECT_FALSE(one_sided.wrong_in_uv1);  // nothing asks the question
}

// One of the two kinds of wrong light is enough.
TEST(KeptUv, ASheetThatIsLitFromAboveIsUnwrapped) {
  const scene::Scene scene = courtyard({.arches_inside_out = false, .canopy = true});
  EXPECT_FALSE(bake(scene, settings_at(128)).atlas.kept);
}

/// A crate of 1 m in the middle of a floor of 4 x 4 m. Its TEXCOORD_1 is a layout, that of the
/// floor was never unwrapped.
scene::Scene floor_that_was_not_unwrapped() {
  scene::Scene scene;
  const uint32_t grey = scene::add_material(scene, "grey", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, grey);
  scene::Mesh crate;
  scene::add_box(crate, {-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, grey);
  scene::place(scene, std::move(crate));
  lay_out_uv1(scene);
  for (Vec2& uv : scene.meshes[0].uv1) uv = {};
  return scene;
}

Rgb light_on_floor(const pipeline::Bake& bake, float x, float z) {
  const auto tracer = trace::RayTracer::build(bake.scene);
  const trace::Hit hit = tracer->closest_hit({{x, 3, z}, 0, {0, -1, 0}, INFINITY});
  return transport::irradiance_at({&bake.atlas, &bake.map, bake.light.irradiance}, hit.point());
}

// The light is that of the default day, by long bakes: in the crate's shadow and beside it.
TEST(KeptUv, AFloorThatWasNotUnwrappedGetsItsShadow) {
  const scene::Scene scene = floor_that_was_not_unwrapped();
  const pipeline::Bake b = bake(scene, settings_at(128));
  EXPECT_FALSE(b.atlas.kept);
  EXPECT_THAT(about_uv1(b), ElementsAre(HasSubstr("TEXCOORD_1 is not kept: 2 triangles of")));
  const Rgb shadow = light_on_floor(b, -0.7f, -0.7f), sun = light_on_floor(b, 1.5f, 1.5f);
  const Rgb true_shadow{6530, 9950, 16695}, true_sun{79159, 73489, 68476};
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(shadow[int(c)] / true_shadow[int(c)], 1, 0.05) << c;
    EXPECT_NEAR(sun[int(c)] / true_sun[int(c)], 1, 0.02) << c;
  }
  const pipeline::Bake kept = bake(scene, settings_at(128, atlas::UvMode::keep));
  EXPECT_TRUE(kept.atlas.kept);
  EXPECT_THAT(about_uv1(kept), ElementsAre(HasSubstr("--uv keep: 2 triangles of")));
  EXPECT_EQ(light_on_floor(kept, -0.7f, -0.7f), light_on_floor(kept, 1.5f, 1.5f));
}

// Several pages are laid out anew in any case.
TEST(KeptUv, SaysThatPagesReplaceIt) {
  pipeline::BakeSettings settings = settings_at(64);
  settings.samples = 1, settings.pages.count = 2;
  EXPECT_THAT(about_uv1(bake(floor_that_was_not_unwrapped(), settings)),
              ElementsAre(HasSubstr("TEXCOORD_1 is not kept: it describes one page")));
}

TEST(KeptUv, ScenesThatCameLitKeepTheirs) {
  for (const char* file :
       {"scenes/living_room/living_room_lit_uv1.glb",
        "scenes/tile_game_room/tile_game_room_lit_uv1.glb", "scenes/cornell_box/cornell_box.glb"}) {
    LUXEL_NEEDS_SHARED(file);
    const auto imported = import::import_scene(shared_folder() / file);
    ASSERT_TRUE(imported) << imported.error().message;
    pipeline::BakeSettings settings = settings_at(128);
    settings.samples = 1;
    EXPECT_TRUE(bake(imported->scene, settings).atlas.kept) << file;
  }
}

}  // namespace
}  // namespace luxel::testing_support
