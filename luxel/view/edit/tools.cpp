#include "luxel/view/edit/tools.h"

#include <algorithm>
#include <charconv>

#include "luxel/scene/light_kinds.h"
#include "luxel/scene/origin.h"
#include "luxel/view/edit/pick.h"
#include "luxel/view/edit/sky_sun.h"
#include "luxel/view/model/lamp_change.h"
#include "luxel/view/model/projection.h"

namespace luxel::view {
namespace {

constexpr float kClick = 4;  ///< so far the pointer may move in a click [pixels]

MarkedLamps marked_lamps(const EditTools& tools) {
  return {tools.desk.now.lamps, tools.bounds, tools.selected.lamp, std::nullopt};
}

const Lamp& selected_lamp(const EditTools& tools) {
  return tools.desk.now.lamps[*tools.selected.lamp];
}

/// Suns are taken in their sky.
Vec3 place_of_lamp(const EditTools& tools) {
  return place_of({*tools.selected.lamp, false}, selected_lamp(tools).light, tools.bounds);
}

void drag_lamp(Lamp lamp, EditTools& tools) {
  lamp.light.intensity = selected_lamp(tools).light.intensity;  // a sun's goes with its sky
  drag_edit(lamp_set(*tools.selected.lamp, lamp, std::nullopt, tools.desk), tools.desk);
}

/// The selected thing goes with its gizmo, from where it was.
void drag_grip(Vec2 pointer, const Walk& walk, EditTools& tools) {
  const auto& [gizmo, grip] = *tools.held;
  const Snap snap = walk.keys.contains("ctrl") ? snap_of(tools.bounds) : Snap{};
  const Mat34 by = dragged_by(gizmo, grip, tools.pointer_from, pointer, snap, walk);
  if (tools.selected.instance) {
    drag_edit(InstanceMoved{*tools.selected.instance, by * tools.placed_from}, tools.desk);
    return;
  }
  Lamp lamp = tools.lamp_from;
  if (gizmo.tool == Tool::turn) {
    lamp.light.direction = normalize(transform_vector(by, lamp.light.direction));
    lamp.light.side = normalize(transform_vector(by, lamp.light.side));
  } else {
    put_at({*tools.selected.lamp, false}, transform_point(by, gizmo.centre), tools.bounds,
           lamp.light);
  }
  drag_lamp(lamp, tools);
}

void drag_mark(Vec2 pointer, const Walk& walk, EditTools& tools) {
  Lamp lamp = tools.lamp_from;
  const Vec3 from = place_of(*tools.held_mark, lamp.light, tools.bounds);
  const Vec3 to = dragged(from, pointer - tools.pointer_from, std::nullopt, walk);
  put_at(*tools.held_mark, to, tools.bounds, lamp.light);
  drag_lamp(lamp, tools);
}

/// True while the pointer has hardly moved: nothing is dragged yet.
bool drag(Vec2 pointer, const Walk& walk, EditTools& tools) {
  const bool has_moved = length(pointer - tools.pointer_from) > kClick;
  if (tools.held)
    drag_grip(pointer, walk, tools);
  else if (tools.held_mark)
    drag_mark(pointer, walk, tools);
  else if (tools.may_be_click && has_moved)
    tools.may_be_click = false;
  return tools.may_be_click;
}

/// Remembers the selected lamp or instance as it is when it is taken hold of.
void hold(Vec2 pointer, EditTools& tools) {
  tools.pointer_from = pointer;
  if (tools.selected.lamp) tools.lamp_from = selected_lamp(tools);
  if (tools.selected.instance)
    tools.placed_from = tools.desk.now.world_from_object[*tools.selected.instance];
}

bool press_button(const Walk& walk, EditTools& tools) {
  if (walk.dragging) return false;
  if (const auto gizmo = gizmo_of(tools))
    if (const auto grip = grip_at(*gizmo, walk, walk.pointer)) {
      tools.held = {*gizmo, *grip};
      return hold(walk.pointer, tools), true;
    }
  if (tools.has_marks) tools.held_mark = handle_at(marked_lamps(tools), walk, walk.pointer);
  if (tools.held_mark) {
    select({.lamp = tools.held_mark->lamp}, tools);
    return hold(walk.pointer, tools), true;
  }
  tools.pointer_from = walk.pointer;
  tools.may_be_click = true;
  return false;
}

/// An instance first, then its materials.
void click(const Walk& walk, EditTools& tools) {
  const auto point =
      surface_seen_now(tools.desk, walk.shown, tools.pointer_from, walk.width, walk.height);
  if (!point) return select({}, tools);
  const scene::Scene& scene = tools.desk.read->scene;
  const uint32_t mesh = scene.instances[point->instance].mesh;
  const uint32_t material = scene.meshes[mesh].triangle_material[point->triangle];
  EditSelection selection{.instance = point->instance};
  if (tools.selected.instance == point->instance && tools.selected.material != material)
    selection.material = material;
  select(selection, tools);
}

/// True: it was no press of the walk's.
bool release_button(const Walk& walk, EditTools& tools) {
  const bool was_held = tools.held || tools.held_mark;
  tools.held.reset(), tools.held_mark.reset();
  if (was_held) end_drag(tools.desk);
  if (std::exchange(tools.may_be_click, false)) click(walk, tools);
  return was_held;
}

/// A drag that is let go of has not been.
void let_go(EditTools& tools) {
  const bool was_held = tools.held || tools.held_mark;
  tools.held.reset(), tools.held_mark.reset();
  if (!was_held) return select({}, tools);
  if (tools.desk.history.is_open) undo_step(tools);
}

void press_edit_key(const std::string& key, EditTools& tools) {
  if (key == "g") tools.tool = Tool::move;
  if (key == "r") tools.tool = Tool::turn;
  if (key == "t") tools.tool = Tool::scale;
  if (key == "esc") let_go(tools);
  if (key == "delete" && tools.selected.lamp) delete_lamp(*tools.selected.lamp, tools);
  if (key == "ctrl+z") undo_step(tools);
  if (key == "ctrl+shift+z" || key == "ctrl+y") redo_step(tools);
  if (key == "m") tools.has_marks = !tools.has_marks;
}

/// The first instance of a name, or of a number.
std::optional<uint32_t> instance_named(const std::string& name, const EditTools& tools) {
  const auto& instances = tools.desk.read->scene.instances;
  const auto is_it = [&](const scene::Instance& instance) { return instance.name == name; };
  const auto found = std::ranges::find_if(instances, is_it);
  if (found != instances.end()) return uint32_t(found - instances.begin());
  uint32_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  const bool is_number = error == std::errc() && end == name.data() + name.size();
  if (is_number && number < instances.size()) return number;
  return std::nullopt;
}

std::vector<uint32_t> materials_named(const std::string& name, const EditTools& tools) {
  std::vector<uint32_t> out;
  const auto& materials = tools.desk.read->scene.materials;
  for (uint32_t m = 0; m < materials.size(); ++m)
    if (materials[m].name == name) out.push_back(m);
  return out;
}

/// Does what an event asks of things that it names.
struct DoAsked {
  EditTools& tools;

