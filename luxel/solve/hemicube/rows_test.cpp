#include "luxel/solve/hemicube/rows.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "luxel/base/vec_double.h"
#include "luxel/solve/hemicube/hemicube_test_support.h"
#include "luxel/viewfactor/point_form_factor.h"

namespace luxel::hemicube {
namespace {

using testing::mesh_of;
using testing::scene_of;
using testing::unit_cube;

/// A scene ready to be looked at.
struct Looked {
  scene::Scene scene;
  Mesh mesh;
  Receivers receivers;
  trace::RayTracer tracer;
  light::Surroundings around;

  Looked(scene::Scene s, ElementKind kind, float size)
      : scene(std::move(s)),
        mesh(mesh_of(scene, size)),
        receivers(make_receivers(scene, mesh, kind)),
        tracer(*trace::RayTracer::build(scene)),
        around(light::surroundings_of(scene)) {}

  Senders senders(bool emission_by_pixels = false) const {
    return {scene, tracer, mesh, receivers, around, emission_by_pixels};
  }

  std::vector<View> views(std::span<const Viewpoint> from, int resolution,
                          bool emission_by_pixels = false) const {
    std::vector<View> out(from.size());
    Progress progress;
    const auto done = look(
        senders(emission_by_pixels), from, {resolution},
        [&](size_t i, const View& view) -> Status {
          out[i] = view;
          return {};
        },
        progress);
    EXPECT_TRUE(done);
    return out;
  }
  std::vector<View> views(int resolution, bool emission_by_pixels = false) const {
    return views(viewpoints(receivers.elements), resolution, emission_by_pixels);
  }
};

double sum_of(const View& view) {
  double sum = 0;
  for (const float share : view.share) sum += double(share);
  return sum;
}

TEST(Look, SharesSumToOneInAClosedRoom) {
  for (const ElementKind kind : {ElementKind::vertex, ElementKind::triangle})
    for (const int resolution : {2, 6, 16, 64}) {
      const Looked room(scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1}), kind, 0.34f);
      for (const View& view : room.views(resolution)) {
        EXPECT_NEAR(sum_of(view), 1, 2e-6);
        EXPECT_TRUE(std::is_sorted(view.element.begin(), view.element.end()));
        EXPECT_EQ(view.back, 0);
        EXPECT_EQ(view.emitted, Rgb{});  // it is computed otherwise
      }
    }
}

// A cube that is seen from outside stands in a room, inside out: its backs are black.
TEST(Look, BacksOfOneSidedSurfacesHaveTheirShare) {
  for (const bool two_sided : {false, true}) {
    scene::Scene scene = scene::furnace_box({0.5f, 0.5f, 0.5f}, {});
    const uint32_t inside_out = scene::add_material(scene, "inside out", {0.5f, 0.5f, 0.5f});
    scene.materials[inside_out].double_sided = two_sided;
    scene::Mesh cube;
    const Box3 room = scene::world_bounds(scene);
    scene::add_box(cube, room.centre() + Vec3{0.2f, 0.2f, 0.2f},
                   room.centre() - Vec3{0.2f, 0.2f, 0.2f}, inside_out);
    for (auto& t : cube.triangles) ASSERT_EQ(t.size(), 3u);
    scene::place(scene, std::move(cube));
    const Looked looked(std::move(scene), ElementKind::triangle, 0.34f);
    int see_backs = 0, inside = 0;
    const std::vector<View> views = looked.views(32);
    for (size_t i = 0; i < views.size(); ++i) {
      const View& view = views[i];
      EXPECT_NEAR(sum_of(view) + double(view.back), 1, 2e-6);
      EXPECT_EQ(two_sided ? view.back : view.two_sided_back, 0);
      const bool of_cube = looked.mesh.nodes[looked.receivers.leaves[i]].instance == 1;
      see_backs += view.back + view.two_sided_back > 0;
      inside += of_cube && is_hidden(view);
    }
    EXPECT_GT(see_backs, 100);
    EXPECT_EQ(inside, 0);  // the fronts inside the cube see fronts alone
  }
}

// Elements inside a solid see its backs: those of a small cube in the wall of a larger one.
TEST(Look, FindsElementsInsideSolids) {
  scene::Scene scene = scene_of(unit_cube());
  scene::Mesh small;
  scene::add_box(small, {0.4f, 0.4f, 0.4f}, {0.6f, 0.6f, 0.6f}, 0);
  scene::place(scene, std::move(small));
  const Looked looked(std::move(scene), ElementKind::vertex, 0);
  const std::vector<View> views = looked.views(16);
  for (size_t v = 0; v < views.size(); ++v) {
    const bool of_small = looked.mesh.vertices[v].instance == 1;
    EXPECT_EQ(is_hidden(views[v]), of_small);
    EXPECT_NEAR(double(views[v].back), of_small ? 1 : 0, 2e-6);
  }
}

