#include "apps/view/lamp_session.h"

#include <algorithm>
#include <chrono>

#include "apps/view/lamp_lines.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/view/relight/save_lxr.h"

namespace luxel::view_window {
namespace {

constexpr size_t kHistory = 120;
constexpr view::LampCheckParams kCheck;

LampLine line_of(const view::Glow& glow) {
  LampLine out;
  out.name = glow.name, out.unit = "W/(sr m2)", out.is_on = glow.is_on;
  set_light(glow.radiance, out);
  return out;
}

/// The materials that can be chosen: those that glow now, or did when they were baked.
std::vector<uint32_t> glows_shown(const LampSession& session) {
  std::vector<uint32_t> out;
  for (uint32_t m = 0; m < session.desk.lamps.glows.size(); ++m)
    if (max_component(session.desk.lamps.glows[m].radiance) > 0 ||
        max_component(session.opened.lamps.glows[m].radiance) > 0)
      out.push_back(m);
  return out;
}

}  // namespace

LampSession begin_lamps(view::OpenedLxr opened, view::LampDrawing drawing) {
  view::LampDesk desk = view::begin_desk(opened.lamps, scene::world_bounds(opened.read->scene),
                                         opened.read->scene.origin);
  return LampSession{std::move(opened), std::move(drawing), std::move(desk)};
}

LampPanel panel_of(const LampSession& session) {
  LampPanel out;
  for (const view::Lamp& lamp : session.desk.lamps.lamps)
    out.lamps.push_back(line_of(lamp, false, session.desk.origin));
  for (const uint32_t m : glows_shown(session))
    out.glows.push_back(line_of(session.desk.lamps.glows[m]));
  out.selected = session.desk.selected ? int(*session.desk.selected) : -1;
  out.selected_glow = session.selected_glow;
  out.history = session.history;
  if (session.check) out.checked = std::max(0.0f, float(session.check->snapshot().share));
  out.found = session.found;
  if (!out.found.empty() && session.found_of != session.desk.changes)
    out.found = "Before the lamps changed: " + out.found;
  return out;
}

void take_changes(const LampPanel& panel, float exposure, LampSession& session) {
  const LampPanel before = panel_of(session);
  view::LampDesk& desk = session.desk;
  for (size_t i = 0; i < before.lamps.size(); ++i) {
    if (panel.lamps[i] == before.lamps[i]) continue;
    take_line(before.lamps[i], panel.lamps[i], desk.origin, desk.lamps.lamps[i]);
    ++desk.changes;
  }
  const std::vector<uint32_t> glows = glows_shown(session);
  for (size_t i = 0; i < glows.size(); ++i) {
    if (panel.glows[i] == before.glows[i]) continue;
    view::Glow& glow = desk.lamps.glows[glows[i]];
    glow.radiance = light_of(panel.glows[i]), glow.is_on = panel.glows[i].is_on;
    ++desk.changes;
  }
  desk.selected = panel.selected >= 0 ? std::optional(uint32_t(panel.selected)) : std::nullopt;
  session.selected_glow = panel.selected_glow;
  const auto add = [&](scene::LightKind kind) {
    view::add_lamp(lamp_to_add(kind, exposure, desk.bounds), desk);
  };
  if (panel.adds_point) add(scene::LightKind::point);
  if (panel.adds_spot) add(scene::LightKind::spot);
  if (panel.adds_sun) add(scene::LightKind::directional);
}

void begin_or_stop_check(LampSession& session) {
  if (session.check) {
    session.check.reset();
    return;
  }
  session.found_of = session.desk.changes;
  session.check = view::begin_lamp_check();
  session.check->ask(view::lamps_to_check(session.opened, session.desk.lamps, kCheck));
}

bool take_check(LampSession& session) {
  if (!session.check) return false;
  const std::vector<Result<pipeline::IndirectError>> found = session.check->take();
  if (found.empty()) return false;
  session.found = found[0] ? view::sentence_of(*found[0], kCheck) : found[0].error().message;
  session.check.reset();
  return true;
}

void begin_to_save_lxr(LampSession& session) {
  if (session.saving.valid()) return;
  view::LampsToSave to_save{session.opened.file, &session.opened.light.relighter.data(),
                            view::lamps_of(session.opened.light.relighter.data()),
                            session.desk.lamps};
  session.saving = std::async(std::launch::async, [to_save = std::move(to_save)] {
    return view::save_lxr(to_save).map([](const std::filesystem::path& file) {
      return fmt::format("wrote {}; `luxel-view {}` opens it", file.string(), file.string());
    });
  });
}

std::optional<Result<std::string>> take_saved(LampSession& session) {
  if (!session.saving.valid() ||
      session.saving.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return std::nullopt;
  return session.saving.get();
}

Result<view::LightTimes> light_lamps(gpu::Commands& commands, const view::Walk& walk,
                                     view::DeviceScene& scene, LampSession& session) {
  const trace::CameraRays eye(walk.shown.camera, walk.width, walk.height);
  const view::Lamps& lamps = session.desk.lamps;
  if (std::exchange(session.lit, session.desk.changes) != session.desk.changes)
    return view::follow_lamps(commands, lamps, &eye, session.opened, session.drawing, scene);
  view::LightTimes out;
  LUXEL_TRY(out.shadows, view::follow_eye(commands, lamps, eye, session.drawing, scene));
  return out;
}

void add_times(const view::LightTimes& light, float draw_ms, LampSession& session) {
  session.history.push_back({float(light.direct), float(light.bounces), float(light.places),
                             float(light.map), float(light.shadows), draw_ms});
  if (session.history.size() > kHistory) session.history.erase(session.history.begin());
}

}  // namespace luxel::view_window
