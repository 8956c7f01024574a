#include "luxel/view/hemicube/hemicube_desk.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "luxel/view/model/projection.h"
#include "luxel/view/relight/lamp_desk.h"

namespace luxel::view {
namespace {

/// A click may shake by so much [pixels].
constexpr float kHemicubeClick = 4;

// Names of SettingChanged and OverlayChanged.
constexpr std::string_view kSize = "hemicube", kPauseAt = "pause_at";
constexpr std::string_view kReport = "vertex", kLitFaces = "lit";

std::optional<Technique> technique_named(std::string_view name,
                                         const char* TechniqueName::*member) {
  for (size_t i = 0; i < kTechniques.size(); ++i)
    if (name == kTechniques[i].*member) return Technique(i);
  return std::nullopt;
}

/// Faces in colours, faces in their light, none.
void next_faces(HemicubeDesk& desk) {
  if (!desk.has_report) {
    desk.has_report = true, desk.faces = Faces::items;
  } else if (desk.faces == Faces::items) {
    desk.faces = Faces::lit;
  } else {
    desk.has_report = false;
  }
}

bool take_hemicube_key(const KeyChanged& key, HemicubeDesk& desk) {
  const auto technique = technique_named(key.key, &TechniqueName::key);
  if (!technique && key.key != "i") return false;
  if (!key.is_down) return true;
  if (technique)
    desk.technique = *technique;
  else
    next_faces(desk);
  return true;
}

void choose_element(const Walk& walk, const LightMesh* mesh, HemicubeDesk& desk) {
  if (!mesh) return;
  const auto seen = surface_seen(mesh->in->scene, *mesh->in->tracer, walk.shown, walk.pointer,
                                 walk.width, walk.height);
  desk.element = seen ? std::optional(nearest_element(*mesh, *seen)) : std::nullopt;
  ++desk.asked;
}

/// The walk sees presses and releases, too: it turns the camera.
void take_hemicube_button(const ButtonChanged& button, const Walk& walk, const LightMesh* mesh,
                          HemicubeDesk& desk) {
  if (button.button != Button::left) return;
  if (button.is_down) {
    desk.pressed_at = walk.pointer;
    return;
  }
  if (std::exchange(desk.pressed_at, std::nullopt)) choose_element(walk, mesh, desk);
}

void change_setting(const SettingChanged& changed, HemicubeDesk& desk) {
  if (changed.name == kPauseAt) desk.pause_at = changed.to;
  if (changed.name != kSize) return;
  desk.resolution = hemicube_size(changed.to);
  ++desk.asked;
}

}  // namespace

int hemicube_size(double pixels) {
  return 2 * int(std::lround(std::clamp(pixels, 2.0, double(kMostPixels)) / 2));
}

bool handle_hemicube(const Event& event, const Walk& walk, const LightMesh* mesh,
                     HemicubeDesk& desk) {
  if (const auto* key = std::get_if<KeyChanged>(&event)) return take_hemicube_key(*key, desk);
  if (const auto* moved = std::get_if<PointerMoved>(&event)) {
    if (desk.pressed_at && length(moved->to - *desk.pressed_at) > kHemicubeClick)
      desk.pressed_at.reset();
    return false;
  }
  if (const auto* button = std::get_if<ButtonChanged>(&event)) {
    take_hemicube_button(*button, walk, mesh, desk);
    return false;
  }
  if (const auto* shown = std::get_if<OwnShown>(&event)) {
    desk.technique = technique_named(shown->name, &TechniqueName::name).value_or(desk.technique);
    return true;
  }
  if (const auto* changed = std::get_if<SettingChanged>(&event))
    return change_setting(*changed, desk), true;
  if (const auto* overlay = std::get_if<OverlayChanged>(&event)) {
    if (overlay->name == kReport) desk.has_report = overlay->is_on;
    if (overlay->name == kLitFaces) desk.faces = overlay->is_on ? Faces::lit : Faces::items;
    return true;
  }
  return false;
}

namespace {

/// Why an event is none of this workshop; nothing: it is one.
std::optional<std::string> wrong_with(const Event& event) {
  if (const auto* shown = std::get_if<OwnShown>(&event))
    if (!technique_named(shown->name, &TechniqueName::name))
      return "hemicube radiosity does not show '" + shown->name + "'";
  if (const auto* overlay = std::get_if<OverlayChanged>(&event))
    if (overlay->name != kReport && overlay->name != kLitFaces)
      return fmt::format("there is no overlay '{}'; choose from: {}, {}", overlay->name, kReport,
                         kLitFaces);
  if (const auto* asked = std::get_if<OwnAsked>(&event))
    return "hemicube radiosity cannot do '" + asked->name + "'";
  if (std::holds_alternative<ToolChanged>(event) || std::holds_alternative<ToolUsed>(event) ||
      std::holds_alternative<SelectionStepped>(event))
    return "hemicube radiosity has no tools; a click chooses a vertex";
  const auto* changed = std::get_if<SettingChanged>(&event);
  if (!changed) return std::nullopt;
  if (changed->name != kSize && changed->name != kPauseAt)
    return fmt::format("there is no setting '{}'; choose from: {}, {}", changed->name, kSize,
                       kPauseAt);
  if (changed->name == kSize && hemicube_size(changed->to) != changed->to)
    return fmt::format("a hemicube has an even number of pixels from 2 to {}, not {}", kMostPixels,
                       changed->to);
  return std::nullopt;
}

}  // namespace

Status check_hemicube(const Play& play, const std::string& name) {
  LUXEL_TRY_STATUS(check_no_lamps(play, name));
  for (const TimedEvent& timed : play.events)
    if (const auto wrong = wrong_with(timed.event))
      return fail(ErrorCode::bad_input, "{}, at {} s: {}", name, timed.at_s, *wrong);
  return {};
}

std::optional<double> first_pause(const Play& play) {
  for (const TimedEvent& timed : play.events) {
    const auto* changed = std::get_if<SettingChanged>(&timed.event);
    if (timed.at_s <= 0 && changed && changed->name == kPauseAt) return changed->to;
  }
  return std::nullopt;
}

std::optional<Mark> mark_of(const HemicubeDesk& desk, const LightMesh* mesh, const Walk& walk) {
  if (!desk.element || !mesh || *desk.element >= mesh->receivers.size()) return std::nullopt;
  const auto at = pixel_of(walk, mesh->receivers.elements.position[*desk.element]);
  if (!at) return std::nullopt;
  return Mark{*at, *at, 3, {1, 0.85f, 0.1f}, {0, 0, 0}, 1.5f};
}

}  // namespace luxel::view
