// Illuminance at points and on work planes, through the whole program, against what is known by
// hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/black_room.h"
#include "tests/command.h"
#include "tests/pictures.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

/// A photometric file as its text says: candela by vertical and horizontal angle [degrees].
struct Photometry {
  std::vector<double> v, h, candela;

  /// Bilinear between the angles. What the file leaves out is the mirror image of what it has.
  double at(double v_deg, double h_deg) const {
    while (h_deg < 0) h_deg += 360;
    if (h.front() == 0 && h.back() < 181 && h_deg > 180) h_deg = 360 - h_deg;
    if (h.front() == 0 && h.back() < 91 && h_deg > 90) h_deg = 180 - h_deg;
    if (h.front() > 89 && (h_deg < 90 || h_deg > 270))
      h_deg = h_deg < 90 ? 180 - h_deg : 540 - h_deg;
    if (h.size() == 1) h_deg = h.front();
    if (v_deg > v.back()) return 0;
    const auto [i, s] = place(v, v_deg);
    const auto [k, t] = place(h, h_deg);
    const auto value = [&](size_t row, size_t column) {
      return candela[std::min(row, h.size() - 1) * v.size() + std::min(column, v.size() - 1)];
    };
    return (1 - t) * ((1 - s) * value(k, i) + s * value(k, i + 1)) +
           t * ((1 - s) * value(k + 1, i) + s * value(k + 1, i + 1));
  }

 private:
  static std::pair<size_t, double> place(const std::vector<double>& angles, double angle) {
    for (size_t i = 0; i + 1 < angles.size(); ++i)
      if (angle <= angles[i + 1]) return {i, (angle - angles[i]) / (angles[i + 1] - angles[i])};
    return {angles.size() - 1, 0};
  }
};

/// Reads what luxel's own files have: TILT=NONE, type C, factors of 1.
Photometry photometry_of(const std::string& file) {
  const std::string text = slurp(file);
  std::istringstream in(text.substr(text.find("TILT=NONE") + 9));
  std::vector<double> head(13);
  for (double& value : head) in >> value;
  Photometry out;
  out.v.resize(size_t(head[3])), out.h.resize(size_t(head[4]));
  out.candela.resize(out.v.size() * out.h.size());
  for (auto* list : {&out.v, &out.h, &out.candela})
    for (double& value : *list) in >> value;
  EXPECT_TRUE(in) << file;
  return out;
}

struct PlaneRow {
  double x, y, z, e, error;
};
std::vector<PlaneRow> rows_of(const std::filesystem::path& csv) {
  std::istringstream in(slurp(csv));
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "x,y,z,E,standard_error,floor,room");
  std::vector<PlaneRow> out;
  while (std::getline(in, line)) {
    PlaneRow row{};
    EXPECT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf", &row.x, &row.y, &row.z, &row.e,
                          &row.error),
              5);
    out.push_back(row);
  }
  return out;
}

void bake_room(const std::string& scene, const std::filesystem::path& folder,
               const std::string& options) {
  const CommandResult r = luxel("bake " + scene + " -o " + folder.string() + " " + options);
  ASSERT_EQ(r.code, 0) << r.err;
}

class PointMethod : public ::testing::TestWithParam<const char*> {};

// Nothing reflects, so E = I(gamma, C) cos^3 gamma / h^2 at each point, h the lamp's height above
// the plane. The stated noise is 0; floats have 7 digits, of which the steepest profile, cos^24,
// loses two.
TEST_P(PointMethod, IsMetInABlackRoom) {
  const ScratchFolder s;
  const Vec3 lamp{0.1f, 3, -0.2f};
  const auto scene = s.write("room.gltf", room_gltf({-3, 0, -3}, {3, 3.2f, 3}, 0, lamp, 1));
  const std::string ies = scene_file("ies/") + GetParam();
  bake_room(scene.string(), s.path / "bake", "--resolution 16 --samples 4 --ies lamp=" + ies);
  const CommandResult r =
      luxel("lux " + scene.string() + " --from " + (s.path / "bake").string() +
            " --plane 0.85 --spacing 0.5 -o " + (s.path / "plane.csv").string() + " --json");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(nlohmann::json::parse(r.out)["unit"], "lux");
  const Photometry photometry = photometry_of(ies);
  const std::vector<PlaneRow> rows = rows_of(s.path / "plane.csv");
  ASSERT_EQ(rows.size(), 144u);
  for (const PlaneRow& row : rows) {
    const double dx = row.x - double(lamp.x), dz = row.z - double(lamp.z), h = 3 - 0.85;
    EXPECT_NEAR(row.y, 0.85, 1e-6);
    const double gamma = std::atan2(std::hypot(dx, dz), h);
    // The node's x is +X, its y, where the angle turns to, is -Z.
    const double turn = std::atan2(-dz, dx) * 180 / M_PI;
    const double e =
        photometry.at(gamma * 180 / M_PI, turn) * std::pow(std::cos(gamma), 3) / (h * h);
    EXPECT_NEAR(row.e, e, 1e-4 * e + 1e-4) << row.x << " " << row.z;
    EXPECT_EQ(row.error, 0);
  }
}
INSTANTIATE_TEST_SUITE_P(Files, PointMethod,
                         ::testing::Values("spot.ies", "batwing.ies", "wall-washer.ies"),
                         [](const auto& file) {
                           std::string name = file.param;
                           name.erase(name.find('.'));
                           std::erase(name, '-');
                           return name;
                         });

