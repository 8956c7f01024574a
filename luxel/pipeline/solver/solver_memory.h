// How much memory solvers may take.
#pragma once

#include "luxel/pipeline/solver/solvers.h"

namespace luxel::pipeline {

/// A bake with less for what its solver stores (hits, rows) would only wait for the disk.
inline constexpr uint64_t kMinHitBytes = 16u << 20;

/// Whether anything that comes after rays looks at where the elements lie.
bool looks_at_places(const BakeSettings& settings);

/// What the process will hold besides stored hits, the scene and all that is there now included.
/// `layers` of light are told apart.
uint64_t bytes_besides_hits(const SolveInput& in, const BakeSettings& settings, size_t layers = 0);

/// How many bytes a solver may use beyond what it needs at least: by --max-memory, or by what is
/// free. Errors (out_of_memory): less than `spare`; says the smallest --max-memory that works.
Result<uint64_t> memory_to_spare(const SolveInput& in, const BakeSettings& settings, uint64_t spare,
                                 size_t layers = 0);

}  // namespace luxel::pipeline
