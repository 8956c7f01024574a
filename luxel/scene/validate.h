// What every solver may rely on.
#pragma once

#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::scene {

/// Repairs what can be repaired, refuses what cannot. After success: there is at least one
/// triangle; all indices are in range; all numbers are finite; no triangle has zero area in the
/// world; reflectance is at most 0.99; normals, when present, are of unit length; unused meshes
/// stay. Returns one warning sentence for each kind of repair (zero-area triangles dropped and
/// counted, reflectance clamped with the material's name).
/// `file` is named in the messages. Errors: no triangles, NaN or infinite vertices, index out of
/// range (names mesh and triangle).
Result<std::vector<std::string>> validate(Scene& scene, const std::string& file);

/// Whether anything shines: emissive triangles, lights, background, environment.
bool has_light(const Scene& scene);

}  // namespace luxel::scene