// A room of rho 0.7, 0.5, 0.2 with six lamps. The lumen method, with the utilisation factor of
// three evenly lit surfaces (docs/guide/architect.md), says 553 lux. Surfaces are not evenly lit:
// the lower walls get more and the upper less, which is a percent or two.
TEST(Lux, IsNearTheLumenMethod) {
  const ScratchFolder s;
  const std::string scene = scene_file("ies/room.gltf");
  bake_room(scene, s.path / "bake",
            "--resolution 128 --samples 128 --ies lamp=" + scene_file("ies/diffuse.ies"));
  const CommandResult r =
      luxel("lux " + scene + " --from " + (s.path / "bake").string() + " --json -o " +
            (s.path / "p.csv").string() + " -o " + (s.path / "p.png").string());
  ASSERT_EQ(r.code, 0) << r.err;
  const nlohmann::json report = nlohmann::json::parse(r.out);
  ASSERT_EQ(report["floors"].size(), 1u);
  const nlohmann::json floor = report["floors"][0];
  ASSERT_EQ(floor["rooms"].size(), 1u);
  EXPECT_NEAR(floor["mean"], 553, 0.03 * 553);
  EXPECT_LT(double(floor["standard_error_of_mean"]), 0.001 * 553);
  EXPECT_NEAR(double(floor["uniformity"]), double(floor["minimum"]) / double(floor["mean"]), 1e-9);
  // The summary agrees with the file.
  const std::vector<PlaneRow> rows = rows_of(s.path / "p.csv");
  double sum = 0, least = INFINITY;
  for (const PlaneRow& row : rows) sum += row.e, least = std::min(least, row.e);
  EXPECT_NEAR(sum / double(rows.size()), double(floor["mean"]), 1e-4 * 553);
  EXPECT_NEAR(least, double(floor["minimum"]), 1e-4 * 553);
  const auto plan = image::decode_ldr(*read_file(s.path / "p.png"), "p.png");
  ASSERT_TRUE(plan);
  EXPECT_GT(plan->width, 760);  // the plan and its legend
}

