// The user's choices while looking into a solver.
#include "luxel/view/hierarchical/desk.h"

#include <gmock/gmock.h>

namespace luxel::view {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Play play_of(const std::string& events) {
  auto play = parse_play("{\"end\": 1, \"events\": [" + events + "]}", "desk.json");
  EXPECT_TRUE(play) << play.error().message;
  return play ? *play : Play();
}

HierarchicalDesk played(const std::string& events) {
  HierarchicalDesk desk;
  for (const TimedEvent& timed : play_of(events).events)
    EXPECT_TRUE(handle_desk(timed.event, desk));
  return desk;
}

TEST(HierarchicalDesk, DoesWhatEventsSay) {
  const HierarchicalDesk desk = played(
      R"({"at": 0, "show": "gouraud-disc"}, {"at": 0, "overlay": {"mesh": true}},
         {"at": 0, "overlay": {"links": true}}, {"at": 0, "overlay": {"mesh": false}},
         {"at": 0, "set": {"eps": 0.25}}, {"at": 0, "set": {"max-leaf-lines": 3}},
         {"at": 0, "set": {"min-weight": 7}}, {"at": 0, "set": {"min-area": 0.5}},
         {"at": 0, "set": {"mesh-depth": 2}}, {"at": 0, "set": {"most-links": 10}},
         {"at": 0, "do": "iterate"}, {"at": 0, "do": "converge-interpolants"})");
  EXPECT_EQ(desk.kind, LightKind::gouraud_disc);
  EXPECT_FALSE(desk.shows(Over::mesh));
  EXPECT_TRUE(desk.shows(Over::links));
  EXPECT_EQ(desk.settings.solve.eps, 0.25);
  EXPECT_EQ(desk.settings.solve.min_area_m2, 0.5);
  EXPECT_EQ(desk.settings.mesh.discontinuity.max_per_leaf, 3u);
  EXPECT_EQ(desk.settings.mesh.discontinuity.least_weight, 7);
  EXPECT_EQ(desk.mesh_depth, 2);
  EXPECT_EQ(desk.most_links, 10u);
  EXPECT_THAT(desk.asked, ElementsAre(Ask::links, Ask::converge_interpolants));
  EXPECT_EQ(number_of(desk, Number::eps), 0.25);
  EXPECT_FALSE(played(R"({"at": 0, "set": {"eps": 0}})").settings.solve.eps) << "by itself";
  const HierarchicalDesk stopped = played(R"({"at": 0, "do": "iterate"}, {"at": 0, "do": "stop"})");
  EXPECT_TRUE(stopped.asks_to_stop);
  EXPECT_THAT(stopped.asked, ElementsAre());
  EXPECT_EQ(played(R"({"at": 0, "key": "7"})").kind, LightKind::interpolant);
  HierarchicalDesk other;
  EXPECT_FALSE(handle_desk(KeyChanged{"w", true}, other)) << "that is for the walk";
}

// Every name of every table can be played.
TEST(HierarchicalDesk, KnowsAllItsNames) {
  std::string events;
  const auto add = [&](const std::string& event) {
    events += (events.empty() ? "" : ", ") + event;
  };
  for (const NamedWords& kind : kLightKinds)
    add(fmt::format(R"({{"at": 0, "show": "{}"}})", kind.name));
  for (const NamedWords& over : kOverlays)
    add(fmt::format(R"({{"at": 0, "overlay": {{"{}": true}}}})", over.name));
  for (const NamedNumber& number : kNumbers)
    add(fmt::format(R"({{"at": 0, "set": {{"{}": {}}}}})", number.name, number.high));
  for (const NamedWords& ask : kAsks) add(fmt::format(R"({{"at": 0, "do": "{}"}})", ask.name));
  const Status checked = check_desk(play_of(events), "desk.json");
  EXPECT_TRUE(checked) << checked.error().message;
  const HierarchicalDesk desk = played(events);
  EXPECT_THAT(desk.over, ::testing::Each(true));
  EXPECT_EQ(desk.asked.size(), kAsks.size());
}

TEST(HierarchicalDesk, RefusesWhatItDoesNotKnow) {
  const auto error = [](const std::string& event) {
    const Status checked = check_desk(play_of(event), "desk.json");
    return checked ? "" : checked.error().message;
  };
  EXPECT_EQ(error(R"({"at": 0.5, "overlay": {"shadows": true}})"),
            "desk.json, at 0.5 s: the overlay 'shadows' is not known; choose from: mesh, links, "
            "partial-links, discontinuities, triangulation, samples, error, reflectance, no-faces");
  EXPECT_THAT(error(R"({"at": 0, "do": "dance"})"),
              HasSubstr("'dance' is not known; choose from: it"));
  EXPECT_EQ(error(R"({"at": 0, "set": {"eps": -1}})"),
            "desk.json, at 0 s: eps is from 0 to 1000000000, not -1");
  EXPECT_THAT(error(R"({"at": 0, "set": {"epsilon": 1}})"), HasSubstr("'epsilon' is not known"));
  EXPECT_THAT(error(R"({"at": 0, "show": "charts"})"), HasSubstr("no bake to look into"));
  EXPECT_EQ(error(R"({"at": 0, "show": "light"}, {"at": 0, "wait": "bake"})"), "");
  for (const char* wrong :
       {R"({"at": 0, "show": "bright"})", R"({"at": 0, "overlay": "mesh"})",
        R"({"at": 0, "set": {"eps": 1, "min-area": 2}})", R"({"at": 0, "do": 3})"})
    EXPECT_FALSE(parse_play(std::string("{\"end\": 1, \"events\": [") + wrong + "]}", "x"))
        << wrong;
  const Status elsewhere = check_no_inside(play_of(R"({"at": 0, "do": "iterate"})"), "desk.json");
  ASSERT_FALSE(elsewhere);
  EXPECT_THAT(elsewhere.error().message, HasSubstr("--inside"));
}

TEST(HierarchicalDesk, WantsWhatItShows) {
  HierarchicalDesk desk;
  const ExactView view{{}, 4, 3};
  Wanted wanted = wanted_for(desk, view);
  EXPECT_FALSE(wanted.whole || wanted.cut || wanted.discontinuities || wanted.error ||
               wanted.exact);
  desk.kind = LightKind::gouraud;
  EXPECT_TRUE(wanted_for(desk, view).whole);
  EXPECT_FALSE(wanted_for(desk, view).cut);
  desk.kind = LightKind::exact;
  wanted = wanted_for(desk, view);
  EXPECT_TRUE(wanted.cut && wanted.exact);
  EXPECT_FALSE(wanted_for(desk, std::nullopt).exact) << "the camera moves";
  for (const Over over : {Over::triangulation, Over::samples}) {
    desk = {};
    desk.over[size_t(over)] = true;
    EXPECT_TRUE(wanted_for(desk, view).cut);
  }
  desk = {};
  desk.over[size_t(Over::discontinuities)] = true;
  EXPECT_TRUE(wanted_for(desk, view).discontinuities && !wanted_for(desk, view).cut);
  desk = {};
  desk.over[size_t(Over::error)] = true;
  EXPECT_TRUE(wanted_for(desk, view).cut && wanted_for(desk, view).error);
}

}  // namespace
}  // namespace luxel::view
