#include "apps/view/edit_session.h"

#include <algorithm>
#include <chrono>

#include "apps/view/lamp_lines.h"
#include "luxel/image/color.h"
#include "luxel/pipeline/settings/sky_setting.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/view/edit/save_scene.h"
#include "luxel/view/edit/sky_sun.h"

namespace luxel::view_window {
namespace {

int number_of(const std::optional<uint32_t>& chosen) { return chosen ? int(*chosen) : -1; }
std::optional<uint32_t> choice_of(int number) {
  return number >= 0 ? std::optional(uint32_t(number)) : std::nullopt;
}

template <class Parts>
std::vector<EditChoice> choices_of(const Parts& parts, const char* kind) {
  std::vector<EditChoice> out;
  for (size_t i = 0; i < parts.size(); ++i)
    out.push_back({parts[i].name.empty() ? fmt::format("{} {}", kind, i) : parts[i].name, int(i)});
  return out;
}

bool is_in_lux(const EditSession& session) { return session.tools.desk.read->light_unit == "lux"; }

PlaceLines lines_of(const view::Placement& placement, DVec3 origin) {
  return {numbers(placement.place, origin), numbers(placement.angles_deg),
          numbers(placement.scale)};
}

MaterialLine line_of(const scene::Material& material, const view::MaterialLook& now, bool is_lux) {
  MaterialLine out;
  const Rgb c = now.base_color;
  out.reflectance = {image::srgb_from_linear(c.x), image::srgb_from_linear(c.y),
                     image::srgb_from_linear(c.z)};
  out.has_texture = material.base_color_texture.texture != scene::kNone;
  out.metallic = now.metallic, out.has_metal = !material.unlit;
  const Rgb percent = c * (100 * (1 - now.metallic));
  out.reflects = fmt::format("{}{:.3g}, {:.3g}, {:.3g} % of red, green, blue",
                             out.has_texture ? "up to " : "", percent.x, percent.y, percent.z);
  out.glow.unit = is_lux ? "cd/m2" : "W/(sr m2)";
  set_light(now.emission, out.glow);
  return out;
}

/// Only what was changed, as take_line().
view::MaterialSet changed(uint32_t number, const MaterialLine& before, const MaterialLine& now,
                          const view::MaterialLook& look) {
  view::MaterialSet out{number, look.base_color, look.emission, look.metallic};
  const auto& c = now.reflectance;
  if (c != before.reflectance)
    out.base_color = {image::linear_from_srgb(c[0]), image::linear_from_srgb(c[1]),
                      image::linear_from_srgb(c[2])};
  if (now.metallic != before.metallic) out.metallic = now.metallic;
  if (now.glow != before.glow) out.emission = light_of(now.glow);
  return out;
}

void take_place(const EditPanel& panel, const EditPanel& before, view::EditTools& tools) {
  if (panel.place == before.place) return;
  view::Placement to = view::placement_of(tools);
  const auto take = [](const auto& now, const auto& was, Vec3& out) {
    if (now != was) out = vector(now);
  };
  if (panel.place.place != before.place.place)
    to.place = vector(panel.place.place, tools.desk.read->scene.origin);
  take(panel.place.angles_deg, before.place.angles_deg, to.angles_deg);
  take(panel.place.scale, before.place.scale, to.scale);
  const uint32_t instance = *tools.selected.instance;
  const Mat34& now = tools.desk.now.world_from_object[instance];
  drag_edit(view::InstanceMoved{instance, view::placed(now, tools.middle, to)}, tools.desk);
}

/// The sun of a panel's words, or why there is none.
void take_sun(const EditPanel& panel, EditSession& session) {
  view::EditTools& tools = session.tools;
  const auto sky = pipeline::parse_sky(panel.sun.data());
  if (!sky) {
    tools.message = "give the sun's AZIMUTH,ELEVATION in degrees, or TIME,LATITUDE,LONGITUDE";
    return;
  }
  view::Lamp lamp = tools.desk.now.lamps[*tools.selected.lamp];
  lamp.light.direction = -pipeline::sky_params(*sky).towards_sun;
  const view::SkyAsked asked{*sky, panel.sun.data()};
  do_edit(view::lamp_set(*tools.selected.lamp, lamp, asked, tools.desk), tools.desk);
}

/// Numbers of what is selected.
void take_numbers(const EditPanel& panel, const EditPanel& before, EditSession& session) {
  view::EditTools& tools = session.tools;
  const view::EditSelection& selected = tools.selected;
  if (selected.instance) take_place(panel, before, tools);
  if (selected.material && panel.look != before.look)
    drag_edit(changed(*selected.material, before.look, panel.look,
                      tools.desk.now.materials[*selected.material]),
              tools.desk);
  if (selected.lamp && panel.light != before.light) {
    view::Lamp lamp = tools.desk.now.lamps[*selected.lamp];
    take_line(before.light, panel.light, tools.desk.read->scene.origin, lamp);
    drag_edit(view::lamp_set(*selected.lamp, lamp, std::nullopt, tools.desk), tools.desk);
  }
  if (selected.lamp && panel.asks_for_sun) take_sun(panel, session);
  if (selected.lamp && panel.deletes_lamp) delete_lamp(*selected.lamp, tools);
}

void take_selection(const EditPanel& panel, const EditPanel& before, view::EditTools& tools) {
  if (panel.lamp != before.lamp) return select({.lamp = choice_of(panel.lamp)}, tools);
  if (panel.instance == before.instance && panel.material == before.material) return;
  const bool is_another = panel.instance != before.instance && panel.instance >= 0;
  select({.instance = choice_of(panel.instance),
          .material = is_another ? std::nullopt : choice_of(panel.material)},
         tools);
}

}  // namespace

EditSession begin_edits(std::shared_ptr<const view::ReadScene> read,
                        const pipeline::BakeSettings& settings) {
  EditSession out;
  out.instances = choices_of(read->scene.instances, "object");
  out.materials = choices_of(read->scene.materials, "material");
  out.tools = view::begin_tools(std::move(read));
  out.settings = settings;
  return out;
}

EditPanel panel_of(const EditSession& session) {
  const view::EditTools& tools = session.tools;
  const view::EditDesk& desk = tools.desk;
  const DVec3 origin = desk.read->scene.origin;
  EditPanel out;
  out.tools = view::kTools, out.tool = int(tools.tool);
  out.can_undo = !desk.history.done.empty(), out.can_redo = !desk.history.undone.empty();
  if (is_saving(session)) out.save_state = "the scene is being saved";
  out.instances = session.instances, out.materials = session.materials;
  for (size_t i = 0; i < desk.now.lamps.size(); ++i)
    if (const view::Lamp& lamp = desk.now.lamps[i]; !lamp.is_deleted)
      out.lamps.push_back(
          {line_of(lamp, false, origin).name + (lamp.is_on ? "" : " (off)"), int(i)});
  out.instance = number_of(tools.selected.instance);
  out.material = number_of(tools.selected.material), out.lamp = number_of(tools.selected.lamp);
  if (out.instance >= 0) out.place = lines_of(placement_of(tools), origin);
  if (const auto m = tools.selected.material)
    out.look = line_of(desk.read->scene.materials[*m], desk.now.materials[*m], is_in_lux(session));
  if (const auto lamp = tools.selected.lamp)
    out.light = line_of(desk.now.lamps[*lamp], is_in_lux(session), origin);
  out.sun = session.sun;
  return out;
}

std::vector<KeyLine> edit_keys() {
  std::vector<KeyLine> out{{"click", "select an object; click again for its material"},
                           {"left button on a handle", "move, turn, scale"}};
  for (const view::KeyHelp& key : view::kEditKeys) out.push_back({key.key, key.does});
  return out;
}

void take_changes(const EditPanel& panel, float exposure, EditSession& session) {
  const EditPanel before = panel_of(session);
  view::EditTools& tools = session.tools;
  tools.tool = view::Tool(panel.tool);
  session.sun = panel.sun;
  take_numbers(panel, before, session);
  if (!panel.is_held && !tools.held && !tools.held_mark) end_drag(tools.desk);
  take_selection(panel, before, tools);
  const auto add = [&](scene::LightKind kind) {
    add_lamp(lamp_to_add(kind, exposure, tools.bounds), tools);
  };
  if (panel.adds_point) add(scene::LightKind::point);
  if (panel.adds_spot) add(scene::LightKind::spot);
  if (panel.adds_sun) add(scene::LightKind::directional);
  if (panel.asks_to_undo) undo_step(tools);
  if (panel.asks_to_redo) redo_step(tools);
  if (panel.asks_to_save) save_edited(session);
}

void has_another(EditSession& session) { session.has_put = false; }

void show_edits(const view::Walk& walk, view::ShownScene& shown, view::Frame& frame,
                EditSession& session) {
  const view::EditDesk& desk = session.tools.desk;
  if (!session.has_put) {
    std::span<const uint32_t> of_layout;
    if (shown.lit) of_layout = shown.lit->material_of_scene;
    session.of_material = view::materials_as_read(desk.read->scene, shown.drawn(), of_layout);
  }
  if (!session.has_put || session.put != desk.changes)
    view::put_edits(desk.now, session.of_material, shown.device);
  session.has_put = true, session.put = desk.changes;
  frame.marks = view::marks_of(session.tools, walk);
  frame.outline = view::outline_of(session.tools.selected, session.of_material);
}

void save_edited(EditSession& session) {
  if (is_saving(session)) return;
  const view::EditDesk& desk = session.tools.desk;
  view::SceneToSave to_save{desk.read, desk.now, session.settings};
  session.saving = std::async(std::launch::async, [to_save = std::move(to_save)] {
    return view::save_scene(to_save).map([&](const std::filesystem::path& file) {
      return "wrote " + file.string() + view::what_sky_lacks(to_save);
    });
  });
}

bool is_saving(const EditSession& session) { return session.saving.valid(); }

std::string news_of(EditSession& session) {
  if (!session.tools.message.empty()) {
    if (session.failed.empty()) session.failed = session.tools.message;
    return std::exchange(session.tools.message, {});
  }
  if (!is_saving(session) ||
      session.saving.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return {};
  const Result<std::string> saved = session.saving.get();
  if (!saved && session.failed.empty()) session.failed = saved.error().message;
  if (saved) session.told = *saved;
  return saved ? *saved : saved.error().message;
}

Result<std::string> end_edits(EditSession& session) {
  if (is_saving(session)) session.saving.wait();
  while (!news_of(session).empty()) continue;
  if (!session.failed.empty()) return fail(ErrorCode::bad_input, "{}", session.failed);
  return session.told;
}

}  // namespace luxel::view_window
