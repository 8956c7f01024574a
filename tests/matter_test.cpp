// Sides, scattered light and unlit surfaces through the whole program and back from its files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/base/vec_double.h"
#include "luxel/display/lightmap_lookup.h"
#include "luxel/export/baked_glb.h"
#include "luxel/image/codec.h"
#include "luxel/import/import.h"
#include "luxel/scene/shapes.h"
#include "luxel/scene/sides.h"
#include "luxel/solve/matrix/lxr.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/viewfactor/rectangle_factor.h"
#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Results of a bake, read back.
struct Baked {
  scene::Scene scene;
  image::Image lightmap;
  nlohmann::json report;

  /// E where a ray from `eye` arrives, on the side that it meets.
  Rgb light_seen(Vec3 eye, Vec3 direction) const {
    const auto tracer = trace::RayTracer::build(scene);
    const trace::Hit hit = tracer->closest_hit({eye, 0, direction, INFINITY});
    EXPECT_TRUE(hit.found());
    EXPECT_FALSE(hit.back_face);
    return display::lightmap_at(scene, lightmap, hit.point());
  }
};

Baked bake(const scene::Scene& scene, const std::string& options) {
  const ScratchFolder s;
  Baked out;
  const auto glb = export_::scene_glb(scene);
  EXPECT_TRUE(glb && write_file_atomically(s.path / "scene.glb", *glb));
  const CommandResult r = luxel("bake " + (s.path / "scene.glb").string() + " -o " +
                                (s.path / "b").string() + " --json " + options);
  EXPECT_EQ(r.code, 0) << r.err;
  if (r.code != 0) return out;
  out.report = nlohmann::json::parse(r.out);
  out.scene = import::import_scene(s.path / "b" / "baked.glb")->scene;
  out.lightmap = *image::decode_exr(*read_file(s.path / "b" / "lightmap.exr"), "lightmap.exr");
  return out;
}

/// A double-sided plate of 2 x 2 m at height 0 under a sun of 3 W/m^2.
scene::Scene plate() {
  scene::Scene s;
  scene::add_material(s, "plate", {0.6f, 0.6f, 0.6f});
  s.materials[0].double_sided = true;
  scene::add_rectangle(s, {-1, 1, -1, 1}, 0, true, 0);
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.intensity = {3, 3, 3};
  s.lights.push_back(sun);
  return s;
}

constexpr Vec3 kAbove{0.3f, 1, -0.4f}, kBelow{0.3f, -1, -0.4f}, kUp{0, 1, 0}, kDown{0, -1, 0};

// The sun stands above: below there is no light at all, in every solver.
TEST(Sides, APlateIsDarkOnItsUnderside) {
  for (const char* solver :
       {"gather", "reference --samples 16", "hemicube --max-elements 500 --hemicube 16",
        "matrix --patches 300 --rays 64", "hierarchical"}) {
    const Baked b = bake(plate(), std::string("--resolution 64 --solver ") + solver);
    ASSERT_EQ(b.scene.meshes.size(), 1u) << solver;
    EXPECT_EQ(b.scene.meshes[0].triangles.size(), 4u);
    for (const uint32_t m : b.scene.meshes[0].triangle_material)
      EXPECT_FALSE(b.scene.materials[m].double_sided);
    for (const uint32_t other : b.scene.meshes[0].other_side) EXPECT_NE(other, scene::kNone);
    EXPECT_NEAR(b.light_seen(kAbove, kDown).x, 3, 0.01) << solver;
    EXPECT_NEAR(b.light_seen(kBelow, kUp).x, 0, 1e-5) << solver;
  }
}

