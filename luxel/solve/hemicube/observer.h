// Watches light arrive on the mesh, element by element.
#pragma once

#include <functional>
#include <span>

#include "luxel/solve/hemicube/field.h"
#include "luxel/solve/hemicube/look.h"

namespace luxel::hemicube {

struct Solution;

/// Callbacks of solve() while it works; empty ones are not called. Their arguments live during the
/// call only.
struct Observer {
  /// A mesh stands, with the light that its elements have by then; empty where they have none.
  std::function<void(const Field&)> on_mesh{};
  /// E per element straight from lights, before any element looks around [W/m^2].
  std::function<void(std::span<const Rgb>)> on_direct{};
  /// An element of the mesh has looked around. E without any reflection is `source`. Called from
  /// many threads, in no order.
  std::function<void(size_t element, Rgb source, const View&)> on_view{};
  /// E of all elements after one bounce more.
  std::function<void(std::span<const Rgb>)> on_bounce{};
  /// The end.
  std::function<void(const Solution&)> on_solved{};
};

}  // namespace luxel::hemicube
