// A user clicks, drags and steps through a lamp over a floor, whose light is known.
#include "luxel/view/hierarchical/selection.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "luxel/view/hierarchical/probe_test_support.h"
#include "luxel/view/model/play.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;
using ::testing::HasSubstr;
using testing::lamp;

/// Shown twice as bright as it is.
Examined examined_lamp(uint64_t number = 1) {
  const auto twice = [](const h::FacePoint& at) {
    return Rgb{1, 1, 1} * float(2 * testing::light_at(at.position.x, at.position.z));
  };
  return {lamp().view(), twice, nullptr, number};
}

/// Above the floor at x = 0.5 m, 100 pixels a metre.
Walk walk_above() {
  Walk walk;
  walk.shown.camera = testing::scene_camera_above();
  walk.width = walk.height = 200;
  return walk;
}

/// Waits for all answers, for some seconds at most.
void finish(const Examined& examined, SelectionDesk& desk) {
  follow(examined, desk);
  for (int k = 0; k < 2000 && is_busy(desk.probers); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    follow(examined, desk);
  }
  EXPECT_FALSE(is_busy(desk.probers));
}

void click(Button button, Vec2 at, const Walk& walk, SelectionDesk& desk, Vec2 by = {}) {
  const Examined examined = examined_lamp();
  handle_selection(PointerMoved{at}, walk, examined, desk);
  handle_selection(ButtonChanged{button, true}, walk, examined, desk);
  handle_selection(PointerMoved{at + by}, walk, examined, desk);
  handle_selection(ButtonChanged{button, false}, walk, examined, desk);
}

TEST(SelectionDesk, AClickSelectsAndKeysStep) {
  const Walk walk = walk_above();
  const Examined examined = examined_lamp();
  SelectionDesk desk;
  click(Button::left, {150, 75}, walk, desk);
  EXPECT_FALSE(desk.selected.at) << "without a tool";
  handle_selection(ToolChanged{InsideTool::element}, walk, examined, desk);
  click(Button::left, {150, 75}, walk, desk, {20, 0});
  EXPECT_FALSE(desk.selected.at) << "that turned the camera";
  click(Button::left, {150, 75}, walk, desk, {2, 0});
  ASSERT_TRUE(desk.selected.has_element());
  EXPECT_NEAR(desk.selected.at->position.x, 1.02, 1e-5);
  const size_t deepest = desk.selected.level;
  EXPECT_EQ(deepest + 1, desk.selected.path.size());
  for (const char* key : {"p", "p", "c"})
    EXPECT_TRUE(handle_selection(KeyChanged{key, true}, walk, examined, desk));
  EXPECT_EQ(desk.selected.level, deepest - 1);
  EXPECT_FALSE(handle_selection(KeyChanged{"w", true}, walk, examined, desk)) << "the walk's";
  // Up to the root and no further.
  for (int k = 0; k < 40; ++k) step_selection(SelectionStep::up, examined, desk);
  EXPECT_EQ(desk.selected.level, 0u);
  handle_selection(KeyChanged{"esc", true}, walk, examined, desk);
  EXPECT_FALSE(desk.selected.has_element());
  EXPECT_TRUE(selected_box(examined, desk).empty());
}

TEST(SelectionDesk, PlacesAreThoseOfTheFile) {
  const Walk walk = walk_above();
  const Examined near = examined_lamp();
  scene::Scene moved = near.view.scene;
  moved.origin = {1e6, 0, -2e6};
  const Examined examined{
      SolutionView{moved, near.view.tracer, near.view.solution, near.view.mesh}, near.shown, {}, 2};
  SelectionDesk desk;
  const auto play = parse_play(R"({"end": 0, "events": [
    {"at": 0, "use": "element", "place": [1000001.01, 0.1, -1999999.8]}]})",
                               "tools.json");
  ASSERT_TRUE(play) << play.error().message;
  handle_selection(play->events.at(0).event, walk, examined, desk);
  ASSERT_TRUE(desk.selected.has_element());
  EXPECT_LE(length(desk.selected.at->position - DVec3{1.01, 0, 0.2}), 1e-9);
}