  template <class Other>
  void operator()(const Other&) const {}
  void operator()(const InstanceSelected& event) const {
    if (event.instance.empty()) return select({}, tools);
    const auto instance = instance_named(event.instance, tools);
    instance ? select({.instance = instance}, tools) : refuse_instance(event.instance);
  }
  void operator()(const MaterialSelected& event) const {
    const std::vector<uint32_t> materials = materials_named(event.material, tools);
    if (materials.empty()) return refuse_material(event.material);
    select({.instance = tools.selected.instance, .material = materials[0]}, tools);
  }
  void operator()(const LampSelected& event) const {
    if (is_lamp(event.lamp)) select({.lamp = event.lamp}, tools);
  }
  void operator()(const InstanceChanged& event) const {
    const auto instance = instance_named(event.instance, tools);
    if (!instance) return refuse_instance(event.instance);
    const Mat34& now = tools.desk.now.world_from_object[*instance];
    const Vec3 middle = object_bounds(tools.desk.read->scene, *instance).centre();
    Placement to = placement_of(now, middle);
    if (event.to) to.place = scene::in_scene(tools.desk.read->scene, *event.to);
    to.scale = event.scale.value_or(to.scale);
    to.angles_deg = event.angles_deg.value_or(to.angles_deg);
    do_edit(InstanceMoved{*instance, placed(now, middle, to)}, tools.desk);
  }
  void operator()(const LampChanged& event) const {
    if (!is_lamp(event.lamp)) return;
    Lamp lamp = tools.desk.now.lamps[event.lamp];
    change(event.change, tools.desk.read->scene.origin, lamp);
    do_edit(lamp_set(event.lamp, lamp, event.change.sky, tools.desk), tools.desk);
  }
  void operator()(const LampAdded& event) const { add_lamp(event, tools); }
  void operator()(const LampRemoved& event) const {
    if (is_lamp(event.lamp)) delete_lamp(event.lamp, tools);
  }
  void operator()(const GlowChanged& event) const {
    (*this)(MaterialChanged{event.material, std::nullopt, event.radiance, std::nullopt});
  }
  void operator()(const MaterialChanged& event) const {
    const std::vector<uint32_t> materials = materials_named(event.material, tools);
    if (materials.empty()) return refuse_material(event.material);
    for (const uint32_t m : materials) {
      const MaterialLook& now = tools.desk.now.materials[m];
      do_edit(
          MaterialSet{m, event.base_color.value_or(now.base_color),
                      event.radiance.value_or(now.emission), event.metallic.value_or(now.metallic)},
          tools.desk);
    }
  }

