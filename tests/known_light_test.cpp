// Small files as other programs write them, against the light that is known of them: closed forms,
// and long runs of an independent path tracer (the README beside each file).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "luxel/import/import.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/scene/origin.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/irradiance_field.h"
#include "tests/support.h"

namespace luxel::testing_support {
namespace {

struct KnownLight {
  const char* file;
  DVec3 place;      ///< on a surface that faces up, in the world of the file
  Rgb irradiance;   ///< W/m^2, or lux under the default day
  float tolerance;  ///< relative: noise of 1,024 rays, and the width of a texel
};
void PrintTo(const KnownLight& p, std::ostream* out) { *out << p.file; }

class KnownLights : public ::testing::TestWithParam<KnownLight> {};

TEST_P(KnownLights, IsFoundByABake) {
  const std::string file = std::string("cases/") + GetParam().file;
  LUXEL_NEEDS_SHARED(file);
  const auto imported = import::import_scene(shared_folder() / file);
  ASSERT_TRUE(imported) << imported.error().message;

  pipeline::BakeSettings settings;
  settings.resolution = 64, settings.samples = 1024;
  Progress progress;
  const auto bake = pipeline::bake_scene(imported->scene, settings, progress);
  ASSERT_TRUE(bake) << bake.error().message;

  const Vec3 place = scene::in_scene(bake->scene, GetParam().place);
  const auto tracer = trace::RayTracer::build(bake->scene);
  const trace::Hit hit = tracer->closest_hit({place + Vec3{0, 0.01f, 0}, 0, {0, -1, 0}, INFINITY});
  const Rgb e =
      transport::irradiance_at({&bake->atlas, &bake->map, bake->light.irradiance}, hit.point());
  const Rgb known = GetParam().irradiance;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(e[c], known[c], GetParam().tolerance * known[c]) << c;
}

const DVec3 kHouse{512345.678, 87.5, -5403210.123};
/// pi L F under the middle of a square of side and height 1 m that gives off L = 2 [cohen1993].
constexpr float kUnderALamp = 1.50456f;

INSTANTIATE_TEST_SUITE_P(
    Shared, KnownLights,
    ::testing::Values(
        KnownLight{"color0-alpha-ignored/leaf.glb", {0, 0, 0}, {78250, 72800, 68120}, 0.01f},
        KnownLight{"far-from-origin-loses-walls/house.obj", {0, 0, 0}, {6493, 7269, 8926}, 0.05f},
        KnownLight{"far-from-origin-loses-walls/house-georeferenced.obj",
                   kHouse,
                   {6493, 7269, 8926},
                   0.05f},
        KnownLight{"light-flush-with-ceiling/flush.glb", {0, 0, 0}, {102, 102, 102}, 0.03f},
        KnownLight{"uv1-collapsed-is-kept/crate.glb", {-0.7, 0, -0.7}, {6530, 9950, 16695}, 0.05f},
        KnownLight{"uv1-collapsed-is-kept/crate.glb", {1.5, 0, 1.5}, {79159, 73489, 68476}, 0.02f},
        KnownLight{"truth/lamp-off1e5/scene.gltf",
                   {1e5, 0, 1e5},
                   {kUnderALamp, kUnderALamp, kUnderALamp},
                   0.01f},
        KnownLight{"truth/mask-half/scene.gltf", {0.1, 0, 0.2}, {4.577f, 4.577f, 4.577f}, 0.03f},
        KnownLight{"truth/room-off0/scene.gltf", {1.5, 0, 2.5}, {0.7124f, 0.7124f, 0.7124f}, 0.02f},
        KnownLight{"truth/room-off1e4/scene.gltf",
                   {10001.5, 0, 10002.5},
                   {0.7124f, 0.7124f, 0.7124f},
                   0.02f}));

}  // namespace
}  // namespace luxel::testing_support
