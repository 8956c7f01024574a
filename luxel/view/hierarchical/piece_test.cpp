// Steps of hierarchical radiosity one by one, against the solver as a whole.
#include "luxel/view/hierarchical/piece.h"

#include <gmock/gmock.h>

#include "luxel/scene/procedural.h"
#include "luxel/solve/hierarchical/represent.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/view/hierarchical/exact_picture.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;

/// The Cornell box, and what its solution needs. It stays where it is.
struct Box {
  scene::Scene scene = scene::cornell_box();
  std::optional<trace::RayTracer> tracer;
  pipeline::HierarchicalSettings settings;
  KnownRounds known;
  Progress progress;

  Box() { tracer.emplace(std::move(*trace::RayTracer::build(scene))); }
  SolvedScene solved() const { return {scene, *tracer}; }
  Piece stepped_from(const Piece& from, SolverStep step) {
    auto out = stepped(from, step, solved(), settings, known, progress);
    EXPECT_TRUE(out) << out.error().message;
    return out ? std::move(*out) : Piece();
  }
};

std::vector<Rgb> light_of(const h::Solution& s) {
  std::vector<Rgb> out;
  for (const h::ElementLight& l : s.light.elements) out.push_back(l.irradiance);
  return out;
}

TEST(Piece, StepByStepIsWhatTheSolverFinds) {
  Box box;
  const auto whole = h::solve(box.scene, *box.tracer, box.settings.solve, box.progress);
  ASSERT_TRUE(whole);
  Piece piece = box.stepped_from({}, SolverStep::begin);
  const size_t first = piece.solution().tree.elements.size();
  std::vector<size_t> leaves;
  for (int k = 0; k < 24 && !piece.is_settled; ++k) {
    const Piece before = piece;
    const std::vector<Rgb> light = light_of(before.solution());
    piece = box.stepped_from(before, SolverStep::links);
    EXPECT_EQ(light_of(before.solution()), light) << "a piece does not change";
    EXPECT_EQ(piece.number, before.number + 1);
    leaves.push_back(piece.solution().tree.elements.size());
  }
  EXPECT_TRUE(piece.is_settled);
  EXPECT_GT(leaves.size(), 1u);
  EXPECT_GT(piece.solution().tree.elements.size(), first);
  EXPECT_EQ(light_of(piece.solution()), light_of(*whole));
  EXPECT_EQ(piece.solution().links.count, whole->links.count);
  EXPECT_EQ(piece.solution().iterations, whole->iterations);
}

TEST(Piece, RoundsByInterpolantsDivideAndEndInALightMesh) {
  Box box;
  box.settings.mesh.discontinuities = false;
  Piece piece = box.stepped_from({}, SolverStep::begin);
  piece = box.stepped_from(piece, SolverStep::links);
  const size_t before = piece.solution().tree.elements.size();
  const Piece round = box.stepped_from(piece, SolverStep::interpolants);
  EXPECT_FALSE(round.is_settled);
  EXPECT_GT(round.solution().tree.elements.size(), before);
  EXPECT_EQ(round.solution().links.count, piece.solution().links.count) << "links stay";
  const Piece last = box.stepped_from(round, SolverStep::last);
  ASSERT_TRUE(last.cut);
  EXPECT_EQ(last.cut->interpolant.size(), last.cut->triangles.size());
  EXPECT_EQ(last.solution().tree.elements.size(), round.solution().tree.elements.size());
  EXPECT_NE(light_of(last.solution()), light_of(round.solution())) << "it has learned";
}

TEST(Piece, AStepThatIsStoppedLeavesNothing) {
  Box box;
  const Piece piece = box.stepped_from({}, SolverStep::begin);
  const std::vector<Rgb> light = light_of(piece.solution());
  Progress stopped_before;
  stopped_before.request_cancel();
  const auto step =
      stepped(piece, SolverStep::links, box.solved(), box.settings, box.known, stopped_before);
  ASSERT_FALSE(step);
  EXPECT_EQ(step.error().code, ErrorCode::cancelled);
  EXPECT_EQ(light_of(piece.solution()), light);
}

