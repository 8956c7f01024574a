// Light that the members of a team work out together has the bits of one process's.
#include <gmock/gmock.h>

#include "luxel/base/team_test_support.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/gather/gather_test_support.h"

namespace luxel::gather {
namespace {

using ::testing::HasSubstr;

/// Everything that gather() returns.
void expect_same(const Gather& a, const Gather& b) {
  EXPECT_TRUE(a.irradiance == b.irradiance);
  EXPECT_TRUE(a.direct == b.direct);
  EXPECT_TRUE(a.direct_variance == b.direct_variance);
  EXPECT_TRUE(a.indirect_variance == b.indirect_variance);
  EXPECT_TRUE(a.met_back == b.met_back && a.enclosed == b.enclosed);
  EXPECT_TRUE(a.pooled_variance == b.pooled_variance);
  EXPECT_TRUE(a.errors == b.errors && a.gathered_errors == b.gathered_errors);
  EXPECT_TRUE(a.samples == b.samples);
  EXPECT_TRUE(a.layers == b.layers && a.layers_shared_out == b.layers_shared_out);
  EXPECT_TRUE(a.sources.punctual == b.sources.punctual && a.sources.others == b.sources.others);
  EXPECT_EQ(a.rays, b.rays);
  EXPECT_EQ(a.supersampled, b.supersampled);
  EXPECT_EQ(a.sweeps, b.sweeps);
  EXPECT_EQ(a.relative_error, b.relative_error);
  EXPECT_EQ(a.relative_noise, b.relative_noise);
  EXPECT_EQ(a.error_p95, b.error_p95);
}

struct TeamCase {
  std::string name;
  GatherParams params;
  bool layers = false, in_file = false;

  friend void PrintTo(const TeamCase& c, std::ostream* out) { *out << c.name; }
};

std::vector<TeamCase> cases() {
  GatherParams plain = with_samples(64, 8);
  plain.supersample = 8, plain.more_shadow_rays = plain.more_points = true;
  GatherParams p95 = with_samples(16, 4);
  p95.max_error = 0.1f, p95.supersample = 4;
  GatherParams rms = p95;
  rms.error_measure = ErrorMeasure::rms, rms.max_error = 0.02f;
  GatherParams two = plain;
  two.bounces = 2, two.tells_direct = true;
  return {{"Samples", plain},
          {"ErrorP95", p95},
          {"ErrorRms", rms, false, true},
          {"Layers", plain, true},
          {"TwoBounces", two}};
}

class GatherOfATeam : public WithFolder, public ::testing::WithParamInterface<TeamCase> {};

// Scenes with lamps, with light through leaves, and with much that is shadowed.
TEST_P(GatherOfATeam, HasTheBitsOfOneProcess) {
  const TeamCase& c = GetParam();
  int guided = 0;
  std::vector<scene::Scene> scenes{scene::cornell_box(), scene::foliage(), scene::office()};
  for (scene::Scene& scene : scenes) {
    SCOPED_TRACE(scene.name);
    const auto room = lay_out(std::move(scene), 48);
    const light::LightLayers layers =
        *light::light_layers(room->scene, room->lights, light::LayerMode::per_light);
    const light::LightLayers* told_apart = c.layers ? &layers : nullptr;
    const Gather alone = solve(*room, c.params, {}, told_apart);
    for (const uint32_t members : {1u, 2u, 3u, 8u}) {
      SCOPED_TRACE(members);
      std::vector<Gather> out(members);
      as_team(members, [&](Team& team) {
        GatherStores stores{.team = &team};
        if (c.in_file) stores.hit_memory_bytes = 0, stores.scratch_folder = folder_;
        out[team.rank()] = solve(*room, c.params, stores, told_apart);
      });
      for (const Gather& one : out) expect_same(one, alone);
    }
    for (size_t i = 0; i < alone.samples.size(); ++i) guided += alone.samples[i] % 16 != 0;
  }
  EXPECT_TRUE(guided > 0 || c.params.error_measure != ErrorMeasure::rms);
}

INSTANTIATE_TEST_SUITE_P(Gather, GatherOfATeam, ::testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

// Time is up when the first member's clock says so, whatever the others' say.
TEST(GatherOfATeam, EndsRoundsTogetherWhenTimeIsUp) {
  const auto room = lay_out(scene::cornell_box(), 48);
  for (const bool first_has_time : {false, true}) {
    SCOPED_TRACE(first_has_time);
    GatherParams params = with_samples(16, 4);
    params.max_samples = 32;
    std::vector<Gather> out(3);
    as_team(3, [&](Team& team) {
      GatherParams own = params;
      own.seconds = (team.rank() == 0) == first_has_time ? 1000.0 + team.rank() : 1e-3;
      out[team.rank()] = solve(*room, own, {.team = &team});
    });
    EXPECT_EQ(out[0].samples[0] > 16, first_has_time);
    for (const Gather& one : out) expect_same(one, out[0]);
  }
}

// One member cannot go on: all end, with its sentence.
TEST(GatherOfATeam, EndsForAllWhenOneGivesUp) {
  const auto room = lay_out(scene::cornell_box(), 48);
  std::vector<std::string> messages(3);
  as_team(3, [&](Team& team) {
    Progress progress;
    GatherStores stores{.team = &team};
    if (team.rank() == 2) stores.hit_memory_bytes = 0, stores.scratch_folder = "absent";
    const auto result = gather(scene_of(*room), nullptr, with_samples(64, 8), stores, {}, progress);
    ASSERT_FALSE(result);
    team.give_up(result.error());
    messages[team.rank()] = result.error().message;
  });
  EXPECT_THAT(messages[2], HasSubstr("absent"));
  EXPECT_EQ(messages[0], "process 2: " + messages[2]);
  EXPECT_EQ(messages[1], messages[0]);
}

}  // namespace
}  // namespace luxel::gather