// In a furnace every plane, wherever it lies, gets e / (1 - rho): half from lamps, half from
// lightmaps. E of the lightmap itself tells how much that is.
TEST(Lux, OfAFurnaceIsThatOfItsWalls) {
  const ScratchFolder s;
  const std::string scene = scene_file("furnace-box.glb");
  bake_room(scene, s.path / "bake", "--resolution 32 --samples 256");
  const std::string from = " --from " + (s.path / "bake").string();
  const CommandResult r = luxel("lux " + scene + from + " --plane 0.4 --spacing 0.25 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  const nlohmann::json floor = nlohmann::json::parse(r.out)["floors"][0];
  const CommandResult p = luxel("probe " + scene + from + " --at 0.5,0,0.5 --json");
  ASSERT_EQ(p.code, 0) << p.err;
  const double wall = nlohmann::json::parse(p.out)["irradiance_interpolated"][1];
  EXPECT_NEAR(floor["mean"], wall, 0.003 * wall);
  EXPECT_GT(floor["uniformity"], 0.99);
  // The picture of irradiance has the same number in every pixel that shows a wall.
  const CommandResult drawn =
      luxel("render " + scene + from + " --technique irradiance --eye 0.5,0.5,0.9 --look-at " +
            "0.5,0.5,0 --size 24x24 -o " + (s.path / "e.exr").string());
  ASSERT_EQ(drawn.code, 0) << drawn.err;
  const image::Image e = exr_at(s.path / "e.exr");
  for (int x = 0; x < 24; ++x) EXPECT_NEAR(e.at(x, 12)[1], wall, 0.01 * wall);
}

/// A box as an OBJ group; `inwards`: a room.
std::string obj_box(const std::string& name, Vec3 low, Vec3 high, bool inwards, int& count) {
  std::string text = "o " + name + "\n";
  for (int i = 0; i < 8; ++i)
    text += fmt::format("v {} {} {}\n", i & 1 ? high.x : low.x, i & 2 ? high.y : low.y,
                        i & 4 ? high.z : low.z);
  const int quads[6][4] = {{0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2},
                           {1, 3, 7, 5}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& q : quads) {
    const int base = 8 * count + 1;
    text +=
        inwards
            ? fmt::format("f {} {} {} {}\n", q[3] + base, q[2] + base, q[1] + base, q[0] + base)
            : fmt::format("f {} {} {} {}\n", q[0] + base, q[1] + base, q[2] + base, q[3] + base);
  }
  return ++count, text;
}

/// Two storeys of 8.2 m by 4 m. Below are two rooms with a door of 2 m between them, a table top at
/// 0.75 m and a closed cupboard of 1 m by 1 m by 1.5 m.
std::string two_storeys() {
  int n = 0;
  std::string text = obj_box("below", {0, 0, 0}, {8.2f, 2.6f, 4}, true, n);
  text += obj_box("above", {0, 2.8f, 0}, {8.2f, 5.4f, 4}, true, n);
  text += obj_box("wall left", {4, 0, 0}, {4.2f, 2.6f, 1.5f}, false, n);
  text += obj_box("wall right", {4, 0, 2.4f}, {4.2f, 2.6f, 4}, false, n);
  text += obj_box("lintel", {4, 2, 1.5f}, {4.2f, 2.6f, 2.4f}, false, n);
  text += obj_box("table", {1, 0.7f, 1}, {2, 0.75f, 2}, false, n);
  return text + obj_box("cupboard", {6, 0, 0}, {7, 1.5f, 1}, false, n);
}

// Work planes lie over floors, not tables; rooms are parted at doors; no plane lies in solids.
TEST(Lux, FindsFloorsAndRooms) {
  const ScratchFolder s;
  const std::string scene = s.write("house.obj", two_storeys()).string();
  bake_room(scene, s.path / "bake", "--resolution 64 --samples 4 --quiet");
  const auto floors = [&](const std::string& options) {
    const CommandResult r = luxel("lux " + scene + " --from " + (s.path / "bake").string() +
                                  " --spacing 0.2 --samples 64 --json " + options);
    EXPECT_EQ(r.code, 0) << r.err;
    return nlohmann::json::parse(r.out)["floors"];
  };
  const nlohmann::json found = floors("");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0]["y"], 0, 1e-5);
  EXPECT_NEAR(found[1]["y"], 2.8, 1e-5);
  // 41 x 20 cells of 0.2 m. The wall is one column of 20, four or five of which are the door's; the
  // cupboard hides 25.
  ASSERT_GE(found[0]["rooms"].size(), 2u);
  EXPECT_EQ(found[0]["rooms"][0]["points"], 400);
  EXPECT_NEAR(double(found[0]["rooms"][0]["area_m2"]), 16, 0.01);
  EXPECT_EQ(int(found[0]["points"]) + int(found[0]["left_out"]["in_solids"]), 820);
  EXPECT_NEAR(double(found[0]["left_out"]["in_solids"]), 25 + 15, 1);
  EXPECT_EQ(found[1]["rooms"].size(), 1u);
  EXPECT_EQ(found[1]["points"], 820);
  // Half a metre from the walls and more: of 20 x 20 points 16 x 16.
  const nlohmann::json inner = floors("--floor 0 --boundary 0.5");
  ASSERT_EQ(inner.size(), 1u);
  EXPECT_EQ(inner[0]["rooms"][0]["points"], 256);
}

