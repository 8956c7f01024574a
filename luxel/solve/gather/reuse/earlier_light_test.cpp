// The light of an earlier bake, direct and of rays that were followed on, brought up to date.
#include "luxel/solve/gather/reuse/earlier_test_support.h"

namespace luxel::gather {
namespace {

/// Direct light that is known, with all of its lamps but `anew`.
void give_direct(const Gather& kept, Earlier& earlier) {
  earlier.direct = kept.kept_direct, earlier.levels = kept.kept_levels;
}

// Light of points has no noise: where it is looked at again, and where not, it is what it is from
// scratch. Only where the box's shadow was or is, rays go to the lamp.
TEST_F(EarlierGather, DirectLightIsFollowedUp) {
  const auto before = lay_out(open_room(), 48);
  const auto now = edited(*before, move_box);
  const Gather first = keeping(*before, some_params(), "before");
  const Gather scratch = keeping(*now, some_params(), "scratch");
  EXPECT_NE(first.direct, scratch.direct);
  const RecordFile rays = file("before");
  Earlier earlier = earlier_of(rays, *before, *now, first);
  give_direct(first, earlier);
  const Gather again = keeping(*now, some_params(), "again", &earlier);
  expect_same_light(again, scratch);
  EXPECT_GT(again.kept_direct.rays, 0u);
  EXPECT_LT(again.kept_direct.rays, scratch.kept_direct.rays / 2);
  EXPECT_EQ(again.rays - again.kept_direct.rays + again.rays_kept,
            scratch.rays - scratch.kept_direct.rays);

  // Elements that lie elsewhere are looked at again for themselves, also where nothing is said of
  // what is in the light's way.
  Earlier blind = earlier_of(rays, *before, *now, first);
  give_direct(first, blind);
  const std::vector<uint8_t> moved = blind.rays.moved;
  blind.rays.boxes = {};
  std::ranges::fill(blind.levels.level, uint8_t(2));
  std::ranges::fill(blind.levels.averaged, uint8_t(1));
  const Gather without_boxes = keeping(*now, some_params(), "without boxes", &blind);
  size_t differ = 0;
  for (size_t i = 0; i < moved.size(); ++i) {
    EXPECT_EQ(without_boxes.direct[i], (moved[i] ? scratch : first).direct[i]) << i;
    EXPECT_EQ(without_boxes.kept_levels.level[i], moved[i] ? 0 : 2) << "it is looked at anew";
    EXPECT_EQ(without_boxes.kept_levels.averaged[i], moved[i] ? 0 : 1) << "not over points";
    differ += moved[i] && !(first.direct[i] == scratch.direct[i]);
  }
  EXPECT_GT(differ, 20u);
}

/// Followed rays that stay, of all, with the box moved under a lamp.
struct Followed {
  uint64_t stay = 0, all = 0;
};
Followed followed_with_lamp_at(EarlierGather& test, Vec3 lamp) {
  scene::Scene scene = open_room();
  scene.lights[0].position = lamp;
  const auto before = lay_out(std::move(scene), 48);
  const auto now = edited(*before, move_box);
  const Gather first = test.keeping(*before, some_params(), "before");
  const Gather scratch = test.keeping(*now, some_params(), "scratch");
  const RecordFile rays = test.file("before");
  const auto again = [&](bool same_light, const std::string& name) {
    Earlier earlier = earlier_of(rays, *before, *now, first);
    give_direct(first, earlier);
    earlier.rays.same_light = same_light;
    return test.keeping(*now, some_params(), name, &earlier);
  };
  const Gather all_followed = again(false, "all"), some_followed = again(true, "some");
  expect_same_light(some_followed, scratch);
  const auto expected = test.tiles("scratch", *now), got = test.tiles("some", *now);
  expect_same_rays(got, expected);
  for (size_t tile = 0; tile < got.size(); ++tile) {
    EXPECT_EQ(got[tile].followed.size(), expected[tile].followed.size());
    for (size_t k = 0; k < got[tile].followed.size(); ++k) {
      EXPECT_EQ(got[tile].followed[k].light, expected[tile].followed[k].light);
      EXPECT_EQ(got[tile].followed[k].bits, expected[tile].followed[k].bits);
    }
  }
  return {some_followed.rays_kept - all_followed.rays_kept, count_of(expected, RayEnd::followed)};
}

// Where lamps and reflectances are as they were, rays that were followed on bring what they did,
// unless the box, or its shadow, is in their way. Most of them lie around it.
TEST_F(EarlierGather, RaysFollowedOnStayWhereTheirLightDoes) {
  const Followed above = followed_with_lamp_at(*this, {1.2f, 2.5f, 0.7f});
  EXPECT_GT(above.stay, above.all / 16);
  EXPECT_LT(above.stay, above.all);
  // Its shadow falls on the joint of floor and wall.
  const Followed low = followed_with_lamp_at(*this, {1.5f, 0.8f, 0.6f});
  EXPECT_GT(low.stay, low.all / 64);
  EXPECT_LT(low.stay, above.stay);
}

// With so many bounces and no more no sweep can be left out.
TEST_F(EarlierGather, SomeBouncesAreThoseFromScratch) {
  const auto before = lay_out(open_room(), 48);
  const auto now = edited(*before, move_box);
  GatherParams params = some_params();
  params.bounces = 2;
  const Gather first = keeping(*before, params, "before");
  const Gather scratch = keeping(*now, params, "scratch");
  const RecordFile rays = file("before");
  Earlier earlier = earlier_of(rays, *before, *now, first);
  give_direct(first, earlier);
  earlier.rays.same_light = true;
  expect_same_light(keeping(*now, params, "again", &earlier), scratch);
}

// A lamp that was off is added to what the others gave.
TEST_F(EarlierGather, ALampIsAdded) {
  const auto off = lay_out(open_room(), 48);
  const Edit switch_on = [](scene::Scene& s) {
    s.lights.push_back(s.lights[0]);
    s.lights[1].position = {-1, 1.5f, 1.5f}, s.lights[1].intensity = {1, 2, 4};
  };
  const auto on = edited(*off, switch_on);
  const auto alone = edited(*off, [&](scene::Scene& s) {
    switch_on(s);
    s.lights.erase(s.lights.begin());
  });
  const Gather first = keeping(*off, some_params(), "before");
  const Gather scratch = keeping(*on, some_params(), "scratch");
  const RecordFile rays = file("before");
  Earlier earlier = earlier_of(rays, *off, *on, first);
  give_direct(first, earlier);
  earlier.changed_lights = alone->lights;
  const Gather again = solve(*on, some_params(), {.earlier = &earlier});
  for (size_t i = 0; i < again.direct.size(); ++i)
    EXPECT_LT(length(again.direct[i] - scratch.direct[i]),
              1e-6f * length(scratch.direct[i]) + 1e-12f)
        << "two numbers were added";
  EXPECT_EQ(again.rays + again.rays_kept, scratch.rays - first.kept_direct.rays)
      << "nothing goes to the lamp that was on";
}

}  // namespace
}  // namespace luxel::gather