// Under the plate arrives what the floor throws back: one reflection, from all of the floor but the
// plate's own shadow, E = rho 3 (F_floor - F_shadow). F of rectangles that are parallel to the
// plate and half a metre below a place which lies 0.3 and 0.4 m off their middle.
TEST(Sides, TheUndersideHasTheLightOfTheFloor) {
  scene::Scene s = plate();
  const uint32_t floor = scene::add_material(s, "floor", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(s, {-3, 3, -3, 3}, -0.5f, true, floor);
  const Baked b = bake(s, "--resolution 256 --samples 1024 --bounces 1");
  const auto factor = [](double half_side) {
    double f = 0;
    for (const double x : {half_side - 0.3, half_side + 0.3})
      for (const double y : {half_side - 0.4, half_side + 0.4}) {
        const double a = std::hypot(x, 0.5), c = std::hypot(y, 0.5);
        f += (x / a * std::atan(y / a) + y / c * std::atan(x / c)) / (2 * kPiDouble);
      }
    return f;
  };
  const double expected = 0.5 * 3 * (factor(3) - factor(1));
  // Texels of 3 cm blur the shadow's rim; 1024 rays.
  EXPECT_NEAR(b.light_seen(kBelow + Vec3{0, 0.6f, 0}, kUp).x, expected, 0.03 * expected);
  EXPECT_NEAR(b.light_seen(kAbove, kDown).x, 3, 0.01);
}

/// E on a black floor under a sky of 1, a metre below a black plate with these alphas.
double light_below(scene::AlphaMode mode, float (*alpha_at)(Vec3)) {
  scene::Scene s;
  scene::add_material(s, "plate", {});
  s.materials[0].double_sided = true, s.materials[0].alpha_mode = mode;
  scene::add_rectangle(s, {-1, 1, -1, 1}, 1, true, 0);
  for (const Vec3& p : s.meshes[0].positions) s.meshes[0].alphas.push_back(alpha_at(p));
  scene::add_rectangle(s, {-3, 3, -3, 3}, 0, true, scene::add_material(s, "floor", {}));
  s.background = {1, 1, 1};
  const Baked b = bake(s, "--resolution 128 --samples 1024");
  size_t plates = 0;
  for (const scene::Mesh& mesh : b.scene.meshes)
    for (size_t v = 0; v < mesh.alphas.size(); ++v, ++plates)
      EXPECT_EQ(mesh.alphas[v], alpha_at(mesh.positions[v])) << "in baked.glb";
  EXPECT_GE(plates, 4u);
  return double(b.light_seen({0.2f, 0.5f, 0.1f}, kDown).x);
}

// As if the plate were not there; half a plate, where a ramp from 0 to 1 is above 0.5; of a plate
// that half covers, half of the light is stopped, and the other half darkened by half.
TEST(VertexAlpha, CutsAndBlends) {
  const double whole = viewfactor::rectangle_factor(-1.2, 0.8, -1.1, 0.9, 1),
               half = viewfactor::rectangle_factor(-0.2, 0.8, -1.1, 0.9, 1);
  for (const scene::AlphaMode mode : {scene::AlphaMode::mask, scene::AlphaMode::blend})
    EXPECT_NEAR(light_below(mode, [](Vec3) { return 0.0f; }), kPiDouble, 1e-3);
  // Texels of 5 cm, 1024 rays.
  const double ramp = light_below(scene::AlphaMode::mask, [](Vec3 p) { return 0.5f + 0.5f * p.x; });
  EXPECT_NEAR(ramp, kPiDouble * (1 - half), 0.03 * kPiDouble);
  const double blended = light_below(scene::AlphaMode::blend, [](Vec3) { return 0.5f; });
  EXPECT_NEAR(blended, kPiDouble * (1 - 0.75 * whole), 0.03 * kPiDouble);
}

/// plate() over a floor, both with a TEXCOORD_1 that is valid.
scene::Scene plate_with_uv1() {
  scene::Scene s = plate();
  for (const Vec3& p : s.meshes[0].positions)
    s.meshes[0].uv1.push_back({0.2f * p.x + 0.25f, 0.2f * p.z + 0.5f});
  const uint32_t floor = scene::add_material(s, "floor", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(s, {-3, 3, -3, 3}, -1, true, floor);
  for (const Vec3& p : s.meshes[1].positions)
    s.meshes[1].uv1.push_back({0.06f * p.x + 0.75f, 0.06f * p.z + 0.5f});
  return s;
}

// With the file's own coordinates there is one place for both sides, and luxel says so.
TEST(Sides, OnePlaceForBothIsSaid) {
  const Baked b = bake(plate_with_uv1(), "--resolution 64 --samples 4 --uv keep");
  EXPECT_EQ(b.scene.meshes[0].triangles.size(), 2u);
  EXPECT_THAT(b.report["warnings"].dump(), HasSubstr("get light on both sides"));
  EXPECT_EQ(b.report["atlas"]["kept_uv1"], true);
  EXPECT_FALSE(b.report["atlas"].contains("wrong_sides_in_uv1"));
}

// One side of the plate is black and the other bright: by itself luxel does not keep them.
TEST(Sides, OnePlaceForBothIsNotKeptWhereTheyDiffer) {
  const Baked b = bake(plate_with_uv1(), "--resolution 64 --samples 4");
  EXPECT_EQ(b.scene.meshes[0].triangles.size(), 4u);
  EXPECT_THAT(b.report["warnings"].dump(), HasSubstr("TEXCOORD_1 is not kept"));
  EXPECT_EQ(b.report["atlas"]["kept_uv1"], false);
  // The plate has 4 of 40 m^2 and 0.16 of 0.2896 of TEXCOORD_1.
  EXPECT_NEAR(b.report["atlas"]["wrong_sides_in_uv1"]["all"], 0.5 * (0.1 + 0.16 / 0.2896), 0.01);
  EXPECT_NEAR(b.report["atlas"]["wrong_sides_in_uv1"]["shown"], 0.326, 0.02);
  EXPECT_LT(b.light_seen(kBelow * 0.9f, kUp).x, 1);
}

// The underside of a floor under which there is nothing is seen by nobody.
TEST(Sides, OnePlaceForBothIsKeptWhereNobodyLooks) {
  scene::Scene s = plate_with_uv1();
  s.meshes.pop_back(), s.instances.pop_back();
  const Baked b = bake(s, "--resolution 64 --samples 4");
  EXPECT_EQ(b.scene.meshes[0].triangles.size(), 2u);
  EXPECT_THAT(b.report["warnings"].dump(), HasSubstr("seen from behind, 100 % of it"));
  EXPECT_EQ(b.report["atlas"]["wrong_sides_in_uv1"]["shown"], 0);
}

// With several pages, or as many as it takes, luxel lays out anew and says why.
TEST(Sides, PagesHaveBothSides) {
  const Baked b = bake(plate_with_uv1(), "--resolution 64 --samples 4 --pages auto");
  EXPECT_EQ(b.scene.meshes[0].triangles.size(), 4u);
  EXPECT_THAT(b.report["warnings"].dump(),
              HasSubstr("TEXCOORD_1 is not kept: it describes one page"));
}

// A bake that is kept keeps its layout, and what was said of it.
TEST(Sides, AKeptBakeKnowsWhyItWasLaidOutAnew) {
  const ScratchFolder s;
  ASSERT_TRUE(write_file_atomically(s.path / "scene.glb", *export_::scene_glb(plate_with_uv1())));
  nlohmann::json reports[2];
  for (nlohmann::json& report : reports) {
    const CommandResult r = luxel("bake " + (s.path / "scene.glb").string() + " -o " +
                                  (s.path / "b").string() + " --json --keep --resolution 64");
    ASSERT_EQ(r.code, 0) << r.err;
    report = nlohmann::json::parse(r.out);
  }
  EXPECT_NE(reports[0]["cache"], reports[1]["cache"]);  // the second builds on the first
  EXPECT_EQ(reports[0]["atlas"], reports[1]["atlas"]);
  EXPECT_GT(reports[1]["atlas"]["wrong_sides_in_uv1"]["shown"], 0.2);
  EXPECT_EQ(reports[0]["warnings"], reports[1]["warnings"]);
}

// Lights of an .lxr file come later, from below as well.
TEST(Sides, TheRelighterHasTexelsOnBoth) {
  const ScratchFolder s;
  ASSERT_TRUE(write_file_atomically(s.path / "scene.glb", *export_::scene_glb(plate_with_uv1())));
  const auto places = [&](const std::string& uv) {
    const CommandResult r =
        luxel("relight " + (s.path / "scene.glb").string() + " -o " + (s.path / "a.lxr").string() +
              " --json --patches 50 --rays 64 --resolution 32 --uv " + uv);
    EXPECT_EQ(r.code, 0) << r.err;
    const auto lxr = matrix::read_lxr(s.path / "a.lxr");
    EXPECT_TRUE(lxr) << lxr.error().message;
    std::pair<size_t, size_t> up_down;
    for (const Vec3& n : lxr->target.geometric_normal) ++(n.y > 0 ? up_down.first : up_down.second);
    const auto warnings = nlohmann::json::parse(r.out)["warnings"].dump();
    EXPECT_THAT(warnings,
                HasSubstr(uv == "auto" ? "TEXCOORD_1 is not kept" : "get light on both sides"));
    return up_down;
  };
  const auto both = places("auto"), kept = places("keep");
  EXPECT_GT(both.second, 25u);  // a twelfth of the surface, in a map of 1024
  EXPECT_GT(kept.first, 25u);
  EXPECT_EQ(kept.second, 0u);
}

// A sheet that lets half of the light through, in green: the lightmap of the side away from the sun
// is black, yet the picture for viewers shows tau E = 0.5 (0, 1, 0) 3 over the base colour.
TEST(Scattering, ViewersGetTheLightThatComesThrough) {
  scene::Scene s = plate();
  s.materials[0].double_sided = false;  // what scatters has two sides in any case
  s.materials[0].diffuse_transmission = 0.5f;
  s.materials[0].diffuse_transmission_color = {0, 1, 0};
  const ScratchFolder folder;
  ASSERT_TRUE(write_file_atomically(folder.path / "s.glb", *export_::scene_glb(s)));
  const std::string out = (folder.path / "b").string();
  const CommandResult r = luxel("bake " + (folder.path / "s.glb").string() + " -o " + out +
                                " --resolution 64 --samples 16");
  ASSERT_EQ(r.code, 0) << r.err;
  const scene::Scene baked = import::import_scene(folder.path / "b" / "baked.glb")->scene;
  const image::Image lightmap =
      *image::decode_exr(*read_file(folder.path / "b" / "lightmap.exr"), "lightmap.exr");
  EXPECT_FLOAT_EQ(baked.materials.back().diffuse_transmission, 0.5f);
  const auto tracer = trace::RayTracer::build(baked);
  const trace::Hit hit = tracer->closest_hit({kBelow, 0, kUp, INFINITY});
  ASSERT_TRUE(hit.found());
  EXPECT_NEAR(display::lightmap_at(baked, lightmap, hit.point()).y, 0, 1e-5);
  // preview.png shows scattered light: from below the sheet is green. The camera looks up.
  const CommandResult shown = luxel("render " + (folder.path / "s.glb").string() + " --from " +
                                    out + " -o " + (folder.path / "p.exr").string() +
                                    " --size 16x16 --eye 0,-1,0.1 --look-at 0,0,0 --fov-deg 40");
  ASSERT_EQ(shown.code, 0) << shown.err;
  const image::Image picture = *image::decode_exr(*read_file(folder.path / "p.exr"), "p.exr");
  EXPECT_NEAR(picture.rgb(8, 8).y, 0.5f * 3 / kPi, 0.01f);
  EXPECT_NEAR(picture.rgb(8, 8).x, 0, 1e-5f);
  // The other solvers lose it, and say so.
  EXPECT_THAT(luxel("bake " + (folder.path / "s.glb").string() + " -o " + out +
                    " --resolution 64 --solver matrix --patches 50 --rays 16")
                  .err,
              HasSubstr("KHR_materials_diffuse_transmission"));
}

}  // namespace
}  // namespace luxel::testing_support