// Under a sky of radiance 1 over an open scene, what is not a surface is sky: E = pi of its share.
TEST(Look, TheSkyHasTheRest) {
  scene::Scene scene = scene::spheres_and_cube();
  scene.background = {1, 2, 0};
  const Looked looked(std::move(scene), ElementKind::triangle, 0);
  int see_sky = 0;
  for (const View& view : looked.views(16)) {
    const double sky = double(view.emitted.x) / M_PI;
    // The part below the element's own facet is black; a sphere's normals lean away from it.
    EXPECT_LE(sum_of(view) + double(view.back) + sky, 1 + 2e-6);
    EXPECT_GE(sum_of(view) + double(view.back) + sky, 0.9);
    EXPECT_NEAR(double(view.emitted.y), 2 * double(view.emitted.x), 1e-5);
    EXPECT_EQ(view.emitted.z, 0);
    see_sky += sky > 0;
  }
  EXPECT_GT(see_sky, 100);
}

// Emitters on all sides: E is pi times their radiance, exactly the sum of the shares.
TEST(Look, EmissionIsTakenFromPixelsWhenAsked) {
  const Looked room(scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 2, 3}), ElementKind::triangle, 0.5f);
  for (const View& view : room.views(8, true)) {
    EXPECT_NEAR(view.emitted.x, kPi, 1e-5f);
    EXPECT_NEAR(view.emitted.z, 3 * kPi, 3e-5f);
  }
}

