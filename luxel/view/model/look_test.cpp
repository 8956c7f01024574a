// Scales and values of a bake whose light and texels are known.
#include "luxel/view/model/look.h"

#include <gmock/gmock.h>

namespace luxel::view {
namespace {

using ::testing::HasSubstr;

/// A square of 2 m on all of a lightmap of 64 x 64 texels, and beside it one whose texels are four
/// times as dense and whose surface is a 400th of the whole.
struct TwoSquares {
  scene::Scene scene;
  pipeline::LightmapPages lightmaps;

  TwoSquares() {
    for (const float half : {1.0f, 0.05f}) {
      const float uv = half == 1 ? 1 : 0.2f;
      scene::Mesh mesh;
      mesh.positions = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
      mesh.uv1 = {{0, 0}, {uv, 0}, {uv, uv}, {0, uv}};
      mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
      mesh.triangle_material = {0, 0};
      scene.instances.push_back({});
      scene.instances.back().mesh = uint32_t(scene.meshes.size());
      scene.meshes.push_back(mesh);
    }
    scene.materials.push_back({});
    image::Image page(64, 64, 4);
    for (int i = 0; i < 64 * 64; ++i) {
      page.set_rgb(i % 64, i / 64, {float(i % 64), 2, 3});
      page.at(i % 64, i / 64)[3] = i % 64 < 32;  // what is not covered does not count
    }
    lightmaps.pictures.push_back(page);
    lightmaps.of_material = {0};
  }
};

TEST(Look, ScalesFitTheBake) {
  const TwoSquares squares;
  const Look look = look_at(squares.scene, squares.lightmaps);
  // Luminance up to 0.2126 * 31 + 1.65 = 8.2, of which 98 % lie below 10 and not below 7.5.
  EXPECT_EQ(look.irradiance, (ColorScale{0, 10, false}));
  EXPECT_EQ(look.chart_count, 2u);
  // 99 % of the surface have 32 texels per metre: a factor of four about that.
  EXPECT_FLOAT_EQ(look.density.low, 16);
  EXPECT_FLOAT_EQ(look.density.high, 64);
  EXPECT_TRUE(look.density.is_logarithmic);
}

TEST(Look, AFramesOwnScaleComesFirst) {
  const ColorScale of_bake{0, 10, false};
  EXPECT_EQ(scale_of({}, of_bake), of_bake);
  EXPECT_EQ(scale_of({2, 3, false}, of_bake), (ColorScale{2, 3, false}));
  const ColorScale logarithmic = scale_of({0, 0, true}, of_bake);
  EXPECT_FLOAT_EQ(logarithmic.low, 0.01f) << "no logarithm of 0";
  EXPECT_EQ(logarithmic.high, 10);
  EXPECT_EQ(scale_of({0, 0, false}, {16, 64, true}), (ColorScale{16, 64, true}));
}

TEST(Look, ValuesAreThoseOfThePoint) {
  const TwoSquares squares;
  Frame frame;
  // The middle of the square: between the texels of 31 and 32.
  const scene::SurfacePoint middle{0, 0, {0.5f, 0}};
  EXPECT_FALSE(value_at(frame, squares.scene, squares.lightmaps, middle));
  frame.show = Show::irradiance, frame.channel = Channel::red;
  const scene::Mesh& mesh = squares.scene.meshes[0];
  const auto& t = mesh.triangles[0];
  const Vec2 uv = interpolate(mesh.uv1[t[0]], mesh.uv1[t[1]], mesh.uv1[t[2]], middle.at);
  EXPECT_FLOAT_EQ(*value_at(frame, squares.scene, squares.lightmaps, middle), uv.x * 64 - 0.5f);
  frame.channel = Channel::blue;
  EXPECT_FLOAT_EQ(*value_at(frame, squares.scene, squares.lightmaps, middle), 3);
  frame.show = Show::density;
  EXPECT_FLOAT_EQ(*value_at(frame, squares.scene, squares.lightmaps, middle), 32);
  EXPECT_FLOAT_EQ(*value_at(frame, squares.scene, squares.lightmaps, {1, 0, {0.5f, 0}}), 128);
}

TEST(Look, ValuesOfABakeThatIsMadeAreThoseOfItsLight) {
  const TwoSquares squares;
  LitScene lit;
  lit.scene = squares.scene;
  for (scene::Mesh& mesh : lit.scene.meshes) lit.light_uv.push_back(std::move(mesh.uv1));
  lit.page_of_material = {1};
  const std::vector<image::HalfImage> pages{image::to_half(image::Image(1, 1, 4)),
                                            image::to_half(squares.lightmaps.pictures[0])};
  Frame frame;
  const scene::SurfacePoint middle{0, 0, {0.5f, 0}};
  for (const Show show : {Show::irradiance, Show::density, Show::charts})
    for (const Channel channel : {Channel::red, Channel::luminance}) {
      frame.show = show, frame.channel = channel;
      EXPECT_EQ(value_at(frame, lit, pages, middle),
                value_at(frame, squares.scene, squares.lightmaps, middle));
    }
  EXPECT_FALSE(value_at(frame, lit, pages, {0, 9, {}})) << "an older scene's";
  EXPECT_FALSE(value_at(frame, lit, pages, {7, 0, {}}));
}

TEST(Look, SaysWhatIsMissing) {
  const TwoSquares squares;
  Look look = look_at(squares.scene, squares.lightmaps);
  EXPECT_THAT(*missing_for(Show::texels, look, "box"), HasSubstr("box: there is no texels.png"));
  EXPECT_THAT(*missing_for(Show::error, look, "box"), HasSubstr("bake with --error-map"));
  EXPECT_THAT(*missing_for(Show::error, look, ""), HasSubstr("error.png is written by bakes with"));
  EXPECT_FALSE(missing_for(Show::charts, look, "box"));
  look.errors.resize(1);
  EXPECT_FALSE(missing_for(Show::error, look, "box"));
  Frame frame;
  EXPECT_FALSE(legend_of(frame, look));
  frame.show = Show::error;
  EXPECT_EQ(legend_of(frame, look)->scale, (ColorScale{0.001f, 0.1f, true}));
}

}  // namespace
}  // namespace luxel::view
