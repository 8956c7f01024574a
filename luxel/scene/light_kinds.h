// Questions about a kind of punctual light: one switch per question and none with a default, so
// that the compiler (-Werror=switch) names each question that a new kind has to answer.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "luxel/scene/scene.h"

namespace luxel::scene {

using LightKind = PunctualLight::Kind;

/// False for a number that is no kind, as a damaged file may hold.
constexpr bool is_known(LightKind kind) {
  switch (kind) {
    case LightKind::point:
    case LightKind::spot:
    case LightKind::directional:
      return true;
  }
  return false;
}

/// The word for a kind in glTF [KHR_lights_punctual] and in light scripts.
constexpr std::string_view name_of(LightKind kind) {
  switch (kind) {
    case LightKind::point:
      return "point";
    case LightKind::spot:
      return "spot";
    case LightKind::directional:
      return "directional";
  }
  return {};
}

/// The kind that has this name; nothing where none has it.
constexpr std::optional<LightKind> kind_named(std::string_view name) {
  for (uint8_t k = 0; is_known(LightKind(k)); ++k)
    if (name_of(LightKind(k)) == name) return LightKind(k);
  return std::nullopt;
}

/// `position` counts: the light falls off with the distance from it, up to `range_m`. A light
/// without one comes from infinitely far away and is the same everywhere.
constexpr bool has_position(LightKind kind) {
  switch (kind) {
    case LightKind::point:
    case LightKind::spot:
      return true;
    case LightKind::directional:
      return false;
  }
  return false;
}

/// `direction` counts, even without a profile.
constexpr bool has_direction(LightKind kind) {
  switch (kind) {
    case LightKind::point:
      return false;
    case LightKind::spot:
    case LightKind::directional:
      return true;
  }
  return false;
}

/// The light stays within `outer_cone_rad` of its direction.
constexpr bool has_cone(LightKind kind) {
  switch (kind) {
    case LightKind::point:
    case LightKind::directional:
      return false;
    case LightKind::spot:
      return true;
  }
  return false;
}

/// Candela of a LightProfile can multiply the intensity.
constexpr bool can_have_profile(LightKind kind) {
  switch (kind) {
    case LightKind::point:
    case LightKind::spot:
      return true;
    case LightKind::directional:
      return false;
  }
  return false;
}

/// The light is seen as a disc of `angular_radius_rad`, so that its shadows have soft edges.
constexpr bool has_disc(const PunctualLight& light) {
  switch (light.kind) {
    case LightKind::point:
    case LightKind::spot:
      return false;
    case LightKind::directional:
      return light.angular_radius_rad > 0;
  }
  return false;
}

}  // namespace luxel::scene
