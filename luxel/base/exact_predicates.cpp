#include "luxel/base/exact_predicates.h"

// CGAL's kernel is under the LGPL, its triangulations under the GPL: include nothing else of it.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace luxel {
inline namespace base {
namespace {

using ExactPoint = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;
ExactPoint exact(DVec2 p) { return {p.x, p.y}; }

}  // namespace

int orientation(DVec2 a, DVec2 b, DVec2 c) {
  return CGAL::orientation(exact(a), exact(b), exact(c));
}

int in_circle(DVec2 a, DVec2 b, DVec2 c, DVec2 d) {
  return CGAL::side_of_oriented_circle(exact(a), exact(b), exact(c), exact(d));
}

}  // namespace base
}  // namespace luxel
