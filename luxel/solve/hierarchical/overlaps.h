// Faces that the solver cannot do right by: on each other, or through each other.
#pragma once

#include <string>
#include <vector>

#include "luxel/solve/hierarchical/blockers.h"

namespace luxel::hierarchical {

/// Sentences for those who made the scene, by the names of instances: faces of one plane and side
/// that overlap (which one is seen is chance), and faces that pass through each other (what lies
/// inside is computed like the rest). A few are named, the others counted.
std::vector<std::string> overlap_warnings(const scene::Scene& scene, const Faces& faces,
                                          const Blockers& blockers);

}  // namespace luxel::hierarchical
