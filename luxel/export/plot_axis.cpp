#include "luxel/export/plot_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxel::export_ {
namespace {

/// 1, 2 or 5 times a power of ten: about a fifth of the range.
double nice_step(double range) {
  const double rough = range / 5, unit = std::pow(10, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (rough <= factor * unit * 1.0001) return factor * unit;
  return 10 * unit;
}

/// 10000 as it is, more and less as powers of ten.
std::string power_label(int exponent) {
  if (exponent >= -3 && exponent <= 4) return fmt::format("{:g}", std::pow(10.0, exponent));
  return fmt::format("1e{}", exponent);
}

void add_linear_ticks(Axis& axis, double step) {
  const double first = std::ceil(axis.low / step - 1e-9);
  const int count = int((axis.high - first * step) / step + 1e-9) + 1;
  for (int k = 0; k < count; ++k) {
    const double value = (first + k) * step;
    // 0.30000000000000004 is 0.3, and -0 is 0.
    axis.ticks.push_back({value, fmt::format("{:.6g}", value == 0 ? 0.0 : value)});
  }
}

/// Decades with their label; 2 .. 9 between them, of which 2 and 5 are labelled when there are few.
void add_log_ticks(Axis& axis) {
  const int from = int(std::floor(std::log10(axis.low) + 1e-9));
  const int to = int(std::ceil(std::log10(axis.high) - 1e-9));
  const int every = std::max(1, (to - from + 7) / 8);
  const bool few = axis.high <= 150 * axis.low;
  for (int e = from; e <= to; ++e)
    for (int m = 1; m <= 9; ++m) {
      const double value = m * std::pow(10.0, e);
      if (value < axis.low * 0.9999 || value > axis.high * 1.0001) continue;
      std::string label;
      if (m == 1 && (e - from) % every == 0) label = power_label(e);
      if (few && (m == 2 || m == 5)) label = fmt::format("{:.3g}", value);
      axis.ticks.push_back({value, label});
    }
}

Axis linear_axis(double low, double high, bool exact) {
  Axis axis;
  // Values that differ in their last digits only are one: ticks between them have no labels.
  if (!(high - low > 1e-9 * std::max(std::abs(low), std::abs(high)))) {
    const double around = low == 0 ? 1 : 0.5 * std::abs(low);
    low -= around, high += around;
  }
  const double step = nice_step(high - low);
  axis.low = exact ? low : std::floor(low / step + 1e-9) * step;
  axis.high = exact ? high : std::ceil(high / step - 1e-9) * step;
  add_linear_ticks(axis, step);
  return axis;
}

/// Down or up to the next of 1, 2, 5, 10.
double round_log(double value, bool up) {
  const double unit = std::pow(10, std::floor(std::log10(value) + 1e-9)), lead = value / unit;
  double best = up ? 10 : 1;
  for (const double m : {1.0, 2.0, 5.0, 10.0}) {
    if (up && m >= lead * 0.9999) best = std::min(best, m);
    if (!up && m <= lead * 1.0001) best = std::max(best, m);
  }
  return best * unit;
}

Axis log_axis(double low, double high, bool exact) {
  Axis axis;
  axis.log = true;
  if (!(high > low)) low /= 2, high *= 2;
  axis.low = exact ? low : round_log(low, false);
  axis.high = exact ? high : round_log(high, true);
  add_log_ticks(axis);
  return axis;
}

}  // namespace

bool Axis::can_show(double value) const { return std::isfinite(value) && (!log || value > 0); }

double Axis::position(double value) const {
  if (!log) return (value - low) / (high - low);
  return std::log(value / low) / std::log(high / low);
}

Axis make_axis(double low, double high, bool log, bool exact) {
  const bool usable = std::isfinite(low) && std::isfinite(high) && low <= high && (!log || low > 0);
  if (!usable) low = log ? 1 : 0, high = log ? 10 : 1;
  return log ? log_axis(low, high, exact) : linear_axis(low, high, exact);
}

}  // namespace luxel::export_
