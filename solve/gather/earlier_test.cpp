// Gather that builds on the rays of an earlier bake ends where gather from scratch does.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>

#include "scene/shapes.h"
#include "solve/gather/gather_test_support.h"

namespace luxel::gather {
namespace {

namespace fs = std::filesystem;
using Edit = std::function<void(scene::Scene&)>;

/// Instances and materials of open_room() by number.
constexpr uint32_t kFloor = 0, kWall = 1, kBox = 2, kPane = 3;
constexpr uint32_t kPaint = 1, kGlass = 2;

/// A floor and a wall under an even sky with a lamp above, a box on the floor, and a thin pane,
/// whose two sides are near to each other: rays end nearer than a texel is wide in the joints.
scene::Scene open_room() {
  scene::Scene scene;
  scene.background = {0.4f, 0.5f, 0.7f};
  const uint32_t gray = scene::add_material(scene, "gray", {0.6f, 0.6f, 0.6f}, {});
  scene::add_material(scene, "paint", {0.7f, 0.3f, 0.2f}, {});
  scene::add_material(scene, "glass", {0.9f, 0.4f, 0.3f}, {});
  scene::add_rectangle(scene, {-2, 2, -2, 2}, 0, true, gray);
  scene::Mesh wall, box, pane;
  scene::add_quad(wall, {Vec3{-2, 0, -2}, {2, 0, -2}, {2, 2, -2}, {-2, 2, -2}}, gray);
  scene::add_box(box, {-0.3f, 0.01f, -0.3f}, {0.3f, 0.5f, 0.3f}, kPaint);
  scene::add_box(pane, {-0.8f, 0.2f, 0.8f}, {0.8f, 0.9f, 0.82f}, kGlass);
  scene::place(scene, std::move(wall));
  scene::place(scene, std::move(box));
  scene::place(scene, std::move(pane));
  scene.lights.resize(1);
  scene.lights[0].position = {1.2f, 2.5f, 0.7f}, scene.lights[0].intensity = {3, 2, 1};
  return scene;
}

void make_glass(scene::Scene& scene) {
  scene.materials[kGlass].alpha_mode = scene::AlphaMode::blend;
  scene.materials[kGlass].alpha = 0.5f, scene.materials[kGlass].double_sided = true;
}

void move_box(scene::Scene& scene) {
  scene.instances[kBox].world_from_object = translation({0.7f, 0, -0.4f});
}

/// The edited scene on the same map.
std::unique_ptr<Room> edited(const Room& room, const Edit& edit) {
  auto out = std::make_unique<Room>();
  out->scene = room.scene;
  edit(out->scene);
  out->atlas = room.atlas;
  out->map = atlas::rasterise(out->scene, out->atlas);
  out->elements = transport::elements_from_texels(out->scene, out->atlas, out->map);
  out->lights = transport::collect_lights(out->scene);
  auto tracer = trace::RayTracer::build(out->scene);
  EXPECT_TRUE(tracer);
  out->tracer.emplace(std::move(*tracer));
  return out;
}

/// Grown by the rounding of positions some metres away from 0, and more.
Box3 bounds_of(const scene::Scene& scene, uint32_t instance) {
  Box3 out;
  const uint32_t mesh = scene.instances[instance].mesh;
  for (uint32_t t = 0; t < scene.meshes[mesh].triangles.size(); ++t) {
    const scene::Triangle3 corners = scene::world_triangle(scene, instance, t);
    for (const Vec3& v : {corners.a, corners.b, corners.c}) out.extend(v);
  }
  constexpr Vec3 kMargin{1e-4f, 1e-4f, 1e-4f};
  return {out.lower - kMargin, out.upper + kMargin};
}

GatherParams some_params() { return with_samples(32, 8); }

uint32_t places_of(const Room& room) {
  const uint32_t side = uint32_t(room.atlas.resolution);
  return (side + 2) * (side + 2);
}
size_t tile_count(size_t elements) { return (elements + kTileElements - 1) / kTileElements; }
size_t tile_size(size_t elements, size_t tile) {
  return std::min(kTileElements, elements - tile * kTileElements);
}

class EarlierGather : public ::testing::Test {
 public:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("luxel-earlier-" + std::to_string(::getpid()) + "-" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Solves, and keeps the rays under a name.
  Gather keeping(const Room& room, GatherParams params, const std::string& name) {
    PartStore store({folder_ / name, "", "", 1e-9, std::chrono::steady_clock::now()}, progress_);
    params.keep = &store;
    return solve(room, params);
  }
  RecordFile file(const std::string& name) {
    auto out = RecordFile::open(folder_ / name);
    EXPECT_TRUE(out) << out.error().message;
    return std::move(*out);
  }
  std::vector<RayTile> tiles(const std::string& name, const Room& room, uint64_t round = 0) {
    const RecordFile rays = file(name);
    std::vector<RayTile> out;
    const size_t n = room.elements.size();
    for (size_t tile = 0; tile < tile_count(n); ++tile) {
      RayTileBuffer buffer;
      const RayTile* found =
          find_rays(rays, round, tile, tile_size(n, tile), places_of(room), buffer);
      EXPECT_TRUE(found) << "tile " << tile;
      out.push_back(found ? *found : RayTile{});
    }
    return out;
  }
  /// Copies a file of one round with tiles changed, or left out where `edit` returns false.
  void copy(const std::string& from, const std::string& to, const Room& room,
            const std::function<bool(size_t, RayTile&)>& edit) {
    PartStore store({folder_ / to, "", "", 1e-9, std::chrono::steady_clock::now()}, progress_);
    std::vector<RayTile> all = tiles(from, room);
    for (size_t tile = 0; tile < all.size(); ++tile)
      if (edit(tile, all[tile])) keep_rays(&store, 0, tile, all[tile]);
    keep_samples(&store, 0, earlier_rounds(file(from), room.elements.size())->front());
  }

  fs::path folder_;
  Progress progress_;
};

/// What is known of `before` for `now`, with boxes around moved instances.
Earlier earlier_of(const RecordFile& rays, const Room& before, const Room& now,
                   const Gather& light) {
  const size_t n = before.elements.size();
  Earlier out;
  out.rounds = *earlier_rounds(rays, n);
  out.rays.file = &rays;
  for (size_t i = 0; i < n; ++i)
    out.rays.moved.push_back(!(before.elements.position[i] == now.elements.position[i]));
  for (uint32_t k = 0; k < now.scene.instances.size(); ++k)
    if (!(before.scene.instances[k].world_from_object == now.scene.instances[k].world_from_object))
      for (const scene::Scene* scene : {&before.scene, &now.scene})
        out.rays.boxes.push_back(bounds_of(*scene, k));
  out.irradiance = light.irradiance;
  return out;
}

void expect_same_rays(std::span<const RayTile> a, std::span<const RayTile> b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t tile = 0; tile < a.size(); ++tile) {
    EXPECT_EQ(a[tile].ends, b[tile].ends) << tile;
    EXPECT_EQ(a[tile].hits.end, b[tile].hits.end) << tile;
    EXPECT_TRUE(std::ranges::equal(a[tile].hits.entries, b[tile].hits.entries,
                                   [](StoredHit x, StoredHit y) { return x.bits == y.bits; }))
        << tile;
    for (size_t i = 0; i < a[tile].escaped.size(); ++i) {
      const EscapedLight &x = a[tile].escaped[i], &y = b[tile].escaped[i];
      // Sums of at most 32 radiances below 1, of which some were added and taken away again: each
      // step rounds a sum below 32 to 24 bits, 2e-6, and there are 64 at most.
      constexpr float kRounding = 1.3e-4f;
      EXPECT_NEAR(luminance(x.sum), luminance(y.sum), kRounding);
      EXPECT_NEAR(x.luminance2, y.luminance2, kRounding);
      EXPECT_NEAR(x.second_luminance, y.second_luminance, kRounding);
    }
  }
}

/// Both have gone through the bounces to their tolerance, from different guesses: 1e-4 of the mean
/// each, and four times as much at single elements.
void expect_same_light(const Gather& a, const Gather& b) {
  ASSERT_EQ(a.irradiance.size(), b.irradiance.size());
  float mean = 0;
  for (const Rgb& e : b.irradiance) mean += luminance(e) / float(b.irradiance.size());
  for (size_t i = 0; i < a.irradiance.size(); ++i)
    ASSERT_LT(length(a.irradiance[i] - b.irradiance[i]), 8e-4f * mean) << i;
  EXPECT_EQ(a.direct, b.direct);
  EXPECT_EQ(a.met_back, b.met_back);
  EXPECT_EQ(a.enclosed, b.enclosed);
  EXPECT_EQ(a.samples, b.samples);
}

uint64_t count_of(std::span<const RayTile> tiles, RayEnd end) {
  uint64_t out = 0;
  for (const RayTile& tile : tiles) out += uint64_t(std::ranges::count(tile.ends, end));
  return out;
}

struct Change {
  const char* name;
  bool glass;  ///< in the scene
  Edit edit;
  bool surroundings = false;
  bool moves = false;
};

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
  GatherParams params = some_params();
  params.earlier = &earlier;
  const Gather again = keeping(*now, params, "again");