TEST(Lux, RefusesWhatCannotBe) {
  const ScratchFolder s;
  const std::string scene = scene_file("cornell-box-empty.glb"), bake_of = (s.path / "b").string();
  bake_room(scene, bake_of, "--resolution 16 --samples 4");
  for (const auto& [options, sentence] :
       {std::pair{"", "--plane 0.85: no surface"},
        {"--plane -1", "--plane -1 is not a height"},
        {"--plane 0.2 --spacing 0", "--spacing 0 is not a spacing"},
        {"--plane 0.2 -o plan.txt", "name it .csv"},
        {"--plane 0.2 --floor 7", "--floor 7: no surface"},
        {"--plane 0.2 --boundary 9", "no point of the work plane is left"},
        {"--plane 0.2 --spacing 1e-6", "give a larger one"}}) {
    const CommandResult r = luxel("lux " + scene + " --from " + bake_of + " " + options);
    EXPECT_EQ(r.code, 1) << options;
    EXPECT_THAT(r.err, HasSubstr(sentence)) << options;
  }
  const CommandResult other =
      luxel("lux " + scene_file("furnace-box.glb") + " --from " + bake_of + " --plane 0.2");
  EXPECT_THAT(other.err, HasSubstr("is not the scene that was baked"));
  EXPECT_EQ(luxel("lux " + scene).code, 2);
}

// Three ways to the light of one point: in closed form, by paths, and from a bake.
TEST(Probe, ThreeMethodsAgree) {
  const ScratchFolder s;
  const std::string scene = scene_file("cornell-box.glb");
  bake_room(scene, s.path / "bake", "--resolution 64 --samples 256");
  const auto probed = [&](const std::string& options) {
    const CommandResult r = luxel("probe " + scene + " --at 0.1,0.01,0.4 --json " + options);
    EXPECT_EQ(r.code, 0) << r.err;
    return nlohmann::json::parse(r.out);
  };
  const nlohmann::json exact = probed("--solver hierarchical"), paths = probed("");
  const nlohmann::json from = probed("--from " + (s.path / "bake").string());
  const double e = exact["illuminance"];
  // Closed forms of the direct light, 1 % of the indirect half by its elements.
  const double sigma = paths["illuminance_standard_error"];
  EXPECT_LE(sigma, 0.005 * e);
  EXPECT_NEAR(paths["illuminance"], e, 4 * sigma + 0.005 * e);
  // A bake of 64 texels is good to a percent or two.
  EXPECT_NEAR(from["illuminance"], e, 0.02 * e);
  EXPECT_EQ(paths["unit"], "lux");
  // Light of the sources adds up to E: all light comes from surfaces.
  double sum = 0, factors = 0;
  for (const nlohmann::json& source : paths["sources"])
    sum += double(source["irradiance"][1]), factors += double(source["form_factor"]);
  EXPECT_NEAR(sum, double(paths["irradiance"][1]), 0.03 * e);
  EXPECT_LE(factors, 1 + 1e-9);
}

// Under a uniform sky of radiance 1 a point in the air high above all gets pi, facing up. The same
// point by a bake, whose rays meet nothing.
TEST(Probe, InTheAir) {
  const ScratchFolder s;
  const std::string scene = scene_file("office.glb");
  const CommandResult r =
      luxel("probe " + scene + " --at 0,50,0 --in-air --background 1,1,1 --json --max-error 0.01");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NEAR(nlohmann::json::parse(r.out)["illuminance"], M_PI, 1e-3);
  EXPECT_EQ(nlohmann::json::parse(r.out)["surface"], "");
}

// The time is over before the error is reached: a number, its error, and a sentence.
TEST(Probe, EndsInTime) {
  const CommandResult r = luxel("probe " + scene_file("cornell-box.glb") +
                                " --at 0.1,0.01,0.4 --max-error 1e-6 --time-budget 0.3");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("--time-budget 0.3 ran out at a standard error of"));
}

// The office takes 14 seconds of a core.
TEST(Probe, SolvesNoSceneForLongerThanItsTime) {
  const CommandResult r = luxel("probe " + scene_file("office.glb") +
                                " --at 0.3,0,0.2 --solver hierarchical --time-budget 0.2");
  EXPECT_EQ(r.code, 3) << r.err;
  EXPECT_THAT(r.err, HasSubstr("--time-budget 0.2 ran out in the stage"));
  EXPECT_THAT(r.err, HasSubstr("give more time or a larger --eps"));
  EXPECT_EQ(r.out, "");
}

}  // namespace
}  // namespace luxel::testing_support
