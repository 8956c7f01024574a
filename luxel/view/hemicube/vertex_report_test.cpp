// One vertex's view, against factors in closed form.
#include "luxel/view/hemicube/vertex_report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/view/draw/surface_corners.h"
#include "luxel/view/hemicube/faces_picture.h"
#include "luxel/view/hemicube/mesh_test_support.h"

namespace luxel::view {
namespace {

using testing::mesh_in;
using testing::vertex_at;

/// F from a point to a parallel rectangle of 2a x 2b at the distance c, whose middle is right above
/// it: four times that of a quarter, a textbook formula.
double to_parallel(double a, double b, double c) {
  const double x = a / c, y = b / c, sx = std::sqrt(1 + x * x), sy = std::sqrt(1 + y * y);
  return 4 / (2 * M_PI) * (x / sx * std::atan(y / sx) + y / sy * std::atan(x / sy));
}

/// The inside of the unit cube, its floor cut so that a vertex lies in its middle; and a plate of
/// half its width in between, which looks down.
scene::Scene box_with_plate(bool has_plate) {
  scene::Scene out;
  scene::add_material(out, "gray", {0.5f, 0.5f, 0.5f});
  scene::Mesh box;
  const auto corner = [](float x, float y, float z) { return Vec3{x, y, z}; };
  for (const float x : {0.0f, 0.5f})
    for (const float z : {0.0f, 0.5f})
      scene::add_quad(box,
                      {corner(x, 0, z), corner(x, 0, z + 0.5f), corner(x + 0.5f, 0, z + 0.5f),
                       corner(x + 0.5f, 0, z)},
                      0);
  scene::add_quad(box, {corner(0, 1, 0), corner(1, 1, 0), corner(1, 1, 1), corner(0, 1, 1)}, 0);
  scene::add_quad(box, {corner(0, 0, 0), corner(1, 0, 0), corner(1, 1, 0), corner(0, 1, 0)}, 0);
  scene::add_quad(box, {corner(0, 0, 1), corner(0, 1, 1), corner(1, 1, 1), corner(1, 0, 1)}, 0);
  scene::add_quad(box, {corner(0, 0, 0), corner(0, 1, 0), corner(0, 1, 1), corner(0, 0, 1)}, 0);
  scene::add_quad(box, {corner(1, 0, 0), corner(1, 0, 1), corner(1, 1, 1), corner(1, 1, 0)}, 0);
  scene::place(out, std::move(box), {});
  if (!has_plate) return out;
  scene::Mesh plate;
  scene::add_quad(plate,
                  {corner(0.25f, 0.5f, 0.25f), corner(0.75f, 0.5f, 0.25f),
                   corner(0.75f, 0.5f, 0.75f), corner(0.25f, 0.5f, 0.75f)},
                  0);
  scene::place(out, std::move(plate), {});
  return out;
}

/// The sum of factors over triangles first to first + 1.
double of_quad(const std::vector<double>& factors, size_t first) {
  return factors[first] + factors[first + 1];
}

TEST(VertexReport, ExactFactorsAreThoseOfTheBook) {
  for (const bool has_plate : {false, true}) {
    const auto mesh = mesh_in(box_with_plate(has_plate));
    Progress progress;
    const auto exact = exact_factors(*mesh, vertex_at(*mesh, {0.5f, 0, 0.5f}), progress);
    ASSERT_TRUE(exact && *exact);
    const std::vector<double>& f = **exact;
    EXPECT_NEAR(std::accumulate(f.begin(), f.end(), 0.0), 1, 1e-5);
    // Behind the plate the ceiling is seen but for what the plate covers of it.
    const double plate = has_plate ? to_parallel(0.25, 0.25, 0.5) : 0;
    EXPECT_NEAR(of_quad(f, 8), to_parallel(0.5, 0.5, 1) - plate, 1e-5);
    if (has_plate) {
      EXPECT_NEAR(of_quad(f, 18), plate, 1e-5);
    }
    const double wall = (1 - to_parallel(0.5, 0.5, 1)) / 4;
    for (const size_t first : {10, 12, 14, 16}) EXPECT_NEAR(of_quad(f, first), wall, 1e-5);
  }
}

TEST(VertexReport, LargerHemicubesErrLess) {
  const auto mesh = mesh_in(box_with_plate(true));
  const uint32_t element = vertex_at(*mesh, {0.5f, 0, 0.5f});
  const std::vector<Rgb> light(mesh->receivers.size(), Rgb{2, 2, 2});
  Progress progress;
  double before = 1;
  for (const int size : {8, 32, 128, 512}) {
    const auto report = report_on(*mesh, light, element, size, progress);
    ASSERT_TRUE(report) << report.error().message;
    ASSERT_TRUE(report->exact);
    EXPECT_EQ(report->items.items.size(), 3u * size_t(size * size));
    EXPECT_NEAR(report->sum, 1, 1e-4f) << "a closed box";
    EXPECT_NEAR(report->exact->sum, 1, 1e-5);
    EXPECT_LT(report->exact->wrong, before * 0.6);
    before = report->exact->wrong;
    // All around reflects half of 2.
    EXPECT_NEAR(report->irradiance.x, 1, 1e-3f);
    EXPECT_EQ(report->direct.x, 0);
  }
  EXPECT_LT(before, 2e-3);
}

TEST(VertexReport, SaysWhatIsMissing) {
  // From a square below a smaller one that turns its back.
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::Mesh mesh;
  scene::add_quad(mesh, {Vec3{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}}, 0);
  scene::add_quad(mesh,
                  {Vec3{-0.5f, 1, -0.5f}, {-0.5f, 1, 0.5f}, {0.5f, 1, 0.5f}, {0.5f, 1, -0.5f}}, 0);
  scene::place(scene, std::move(mesh), {});
  const auto in = mesh_in(scene, 0.4f);
  Progress progress;
  const auto report = report_on(*in, std::vector<Rgb>(in->receivers.size()),
                                vertex_at(*in, {0, 0, 0}), 256, progress);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_NEAR(report->position.x, 0, 1e-6f);
  const double back = to_parallel(0.5, 0.5, 1);
  EXPECT_EQ(report->sum, 0);
  EXPECT_NEAR(report->back, back, 1e-3);
  EXPECT_NEAR(report->open, 1 - back, 1e-3);
  EXPECT_EQ(report->exact->sum, 0);
}

TEST(VertexReport, CountsFactorsByPowersOfTen) {
  const std::vector<float> row{0, 1.5e-7f, 2e-4f, 2.1e-4f, 0.2f, 1};
  const auto bins = histogram_of_row(row);
  EXPECT_EQ(std::accumulate(bins.begin(), bins.end(), 0u), 5u);
  EXPECT_EQ(bins[0], 1u);
  EXPECT_EQ(bins[13], 2u) << "10^-3.75 = 1.8e-4";
  EXPECT_EQ(bins[kFactorBins - 1], 1u);
}

// Pixels that touch in the cross look nearly the same way: a degree and a half at 64 pixels.
TEST(FacesPicture, FacesHangTogether) {
  const auto mesh = mesh_in(box_with_plate(false));
  constexpr int kSize = 64;
  Progress progress;
  const auto report = report_on(*mesh, std::vector<Rgb>(mesh->receivers.size()),
                                vertex_at(*mesh, {0.5f, 0, 0.5f}), kSize, progress);
  ASSERT_TRUE(report);
  std::vector<int> pixel(4 * kSize * kSize, -1);
  for (size_t i = 0; i < report->items.items.size(); ++i) {
    const CrossPlace at = place_in_cross(kSize, i);
    ASSERT_TRUE(at.x >= 0 && at.y >= 0 && at.x < 2 * kSize && at.y < 2 * kSize);
    int& here = pixel[size_t(at.y * 2 * kSize + at.x)];
    EXPECT_EQ(here, -1) << "two pixels in one place";
    here = int(i);
  }
  int pairs = 0;
  for (int y = 0; y < 2 * kSize; ++y)
    for (int x = 0; x < 2 * kSize; ++x)
      for (const auto& [dx, dy] : {std::pair(1, 0), {0, 1}}) {
        if (x + dx >= 2 * kSize || y + dy >= 2 * kSize) continue;
        const int a = pixel[size_t(y * 2 * kSize + x)];
        const int b = pixel[size_t((y + dy) * 2 * kSize + x + dx)];
        if (a < 0 || b < 0) continue;
        ++pairs;
        const auto& d = report->items.direction;
        EXPECT_GT(dot(d[size_t(a)], d[size_t(b)]), std::cos(2.0f / kSize)) << x << " " << y;
      }
  // Inside of the five faces, and along four edges.
  EXPECT_EQ(pairs, 2 * kSize * (kSize - 1) +
                       4 * ((kSize - 1) * kSize / 2 + kSize * (kSize / 2 - 1)) + 4 * kSize);
}

TEST(FacesPicture, ShowsTrianglesInTheirColoursAndTheirLight) {
  const auto mesh = mesh_in(box_with_plate(true));
  const std::vector<Rgb> light(mesh->receivers.size(), Rgb{1, 1, 1} * (2 * kPi * 0.25f));
  Progress progress;
  const auto report = report_on(*mesh, light, vertex_at(*mesh, {0.5f, 0, 0.5f}), 16, progress);
  ASSERT_TRUE(report);
  // L = rho E / pi = 1/4, and 1/4 is 137 of 255 on a screen.
  const image::Image8 lit = faces_picture(*mesh, *report, {Faces::lit, 1, display::ToneMap::clamp});
  const image::Image8 items = faces_picture(*mesh, *report, {});
  ASSERT_EQ(lit.width, 32);
  for (size_t i = 0; i < report->items.items.size(); ++i) {
    const CrossPlace at = place_in_cross(16, i);
    const size_t byte = 4 * size_t(at.y * 32 + at.x);
    EXPECT_EQ(lit.data[byte], 137);
    const hemicube::Item& item = report->items.items[i];
    const uint32_t color = item_color(mesh->receivers.leaf_of_node[item.at.node]);
    EXPECT_EQ(items.data[byte], uint8_t(color));
    EXPECT_EQ(items.data[byte + 2], uint8_t(color >> 16));
    EXPECT_EQ(items.data[byte + 3], 255);
  }
  EXPECT_EQ(items.data[3], 0) << "around the cross";
  const image::Image8 whole = report_picture(*mesh, *report, {}, 128, "lux");
  EXPECT_GE(whole.width, 128);
  EXPECT_EQ(whole.data.size(), size_t(4 * whole.width * whole.height));
  EXPECT_EQ(whole.channels, 4);
}

}  // namespace
}  // namespace luxel::view
