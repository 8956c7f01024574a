// Sums over a row of form factors, many columns of numbers at a time.
#pragma once

#include <cstdint>
#include <span>

#include "luxel/base/vectorize.h"

namespace luxel::matrix {

/// sum += sum_k factor_k rows_(column k), N times eight numbers of each row's `value`. To be called
/// by what has LUXEL_VECTOR_CLONES.
template <size_t N, class Row>
[[gnu::always_inline]] inline void add_products(std::span<const uint32_t> column,
                                                std::span<const float> factor, const Row* rows,
                                                Float8 (&sum)[N]) {
  for (size_t k = 0; k < column.size(); ++k) {
    const float f = factor[k];
    const float* x = rows[column[k]].value;
    for (size_t v = 0; v < N; ++v) {
      Float8 lanes;
      load8(x + v * 8, lanes);
      sum[v] += f * lanes;
    }
  }
}

}  // namespace luxel::matrix
