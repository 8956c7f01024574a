// How much memory solvers may take.
#pragma once

#include "luxel/light/texel_scene.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// A bake with less for what its solver stores (hits, rows) would only wait for the disk.
inline constexpr uint64_t kMinHitBytes = 16u << 20;

/// Whether anything that comes after rays looks at where the elements lie.
bool looks_at_places(const BakeSettings& settings);

/// Where texels and elements lie, of a bake that needs more memory than it may have; null: on the
/// heap.
const MappedMemory* mapped_memory_of(const light::TexelScene& in);

/// What a solver that gives light per texel leaves, and what it and the steps after it take, of
/// memory [bytes], besides what the process holds now and what the solver has of its own.
uint64_t bytes_of_light(const light::TexelScene& in, const BakeSettings& settings);

/// How many bytes a solver may store beyond `besides`, which it or what comes after it will hold
/// besides all that the process holds now: by --max-memory, or by what is free. Errors:
/// less than `spare` (out_of_memory; says the smallest --max-memory that works); the mapped memory
/// of texels has trouble.
Result<uint64_t> memory_to_spare(const light::TexelScene& in, const BakeSettings& settings,
                                 uint64_t besides, uint64_t spare);

}  // namespace luxel::pipeline
