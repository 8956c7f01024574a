#include "luxel/view/edit/edits.h"

#include <cmath>
#include <utility>

#include "luxel/scene/brightness.h"
#include "luxel/scene/held_range.h"

namespace luxel::view {
namespace {

/// Axes of instances, over and under a metre: within them products of three are held.
constexpr float kLargestScale = 1e6f, kSmallestScale = 1e-6f;

bool is_light(Rgb c) { return min_component(c) >= 0 && max_component(c) <= scene::kBrightest; }

bool is_place(const Mat34& m) {
  for (int axis = 0; axis < 3; ++axis) {
    const float scale = length(column(m, axis));
    if (!(scale >= kSmallestScale && scale <= kLargestScale)) return false;
  }
  return scene::is_held(column(m, 3)) && std::abs(determinant(m)) > 0;
}

bool is_lamp(const scene::PunctualLight& light) {
  return is_light(light.intensity) && scene::is_held(light.position, scene::kFarthestLight_m) &&
         scene::has_unit_vector(light.direction) && light.inner_cone_rad >= 0 &&
         light.inner_cone_rad <= light.outer_cone_rad && light.outer_cone_rad <= kPi / 2 &&
         light.angular_radius_rad >= 0 && light.angular_radius_rad <= kPi / 2;
}

/// True where two edits change one thing, so that the later one says all that the earlier one did.
bool changes_the_same(const Edit& a, const Edit& b) {
  if (a.index() != b.index()) return false;
  if (const auto* moved = std::get_if<InstanceMoved>(&a))
    return moved->instance == std::get<InstanceMoved>(b).instance;
  if (const auto* set = std::get_if<LampSet>(&a)) return set->lamp == std::get<LampSet>(b).lamp;
  if (const auto* set = std::get_if<MaterialSet>(&a))
    return set->material == std::get<MaterialSet>(b).material;
  return false;
}

bool is_there(uint32_t lamp, const SceneNow& now) {
  return lamp < now.lamps.size() && !now.lamps[lamp].is_deleted;
}

struct CanBePut {
  const SceneNow& now;
  bool operator()(const InstanceMoved& edit) const {
    return edit.instance < now.world_from_object.size() && is_place(edit.world_from_object);
  }
  bool operator()(const LampSet& edit) const {
    return is_there(edit.lamp, now) && is_lamp(edit.light);
  }
  bool operator()(const LampCreated& edit) const { return is_lamp(edit.light); }
  bool operator()(const LampDeleted& edit) const { return is_there(edit.lamp, now); }
  bool operator()(const MaterialSet& edit) const {
    return edit.material < now.materials.size() && is_light(edit.base_color) &&
           is_light(edit.emission) && edit.metallic >= 0 && edit.metallic <= 1;
  }
};

struct Put {
  SceneNow& now;
  void operator()(const InstanceMoved& edit) const {
    now.world_from_object[edit.instance] = edit.world_from_object;
  }
  void operator()(const LampSet& edit) const {
    now.lamps[edit.lamp] = {edit.light, edit.is_on};
    if (edit.sky) now.sky = edit.sky;
  }
  void operator()(const LampCreated& edit) const { now.lamps.push_back({edit.light}); }
  void operator()(const LampDeleted& edit) const { now.lamps[edit.lamp].is_deleted = true; }
  void operator()(const MaterialSet& edit) const {
    now.materials[edit.material] = {edit.base_color, edit.emission, edit.metallic};
  }
};

}  // namespace

void do_edit(const Edit& edit, History& history) {
  end_drag(history);
  history.done.push_back(edit);
  history.undone.clear();
}

void drag_edit(const Edit& edit, History& history) {
  if (history.is_open && changes_the_same(edit, history.done.back()))
    history.done.back() = edit;
  else
    do_edit(edit, history);
  history.is_open = true;
}

void end_drag(History& history) { history.is_open = false; }

bool undo(History& history) {
  end_drag(history);
  if (history.done.empty()) return false;
  history.undone.push_back(std::move(history.done.back()));
  history.done.pop_back();
  return true;
}

bool redo(History& history) {
  end_drag(history);
  if (history.undone.empty()) return false;
  history.done.push_back(std::move(history.undone.back()));
  history.undone.pop_back();
  return true;
}

MaterialLook look_of(const scene::Material& material) {
  return {material.base_color, material.emission, material.metallic};
}

SceneNow unedited(const scene::Scene& as_read) {
  SceneNow out;
  for (const scene::Instance& instance : as_read.instances)
    out.world_from_object.push_back(instance.world_from_object);
  for (const scene::PunctualLight& light : as_read.lights) out.lamps.push_back({light});
  for (const scene::Material& material : as_read.materials)
    out.materials.push_back(look_of(material));
  return out;
}

SceneNow now_after(const scene::Scene& as_read, const History& history) {
  SceneNow out = unedited(as_read);
  for (const Edit& edit : history.done) put(edit, out);
  return out;
}

void put(const Edit& edit, SceneNow& now) { std::visit(Put{now}, edit); }

scene::Scene edited(const scene::Scene& as_read, const SceneNow& now) {
  scene::Scene out = as_read;
  for (size_t i = 0; i < out.instances.size(); ++i)
    out.instances[i].world_from_object = now.world_from_object[i];
  for (size_t m = 0; m < out.materials.size(); ++m) {
    out.materials[m].base_color = now.materials[m].base_color;
    out.materials[m].emission = now.materials[m].emission;
    out.materials[m].metallic = now.materials[m].metallic;
  }
  out.lights.clear();
  for (const EditedLamp& lamp : now.lamps) {
    out.lights.push_back(lamp.light);
    if (!lamp.is_on || lamp.is_deleted) out.lights.back().intensity = {};
  }
  if (now.sky) out.environment = scene::make_sky(pipeline::sky_params(now.sky->setting)).radiance;
  return out;
}

bool can_be_put(const Edit& edit, const SceneNow& now) { return std::visit(CanBePut{now}, edit); }

EditDesk begin_editing(std::shared_ptr<const ReadScene> read) {
  EditDesk out;
  out.now = unedited(read->scene);
  out.read = std::move(read);
  return out;
}

void do_edit(const Edit& edit, EditDesk& desk) {
  if (!can_be_put(edit, desk.now)) return;
  do_edit(edit, desk.history);
  put(edit, desk.now);
  ++desk.changes;
}

void drag_edit(const Edit& edit, EditDesk& desk) {
  if (!can_be_put(edit, desk.now)) return;
  drag_edit(edit, desk.history);
  put(edit, desk.now);
  ++desk.changes;
}

void end_drag(EditDesk& desk) { end_drag(desk.history); }

bool undo(EditDesk& desk) {
  if (!undo(desk.history)) return false;
  desk.now = now_after(desk.read->scene, desk.history);
  return ++desk.changes, true;
}

bool redo(EditDesk& desk) {
  if (!redo(desk.history)) return false;
  put(desk.history.done.back(), desk.now);
  return ++desk.changes, true;
}

}  // namespace luxel::view
