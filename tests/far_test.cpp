// Scenes far from the origin of their file, through the whole program: their light is that of the
// same scene at the origin, and all that is asked for and told is in the world of the file.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "luxel/base/vec_double.h"
#include "luxel/export/glb_test_support.h"
#include "luxel/export/view_page.h"
#include "tests/black_room.h"
#include "tests/command.h"

namespace luxel::testing_support {
namespace {

/// A room of 3 x 2 x 4 m with a lamp. A node moves all of it.
std::string room_at(DVec3 place) {
  nlohmann::json file =
      nlohmann::json::parse(room_gltf({0, 0, 0}, {3, 2, 4}, 0.6f, {1.6f, 1.7f, 2.1f}, 1));
  file["scenes"][0]["nodes"] = {2};
  file["nodes"].push_back(
      {{"name", "root"}, {"translation", {place.x, place.y, place.z}}, {"children", {0, 1}}});
  return file.dump();
}

/// Multiples of 8 m, the power of two above the room's size: subtracting one is exact.
constexpr DVec3 kFar{1e6, -8e3, -5e6};

/// One command in a folder with room.gltf at 0, and in one with it far away.
class FarScenes : public ::testing::Test {
 protected:
  FarScenes() {
    for (const char* folder : {"near", "far"})
      std::filesystem::create_directory(scratch_.path / folder);
    scratch_.write("near/room.gltf", room_at({}));
    scratch_.write("far/room.gltf", room_at(kFar));
  }

  std::string in(const std::string& folder, const std::string& file) const {
    return (scratch_.path / folder / file).string();
  }
  CommandResult run(const std::string& folder, const std::string& command) const {
    CommandResult r =
        shell("cd " + (scratch_.path / folder).string() + " && " LUXEL_BINARY " " + command);
    EXPECT_EQ(r.code, 0) << command << ": " << r.err;
    return r;
  }
  /// `near` at 0, `far` in the far scene.
  std::pair<nlohmann::json, nlohmann::json> printed(const std::string& near,
                                                    const std::string& far) const {
    return {nlohmann::json::parse(run("near", near + " --json").out),
            nlohmann::json::parse(run("far", far + " --json").out)};
  }
  std::pair<nlohmann::json, nlohmann::json> written(const std::string& file) const {
    return {nlohmann::json::parse(slurp(in("near", file))),
            nlohmann::json::parse(slurp(in("far", file)))};
  }

