// The memory that solvers may take.
#pragma once

#include "luxel/light/texel_scene.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// A bake with less for what its solver stores (hits, rows) would only wait for the disk.
inline constexpr uint64_t kMinHitBytes = 16u << 20;

/// True: something that comes after rays looks at where the elements lie.
bool looks_at_places(const BakeSettings& settings);

/// Where texels and elements lie, of a bake that needs more memory than it may have; null: on the
/// heap.
const MappedMemory* mapped_memory_of(const light::TexelScene& in);

/// Memory [bytes] for the light per texel that a solver leaves, and for work on it by the solver
/// and the steps after it. It excludes all that the process holds now and the solver's own data.
uint64_t bytes_of_light(const light::TexelScene& in, const BakeSettings& settings);

/// The bytes that a solver may store: by --max-memory, or by free memory. `besides`: bytes that the
/// solver or later steps will hold as well, beyond all that the process holds now. Errors: less
/// than `spare` (out_of_memory; says the smallest --max-memory that works); the mapped memory of
/// texels has trouble.
Result<uint64_t> memory_to_spare(const light::TexelScene& in, const BakeSettings& settings,
                                 uint64_t besides, uint64_t spare);

}  // namespace luxel::pipeline
