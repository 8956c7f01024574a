#include "luxel/solve/hierarchical/solve.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/solve/hierarchical/hierarchical_test_support.h"
#include "luxel/viewfactor/point_form_factor.h"
#include "luxel/viewfactor/polygon_form_factor.h"
#include "tests/reference_data.h"

namespace luxel::hierarchical {
namespace {

using testing::leaf_count;
using testing::solved;

Rgb gray(double v) { return Rgb{1, 1, 1} * float(v); }

// [exact-solutions.md, section 1] Form factors in closed form: their tolerance is 1e-4, and far
// pairs, seen from Gauss's points, err by less. After k reflections of many errs as little.
TEST(HierarchicalSolve, FurnaceIsExactAtEveryLeaf) {
  for (const TextRow& row :
       testing_support::markdown_rows("reference/exact-solutions.md", "## 1 ", "rho")) {
    const double rho = std::stod(row[0]), e = std::stod(row[1]);
    const double b = std::stod(row[2]);
    for (const double eps : {1.0, 0.02}) {
      const auto s = solved(scene::furnace_box(gray(rho), gray(e / M_PI)), {.eps = eps * b});
      for (size_t k = 0; k < s->solution.tree.elements.size(); ++k)
        if (s->solution.tree.elements[k].is_leaf()) {
          EXPECT_NEAR(s->solution.light.elements[k].radiosity.x, b, 0.01 * b);
        }
      EXPECT_NEAR(absorbed_over_emitted(s->solution), 1, 1e-3);
    }
    for (const auto& [k, column] : {std::pair{1, 3}, {2, 4}, {5, 5}}) {
      const auto s = solved(scene::furnace_box(gray(rho), gray(e / M_PI)),
                            {.eps = std::nullopt, .bounces = k - 1});
      const double wanted = std::stod(row[size_t(column)]);
      EXPECT_NEAR(totals_of(s->solution).radiosity.x, wanted, 1e-3 * wanted) << k;
    }
  }
}

// A closed room absorbs what its lamp emits. The lamp is small and hangs beside the ceiling's other
// pieces: light differs by a hundred between neighbours.
TEST(HierarchicalSolve, ClosedRoomsAbsorbWhatTheyEmit) {
  for (const double eps : {0.1, 0.02}) {
    const auto box = solved(scene::radiosity_box(), {.eps = eps});
    EXPECT_NEAR(absorbed_over_emitted(box->solution), 1, 5 * eps * 0.02) << eps;
  }
}

// The box with a sphere and a torus of 3,872 facets, which are lit as clusters: a hundredth, as
// issue and page promise.
TEST(HierarchicalSolve, ClustersKeepEnergyWithinAHundredth) {
  const auto s = solved(scene::radiosity_box_with_shapes(), {.eps = 0.01});
  EXPECT_NEAR(absorbed_over_emitted(s->solution), 1, 0.01);
  EXPECT_LT(s->solution.links.count, 1'500'000u);  // all pairs would be 15,000,000
}

// Every pair of places is under one link: what an element sends arrives, and what all send to it is
// all that it sees.
TEST(HierarchicalSolve, LinksCoverEveryPairOnce) {
  const auto s = solved(scene::furnace_box(gray(0.5), gray(1), 2), {.eps = 0.02});
  const Solution& solution = s->solution;
  std::vector<double> seen(solution.tree.elements.size()), sent(seen.size());
  const size_t clusters = solution.tree.clusters.size();
  for (size_t e = 0; e < seen.size(); ++e)
    for (const Link& link : solution.links.of[solution.tree.id_of(e)]) {
      ASSERT_FALSE(solution.tree.is_cluster(link.source));
      const double area = solution.tree.elements[e].area_m2;
      seen[e] += area * double(link.factor),
          sent[link.source - clusters] += area * double(link.factor);
    }
  for (size_t e = seen.size(); e-- > 0;)
    if (const uint32_t parent = solution.tree.elements[e].parent; parent != kNone)
      seen[parent] += seen[e], sent[parent] += sent[e];
  for (size_t r = 0; r < solution.tree.first_root.back(); ++r) {
    EXPECT_NEAR(seen[r], solution.tree.elements[r].area_m2, 2e-4);
    EXPECT_NEAR(sent[r], solution.tree.elements[r].area_m2, 2e-4);
  }
}

// A smaller eps takes more links and comes nearer to the closed form's pairs.
TEST(HierarchicalSolve, LinksHaveTheFactorsOfTheirPairs) {
  const auto s = solved(scene::radiosity_box(), {.eps = 0.05});
  const Solution& solution = s->solution;
  size_t compared = 0;
  for (uint32_t id = uint32_t(solution.tree.clusters.size()); id < solution.tree.size(); ++id)
    for (const Link& link : solution.links.of[id]) {
      if (solution.tree.is_cluster(link.source)) continue;
      const double exact = viewfactor::polygon_form_factor(
          solution.tree.element(id).polygon(), solution.tree.element(link.source).polygon());
      EXPECT_NEAR(link.factor, exact, 2e-3 * exact + 1e-7);
      ++compared;
    }
  EXPECT_GT(compared, 500u);
}

// A link brings the function through the values that Gauss's points see, whatever the mean: on a
// floor beside a shining wall a corner at the wall gets many times as much as one far from it.
TEST(HierarchicalSolve, LinksBringWhatPointsSee) {
  scene::Scene scene;
  const uint32_t dark = scene::add_material(scene, "dark", gray(0));
  testing::add_polygon(scene, "floor", {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}, dark);
  testing::add_polygon(scene, "wall", {{-0.2, 0, 0}, {-0.2, 1, 0}, {-0.2, 1, 1}, {-0.2, 0, 1}},
                       dark);
  const auto s = solved(std::move(scene));
  const Exchange x = s->solution.exchange(*s->tracer);
  viewfactor::VisibilityScratch scratch;
  const Link link = make_link(x, x.tree.id_of(0), x.tree.id_of(1), nullptr, scratch);
  ASSERT_GT(link.factor, 0);
  const Element &floor = x.tree.elements[0], &wall = x.tree.elements[1];
  const double low = 0.5 - 0.5 / std::sqrt(3.0), high = 1 - low;
  std::array<double, 4> seen, brought;
  double mean = 0;
  for (size_t k = 0; k < 4; ++k) {
    const double u = k == 0 || k == 3 ? low : high, v = k < 2 ? low : high;
    seen[k] =
        viewfactor::point_to_polygon(linear_at(floor.corner, 4, u, v), {0, 1, 0}, wall.polygon());
    brought[k] = double(linear_at(link.to, 4, float(u), float(v)));
    mean += seen[k] / 4;
  }
  EXPECT_GT(*std::max_element(seen.begin(), seen.end()),
            2 * *std::min_element(seen.begin(), seen.end()));
  for (size_t k = 0; k < 4; ++k)
    EXPECT_NEAR(brought[k] / double(link.factor), seen[k] / mean, 1e-4) << k;
}

// Two squares of 1 m, 1 m apart, see a share of 0.1998 of each other [exact-solutions.md, section
// 2]; eight pairs of points come near that. Nothing arrives past a screen. At most all arrives that
// the source sends, which is B A, and counts four times.
TEST(HierarchicalSolve, GuessesComeNearTheFactorAndEndAtScreens) {
  scene::Scene scene;
  const uint32_t bright = scene::add_material(scene, "bright", {0, 0, 0}, gray(1 / M_PI));
  scene::add_rectangle(scene, {0, 1, 0, 1}, 0, true, bright);
  scene::add_rectangle(scene, {0, 1, 0, 1}, 1, false, bright);
  scene::Scene closed = scene;
  scene::add_rectangle(closed, {-2, 3, -2, 3}, 0.5f, true, bright);
  const auto open = solved(std::move(scene)), shut = solved(std::move(closed));
  const Exchange x = open->solution.exchange(*open->tracer);
  const Link guess = guess_link(x, x.tree.id_of(0), x.tree.id_of(1));
  const Light& light = open->solution.light;
  EXPECT_NEAR(irradiance_of(guess, x, light).x, 0.1998, 0.05);
  EXPECT_NEAR(error_of(guess, x.tree.id_of(0), x, light), 4 * 1 / x.unit_area_m2, 1e-5);
  const Exchange past = shut->solution.exchange(*shut->tracer);
  EXPECT_EQ(guess_link(past, past.tree.id_of(0), past.tree.id_of(1)).factor, 0);
}

// A furnace of 4 m with a clump of 216 boxes of 1 cm: B is e / (1 - rho) everywhere. Pairs of small
// faces exchange less than eps, and are guessed; the room and the clump in the mean have their
// light all the same. Divided down to faces, the scene takes 152,961 links.
TEST(HierarchicalSolve, SmallNeighboursAreGuessedAndKeepTheLight) {
  scene::Scene scene;
  const uint32_t glow = scene::add_material(scene, "glow", gray(0.5), gray(1 / M_PI));
  scene::Mesh room, clump;
  scene::add_box(room, {-2, -2, -2}, {2, 2, 2}, glow);
  for (auto& t : room.triangles) std::swap(t[1], t[2]);  // seen from inside
  for (int k = 0; k < 216; ++k) {
    const Vec3 at = Vec3{float(k % 6), float(k / 6 % 6), float(k / 36)} * 0.03f;
    scene::add_box(clump, at, at + Vec3{0.01f, 0.01f, 0.01f}, glow);
  }
  scene::place(scene, std::move(room)), scene::place(scene, std::move(clump));
  const auto s = solved(std::move(scene));
  const Solution& solution = s->solution;
  double light = 0, area = 0;
  for (size_t e = 0; e < solution.tree.first_root.back(); ++e) {
    const double b = double(solution.light.elements[e].radiosity.x);
    if (solution.tree.elements[e].area_m2 > 1) {
      EXPECT_NEAR(b, 2, 0.02);
    } else {
      light += b * solution.tree.elements[e].area_m2, area += solution.tree.elements[e].area_m2;
    }
  }
  EXPECT_NEAR(light / area, 2, 0.1);
  EXPECT_LT(solution.links.count, 130'000u);
}

TEST(HierarchicalSolve, HidesWhatABlockerHides) {
  scene::Scene scene;
  const uint32_t dark = scene::add_material(scene, "dark", {0, 0, 0});
  const uint32_t bright = scene::add_material(scene, "bright", {0, 0, 0}, gray(1 / M_PI));
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 0, true, dark);
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 2, false, bright);
  const double open = double(totals_of(solved(scene)->solution).irradiance.x);
  scene::Scene half = scene, closed = scene;
  scene::add_rectangle(closed, {-3, 3, -3, 3}, 1, true, dark);
  EXPECT_EQ(solved(closed)->solution.light.elements[0].irradiance.x, 0);
  // Half of all pairs: by symmetry a screen over x < 0 in the middle hides half of the light.
  scene::add_rectangle(half, {-3, 0, -3, 3}, 1, true, dark);
  const auto s = solved(half, {.eps = 0.002});
  double lit = 0;
  for (size_t r = 0; r < s->solution.tree.first_root.back(); ++r)
    if (s->solution.faces.faces[s->solution.tree.elements[r].face].material == dark &&
        s->solution.tree.elements[r].centre.y < 0.5)
      lit +=
          s->solution.tree.elements[r].area_m2 * double(s->solution.light.elements[r].irradiance.x);
  EXPECT_NEAR(lit, 0.5 * open * 8, 0.01 * open * 8);  // the mean of both faces was `open`
}

// A sheet with a fourth of it cut out, hung in the middle of a furnace's side: what it sends is
// three fourths of what its own matter would.
TEST(HierarchicalSolve, HolesOfMasksSendNothing) {
  scene::Scene scene;
  scene::Texture holes;
  holes.width = holes.height = 4;
  for (int k = 0; k < 16; ++k)
    holes.rgba.insert(holes.rgba.end(), {255, 255, 255, uint8_t(k % 4 == 3 ? 0 : 255)});
  scene.textures.push_back(std::move(holes));
  const uint32_t sheet = scene::add_material(scene, "sheet", gray(0.8f), gray(2));
  scene.materials[sheet].alpha_mode = scene::AlphaMode::mask;
  scene.materials[sheet].base_color_texture = {.texture = 0, .filter = scene::Filter::nearest};
  scene::Mesh mesh;
  scene::add_quad(mesh, {Vec3{0, 1, 0}, {0, 1, 1}, {1, 1, 1}, {1, 1, 0}}, sheet);
  for (const Vec3& p : mesh.positions) mesh.uv0.push_back({p.x, p.z});
  scene::place(scene, std::move(mesh));
  scene::add_rectangle(scene, {0, 1, 0, 1}, 0, true, scene::add_material(scene, "floor", gray(0)));
  const auto s = solved(std::move(scene), {.eps = 0.5});
  const uint32_t face = s->solution.faces.face_of_triangle[0];
  const ElementLight& l = s->solution.light.elements[s->solution.tree.first_root[face]];
  // 1,024 scattered places: the share that falls into four strips is known to some thousandths.
  EXPECT_NEAR(l.reflectance.x, 0.75 * 0.8, 0.005);
  EXPECT_NEAR(l.emission.x, 0.75 * 2 * M_PI, 0.05);
}

TEST(HierarchicalSolve, SameBitsForAnyNumberOfThreads) {
  std::vector<float> first;
  for (const int threads : {1, 2, 7}) {
    const ThreadLimit limit(threads);
    const auto s = solved(scene::cornell_box(), {.eps = 0.02});
    std::vector<float> light;
    for (const ElementLight& l : s->solution.light.elements) light.push_back(l.irradiance.x);
    if (first.empty()) first = light;
    EXPECT_EQ(light, first) << threads;
  }
}

// With eps 0 the least area and the most elements end the work.
TEST(HierarchicalSolve, AnEpsOfZeroEnds) {
  const auto s =
      solved(scene::cornell_box(),
             {.eps = 0.0, .min_area_m2 = 0.01, .max_elements = 3000, .max_links = 200000});
  EXPECT_LE(s->solution.tree.elements.size(), 3000u);
  EXPECT_LE(s->solution.links.count, 210000u);
  EXPECT_GT(s->solution.links.at_least_area, 0u);
  EXPECT_LT(leaf_count(s->solution.tree), 3000u);
}

// Less than a ten-thousandth of the mean light nobody gets, and is told so.
TEST(HierarchicalSolve, SaysWhatEpsItUsedInsteadOfZero) {
  const auto s = solved(scene::cornell_box(), {.eps = 0.0});
  const double mean = double(max_component(totals_of(s->solution).irradiance));
  EXPECT_NEAR(s->solution.eps, 1e-4 * mean, 0.1 * 1e-4 * mean);  // of the brightest channel
  ASSERT_EQ(s->solution.warnings.size(), 1u);
  EXPECT_TRUE(s->solution.warnings[0].starts_with("--eps 0 is below")) << s->solution.warnings[0];
  EXPECT_FALSE(s->solution.links.bounded);
}

TEST(HierarchicalSolve, StopsWhenAsked) {
  const scene::Scene scene = scene::cornell_box();
  const auto tracer = *trace::RayTracer::build(scene);
  Progress progress;
  progress.request_cancel();
  const auto s = solve(scene, tracer, {}, progress);
  ASSERT_FALSE(s);
  EXPECT_EQ(s.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace luxel::hierarchical