// A flat mesh covers what elements cover, each place with the light of its element.
TEST(Piece, AFlatMeshHasTheAreaAndTheLightOfItsElements) {
  Box box;
  const Piece piece = box.stepped_from({}, SolverStep::begin);
  const h::Solution& s = piece.solution();
  const display::QuadraticMesh drawn = drawn_mesh(piece, *piece.flat, LightKind::flat, box.scene);
  double area = 0, light = 0;
  for (size_t t = 0; t < drawn.triangles.size(); ++t) {
    const auto& v = drawn.triangles[t];
    const Vec3 a = drawn.vertices[v[0]];
    const double own =
        0.5 * double(length(cross(drawn.vertices[v[1]] - a, drawn.vertices[v[2]] - a)));
    area += own, light += own * double(drawn.irradiance[t][5].y);
    for (size_t k = 0; k < 5; ++k) EXPECT_EQ(max_component(drawn.irradiance[t][k]), 0);
  }
  const h::Totals totals = h::totals_of(s);
  EXPECT_NEAR(area, totals.area_m2, 1e-4 * totals.area_m2);
  EXPECT_NEAR(light / area, double(totals.irradiance.y), 1e-3 * double(totals.irradiance.y));
}

// Gouraud has the exact light at corners, and is the mean of two corners between them.
TEST(Piece, GouraudIsLinearBetweenExactCorners) {
  Box box;
  Piece piece = box.stepped_from({}, SolverStep::begin);
  h::MeshParams params;
  params.discontinuities = false;
  auto made = h::make_light_mesh(piece.solution(), box.scene, *box.tracer, params, box.progress);
  ASSERT_TRUE(made);
  const h::LightMesh mesh = std::move(*made);
  const display::QuadraticMesh drawn = drawn_mesh(piece, mesh, LightKind::gouraud, box.scene);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const h::Interpolant &r = drawn.irradiance[t], &exact = mesh.interpolant[t];
    for (const auto& [u, v] : {std::pair{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}})
      EXPECT_NEAR(h::value_of(r, u, v).y, h::value_of(exact, u, v).y, 1e-3);
    EXPECT_NEAR(h::value_of(r, 0.5f, 0.5f).y,
                0.5f * (h::value_of(r, 1, 0).y + h::value_of(r, 0, 1).y), 1e-3);
  }
}

TEST(ExactPicture, ComesPartByPartAndIsTheLightAtPixels) {
  Box box;
  const Piece piece = box.stepped_from({}, SolverStep::begin);
  const ExactView view{box.scene.cameras[0], 24, 18};
  ExactPicture picture = begin_exact(piece, view);
  size_t parts = 0;
  for (; !is_whole(picture); ++parts) {
    const size_t before = picture.done;
    ASSERT_TRUE(add_exact(piece, box.solved(), 100, picture, box.progress));
    EXPECT_EQ(picture.done, std::min<size_t>(before + 100, 24 * 18));
    if (parts == 0) {
      EXPECT_NE(picture.pixels[16 * 24 + 16].face, h::kNone) << "on the coarsest grid";
      EXPECT_EQ(picture.pixels[17 * 24 + 17].face, h::kNone);
    }
  }
  EXPECT_EQ(parts, 5u);
  // A pixel in the middle of the back wall: the light at the place that its ray meets.
  const size_t pixel = 6 * 24 + 12;
  const trace::Ray ray = trace::CameraRays(view.camera, 24, 18).through(12.5f, 6.5f);
  std::array rays{ray};
  const trace::Hit hit = trace::visible_hits(box.scene, *box.tracer, rays).front();
  ASSERT_TRUE(hit.found());
  const DVec3 place = to_double(scene::world_position(box.scene, hit.point()));
  const uint32_t face = picture.pixels[pixel].face;
  ASSERT_NE(face, h::kNone);
  EXPECT_NEAR(piece.solution().faces.faces[face].plane.height(place), 0, 1e-4);
  const h::Receiver receiver{place, piece.solution().faces.faces[face].plane.normal,
                             piece.solution().faces.faces[face].plane.normal, face,
                             piece.solution().faces.faces[face].size_m};
  const std::array receivers{receiver};
  const auto light =
      h::irradiance_at(piece.solution(), box.scene, *box.tracer, receivers, {1e-3}, box.progress);
  ASSERT_TRUE(light);
  EXPECT_NEAR((*light)[0].y, picture.pixels[pixel].irradiance.y, 1e-3 * double((*light)[0].y));
}

}  // namespace
}  // namespace luxel::view
