// Light on several pages, through the atlas, the repairs and baked.glb back to places of the world.
#include <gtest/gtest.h>

#include <map>

#include "luxel/atlas/pages.h"
#include "luxel/export/baked_glb.h"
#include "luxel/export/glb_test_support.h"
#include "luxel/image/codec.h"
#include "luxel/image/color.h"
#include "luxel/post/dilate.h"
#include "luxel/scene/procedural.h"

namespace luxel {
namespace {

using export_::ReadTriangle;

/// Linear in the place, all components between 1 and 2 in the box.
struct Ramp {
  Box3 box;
  Rgb at(Vec3 p) const {
    const Vec3 size = box.upper - box.lower;
    return {1 + (p.x - box.lower.x) / size.x, 1 + (p.y - box.lower.y) / size.y,
            1 + (p.z - box.lower.z) / size.z};
  }
};

struct Baked {
  atlas::Atlas atlas;
  std::vector<image::Image> lightmaps;
  std::vector<std::byte> glb;
  double texel_m = 0;
};

Baked bake_ramp(const scene::Scene& scene, const atlas::AtlasParams& params, const Ramp& ramp) {
  Baked out;
  Progress progress;
  out.atlas = *atlas::make_atlas(scene, params, progress);
  const atlas::TexelMap map = atlas::rasterise(scene, out.atlas);
  std::vector<Rgb> light;
  for (const atlas::Texel& texel : map.texels)
    light.push_back(ramp.at(scene::world_position(scene, texel.sample)));
  out.lightmaps = post::lightmap_pages(out.atlas, map, light);
  for (image::Image& page : out.lightmaps) post::dilate(page, 2);
  out.glb = *export_::baked_glb(scene, out.atlas, out.lightmaps);
  out.texel_m = 1 / atlas::atlas_stats(scene, out.atlas, map).texels_per_metre;
  return out;
}

/// The pictures in the file, decoded to light.
std::map<std::string, image::Image> pictures_of(const export_::Document& d) {
  std::map<std::string, image::Image> out;
  for (const auto& material : d.j["materials"]) {
    const auto& extension = material["extensions"]["MOZ_lightmap"];
    const auto& texture = d.j["textures"][extension["index"].get<size_t>()];
    const auto& picture = d.j["images"][texture["source"].get<size_t>()];
    const auto& view = d.j["bufferViews"][picture["bufferView"].get<size_t>()];
    const auto bytes = std::span(d.binary).subspan(view["byteOffset"].get<size_t>(),
                                                   view["byteLength"].get<size_t>());
    const image::Image8 decoded = *image::decode_ldr(bytes, "lightmap");
    image::Image light(decoded.width, decoded.height, 3);
    const size_t channels = size_t(decoded.channels);
    for (size_t i = 0; i < light.data.size(); ++i)
      light.data[i] = extension["intensity"].get<float>() *
                      image::linear_from_srgb(float(decoded.data[i / 3 * channels + i % 3]) / 255);
    out.emplace(material["extras"]["luxel"]["lightmap"].get<std::string>(), std::move(light));
  }
  return out;
}

/// As a graphics card looks it up: bilinear, clamped.
Rgb looked_up(const image::Image& picture, Vec2 uv) {
  const float x = uv.x * float(picture.width) - 0.5f, y = uv.y * float(picture.height) - 0.5f;
  const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
  Rgb sum{};
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const float wx = i ? x - float(x0) : 1 - (x - float(x0));
      const float wy = j ? y - float(y0) : 1 - (y - float(y0));
      sum += picture.rgb(std::clamp(x0 + i, 0, picture.width - 1),
                         std::clamp(y0 + j, 0, picture.height - 1)) *
             (wx * wy);
    }
  return sum;
}

// Bilinear lookups of a linear function give it back, up to where it was sampled: texels at a
// chart's rim are sampled up to 0.71 texel off their centre, or take the mean of neighbours two
// texels away at most; and up to the picture's steps, 2 / 220 where E is 2 (docs/format/bake.md).
// The ramp's slope is 1 over the box.
TEST(PagesGlb, EveryPlaceFindsItsLight) {
  const scene::Scene scene = scene::spheres_and_cube();
  const Box3 box = scene::world_bounds(scene);
  const Ramp ramp{box};
  const Vec3 size = box.upper - box.lower;
  const atlas::AtlasParams one{.uv = atlas::UvMode::unwrap, .resolution = 128};
  atlas::AtlasParams three = one, each = one;
  three.pages = 3;
  each.page_mode = atlas::PageMode::per_instance;
  for (const atlas::AtlasParams& params : {one, three, each}) {
    const Baked baked = bake_ramp(scene, params, ramp);
    const export_::Document document = export_::parse(baked.glb);
    const std::map<std::string, image::Image> pictures = pictures_of(document);
    EXPECT_EQ(pictures.size(), baked.lightmaps.size());
    const std::vector<ReadTriangle> triangles = export_::read_triangles(document);
    ASSERT_EQ(triangles.size(), baked.atlas.corners.size());
    double worst = 0;
    for (const ReadTriangle& t : triangles) {
      const std::string file = t.material["extras"]["luxel"]["lightmap"];
      const auto& c = t.corner;
      const Vec3 p = (c[0].position + c[1].position + c[2].position) / 3;
      const Vec2 uv = (c[0].uv1 + c[1].uv1 + c[2].uv1) * (1.0f / 3);
      const Rgb found = looked_up(pictures.at(file), uv), wanted = ramp.at(p);
      for (int k = 0; k < 3; ++k) {
        const double off = std::abs(double(found[k]) - double(wanted[k]));
        EXPECT_LE(off, 2.0 / 220 + 2 * baked.texel_m / double(size[k])) << file << " " << k;
        worst = std::max(worst, off);
      }
    }
    std::printf("%zu pages: at most %.4f off, a texel is %.4f m\n", pictures.size(), worst,
                baked.texel_m);
  }
}

TEST(PagesGlb, SaysWhichFileBelongsToWhichMaterial) {
  const scene::Scene scene = scene::spheres_and_cube();
  const Ramp ramp{scene::world_bounds(scene)};
  atlas::AtlasParams params{.uv = atlas::UvMode::unwrap, .resolution = 64, .pages = 2};
  const Baked baked = bake_ramp(scene, params, ramp);
  const auto files = export_::lightmap_files_of(baked.glb, "baked.glb");
  ASSERT_TRUE(files);
  const export_::Document document = export_::parse(baked.glb);
  ASSERT_EQ(files->size(), document.j["materials"].size());
  for (size_t m = 0; m < files->size(); ++m)
    EXPECT_EQ((*files)[m], document.j["materials"][m]["extras"]["luxel"]["lightmap"]);
  EXPECT_EQ(std::set<std::string>(files->begin(), files->end()),
            (std::set<std::string>{"lightmap-0.exr", "lightmap-1.exr"}));
  for (const size_t size : {size_t(0), size_t(7), size_t(20), size_t(50)})
    EXPECT_FALSE(export_::lightmap_files_of(std::span(baked.glb).first(size), "baked.glb"));
}

}  // namespace
}  // namespace luxel