/// Two unit squares; the elements of the first are asked what they see of the second.
struct Squares {
  const char* name;
  scene::Quad from, to;
};
const Squares kParallel{"parallel",
                        {Vec3{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}},
                        {Vec3{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}};
const Squares kPerpendicular{"perpendicular",
                             {Vec3{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}},
                             {Vec3{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}};

scene::Scene scene_of_squares(const Squares& squares) {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  for (const scene::Quad& quad : {squares.from, squares.to}) {
    scene::Mesh mesh;
    scene::add_quad(mesh, quad, 0);
    scene::place(scene, std::move(mesh));
  }
  return scene;
}

struct FactorErrors {
  double rms = 0, worst = 0;
};
/// Relative errors of F(element -> the other square) over the elements of the first square.
FactorErrors errors_at(const Squares& squares, ElementKind kind, float size, int resolution) {
  const Looked looked(scene_of_squares(squares), kind, size);
  std::vector<Viewpoint> from;
  const std::vector<Viewpoint> all = viewpoints(looked.receivers.elements);
  const auto instance_of = [&](uint32_t i) {
    return kind == ElementKind::vertex ? looked.mesh.vertices[i].instance
                                       : looked.mesh.nodes[looked.receivers.leaves[i]].instance;
  };
  for (uint32_t i = 0; i < all.size(); ++i)
    if (instance_of(i) == 0) from.push_back(all[i]);
  const std::vector<View> views = looked.views(from, resolution);
  FactorErrors out;
  for (size_t i = 0; i < views.size(); ++i) {
    double seen = 0;
    for (size_t k = 0; k < views[i].share.size(); ++k) {
      EXPECT_EQ(instance_of(views[i].element[k]), 1u);
      seen += double(views[i].share[k]);
    }
    const double exact = viewfactor::point_to_polygon(from[i].position, from[i].normal, squares.to);
    const double error = std::abs(seen / exact - 1);
    out.rms += error * error / double(views.size()), out.worst = std::max(out.worst, error);
  }
  out.rms = std::sqrt(out.rms);
  return out;
}

// A pixel at the border of what is seen is taken whole or not at all. There are 1/N as many of them
// as pixels, so the error falls at least like 1/N (with luck like N^-1.5).
TEST(SlowFactors, ErrorsFallLikeOneOverTheResolution) {
  for (const Squares& squares : {kParallel, kPerpendicular})
    for (const ElementKind kind : {ElementKind::vertex, ElementKind::triangle}) {
      SCOPED_TRACE(squares.name);
      double first = 0;
      for (const int resolution : {64, 128, 256, 512}) {
        const FactorErrors e = errors_at(squares, kind, 0.5f, resolution);
        if (first == 0) first = e.rms;
        EXPECT_LT(e.rms, 1.5 * first * 64 / resolution) << resolution;
        EXPECT_LT(e.worst, 0.05);
        if (resolution == 512) {
          EXPECT_LT(e.worst, 0.005);
        }
        std::printf("%s %s, N = %d: rms %.5f worst %.5f\n", squares.name,
                    kind == ElementKind::vertex ? "vertices" : "triangles", resolution, e.rms,
                    e.worst);
      }
    }
}

/// Reads one row back.
std::vector<double> dense(const RowTile<RowEntry>& tile, size_t row, float scale, size_t columns) {
  std::vector<double> out(columns);
  uint32_t column = 0;
  for (size_t k = row == 0 ? 0 : tile.end[row - 1]; k < tile.end[row]; ++k) {
    column += tile.entries[k].step;
    out[column] += double(tile.entries[k].weight) * double(scale);
  }
  return out;
}

TEST(AppendRow, KeepsTheSumAndEveryFactorToItsStep) {
  RandomStream random{2};
  RowTile<RowEntry> tile;
  for (size_t row = 0; row < 200; ++row) {
    View view;
    double sum = 0, largest = 0;
    for (uint32_t i = 0; i < 3000; ++i) {
      if (random.next() < 0.5f) continue;
      // Some rows of equals, others with factors over many powers of ten.
      const float share = row % 2 ? random.next() : std::pow(10.0f, -7 * random.next());
      view.element.push_back(i), view.share.push_back(share);
      sum += double(share), largest = std::max(largest, double(share));
    }
    const float scale = append_row(view, tile);
    ASSERT_EQ(tile.end.size(), row + 1);
    const std::vector<double> read = dense(tile, row, scale, 3000);
    double read_sum = 0, error = 0;
    for (const double f : read) read_sum += f;
    for (size_t k = 0; k < view.share.size(); ++k)
      error = std::max(error, std::abs(read[view.element[k]] - double(view.share[k])));
    EXPECT_NEAR(read_sum, sum, 1e-7 * sum);
    EXPECT_LE(error, 1.02 / 65535 * largest) << row;
  }
}

// Many elements that are each less than half a step: together they are not nothing.
TEST(AppendRow, KeepsTheSumOfWhatIsTooSmall) {
  View view;
  for (uint32_t i = 0; i < 40001; ++i) {
    view.element.push_back(i);
    view.share.push_back(i == 20000 ? 1.0f : 0.3f / 65535);
  }
  RowTile<RowEntry> tile;
  const float scale = append_row(view, tile);
  const std::vector<double> read = dense(tile, 0, scale, 40001);
  double low = 0, high = 0;
  for (size_t i = 0; i < 20000; ++i) low += read[i], high += read[i + 20001];
  EXPECT_NEAR(read[20000], 1, 1.02 / 65535);
  EXPECT_NEAR(low, 20000 * 0.3 / 65535, 2.0 / 65535);
  EXPECT_NEAR(high, 20000 * 0.3 / 65535, 2.0 / 65535);
}

TEST(AppendRow, ReachesColumnsFarApart) {
  View view;
  view.element = {3, 65538, 65538 + 65535, 400000, 400001, 10000000};
  view.share = {0.25f, 0.5f, 0.125f, 0.0625f, 0.03125f, 0.03125f};
  RowTile<RowEntry> tile;
  const std::vector<double> read = dense(tile, 0, append_row(view, tile), 10000001);
  for (size_t k = 0; k < view.element.size(); ++k)
    EXPECT_NEAR(read[view.element[k]], double(view.share[k]), 0.5 * 1.02 / 65535);
  double sum = 0;
  for (const double f : read) sum += f;
  EXPECT_NEAR(sum, 1, 1e-7);
}

TEST(AppendRow, OfNothingIsEmpty) {
  RowTile<RowEntry> tile;
  EXPECT_EQ(append_row({}, tile), 0);
  View zero;
  zero.element = {1, 2}, zero.share = {0, 0};
  EXPECT_EQ(append_row(zero, tile), 0);
  EXPECT_EQ(tile.end, (std::vector<uint32_t>{0, 0}));
  EXPECT_TRUE(tile.entries.empty());
}

// A sweep is a product of matrix and vector; the matrix is what the views say.
TEST(Sweep, IsTheSumOverTheViews) {
  const Looked room(scene::cornell_box(), ElementKind::vertex, 0.12f);
  Progress progress;
  const std::vector<Viewpoint> from = viewpoints(room.receivers.elements);
  const auto rows = make_rows(room.senders(), from, {{16}, UINT64_MAX, "."}, progress);
  ASSERT_TRUE(rows);
  RandomStream random{8};
  std::vector<Rgb> b(from.size()), source(from.size()), next(from.size());
  for (Rgb& v : b) v = {random.next(), random.next(), random.next()};
  for (Rgb& v : source) v = {random.next(), random.next(), random.next()};
  ASSERT_TRUE(sweep(*rows, source, b, next, progress));
  const std::vector<View> views = room.views(16);
  for (size_t i = 0; i < views.size(); ++i) {
    DVec3 sum = to_double(source[i]);
    for (size_t k = 0; k < views[i].share.size(); ++k)
      sum = sum + to_double(b[views[i].element[k]]) * double(views[i].share[k]);
    EXPECT_NEAR(double(next[i].x), sum.x, 2e-4);
    EXPECT_NEAR(double(next[i].z), sum.z, 2e-4);
    EXPECT_EQ(rows->hidden[i], is_hidden(views[i]));
  }
  progress.request_cancel();
  const Status cancelled = sweep(*rows, source, b, next, progress);
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().code, ErrorCode::cancelled);
  const auto none = make_rows(room.senders(), from, {{16}, UINT64_MAX, "."}, progress);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace luxel::hemicube
