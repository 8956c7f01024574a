// Guarantees that every solver may rely on.
#pragma once

#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::scene {

/// Repairs what can be repaired, refuses what cannot. After success: there is at least one
/// triangle; all indices are in range; all numbers are finite; coordinates lie in the range that
/// single precision holds (held_range.h), in meshes and in the world; each triangle has a normal in
/// the world; reflectance is at most 0.99; normals, when present, are of unit length; unused meshes
/// stay. Returns one warning sentence for each kind of repair (zero-area triangles dropped and
/// counted, reflectance clamped with the material's name).
/// `file` is named in the messages. Errors: no triangles, or none left (says why), coordinates that
/// are not finite or too large (names mesh, vertex and value), index out of range (names mesh and
/// triangle), light that is too bright (check_brightness).
Result<std::vector<std::string>> validate(Scene& scene, const std::string& file);

/// Something shines besides surfaces: lights, background, environment.
bool has_lamp_or_sky(const Scene& scene);
/// Something shines: emissive triangles, lights, background, environment.
bool has_light(const Scene& scene);

}  // namespace luxel::scene