  const auto expected = tiles("scratch", *now);
  expect_same_rays(tiles("again", *now), expected);
  expect_same_light(again, scratch);
  EXPECT_EQ(again.rays + again.rays_kept, scratch.rays);
  EXPECT_EQ(scratch.rays_kept, 0u);
  // What is not followed on, has not escaped through glass, and lies far from what moves.
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
  GatherParams params = some_params();
  params.earlier = &earlier;
  keeping(*now, params, "again");
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

// What is kept of an element that lies elsewhere is not looked at; of others it is.
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
  GatherParams params = some_params();
  params.earlier = &earlier;
  const Gather again = keeping(*room, params, "again");
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
  params.earlier = &believed;
  const Gather wrong = solve(*room, params);
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
  GatherParams params = some_params();
  params.earlier = &earlier;
  const Gather again = keeping(*room, params, "again");
  const auto got = tiles("again", *room), expected = tiles("scratch", *room);
  expect_same_rays(got, expected);
  EXPECT_EQ(again.rays + again.rays_kept, scratch.rays);
  uint64_t known = 0;
  for (size_t tile = 2; tile < expected.size(); ++tile)
    known += uint64_t(std::ranges::count_if(expected[tile].ends,
                                            [](RayEnd end) { return end != RayEnd::followed; }));
  // Of the element whose hits are missing all rays are traced, and those of the next, which has too
  // many.
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
  exact.max_error = 0, exact.earlier = &earlier;
  const Gather again = keeping(*room, exact, "again");
  EXPECT_EQ(again.samples, first.samples);
  EXPECT_EQ(again.met_back, first.met_back);
  for (uint64_t round = 0; round < rounds; ++round)
    expect_same_rays(tiles("again", *room, round), tiles("first", *room, round));
  EXPECT_EQ(*earlier_rounds(file("again"), room->elements.size()),
            *earlier_rounds(rays, room->elements.size()));
}

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
  GatherParams params = some_params();
  params.earlier = &earlier;
  const Gather again = keeping(*now, params, "again");
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
  params.earlier = &blind;
  const Gather without_boxes = keeping(*now, params, "without boxes");
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
    GatherParams params = some_params();
    params.earlier = &earlier;
    return test.keeping(*now, params, name);
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
  params.earlier = &earlier;
  expect_same_light(keeping(*now, params, "again"), scratch);
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
  earlier.lamps_anew = alone->lights;
  GatherParams params = some_params();
  params.earlier = &earlier;
  const Gather again = solve(*on, params);
  for (size_t i = 0; i < again.direct.size(); ++i)
    EXPECT_LT(length(again.direct[i] - scratch.direct[i]),
              1e-6f * length(scratch.direct[i]) + 1e-12f)
        << "two numbers were added";
  EXPECT_EQ(again.rays + again.rays_kept, scratch.rays - first.kept_direct.rays)
      << "nothing goes to the lamp that was on";
}

}  // namespace
}  // namespace luxel::gather
