// Bytes of a .gltf file's buffers against what it says of them. For this room only.
#pragma once

#include "luxel/import/gltf_check_steps.h"
#include "luxel/import/scene_files.h"

namespace luxel::import {

/// Makes the byteLength of each buffer what its data URI or its file holds. A buffer
/// may be longer than it says [glTF 2.0, section 3.6.1.1], which tinygltf refuses; one that is too
/// short is refused later, with a sentence.
void state_true_lengths(Json& document, const SceneFiles& files);

}  // namespace luxel::import
