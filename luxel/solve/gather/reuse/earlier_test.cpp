// Gather that builds on the rays of an earlier bake ends where gather from scratch does.
#include "luxel/solve/gather/reuse/earlier_test_support.h"

namespace luxel::gather {
namespace {

struct Change {
  const char* name;
  bool glass;  ///< in the scene
  Edit edit;
  bool surroundings = false;
  bool moves = false;
};
/// For the names of tests.
void PrintTo(const Change& p, std::ostream* out) { *out << p.name; }

class EarlierEdits : public EarlierGather, public ::testing::WithParamInterface<Change> {};

TEST_P(EarlierEdits, GiveWhatIsTracedFromScratch) {
  scene::Scene scene = open_room();
  if (GetParam().glass) make_glass(scene);
  const auto before = lay_out(std::move(scene), 48);
  const auto now = edited(*before, GetParam().edit);
  const Gather first = keeping(*before, some_params(), "before");
  const Gather scratch = keeping(*now, some_params(), "scratch");
  const RecordFile rays = file("before");
  Earlier earlier = earlier_of(rays, *before, *now, first);
  EXPECT_EQ(!earlier.rays.boxes.empty(), GetParam().moves);
  earlier.rays.surroundings = GetParam().surroundings;
  const Gather again = keeping(*now, some_params(), "again", &earlier);

  const auto expected = tiles("scratch", *now);
  expect_same_rays(tiles("again", *now), expected);
  expect_same_light(again, scratch);
  EXPECT_EQ(again.rays + again.rays_kept, scratch.rays);
  EXPECT_EQ(scratch.rays_kept, 0u);
  // Kept rays are not followed on, have not escaped through glass, and lie far from all that moves.
  const uint64_t all = 32 * now->elements.size();
  const uint64_t followed = count_of(expected, RayEnd::followed);
  const uint64_t known =
      all - followed - (GetParam().glass ? count_of(expected, RayEnd::escaped) : 0);
  EXPECT_GT(followed, 100u);
  EXPECT_GT(known, all / 8);
  if (GetParam().moves) {
    EXPECT_LT(again.rays_kept, known);
    EXPECT_GT(again.rays_kept, known / 2);
  } else {
    EXPECT_EQ(again.rays_kept, known);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EarlierEdits,
                         ::testing::Values(Change{"nothing", false, [](scene::Scene&) {}},
                                           Change{"box", false, move_box, false, true},
                                           Change{"box_beside_glass", true, move_box, false, true},
                                           Change{"paint", false,
                                                  [](scene::Scene& s) {
                                                    s.materials[kPaint].base_color = {0, 1, 0};
                                                  }},
                                           Change{"sky", false,
                                                  [](scene::Scene& s) {
                                                    s.background = {0.7f, 0.1f, 0};
                                                  },
                                                  true},
                                           Change{"sky_behind_glass", true,
                                                  [](scene::Scene& s) {
                                                    s.background = {0.7f, 0.1f, 0};
                                                  },
                                                  true},
                                           Change{"box_and_sky", false,
                                                  [](scene::Scene& s) {
                                                    move_box(s), s.background = {0.7f, 0.1f, 0};
                                                  },
                                                  true, true},
                                           Change{"lamp", false,
                                                  [](scene::Scene& s) {
                                                    s.lights[0].intensity = {1, 1, 4};
                                                  }}),
                         [](const auto& edit) { return edit.param.name; });

// The edit that the others are about is one: without boxes the old rays would stay.
TEST_F(EarlierGather, RaysThatAreNotMarkedStayAsTheyWere) {
  const auto before = lay_out(open_room(), 48);
  const auto now = edited(*before, move_box);
  const Gather first = keeping(*before, some_params(), "before");
  keeping(*now, some_params(), "scratch");
  const RecordFile rays = file("before");
  Earlier earlier = earlier_of(rays, *before, *now, first);
  earlier.rays.boxes = {};
  keeping(*now, some_params(), "again", &earlier);
  const auto old = tiles("before", *now), again = tiles("again", *now);
  const auto scratch = tiles("scratch", *now);
  size_t differ = 0, rays_of_unmoved = 0;
  for (size_t tile = 0, i = 0; tile < old.size(); ++tile)
    for (size_t k = 0; k < old[tile].ends.size(); ++k) {
      if (k % 32 == 0) ++i;
      if (earlier.rays.moved[i - 1]) {
        EXPECT_EQ(again[tile].ends[k], scratch[tile].ends[k]) << "it lies elsewhere";
        continue;
      }
      ++rays_of_unmoved;
      if (old[tile].ends[k] != RayEnd::followed) {
        EXPECT_EQ(again[tile].ends[k], old[tile].ends[k]);
        differ += old[tile].ends[k] != scratch[tile].ends[k];
      }
    }
  EXPECT_GT(rays_of_unmoved, 20000u);
  EXPECT_GT(differ, 300u);
}

/// All 32 rays of the tile's k-th element have met a back.
void make_dark(RayTile& tile, size_t k) {
  const auto begin = tile.ends.begin() + std::ptrdiff_t(32 * k), end = begin + 32;
  const auto before = std::count(tile.ends.begin(), begin, RayEnd::followed);
  const auto first = tile.followed.begin() + before;
  tile.followed.erase(first, first + std::count(begin, end, RayEnd::followed));
  std::fill(begin, end, RayEnd::back);
  const uint32_t first_hit = k == 0 ? 0 : tile.hits.end[k - 1], hits = tile.hits.end[k] - first_hit;
  const auto hit = tile.hits.entries.begin() + std::ptrdiff_t(first_hit);
  tile.hits.entries.erase(hit, hit + std::ptrdiff_t(hits));
  for (size_t later = k; later < tile.hits.end.size(); ++later) tile.hits.end[later] -= hits;
}

// Rays kept for an element that lies elsewhere now are not looked at; those of others are.
TEST_F(EarlierGather, OfElementsThatMovedAllRaysAreTraced) {
  const auto room = lay_out(open_room(), 48);
  const size_t n = room->elements.size();
  const Gather scratch = keeping(*room, some_params(), "scratch");
  const auto is_moved = [](size_t i) { return i % 3 == 0; };
  copy("scratch", "damaged", *room, [&](size_t tile, RayTile& rays) {
    for (size_t k = 0; k < rays.escaped.size(); ++k)
      if (is_moved(tile * kTileElements + k))
        make_dark(rays, k), rays.escaped[k].sum = {100, 100, 100};
    return true;
  });
  const RecordFile rays = file("damaged");
  Earlier earlier = earlier_of(rays, *room, *room, scratch);
  for (size_t i = 0; i < n; ++i) earlier.rays.moved[i] = is_moved(i);
  const Gather again = keeping(*room, some_params(), "again", &earlier);
  const auto expected = tiles("scratch", *room);
  expect_same_rays(tiles("again", *room), expected);
  expect_same_light(again, scratch);
  EXPECT_EQ(again.rays + again.rays_kept, scratch.rays);
  uint64_t known = 0;
  for (size_t tile = 0; tile < expected.size(); ++tile)
    for (size_t k = 0; k < expected[tile].ends.size(); ++k)
      known +=
          !is_moved(tile * kTileElements + k / 32) && expected[tile].ends[k] != RayEnd::followed;
  EXPECT_EQ(again.rays_kept, known);

  Earlier believed = earlier_of(rays, *room, *room, scratch);
  const Gather wrong = solve(*room, some_params(), {.earlier = &believed});
  for (size_t i = 0; i < n; ++i)
    EXPECT_EQ(wrong.met_back[i], is_moved(i) ? 32 : scratch.met_back[i]) << i;
}

// A tile that is not there, or is not one, is traced as if nothing were known.
TEST_F(EarlierGather, TilesThatAreMissingAreTraced) {
  const auto room = lay_out(open_room(), 48);
  const Gather scratch = keeping(*room, some_params(), "scratch");
  ASSERT_GT(tile_count(room->elements.size()), 2u);
  copy("scratch", "damaged", *room, [](size_t tile, RayTile& rays) {
    if (tile == 0) rays.ends[5] = RayEnd(77);
    // All of it fits, but an element has fewer hits than its rays say.
    if (tile == 2) rays.hits.end[0] = 0;
    return tile != 1;
  });
  const RecordFile rays = file("damaged");
  Earlier earlier = earlier_of(rays, *room, *room, scratch);
  const Gather again = keeping(*room, some_params(), "again", &earlier);
  const auto got = tiles("again", *room), expected = tiles("scratch", *room);
  expect_same_rays(got, expected);
  EXPECT_EQ(again.rays + again.rays_kept, scratch.rays);
  uint64_t known = 0;
  for (size_t tile = 2; tile < expected.size(); ++tile)
    known += uint64_t(std::ranges::count_if(expected[tile].ends,
                                            [](RayEnd end) { return end != RayEnd::followed; }));
  // All rays are traced of the element whose hits are missing, and of the next, which has too many.
  for (size_t k = 0; k < 64; ++k) known -= expected[2].ends[k] != RayEnd::followed;
  EXPECT_EQ(again.rays_kept, known);
  EXPECT_GT(expected[2].hits.end[0], 0u);
}

// The rounds of a bake to an error are gone through again, and give the same.
TEST_F(EarlierGather, GoesThroughTheSameRounds) {
  const auto room = lay_out(open_room(), 48);
  GatherParams params = some_params();
  params.samples = 8, params.max_error = 0.03f, params.max_samples = 128;
  const Gather first = keeping(*room, params, "first");
  const RecordFile rays = file("first");
  Earlier earlier = earlier_of(rays, *room, *room, first);
  const size_t rounds = earlier.rounds.size();
  ASSERT_GT(rounds, 2u);
  EXPECT_EQ(earlier.rounds.back(), first.samples);
  EXPECT_EQ(earlier.rounds.front(), std::vector<uint16_t>(room->elements.size(), 8));
  GatherParams exact = params;
  exact.max_error = 0;
  const Gather again = keeping(*room, exact, "again", &earlier);
  EXPECT_EQ(again.samples, first.samples);
  EXPECT_EQ(again.met_back, first.met_back);
  for (uint64_t round = 0; round < rounds; ++round)
    expect_same_rays(tiles("again", *room, round), tiles("first", *room, round));
  EXPECT_EQ(*earlier_rounds(file("again"), room->elements.size()),
            *earlier_rounds(rays, room->elements.size()));
}

}  // namespace
}  // namespace luxel::gather
