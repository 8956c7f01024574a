// Edits, and their undoing: a scene that was edited is the one that was read but for what was said.
#include "luxel/view/edit/edits.h"

#include <gmock/gmock.h>

#include <cstring>

#include "luxel/scene/digest.h"
#include "luxel/scene/procedural.h"

namespace luxel::view {
namespace {

using ::testing::IsEmpty;

std::shared_ptr<const ReadScene> cornell_read() {
  auto out = std::make_shared<ReadScene>();
  out->scene = scene::cornell_box();
  out->scene.lights.resize(2);
  out->scene.lights[1].kind = scene::PunctualLight::Kind::directional;
  return out;
}

scene::Scene scene_of(const EditDesk& desk) { return edited(desk.read->scene, desk.now); }

/// Differences between two scenes, but for names.
std::string difference(const scene::Scene& before, const scene::Scene& now) {
  return scene::difference(scene::digests_of(before), scene::digests_of(now));
}

scene::PunctualLight red_spot() {
  scene::PunctualLight out;
  out.kind = scene::PunctualLight::Kind::spot;
  out.intensity = {3, 1, 1}, out.position = {0.1f, 0.2f, 0.3f};
  return out;
}

/// One of each.
std::vector<Edit> all_kinds() {
  return {InstanceMoved{1, translation({0.1f, 0, 0.2f})},
          LampSet{0, red_spot(), true},
          LampSet{1, red_spot(), false},
          LampCreated{red_spot()},
          MaterialSet{0, {0.1f, 0.2f, 0.3f}, {5, 0, 0}, 0.25f},
          LampDeleted{0}};
}

TEST(Edits, EachChangesWhatItSaysAndNothingElse) {
  EditDesk desk = begin_editing(cornell_read());
  scene::Scene expected = desk.read->scene;
  for (const Edit& edit : all_kinds()) do_edit(edit, desk);
  expected.instances[1].world_from_object = translation({0.1f, 0, 0.2f});
  expected.lights = {red_spot(), red_spot(), red_spot()};
  expected.lights[0].intensity = expected.lights[1].intensity = {};  // deleted, and off
  expected.materials[0].base_color = {0.1f, 0.2f, 0.3f}, expected.materials[0].emission = {5, 0, 0};
  expected.materials[0].metallic = 0.25f;
  EXPECT_THAT(difference(expected, scene_of(desk)), IsEmpty());
  EXPECT_EQ(desk.changes, all_kinds().size());
}

TEST(Edits, UndoAndRedoGoThroughTheSameScenesBitByBit) {
  EditDesk desk = begin_editing(cornell_read());
  std::vector<scene::Scene> scenes{scene_of(desk)};
  for (const Edit& edit : all_kinds()) do_edit(edit, desk), scenes.push_back(scene_of(desk));
  for (size_t i = scenes.size() - 1; i > 0; --i) {
    EXPECT_THAT(difference(scenes[i], scene_of(desk)), IsEmpty()) << i;
    EXPECT_TRUE(undo(desk));
  }
  EXPECT_THAT(difference(scenes[0], scene_of(desk)), IsEmpty());
  EXPECT_FALSE(undo(desk)) << "there is nothing more";
  for (size_t i = 1; i < scenes.size(); ++i) {
    EXPECT_TRUE(redo(desk));
    EXPECT_THAT(difference(scenes[i], scene_of(desk)), IsEmpty()) << i;
  }
  EXPECT_FALSE(redo(desk));
}

TEST(Edits, ADragIsOneStep) {
  EditDesk desk = begin_editing(cornell_read());
  for (const float x : {0.1f, 0.2f, 0.3f})
    drag_edit(InstanceMoved{1, translation({x, 0, 0})}, desk);
  end_drag(desk);
  EXPECT_EQ(desk.now.world_from_object[1], translation({0.3f, 0, 0}));
  drag_edit(InstanceMoved{1, translation({0.4f, 0, 0})}, desk);
  EXPECT_EQ(desk.history.done.size(), 2u) << "the next drag is a step of its own";
  undo(desk);
  EXPECT_EQ(desk.now.world_from_object[1], translation({0.3f, 0, 0}));
  undo(desk);
  EXPECT_EQ(desk.now.world_from_object[1], desk.read->scene.instances[1].world_from_object);
}

TEST(Edits, ADragOfAnotherThingIsAStepOfItsOwn) {
  EditDesk desk = begin_editing(cornell_read());
  drag_edit(InstanceMoved{1, translation({0.1f, 0, 0})}, desk);
  drag_edit(InstanceMoved{2, translation({0.1f, 0, 0})}, desk);
  drag_edit(LampSet{0, red_spot()}, desk), drag_edit(LampSet{1, red_spot()}, desk);
  drag_edit(MaterialSet{0}, desk), drag_edit(MaterialSet{0, {0.5f, 0, 0}}, desk);
  EXPECT_EQ(desk.history.done.size(), 5u);
  while (undo(desk)) continue;
  EXPECT_THAT(difference(desk.read->scene, scene_of(desk)), IsEmpty());
}

TEST(Edits, WhatWasUndoneIsForgottenByTheNextEdit) {
  EditDesk desk = begin_editing(cornell_read());
  do_edit(LampDeleted{0}, desk), undo(desk);
  do_edit(LampDeleted{1}, desk);
  EXPECT_FALSE(redo(desk));
  EXPECT_FALSE(desk.now.lamps[0].is_deleted);
  EXPECT_TRUE(desk.now.lamps[1].is_deleted);
}

TEST(Edits, WhatASceneCannotHoldChangesNothing) {
  EditDesk desk = begin_editing(cornell_read());
  scene::PunctualLight dark = red_spot(), lost = red_spot(), wide = red_spot();
  dark.intensity.x = -1, lost.direction = {}, wide.outer_cone_rad = 2;
  for (const Edit& edit :
       std::vector<Edit>{InstanceMoved{99, {}}, InstanceMoved{0, scaling({1, 0, 1})},
                         InstanceMoved{0, translation({NAN, 0, 0})}, LampSet{2, red_spot()},
                         LampSet{0, dark}, LampSet{0, lost}, LampCreated{wide}, LampDeleted{7},
                         MaterialSet{99}, MaterialSet{0, {-1, 0, 0}},
                         MaterialSet{0, {}, {INFINITY, 0, 0}}, MaterialSet{0, {}, {}, 1.5f}})
    do_edit(edit, desk);
  EXPECT_EQ(desk.changes, 0u);
  EXPECT_TRUE(desk.history.done.empty());
  do_edit(LampDeleted{0}, desk), do_edit(LampSet{0, red_spot()}, desk);
  EXPECT_EQ(desk.changes, 1u) << "what is deleted is no more";
}

TEST(Edits, ThousandsOfStepsCanBeTakenBack) {
  EditDesk desk = begin_editing(cornell_read());
  for (int i = 0; i < 3000; ++i)
    do_edit(InstanceMoved{0, translation({0.001f * float(i), 0, 0})}, desk);
  while (undo(desk)) continue;
  EXPECT_THAT(difference(desk.read->scene, scene_of(desk)), IsEmpty());
}

}  // namespace
}  // namespace luxel::view