TEST(SelectionDesk, LinksComeByWhatTheyBring) {
  const Walk walk = walk_above();
  const Examined examined = examined_lamp();
  SelectionDesk desk;
  handle_selection(SelectionStepped{SelectionStep::next}, walk, examined, desk);
  EXPECT_THAT(desk.said, HasSubstr("select an element first"));
  handle_selection(ToolUsed{InsideTool::element, ToolPlace(DVec3{1, 0.1, 0.2}), {}}, walk, examined,
                   desk);
  ASSERT_TRUE(desk.selected.has_element());
  EXPECT_NEAR(desk.selected.at->position.y, 0, 1e-9);
  const Box3 of_element = selected_box(examined, desk);
  EXPECT_TRUE(of_element.lower.x <= 1 && of_element.upper.x >= 1 && of_element.upper.y == 0);
  handle_selection(SelectionStepped{SelectionStep::next}, walk, examined, desk);
  ASSERT_TRUE(desk.selected.link);
  EXPECT_LT(of_element.diagonal(), selected_box(examined, desk).diagonal()) << "both ends";
  const LinkFacts first = facts_of(examined.view, *desk.selected.link);
  EXPECT_THAT(first.source, HasSubstr("lamp"));
  const std::vector<display::Line> lines = shapes_of(examined, desk).lines;
  EXPECT_GT(lines.size(), 9u) << "two outlines and the link";
  const auto begin_at = [&](uint32_t id) {
    const Vec3 middle = to_float(middle_of(examined.view.solution.tree, id));
    return std::ranges::count(lines, middle, &display::Line::from);
  };
  EXPECT_EQ(begin_at(desk.selected.link->receiver), 3) << "the line, and its head";
  EXPECT_EQ(begin_at(desk.selected.link_source), 0);
  handle_selection(SelectionStepped{SelectionStep::next}, walk, examined, desk);
  ASSERT_TRUE(desk.selected.link);
  EXPECT_LE(luminance(facts_of(examined.view, *desk.selected.link).irradiance),
            luminance(first.irradiance));
}

TEST(SelectionDesk, ARightClickProbesAndWithShiftSeesSources) {
  Walk walk = walk_above();
  const Examined examined = examined_lamp();
  SelectionDesk desk;
  click(Button::right, {150, 100}, walk, desk);
  finish(examined, desk);
  ASSERT_TRUE(desk.probed.light);
  const double e = testing::light_at(1, 0);
  EXPECT_NEAR(double(desk.probed.light->exact.x), e, 1e-3 * e);
  EXPECT_NEAR(desk.probed.light->difference, 1, 1e-3);
  EXPECT_FALSE(desk.probed.sources);
  walk.keys.insert("shift");
  click(Button::right, {150, 100}, walk, desk);
  finish(examined, desk);
  ASSERT_TRUE(desk.probed.sources);
  EXPECT_EQ(desk.probed.sources->sources.size(), 1u);
  EXPECT_FALSE(shapes_of(examined, desk).areas.empty());
}

TEST(SelectionDesk, ADragIsAGraph) {
  const Walk walk = walk_above();
  const Examined examined = examined_lamp();
  SelectionDesk desk;
  desk.tool = InsideTool::graph;
  click(Button::left, {100, 100}, walk, desk, {70, 0});
  finish(examined, desk);
  ASSERT_TRUE(desk.probed.graph);
  const Curve& curve = desk.probed.graph->curve;
  EXPECT_NEAR(curve.line.from.x, 0.5, 1e-5);
  EXPECT_NEAR(curve.line.to.x, 1.2, 1e-5);
  // Shown twice as bright: what it is off by is what there is.
  double squares = 0;
  for (const float x : curve.at_m) {
    const double e = testing::light_at(0.5 + double(x), 0);
    squares += e * e / double(curve.at_m.size());
  }
  EXPECT_NEAR(curve.rms, std::sqrt(squares), 1e-3 * std::sqrt(squares));
  EXPECT_FALSE(desk.probed.graph->surface);
  // The line itself, and one less than points of each curve.
  const auto lines = [&] { return shapes_of(examined, desk).lines.size(); };
  const size_t of_curve = curve.at_m.size() - 1;
  EXPECT_EQ(lines(), 1 + 3 * of_curve);
  GraphChanged alone;
  alone.shows = {true, false, false}, alone.height = 2.0f;
  EXPECT_TRUE(handle_selection(alone, walk, examined, desk));
  EXPECT_EQ(lines(), 1 + of_curve);
  float highest = 0;
  for (const display::Line& line : shapes_of(examined, desk).lines)
    highest = std::max({highest, line.from.y, line.to.y});
  EXPECT_NEAR(highest, 0.5 * 2 * 0.7, 0.02) << "half as high as what is shown";
}

TEST(SelectionDesk, ADiscontinuityAndTheGraphAcrossIt) {
  const Walk walk = walk_above();
  const Examined examined = examined_lamp();
  SelectionDesk desk;
  // The penumbra of the lamp's near edge begins at x = 0.35: pixel 85.
  use_tool({InsideTool::discontinuity, ToolPlace(Vec2{86, 100}), {}}, walk, examined, desk);
  finish(examined, desk);
  ASSERT_TRUE(desk.selected.discontinuity) << desk.said;
  EXPECT_NEAR(desk.selected.discontinuity->line.a.x, 0.35, 1e-4);
  handle_selection(KeyChanged{"g", true}, walk, examined, desk);
  finish(examined, desk);
  ASSERT_TRUE(desk.probed.graph);
  const CurveLine& line = desk.probed.graph->curve.line;
  EXPECT_NEAR((line.from.x + line.to.x) / 2, 0.35, 1e-4);
  EXPECT_NEAR(line.from.z, line.to.z, 1e-9);
  // No line is near there, and a sentence says so.
  use_tool({InsideTool::discontinuity, ToolPlace(Vec2{190, 20}), {}}, walk, examined, desk);
  finish(examined, desk);
  EXPECT_THAT(desk.said, HasSubstr("discontinuities"));
}

