// The axes of a plot: which range it shows, and where the ticks stand.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace luxel::export_ {

struct Tick {
  double value = 0;
  std::string label;  ///< empty: a small tick between two labelled ones
};

/// From data to the interval [0, 1].
struct Axis {
  bool log = false;
  double low = 0, high = 1;
  std::vector<Tick> ticks;
  /// False: the axis has no place for the value at all.
  bool can_show(double value) const;
  double position(double value) const;
};

/// An axis for values between low and high. With `exact` it shows these and no more; otherwise it
/// is widened to round numbers.
Axis make_axis(double low, double high, bool log, bool exact);

}  // namespace luxel::export_
