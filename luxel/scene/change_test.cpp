#include "luxel/scene/change.h"

#include <gtest/gtest.h>

#include <functional>

#include "luxel/scene/shapes.h"

namespace luxel::scene {
namespace {

enum : uint32_t { paint, glow, glass, leaf, pane };

/// A room's worth of everything: a box, a lit box, a pane of glass, a leaf with holes and one more
/// pane that lets light through as KHR_materials_transmission has it; each an instance of its own.
Scene some_scene() {
  Scene s;
  s.textures = {{"grain", 2, 1, {10, 20, 30, 255, 50, 60, 70, 0}, {}, ""},
                {"spare", 1, 1, {1, 2, 3, 4}, {}, ""}};
  add_material(s, "paint", {0.5f, 0.5f, 0.5f});
  add_material(s, "glow", {0.5f, 0.5f, 0.5f}, {4, 2, 0});
  add_material(s, "glass", {0.9f, 0.5f, 0.5f});
  add_material(s, "leaf", {0.2f, 0.6f, 0.1f});
  add_material(s, "pane", {0.5f, 0.9f, 0.5f});
  s.materials[paint].base_color_texture.texture = 0;
  s.materials[glow].emission_texture.texture = 0;
  s.materials[glass].alpha_mode = AlphaMode::blend, s.materials[glass].alpha = 0.3f;
  s.materials[leaf].alpha_mode = AlphaMode::mask, s.materials[leaf].base_color_texture.texture = 0;
  s.materials[leaf].diffuse_transmission = 0.4f, s.materials[leaf].double_sided = true;
  s.materials[pane].transmission = 0.8f;
  for (uint32_t material = 0; material < s.materials.size(); ++material) {
    Mesh mesh;
    mesh.name = s.materials[material].name + " box";
    add_box(mesh, {0, 0, 0}, {1, 2, 3}, material);
    place(s, mesh, translation({10 * float(material), 0, 0}));
  }
  s.lights.resize(3);
  s.lights[0].name = "desk", s.lights[0].intensity = {4, 4, 8};
  s.lights[1].name = "off", s.lights[1].intensity = {};
  s.lights[2].name = "spot", s.lights[2].profile = 0;
  s.profiles = {{"down.ies", LightProfile::Angles::c, {0, 1}, {0}, {5, 6}}};
  s.cameras.resize(1);
  s.environment = {1, 1, {{1, 1, 1}}, 0};
  return s;
}

using Edit = std::function<void(Scene&)>;

SceneChange changed_by(const Edit& edit, const Edit& before_too = {}) {
  Scene before = some_scene();
  if (before_too) before_too(before);
  Scene now = before;
  edit(now);
  return change_between(state_of(before), state_of(now));
}

/// The change by an edit of one material.
SceneChange changed_in(uint32_t material, const std::function<void(Material&)>& edit) {
  return changed_by([&](Scene& s) { edit(s.materials[material]); });
}

std::string beyond(const Edit& edit) { return changed_by(edit).beyond; }

using Indices = std::vector<uint32_t>;
constexpr Rgb kOne{1, 1, 1};

/// That rays can meet something else in the box of this instance of some_scene(), nowhere else.
void expect_box_of(const SceneChange& change, uint32_t instance) {
  ASSERT_EQ(change.boxes.size(), 1u);
  EXPECT_EQ(change.boxes[0].lower, (Vec3{10 * float(instance), 0, 0}));
  EXPECT_EQ(change.boxes[0].upper, (Vec3{10 * float(instance) + 1, 2, 3}));
  EXPECT_TRUE(change.moved.empty());
}

TEST(SceneChange, OfTheSameSceneIsNone) {
  const SceneChange change = changed_by([](Scene&) {});
  EXPECT_FALSE(change.any());
  EXPECT_EQ(in_words(state_of(some_scene()), change), "");
  EXPECT_EQ(change.light_scale, std::vector<std::optional<Rgb>>(3, kOne));
  EXPECT_EQ(change.emission_scale, std::vector<std::optional<Rgb>>(5, kOne));
}

TEST(SceneChange, IsNotInNamesNorInWhatOnlyPicturesShow) {
  EXPECT_FALSE(changed_by([](Scene& s) {
                 s.name = "other", s.meshes[0].name = "m", s.instances[0].name = "i";
                 s.materials[0].name = "a", s.textures[0].name = "t", s.lights[0].name = "l";
                 s.profiles[0].name = "p", s.textures[0].mime_type = "image/png";
                 s.textures[0].encoded.resize(7);
               }).any());
  EXPECT_FALSE(changed_by([](Scene& s) { s.cameras.clear(); }).any());
  EXPECT_FALSE(changed_in(paint, [](Material& m) {
                 m.roughness = 0.1f, m.specular = {1, 1, 1}, m.sharpness = 3, m.unlit = true;
                 m.normal_texture.texture = 1, m.normal_scale = 2;
               }).any());
}

// Only values that are looked up count, not those that another setting would bring into use.
TEST(SceneChange, IsNotInWhatIsNotLookedUp) {
  EXPECT_FALSE(changed_in(paint, [](Material& m) {
                 m.alpha = 0.2f, m.alpha_cutoff = 0.1f;     // opaque
                 m.metallic_texture.texture = 1;            // no metal
                 m.transmission_texture.texture = 1;        // no transmission
                 m.diffuse_transmission_color = {0, 0, 1};  // none of it
               }).any());
  EXPECT_FALSE(changed_in(leaf, [](Material& m) {
                 m.diffuse_transmission_texture.offset.x = 1;  // without a texture
               }).any());
  // Pictures that nobody uses; another number for the same pixels.
  EXPECT_FALSE(changed_by([](Scene& s) { s.textures[1].rgba[0] = 99; }).any());
  EXPECT_FALSE(changed_by([](Scene& s) {
                 s.textures.push_back(s.textures[0]);
                 s.materials[paint].base_color_texture.texture = 2;
               }).any());
  // A map of the surroundings that is not there does not turn.
  EXPECT_FALSE(changed_by([](Scene& s) { s.environment.rotation_rad = 1; },
                          [](Scene& s) { s.environment = {}; })
                   .any());
  // Black stays black.
  EXPECT_FALSE(changed_in(paint, [](Material& m) { m.emission_texture.texture = 1; }).any());
  EXPECT_FALSE(changed_by([](Scene& s) { s.lights[1].position.x = 3; }).any());
}

TEST(SceneChange, SaysWhatCannotBeFollowedUp) {
  EXPECT_EQ(beyond([](Scene& s) { s.lights.resize(4); }), "3 lights there, 4 here");
  EXPECT_EQ(beyond([](Scene& s) { s.meshes.push_back(s.meshes[0]); }), "5 meshes there, 6 here");
  EXPECT_EQ(beyond([](Scene& s) { s.instances.pop_back(); }), "5 instances there, 4 here");
  EXPECT_EQ(beyond([](Scene& s) { s.materials.emplace_back(); }), "5 materials there, 6 here");
  EXPECT_EQ(beyond([](Scene& s) { s.meshes[1].positions[0].x = 0.1f; }),
            "mesh 'glow box' has changed");
  EXPECT_EQ(beyond([](Scene& s) { s.meshes[0].colors.resize(8); }), "mesh 'paint box' has changed");
  EXPECT_EQ(beyond([](Scene& s) { s.meshes[0].alphas.resize(8); }), "mesh 'paint box' has changed");
  EXPECT_EQ(beyond([](Scene& s) { s.meshes[0].triangle_material[3] = glow; }),
            "mesh 'paint box' has changed");
  EXPECT_EQ(beyond([](Scene& s) { s.instances[0].mesh = 1; }),
            "instance 'paint box' has another mesh");
  EXPECT_EQ(beyond([](Scene& s) { s.materials[paint].double_sided = true; }),
            "material 'paint' is double-sided now");
  EXPECT_EQ(beyond([](Scene& s) { s.materials[leaf].double_sided = false; }),
            "material 'leaf' is one-sided now");
  EXPECT_EQ(beyond([](Scene& s) { s.materials[paint].diffuse_transmission = 0.1f; }),
            "material 'paint' scatters light through now");
  EXPECT_EQ(beyond([](Scene& s) { s.materials[leaf].diffuse_transmission = 0; }),
            "material 'leaf' no longer scatters light through");
  const SceneChange change = changed_by([](Scene& s) { s.instances[4].name = "", s.lights = {}; });
  EXPECT_TRUE(change.any());
  EXPECT_EQ(in_words(state_of(some_scene()), change), "3 lights there, 0 here");
}

TEST(SceneChange, OfSizeCannotBeFollowedUp) {
  const auto after = [](const Mat34& m) {
    return beyond(
        [&](Scene& s) { s.instances[2].name = "", s.instances[2].world_from_object = m; });
  };
  EXPECT_EQ(after(scaling({1, 1.001f, 1})), "instance number 3 has another size");
  // The volume stays.
  EXPECT_EQ(after(scaling({2, 0.5f, 1})), "instance number 3 has another size");
  // The lengths of the axes stay, their angle does not.
  EXPECT_EQ(after(from_columns({1, 0, 0}, {0.6f, 0.8f, 0}, {0, 0, 1}, {})),
            "instance number 3 has another size");
  EXPECT_EQ(after(scaling({-1, 1, 1})), "instance number 3 is mirrored");
  // A turn by any angle, rounded to float, is none.
  for (const float angle : {0.1f, 1.0f, 2.5f}) {
    const float c = std::cos(angle), s = std::sin(angle);
    EXPECT_EQ(after(from_columns({c, s, 0}, {-s, c, 0}, {0, 0, 1}, {5, 6, 7})), "");
  }
}

TEST(SceneChange, MovedBoxIsWhereItWasAndWhereItIs) {
  const SceneChange change = changed_by([](Scene& s) {
    // A quarter turn: x to y, y to -x.
    s.instances[1].world_from_object = from_columns({0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 20, 0});
  });
  EXPECT_EQ(change.beyond, "");
  EXPECT_EQ(change.moved, Indices{1});
  ASSERT_EQ(change.boxes.size(), 2u);
  EXPECT_EQ(change.boxes[0].lower, (Vec3{10, 0, 0}));
  EXPECT_EQ(change.boxes[0].upper, (Vec3{11, 2, 3}));
  EXPECT_EQ(change.boxes[1].lower, (Vec3{-2, 20, 0}));
  EXPECT_EQ(change.boxes[1].upper, (Vec3{0, 21, 3}));
  EXPECT_TRUE(change.recoloured.empty());
  EXPECT_EQ(change.emission_scale[glow], kOne);  // its light is as strong, elsewhere
  EXPECT_EQ(in_words(state_of(some_scene()), change), "instance 'glow box' moved");
}

TEST(SceneChange, OfLampsIsAFactorOrNothing) {
  const auto scale = [](size_t light, const Edit& edit) {
    const SceneChange change = changed_by(edit);
    EXPECT_TRUE(change.boxes.empty());
    for (size_t i = 0; i < 3; ++i) {
      if (i != light) {
        EXPECT_EQ(change.light_scale[i], kOne);
      }
    }
    EXPECT_TRUE(change.any());
    return change.light_scale[light];
  };
  EXPECT_EQ(scale(0, [](Scene& s) { s.lights[0].intensity = {1, 2, 16}; }), (Rgb{0.25f, 0.5f, 2}));
  EXPECT_EQ(scale(0, [](Scene& s) { s.lights[0].intensity = {}; }), Rgb{});
  EXPECT_EQ(scale(1, [](Scene& s) { s.lights[1].intensity = {0, 0, 1}; }), std::nullopt);
  EXPECT_EQ(scale(0, [](Scene& s) { s.lights[0].position.y = 1; }), std::nullopt);
  EXPECT_EQ(scale(0, [](Scene& s) { s.lights[0].range_m = 1; }), std::nullopt);
  EXPECT_EQ(scale(0, [](Scene& s) { s.lights[0].kind = PunctualLight::Kind::directional; }),
            std::nullopt);
  EXPECT_EQ(scale(0, [](Scene& s) { s.lights[0].profile = 0; }), std::nullopt);
  EXPECT_EQ(scale(2, [](Scene& s) { s.profiles[0].candela[1] = 7; }), std::nullopt);
  // A profile under another number, with equal contents.
  EXPECT_FALSE(changed_by([](Scene& s) {
                 s.profiles.push_back(s.profiles[0]), s.lights[2].profile = 1;
               }).any());
}

TEST(SceneChange, OfADarkChannelIsNoneOrNothing) {
  const auto scale = [](Rgb now) {
    return changed_in(glow, [&](Material& m) { m.emission = now; }).emission_scale[glow];
  };
  EXPECT_EQ(scale({2, 6, 0}), (Rgb{0.5f, 3, 1}));  // from {4, 2, 0}
  EXPECT_EQ(scale({}), (Rgb{0, 0, 1}));
  EXPECT_EQ(scale({4, 2, 0.1f}), std::nullopt);
  // Beyond the range of float.
  EXPECT_EQ(changed_by(
                [](Scene& s) {
                  s.lights[0].intensity = {1e30f, 1, 1};
                },
                [](Scene& s) {
                  s.lights[0].intensity = {1e-30f, 1, 1};
                })
                .light_scale[0],
            std::nullopt);
}

TEST(SceneChange, OfWhereASurfaceEmitsIsNoFactor) {
  const auto scale = [](const std::function<void(Material&)>& edit) {
    return changed_in(glow, edit).emission_scale[glow];
  };
  EXPECT_EQ(scale([](Material& m) { m.emission_texture.texture = 1; }), std::nullopt);
  EXPECT_EQ(scale([](Material& m) { m.emission_texture.offset.x = 0.5f; }), std::nullopt);
  EXPECT_EQ(scale([](Material& m) { m.emission_texture.texture = kNone; }), std::nullopt);
  EXPECT_EQ(scale([](Material& m) { m.alpha_mode = AlphaMode::blend; }), std::nullopt);
  // Its alpha is not looked up; its pixels are those of the paint as well.
  EXPECT_EQ(changed_by([](Scene& s) { s.textures[0].rgba[3] = 9; }).emission_scale[glow], kOne);
  EXPECT_EQ(changed_by([](Scene& s) { s.textures[0].rgba[0] = 9; }).emission_scale[glow],
            std::nullopt);
}

TEST(SceneChange, OfPaintIsAnotherColour) {
  const auto expect = [](const SceneChange& change) {
    EXPECT_EQ(change.beyond, "");
    EXPECT_EQ(change.recoloured, Indices{paint});
    EXPECT_TRUE(change.boxes.empty() && change.reshaped.empty());
  };
  expect(changed_in(paint, [](Material& m) { m.base_color.y = 0.6f; }));
  expect(changed_in(paint, [](Material& m) { m.metallic = 0.5f; }));
  expect(changed_in(paint, [](Material& m) { m.base_color_texture.rotation = 1; }));
  expect(changed_in(paint, [](Material& m) { m.base_color_texture.texture = kNone; }));
  const SceneChange green = changed_by([](Scene& s) { s.textures[0].rgba[1] = 99; });
  EXPECT_EQ(green.recoloured, (Indices{paint, leaf}));
  EXPECT_TRUE(green.boxes.empty());  // the leaf's holes are in alpha
  EXPECT_EQ(changed_in(leaf, [](Material& m) { m.diffuse_transmission = 0.5f; }).recoloured,
            Indices{leaf});
  EXPECT_EQ(changed_in(leaf, [](Material& m) { m.diffuse_transmission_color.x = 0; }).recoloured,
            Indices{leaf});
}

TEST(SceneChange, OfWhatLightPassesIsAnotherShape) {
  // Glass tints: its colour is both.
  for (const uint32_t material : {glass, pane}) {
    const SceneChange change = changed_in(material, [](Material& m) { m.base_color.z = 0.1f; });
    expect_box_of(change, material);
    EXPECT_EQ(change.reshaped, Indices{material});
    EXPECT_EQ(change.recoloured, Indices{material});
  }
  const auto expect_shape = [](uint32_t material, const std::function<void(Material&)>& edit) {
    const SceneChange change = changed_in(material, edit);
    expect_box_of(change, material);
    EXPECT_EQ(change.reshaped, Indices{material});
    EXPECT_TRUE(change.recoloured.empty());
  };
  expect_shape(glass, [](Material& m) { m.alpha = 0.4f; });
  expect_shape(paint, [](Material& m) { m.alpha_mode = AlphaMode::mask; });
  expect_shape(paint, [](Material& m) { m.transmission = 0.1f; });
  expect_shape(pane, [](Material& m) { m.transmission = 0.7f; });
  expect_shape(pane, [](Material& m) { m.transmission_texture.texture = 0; });
  expect_shape(leaf, [](Material& m) { m.alpha_cutoff = 0.9f; });
  expect_box_of(changed_in(pane, [](Material& m) { m.metallic = 0.5f; }), pane);
  // A hole more, in a texture whose colours stay.
  const SceneChange hole = changed_by([](Scene& s) { s.textures[0].rgba[3] = 0; });
  expect_box_of(hole, leaf);
  EXPECT_TRUE(hole.recoloured.empty());
  // The colour of a surface with holes is no shape.
  EXPECT_TRUE(changed_in(leaf, [](Material& m) { m.base_color.x = 0; }).boxes.empty());
}

TEST(SceneChange, OfGlassThatMovedHasTwoBoxes) {
  const SceneChange change = changed_by([](Scene& s) {
    s.materials[glass].alpha = 0.5f;
    s.instances[glass].world_from_object = translation({0, 50, 0});
  });
  ASSERT_EQ(change.boxes.size(), 2u);
  EXPECT_EQ(change.boxes[0].lower, (Vec3{20, 0, 0}));
  EXPECT_EQ(change.boxes[1].lower, (Vec3{0, 50, 0}));
}

TEST(SceneChange, KnowsTheSurroundings) {
  const auto expect = [](const SceneChange& change) {
    EXPECT_TRUE(change.surroundings && change.any() && change.beyond.empty());
  };
  expect(changed_by([](Scene& s) { s.background = {0, 0, 1}; }));
  expect(changed_by([](Scene& s) { s.environment.rotation_rad = 1; }));
  expect(changed_by([](Scene& s) { s.environment.radiance[0].x = 2; }));
  expect(changed_by([](Scene& s) { s.environment = {}; }));
}

// A state out of a file need not know which material is on which mesh.
TEST(SceneChange, AsksOnlyTheNewStateForMaterialsOfMeshes) {
  Scene scene = some_scene();
  SceneState before = state_of(scene);
  before.mesh_materials.clear();
  scene.materials[glass].alpha = 0.9f;
  expect_box_of(change_between(before, state_of(scene)), glass);
}

TEST(SceneChange, IsSaidInWords) {
  const Scene before = some_scene();
  Scene now = before;
  now.instances[0].world_from_object = translation({1, 0, 0});
  now.lights[0].position.x = 1, now.lights[2].intensity = {2, 2, 2}, now.lights[2].name = "";
  const auto words = [&] {
    const SceneState state = state_of(now);
    return in_words(state, change_between(state_of(before), state));
  };
  EXPECT_EQ(words(),
            "instance 'paint box' moved, light 'desk' shines otherwise, light number 3 has another "
            "intensity");
  now.materials[glass].alpha = 0.9f, now.materials[paint].base_color = {};
  now.background = {1, 1, 1};
  EXPECT_EQ(words(),
            "instance 'paint box' moved, material 'glass' transmits light differently, material "
            "'paint' has another colour, light 'desk' shines otherwise and 2 more");
}

}  // namespace
}  // namespace luxel::scene
