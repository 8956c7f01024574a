// Lamps and light as lines of the panel, and back.
#pragma once

#include "apps/view/lamp_panel.h"
#include "luxel/view/lamp.h"
#include "luxel/view/model/events.h"

namespace luxel::view_window {

std::array<float, 3> numbers(Vec3 v);
Vec3 vector(const std::array<float, 3>& v);
/// A place of a scene of this origin in the world of its file, and back.
std::array<double, 3> numbers(Vec3 place, DVec3 origin);
Vec3 vector(const std::array<double, 3>& place, DVec3 origin);

/// Light as a colour and a strength, and back.
void set_light(Rgb light, LampLine& line);
Rgb light_of(const LampLine& line);

/// `is_lux`: intensities are in candela and lux, else in watts. `origin`: of the scene.
LampLine line_of(const view::Lamp& lamp, bool is_lux, DVec3 origin);
/// Only what was changed: other numbers are rounded on their way through the panel.
void take_line(const LampLine& before, const LampLine& now, DVec3 origin, view::Lamp& lamp);

/// A lamp more, so bright that a grey surface that faces it, from a quarter of the scene's size, is
/// shown half as bright as can be.
view::LampAdded lamp_to_add(scene::PunctualLight::Kind kind, float exposure, const Box3& bounds);

}  // namespace luxel::view_window
