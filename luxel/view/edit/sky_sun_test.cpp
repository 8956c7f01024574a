// A sun that is moved takes its sky along: what `luxel bake --sky` makes of the same words.
#include "luxel/view/edit/sky_sun.h"

#include <gmock/gmock.h>

#include "luxel/pipeline/settings/outside_light.h"
#include "luxel/scene/digest.h"
#include "luxel/scene/procedural.h"
#include "luxel/view/edit/save_scene.h"
#include "luxel/view/edit/tools.h"

namespace luxel::view {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A box under this light.
scene::Scene box_under(const pipeline::OutsideLight& outside) {
  scene::Scene out = scene::cornell_box();
  for (scene::Material& material : out.materials) material.emission = {};
  EXPECT_TRUE(pipeline::add_outside_light(outside, out));
  return out;
}

pipeline::OutsideLight sky_of(const char* words) {
  pipeline::OutsideLight out;
  out.sky = *pipeline::parse_sky(words);
  return out;
}

std::shared_ptr<const ReadScene> read_under(const pipeline::OutsideLight& outside) {
  pipeline::BakeSettings settings;
  settings.outside = outside;
  auto read = read_scene(box_under(outside), settings);
  EXPECT_TRUE(read);
  return *read;
}

/// --sky 90,30
EditTools tools_of_morning() {
  static const std::shared_ptr<const ReadScene> read = read_under(sky_of("90,30"));
  return begin_tools(read);
}

void take_by(const Event& event, EditTools& tools) { handle_edits(event, Walk(), tools); }

/// As a play has it.
LampChanged stands_at(const char* words) {
  LampChanged out;
  const pipeline::SkySetting sky = *pipeline::parse_sky(words);
  out.change.direction = -pipeline::sky_params(sky).towards_sun;
  out.change.sky = SkyAsked{sky, words};
  return out;
}

std::string what_differs(const scene::Scene& before, const scene::Scene& now) {
  return scene::difference(scene::digests_of(before), scene::digests_of(now));
}
scene::Scene scene_made_by(const EditTools& tools) {
  return edited(tools.desk.read->scene, tools.desk.now);
}

TEST(SkySun, StandsWhereWordsSayUnderTheSkyOfABake) {
  for (const char* words : {"2026-06-21T07:10+02:00,48.85,2.35,4", "10,-3"}) {
    EditTools tools = tools_of_morning();
    take_by(stands_at(words), tools);
    scene::Scene wanted = box_under(sky_of(words));
    // At night a bake has no sun, and an edited scene one that is dark.
    if (wanted.lights.empty()) {
      EXPECT_EQ(max_component(scene_made_by(tools).lights[0].intensity), 0);
      wanted.lights = scene_made_by(tools).lights;
    }
    EXPECT_THAT(what_differs(wanted, scene_made_by(tools)), IsEmpty()) << words;
    undo_step(tools);
    EXPECT_THAT(what_differs(tools.desk.read->scene, scene_made_by(tools)), IsEmpty());
  }
}

TEST(SkySun, ThatOfTheDefaultDayHasASkyAndOthersHaveNone) {
  EXPECT_EQ(read_under({})->sun->light, 0u);
  pipeline::OutsideLight bare;
  bare.sun = pipeline::Sun{90, 30, 1000};
  EditTools tools = begin_tools(read_under(bare));
  EXPECT_FALSE(tools.desk.read->sun);
  take_by(stands_at("200,12,4"), tools);
  EXPECT_TRUE(scene_made_by(tools).environment.empty());
  EXPECT_EQ(scene_made_by(tools).lights[0].intensity, (Rgb{1000, 1000, 1000}));
}

/// By its numbers, as dragging does.
void turn_to(Vec3 direction, EditTools& tools) {
  LampChanged event;
  event.change.direction = direction;
  take_by(event, tools);
}

TEST(SkySun, ThatIsDraggedHasTheSkyThatItsWordsSay) {
  EditTools tools = tools_of_morning();
  const Vec3 direction = normalize(Vec3{0.3f, -0.5f, 0.7f});
  turn_to(direction, tools);
  ASSERT_TRUE(tools.desk.now.sky);
  EXPECT_THAT(
      what_differs(box_under(sky_of(tools.desk.now.sky->words.c_str())), scene_made_by(tools)),
      IsEmpty());
  EXPECT_LT(length(tools.desk.now.lamps[0].light.direction - direction), 1e-4f)
      << "a hundredth of a degree";
}

TEST(SkySun, KeepsTheLightThatItWasGivenByHand) {
  EditTools tools = tools_of_morning();
  LampChanged red;
  red.change.intensity = Rgb{100, 0, 0};
  take_by(red, tools), turn_to({0, -1, 0}, tools);
  EXPECT_EQ(tools.desk.now.lamps[0].light.intensity, (Rgb{100, 0, 0}));
  EXPECT_EQ(tools.desk.now.sky->setting.elevation_deg, 90);
}

TEST(SkySun, ThatComesUpAgainIsBright) {
  EditTools tools = tools_of_morning();
  turn_to(normalize(Vec3{-1, 0.5f, 0}), tools);
  EXPECT_EQ(max_component(tools.desk.now.lamps[0].light.intensity), 0);
  take_by(stands_at("90,30"), tools);
  EXPECT_THAT(what_differs(tools.desk.read->scene, scene_made_by(tools)), IsEmpty());
}

TEST(SkySun, OfASavedSceneIsLeftToTheOptionThatIsSaid) {
  EditTools tools = tools_of_morning();
  const auto lacks = [&] { return what_sky_lacks({tools.desk.read, tools.desk.now, {}}); };
  EXPECT_THAT(lacks(), IsEmpty());
  take_by(stands_at("200,12,4"), tools);
  EXPECT_TRUE(is_of_sky(0, *tools.desk.read, tools.desk.now));
  EXPECT_THAT(lacks(), HasSubstr("open it with --sky 200,12,4"));
  Lamp dim = tools.desk.now.lamps[0];
  dim.light.intensity = dim.light.intensity * 0.5f;
  do_edit(lamp_set(0, dim, std::nullopt, tools.desk), tools.desk);
  EXPECT_FALSE(is_of_sky(0, *tools.desk.read, tools.desk.now));
  EXPECT_THAT(lacks(), HasSubstr("only its sun"));
}

}  // namespace
}  // namespace luxel::view