  ScratchFolder scratch_;
};

/// To the bit: both are a float and an offset.
void expect_moved(const nlohmann::json& near, const nlohmann::json& far) {
  ASSERT_EQ(near.size(), 3u) << near;
  ASSERT_EQ(far.size(), 3u) << far;
  const double shift[] = {kFar.x, kFar.y, kFar.z};
  for (size_t k = 0; k < 3; ++k)
    EXPECT_EQ(far[k].get<double>(), near[k].get<double>() + shift[k]) << near << far;
}

/// The translation of a matrix of 16 numbers.
nlohmann::json place_of(const nlohmann::json& matrix) {
  return {matrix[12], matrix[13], matrix[14]};
}

TEST_F(FarScenes, HaveTheTexelsOfNearOnes) {
  for (const auto& [solver, options] : {std::pair("gather", "--samples 16"),
                                        {"reference", "--samples 16"},
                                        {"hemicube", "--max-elements 500"},
                                        {"matrix", "--patches 256"}}) {
    const std::string bake =
        fmt::format("bake room.gltf -o {} --solver {} --resolution 32 {}", solver, solver, options);
    run("near", bake), run("far", bake);
    for (const char* file : {"/lightmap.exr", "/preview.png"})
      EXPECT_TRUE(slurp(in("near", solver + std::string(file))) ==
                  slurp(in("far", solver + std::string(file))))
          << solver;
  }
}

// By multiples of a power of two the coordinates are the same to the bit, whatever the distance.
TEST_F(FarScenes, HaveTheTexelsOfNearOnesAtAnyDistance) {
  const std::string bake = "bake room.gltf -o out --resolution 32 --samples 16";
  run("near", bake);
  for (const double far : {1e4, 1e5, 1e6}) {
    scratch_.write("far/room.gltf", room_at({far, 0, far}));
    run("far", bake);
    EXPECT_TRUE(slurp(in("near", "out/lightmap.exr")) == slurp(in("far", "out/lightmap.exr")))
        << far;
  }
}

TEST_F(FarScenes, AreMeasuredInTheWorldOfTheFile) {
  const auto [near, far] = printed("info room.gltf", "info room.gltf");
  for (size_t k = 0; k < 2; ++k) expect_moved(near["bounds"][k], far["bounds"][k]);
  EXPECT_EQ(near["origin"], nlohmann::json({0.0, 0.0, 0.0}));
  EXPECT_EQ(far["origin"], nlohmann::json({kFar.x, kFar.y, kFar.z}));
  EXPECT_EQ(near["area_m2"], far["area_m2"]);
}

TEST_F(FarScenes, AreProbedInTheWorldOfTheFile) {
  for (const char* solver : {"paths", "hierarchical"}) {
    const auto probe = [&](const char* at) {
      return fmt::format("probe room.gltf --solver {} --max-error 0.05 --at {}", solver, at);
    };
    const auto [near, far] = printed(probe("1.5,0.25,2.5"), probe("1000001.5,-7999.75,-4999997.5"));
    expect_moved(near["position"], far["position"]);
    EXPECT_EQ(near["distance_m"], far["distance_m"]);
    if (std::string(solver) == "paths") {
      EXPECT_EQ(near["irradiance"], far["irradiance"]);
    }
  }
}

// Away from such multiples coordinates are rounded to other floats, near the origin all the same.
TEST_F(FarScenes, HaveTheLightOfNearOnesAtAnyPlace) {
  scratch_.write("far/room.gltf", room_at({12345.678, -9.9, 54321.1}));
  const auto [near, far] = printed("probe room.gltf --max-error 0.02 --at 1.5,0,2.5",
                                   "probe room.gltf --max-error 0.02 --at 12347.178,-9.9,54323.6");
  for (size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(near["irradiance"][c].get<double>(), far["irradiance"][c].get<double>(),
                2 * std::hypot(near["standard_error"][c].get<double>(),
                               far["standard_error"][c].get<double>()));
}

TEST_F(FarScenes, AreSeenFromTheWorldOfTheFile) {
  run("near",
      "render room.gltf --technique path --samples 4 --size 32x24 -o a.png "
      "--eye 1,1,3.5 --look-at 2,0.5,0");
  run("far",
      "render room.gltf --technique path --samples 4 --size 32x24 -o a.png "
      "--eye 1000001,-7999,-4999996.5 --look-at 1000002,-7999.5,-5000000");
  EXPECT_TRUE(slurp(in("near", "a.png")) == slurp(in("far", "a.png")));
}

TEST_F(FarScenes, LeaveBakesInTheWorldOfTheFile) {
  const std::string bake = "bake room.gltf -o out --resolution 32 --max-error 0.2 --probes 1";
  const bool has_page = bool(export_::check_view_page());
  for (const char* folder : {"near", "far"}) run(folder, bake + (has_page ? " --html" : ""));
  {
    const auto [near, far] = written("out/bake.json");
    expect_moved(near["error"]["worst"]["position"], far["error"]["worst"]["position"]);
    expect_moved(place_of(near["preview"]["camera"]["matrix"]),
                 place_of(far["preview"]["camera"]["matrix"]));
    EXPECT_FALSE(near.contains("origin"));
    EXPECT_EQ(far["origin"], nlohmann::json({kFar.x, kFar.y, kFar.z}));
  }
  {
    const auto [near, far] = written("out/probes.json");
    expect_moved(near["origin"], far["origin"]);
    ASSERT_GT(near["position"].size(), 8u);
    ASSERT_EQ(near["position"].size(), far["position"].size());
    for (size_t i = 0; i < near["position"].size(); ++i)
      expect_moved(near["position"][i], far["position"][i]);
  }
  {
    const auto nodes_of = [&](const char* folder) {
      const std::string glb = slurp(in(folder, "out/baked.glb"));
      return export_::parse(std::as_bytes(std::span(glb))).j["nodes"];
    };
    const nlohmann::json near = nodes_of("near"), far = nodes_of("far");
    ASSERT_EQ(far.size(), 2u);  // the room, the lamp
    expect_moved({0, 0, 0}, far[0]["translation"]);
    EXPECT_FALSE(near[0].contains("translation"));
    expect_moved(near[1]["translation"], far[1]["translation"]);
  }
  // Pages are drawn in single precision: theirs is the near scene.
  if (has_page) {
    EXPECT_TRUE(slurp(in("near", "out/view.html")) == slurp(in("far", "out/view.html")));
  }
  // The files of a bake are read with the scene that it is of.
  const std::string from = "probe room.gltf --from out --at ";
  const auto [near, far] = printed(from + "1.5,0.1,2.5", from + "1000001.5,-7999.9,-4999997.5");
  expect_moved(near["position"], far["position"]);
  EXPECT_EQ(near["irradiance"], far["irradiance"]);
  // And as a scene of its own.
  const auto [info_near, info_far] = printed("info out/baked.glb", "info out/baked.glb");
  for (size_t k = 0; k < 2; ++k) expect_moved(info_near["bounds"][k], info_far["bounds"][k]);
}

TEST_F(FarScenes, HaveWorkPlanesInTheWorldOfTheFile) {
  const std::string bake = "bake room.gltf -o out --resolution 32 --samples 16";
  run("near", bake), run("far", bake);
  const std::string lux = "lux room.gltf --from out --spacing 1 -o plane.csv --floor ";
  const auto [near, far] = printed(lux + "0", lux + "-8000");
  const nlohmann::json &a = near["floors"][0], &b = far["floors"][0];
  EXPECT_EQ(b["y"].get<double>(), a["y"].get<double>() + kFar.y);
  for (const char* place : {"minimum_at", "maximum_at"}) expect_moved(a[place], b[place]);
  for (size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(b["bounds_xz"][k][0].get<double>(), a["bounds_xz"][k][0].get<double>() + kFar.x);
    EXPECT_EQ(b["bounds_xz"][k][1].get<double>(), a["bounds_xz"][k][1].get<double>() + kFar.z);
  }
  EXPECT_EQ(a["mean"], b["mean"]);
  std::istringstream rows_near(slurp(in("near", "plane.csv"))),
      rows_far(slurp(in("far", "plane.csv")));
  std::string row_near, row_far;
  std::getline(rows_near, row_near), std::getline(rows_far, row_far);
  size_t rows = 0;
  for (; std::getline(rows_near, row_near) && std::getline(rows_far, row_far); ++rows) {
    std::array<double, 4> p{}, q{};
    std::sscanf(row_near.c_str(), "%lf,%lf,%lf,%lf", &p[0], &p[1], &p[2], &p[3]);
    std::sscanf(row_far.c_str(), "%lf,%lf,%lf,%lf", &q[0], &q[1], &q[2], &q[3]);
    // Printed with as few digits as tell the floats apart.
    EXPECT_NEAR(q[0], p[0] + kFar.x, 1e-6) << row_far;
    EXPECT_NEAR(q[1], p[1] + kFar.y, 1e-6) << row_far;
    EXPECT_NEAR(q[2], p[2] + kFar.z, 1e-6) << row_far;
    EXPECT_EQ(q[3], p[3]) << row_far;
  }
  EXPECT_EQ(rows, 12u);
}

// Two parallel unit squares lie 1 m apart, by the closed form [Howell, C-11]. The table's rays make
// the standard error sqrt(F (1 - F) / rays).
TEST_F(FarScenes, ExchangeWhatNearOnesDo) {
  constexpr double kFactor = 0.19982489569838738, kRays = 1 << 18;
  for (const double far : {1e4, 1e6}) {
    std::string obj;
    for (const double z : {0, 1})
      for (const auto& [x, y] : {std::pair(0.0, 0), {1.0, 0}, {1.0, 1}, {0.0, 1}})
        obj += fmt::format("v {:.1f} {} {:.1f}\n", far + 0.3 + x, y, far + 0.7 + z);
    scratch_.write("far/squares.obj", obj + "g a\nf 1 2 3 4\ng b\nf 8 7 6 5\n");
    run("far", "factors squares.obj --method rays -o f.csv");
    double there = 0, back = 0;
    const std::string table = slurp(in("far", "f.csv"));
    ASSERT_EQ(std::sscanf(table.c_str(), "surface,a,b\na,0,%lf\nb,%lf,0", &there, &back), 2)
        << table;
    const double error = std::sqrt(kFactor * (1 - kFactor) / kRays);
    EXPECT_NEAR(there, kFactor, 3 * error) << far;
    EXPECT_NEAR(back, kFactor, 3 * error) << far;
  }
}

}  // namespace
}  // namespace luxel::testing_support
