// The pairs of elements and clusters that are linked, each as coarsely as its error allows.
#pragma once

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/solve/hierarchical/link.h"

namespace luxel::hierarchical {

struct RefineParams {
  /// A link may be wrong by so much over its receiver [W/m^2].
  double eps = 0.1;
  /// Elements are not divided below this [m^2].
  double min_area_m2 = 0;
  size_t max_elements = 1u << 20, max_links = 1u << 25;
  /// True: a pair with a cluster that is too near for exchange between points gets guess_link(),
  /// where most_error_of is no more than eps. Else it is divided down to elements.
  bool guesses = false;
};

/// The links of a scene, kept with their receivers.
struct Links {
  std::vector<std::vector<Link>> of;  ///< per id of the tree
  size_t count = 0;
  size_t at_least_area = 0;  ///< links above eps whose elements are as small as may be
  bool bounded = false;      ///< max_elements or max_links ended the work
};

/// Everything that refinement changes.
struct Refined {
  const scene::Scene& scene;
  Tree& tree;
  Light& light;
  Links& links;
};

/// Reflectance and emission of an element: means over some of its points. It reflects nothing where
/// something much closer than itself covers all of it (transport::open_share): as a whole, it would
/// see the other side of the gap by a form factor of more than it has room for.
ElementLight bare_light(const scene::Scene& scene, const Exchange& exchange, const Element& e);

/// Links everything to everything, as coarsely as error_of allows by the light there is.
Status link_all(Refined& state, const Exchange& exchange, const RefineParams& params,
                Progress& progress);
/// Divides the links that have more error than eps by now. Returns how many did.
Result<size_t> refine(Refined& state, const Exchange& exchange, const RefineParams& params,
                      Progress& progress);
/// Divides a leaf. Its parts have its light, and reflectance and emission of their own.
void divide_element(Refined& state, const Exchange& exchange, size_t element);

}  // namespace luxel::hierarchical
