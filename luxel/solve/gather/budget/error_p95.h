// The error that 95 of 100 elements stay below.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

namespace luxel::gather {

/// The error x that 95 % of elements stay below, if each errs normally with its standard error s:
///     mean over elements of P(|N(0, s)| > x) = 0.05.
/// It is 1.96 s where all are alike. The 95th percentile of s itself would be too small: half of
/// the elements that know their light worse than most still err by less than x, but so do some of
/// the others err by more. `counts` says which elements there are; empty: all. 0 where none errs.
float error_p95(std::span<const float> standard_errors,
                const std::function<bool(size_t)>& counts = {});

}  // namespace luxel::gather