 private:
  bool is_lamp(uint32_t lamp) const {
    const auto& lamps = tools.desk.now.lamps;
    const bool is_there = lamp < lamps.size() && !lamps[lamp].is_deleted;
    if (!is_there) tools.message = fmt::format("there is no lamp {}", lamp);
    return is_there;
  }
  void refuse_instance(const std::string& name) const {
    tools.message = fmt::format("the scene has nothing of the name '{}'", name);
  }
  void refuse_material(const std::string& name) const {
    tools.message = fmt::format("the scene has no material '{}'", name);
  }
};

/// Lets go of grips and marks, and deselects a lamp that a step back has taken away.
void tidy(EditTools& tools) {
  const auto& lamps = tools.desk.now.lamps;
  const auto& lamp = tools.selected.lamp;
  if (lamp && (*lamp >= lamps.size() || lamps[*lamp].is_deleted)) select({}, tools);
  tools.held.reset(), tools.held_mark.reset();
}

}  // namespace

EditTools begin_tools(std::shared_ptr<const ReadScene> read) {
  EditTools out;
  out.bounds = scene::world_bounds(read->scene);
  out.desk = begin_editing(std::move(read));
  return out;
}

bool handle_edits(const Event& event, const Walk& walk, EditTools& tools) {
  if (const auto* moved = std::get_if<PointerMoved>(&event)) return drag(moved->to, walk, tools);
  if (const auto* button = std::get_if<ButtonChanged>(&event)) {
    if (button->button != Button::left) return false;
    return button->is_down ? press_button(walk, tools) : release_button(walk, tools);
  }
  if (const auto* key = std::get_if<KeyChanged>(&event); key && key->is_down)
    press_edit_key(key->key, tools);
  std::visit(DoAsked{tools}, event);
  return false;
}

void select(const EditSelection& selection, EditTools& tools) {
  if (selection.instance && selection.instance != tools.selected.instance)
    tools.middle = object_bounds(tools.desk.read->scene, *selection.instance).centre();
  tools.selected = selection;
}

Placement placement_of(const EditTools& tools) {
  return placement_of(tools.desk.now.world_from_object[*tools.selected.instance], tools.middle);
}

Box3 selected_box(const EditTools& tools) {
  Box3 out;
  if (const auto i = tools.selected.instance) {
    const Box3 box = object_bounds(tools.desk.read->scene, *i);
    for (int k = 0; k < 8; ++k) {
      const Vec3 corner{k & 1 ? box.upper.x : box.lower.x, k & 2 ? box.upper.y : box.lower.y,
                        k & 4 ? box.upper.z : box.lower.z};
      out.extend(transform_point(tools.desk.now.world_from_object[*i], corner));
    }
  } else if (tools.selected.lamp && scene::has_position(selected_lamp(tools).light.kind)) {
    const Vec3 place = selected_lamp(tools).light.position;
    const Vec3 reach = (tools.bounds.upper - tools.bounds.lower) * 0.05f;
    out.extend(place - reach), out.extend(place + reach);
  }
  return out;
}

void undo_step(EditTools& tools) { undo(tools.desk), tidy(tools); }
void redo_step(EditTools& tools) { redo(tools.desk), tidy(tools); }

void add_lamp(const LampAdded& added, EditTools& tools) {
  const size_t before = tools.desk.now.lamps.size();
  do_edit(LampCreated{new_lamp(added, tools.bounds, tools.desk.read->scene.origin).light},
          tools.desk);
  if (tools.desk.now.lamps.size() > before) select({.lamp = uint32_t(before)}, tools);
}

void delete_lamp(uint32_t lamp, EditTools& tools) {
  do_edit(LampDeleted{lamp}, tools.desk);
  tidy(tools);
}

std::optional<Gizmo> gizmo_of(const EditTools& tools) {
  Gizmo out;
  out.tool = tools.tool;
  if (tools.selected.instance) {
    const Mat34& placed = tools.desk.now.world_from_object[*tools.selected.instance];
    out.centre = transform_point(placed, tools.middle);
    if (out.tool == Tool::scale) out.axes = turn_of(placed);
    return out;
  }
  if (!tools.selected.lamp || !tools.has_marks) return std::nullopt;
  out.centre = place_of_lamp(tools);
  const bool turns =
      out.tool == Tool::turn && scene::has_direction(selected_lamp(tools).light.kind);
  if (!turns) out.tool = Tool::move;
  return out;
}

std::vector<Mark> marks_of(const EditTools& tools, const Walk& walk) {
  std::vector<Mark> out;
  if (tools.has_marks) out = marks_of(marked_lamps(tools), walk);
  if (const auto gizmo = gizmo_of(tools)) {
    std::optional<Grip> lit = tools.held ? std::optional(tools.held->grip) : std::nullopt;
    if (!tools.held && !walk.dragging) lit = grip_at(*gizmo, walk, walk.pointer);
    const std::vector<Mark> marks = marks_of(*gizmo, lit, walk);
    out.insert(out.end(), marks.begin(), marks.end());
  }
  return out;
}

}  // namespace luxel::view
