// A solver in a thread that does what it is asked for.
#include "luxel/view/hierarchical/workshop.h"

#include <gmock/gmock.h>

#include <chrono>
#include <thread>

namespace luxel::view {
namespace {

constexpr auto kLongest = std::chrono::seconds(60);

pipeline::BakeSettings box_settings() {
  pipeline::BakeSettings out;
  out.scene = LUXEL_SOURCE_DIR "/scenes/cornell-box.glb";
  out.solver = "hierarchical";
  out.own.of<pipeline::HierarchicalSettings>().solve.eps = 0.5;
  return out;
}

/// All news until the workshop is at rest, or `until` says so.
struct Seen {
  WorkshopNews last;
  std::vector<uint64_t> numbers;  ///< of pieces

  void take(Workshop& workshop) {
    WorkshopNews news = workshop.take();
    if (news.read) last.read = std::move(news.read);
    if (news.exposure > 0) last.exposure = news.exposure;
    if (news.said) last.said = news.said;
    if (news.exact) last.exact = std::move(news.exact);
    if (!news.piece) return;
    last.piece = std::move(news.piece);
    numbers.push_back(last.piece->number);
  }
  template <class Until>
  void follow(Workshop& workshop, const Until& until) {
    const auto begun = std::chrono::steady_clock::now();
    do {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      take(workshop);
      ASSERT_LT(std::chrono::steady_clock::now() - begun, kLongest);
    } while (!until());
  }
  void follow(Workshop& workshop) {
    follow(workshop, [&] { return workshop.state() != WorkshopState::at_work; });
  }
};

TEST(Workshop, HandsOverEachStepAndWhatIsWantedOfIt) {
  const pipeline::BakeSettings settings = box_settings();
  const auto& own = settings.own.of<pipeline::HierarchicalSettings>();
  const auto workshop = Workshop::begin(settings);
  Seen seen;
  seen.follow(*workshop);
  ASSERT_TRUE(seen.last.read && seen.last.piece);
  EXPECT_FALSE(seen.last.said);
  EXPECT_GT(seen.last.exposure, 0);
  EXPECT_EQ(seen.last.piece->number, 1u);
  EXPECT_TRUE(seen.last.piece->flat && !seen.last.piece->whole && !seen.last.piece->cut);
  const auto first = seen.last.piece;
  workshop->ask(Ask::links, own);
  seen.follow(*workshop);
  EXPECT_EQ(seen.last.piece->number, 2u);
  EXPECT_EQ(seen.last.piece->solution().iterations, 1);
  EXPECT_EQ(first->solution().iterations, 0) << "what was handed over stays";
  // Meshes of the same solution.
  workshop->want({.whole = true, .cut = true}, own.mesh);
  seen.follow(*workshop);
  EXPECT_EQ(seen.last.piece->number, 2u);
  EXPECT_TRUE(seen.last.piece->whole && seen.last.piece->cut);
  EXPECT_EQ(seen.last.piece->whole->lines, 0u);
  EXPECT_GT(seen.last.piece->cut->lines, 0u);
  // Other settings make another one.
  hierarchical::MeshParams fewer = own.mesh;
  fewer.discontinuity.max_per_leaf = 1;
  const size_t lines = seen.last.piece->cut->lines;
  workshop->want({.cut = true}, fewer);
  seen.follow(*workshop);
  EXPECT_LT(seen.last.piece->cut->lines, lines);
  // Exact light of a small picture.
  workshop->want({.exact = ExactView{seen.last.read->first.camera, 20, 15}}, fewer);
  seen.follow(*workshop);
  ASSERT_TRUE(seen.last.exact);
  EXPECT_TRUE(is_whole(*seen.last.exact));
  // To the end, by both refinements.
  workshop->ask(Ask::converge_links, own);
  seen.follow(*workshop);
  EXPECT_TRUE(seen.last.piece->is_settled);
  pipeline::HierarchicalSettings rough = own;
  rough.solve.eps = 5;
  workshop->ask(Ask::converge_interpolants, rough);
  seen.follow(*workshop);
  EXPECT_TRUE(seen.last.piece->cut && seen.last.piece->is_settled);
  EXPECT_TRUE(std::ranges::is_sorted(seen.numbers));
  workshop->ask(Ask::begin, own);
  seen.follow(*workshop);
  EXPECT_EQ(seen.last.piece->solution().iterations, 0);
}

TEST(Workshop, IsInterruptedAtOnce) {
  pipeline::BakeSettings settings = box_settings();
  const auto workshop = Workshop::begin(settings);
  Seen seen;
  seen.follow(*workshop);
  // Links without end.
  pipeline::HierarchicalSettings endless;
  endless.solve.eps = 1e-9, endless.solve.min_area_m2 = 1e-9;
  workshop->ask(Ask::converge_links, endless);
  workshop->ask(Ask::converge_links, endless);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_TRUE(workshop->is_solving());
  const auto before = std::chrono::steady_clock::now();
  workshop->interrupt();
  seen.follow(*workshop);
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::milliseconds(400));
  EXPECT_FALSE(workshop->is_solving());
  EXPECT_FALSE(seen.last.said) << "that is no error";
  // It goes on from the last whole step.
  const uint64_t number = seen.last.piece->number;
  workshop->ask(Ask::links, settings.own.of<pipeline::HierarchicalSettings>());
  seen.follow(*workshop);
  EXPECT_EQ(seen.last.piece->number, number + 1);
  // And ends at once, too.
  workshop->ask(Ask::converge_links, endless);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

TEST(Workshop, SaysWhatIsWrong) {
  pipeline::BakeSettings settings = box_settings();
  settings.scene = "/none/there.glb";
  const auto workshop = Workshop::begin(settings);
  Seen seen;
  seen.follow(*workshop);
  EXPECT_EQ(workshop->state(), WorkshopState::failed);
  ASSERT_TRUE(seen.last.said);
  EXPECT_THAT(*seen.last.said, ::testing::HasSubstr("/none/there.glb"));
}

}  // namespace
}  // namespace luxel::view