TEST(SelectionDesk, AnotherSolutionIsAskedAgain) {
  const Walk walk = walk_above();
  SelectionDesk desk;
  follow(examined_lamp(1), desk);
  use_tool({InsideTool::element, ToolPlace(Vec2{150, 100}), {}}, walk, examined_lamp(1), desk);
  step_selection(SelectionStep::up, examined_lamp(1), desk);
  const uint32_t node = desk.selected.path[desk.selected.level];
  use_tool({InsideTool::graph, std::nullopt, {}}, walk, examined_lamp(1), desk);
  use_tool({InsideTool::irradiance, ToolPlace(Vec2{150, 100}), {}}, walk, examined_lamp(1), desk);
  finish(examined_lamp(1), desk);
  ASSERT_TRUE(desk.probed.light && desk.probed.graph && desk.probed.graph->surface);
  Examined exact = examined_lamp(2);
  exact.shown = [](const h::FacePoint& at) {
    return Rgb{1, 1, 1} * float(testing::light_at(at.position.x, at.position.z));
  };
  EXPECT_TRUE(follow(exact, desk));
  finish(exact, desk);
  EXPECT_NEAR(desk.probed.light->difference, 0, 1e-3);
  EXPECT_LT(desk.probed.graph->curve.most, 1e-3);
  EXPECT_LT(desk.probed.graph->surface->most, 1e-3);
  EXPECT_EQ(desk.selected.path[desk.selected.level], node);
  EXPECT_FALSE(follow(exact, desk)) << "nothing has come";
}

TEST(SelectionDesk, SaysWhatIsMissing) {
  const Walk walk = walk_above();
  Examined examined = examined_lamp();
  examined.view.mesh = nullptr;
  SelectionDesk desk;
  use_tool({InsideTool::triangle, ToolPlace(Vec2{150, 100}), {}}, walk, examined, desk);
  EXPECT_THAT(desk.said, HasSubstr("no triangles"));
  use_tool({InsideTool::graph, std::nullopt, {}}, walk, examined, desk);
  EXPECT_THAT(desk.said, HasSubstr("a graph needs"));
  use_tool({InsideTool::irradiance, ToolPlace(Vec2{100, 1e6f}), {}}, walk, examined, desk);
  EXPECT_THAT(desk.said, HasSubstr("no surface"));
}

TEST(Events, OfToolsAreRead) {
  const auto play = parse_play(R"({"end": 1, "events": [
      {"at": 0, "tool": "link"}, {"at": 0, "use": "element", "pixel": [10, 20]},
      {"at": 0, "use": "graph", "place": [1, 2, 3], "to_place": [4, 5, 6]},
      {"at": 0, "use": "graph"}, {"at": 0, "selection": "up"}, {"at": 0, "use": "none"}]})",
                               "p");
  ASSERT_TRUE(play) << play.error().message;
  ASSERT_EQ(play->events.size(), 6u);
  const auto& graph = std::get<ToolUsed>(play->events[2].event);
  EXPECT_EQ(std::get<DVec3>(*graph.to).z, 6);
  EXPECT_TRUE(parse_play(
      R"({"end": 0, "events": [{"at": 0, "graph": {"difference": false, "height": 0.5}}]})", "p"));
  for (const char* wrong :
       {R"("graph": {})", R"("graph": {"height": 0})", R"("graph": {"curve": true})",
        R"("tool": "hammer")", R"("use": "element")", R"("use": "graph", "to_pixel": [1, 2])",
        R"("selection": "sideways")", R"("use": "link", "pixel": [1, 2], "more": 3)",
        R"("tool": "link", "pixel": [1, 2])", R"("use": "element", "place": [1, 2, 1e39])"}) {
    const auto bad =
        parse_play(std::string(R"({"end": 1, "events": [{"at": 0, )") + wrong + "}]}", "p");
    EXPECT_FALSE(bad) << wrong;
  }
}

// A tool that has just been used begins to work; what stands after the wait comes when that is
// done.
TEST(Events, AWaitIsForWhatCameJustBefore) {
  const auto play = parse_play(R"({"end": 0, "events": [{"at": 0, "use": "none"},
      {"at": 0, "wait": "bake"}, {"at": 0, "use": "graph"}, {"at": 0, "wait": "bake"}]})",
                               "p");
  ASSERT_TRUE(play);
  int taken = 0;
  bool is_at_work = false;
  const auto take = [&](const Event&) { ++taken, is_at_work = true; };
  Played played;
  for (const int expected : {1, 2}) {
    EXPECT_EQ(step(*play, is_at_work, take, played), Step::waits);
    EXPECT_EQ(taken, expected);
    EXPECT_EQ(step(*play, is_at_work, take, played), Step::waits) << "still at work";
    EXPECT_EQ(taken, expected);
    is_at_work = false;
  }
  EXPECT_EQ(step(*play, is_at_work, take, played), Step::ends);
}

}  // namespace
}  // namespace luxel::view
