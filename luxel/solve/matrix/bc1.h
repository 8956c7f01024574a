// The paper's own codec: a picture of the matrix, compressed as textures are.
// [Shcherbakov17, section 3.5]
//
// The largest entries of each row and channel are kept. The rest is divided by the channel's
// maximum; of that the natural logarithm, + 25, goes from 0..25 to 8 bits; rows and columns are put
// in an order in which neighbours are alike; and every 4 x 4 entries, red, green and blue, become
// one BC1 block of 8 bytes: half a byte per entry where floats take 12.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/solve/matrix/colour_matrix.h"
#include "luxel/solve/matrix/instructions.h"

namespace luxel::matrix {

/// The defaults are not all the paper's, but cost no more bytes or time: see paper_params().
struct Bc1Params {
  float kept = 0.04f;  ///< the part of each row and channel that is kept exact, [0, 1)
  /// e^-log_range of the maximum is the least that 8 bits tell from 0, up to 80 (the paper: 25).
  /// 0: as few as lose no row more than 0.2 % of what it sums to; steps are the finer.
  float log_range = 0;
  enum class Order { as_is, rows, rows_and_columns };
  Order order = Order::rows_and_columns;
  /// The value in the picture where an entry is kept: 0 (the paper), or the mean of the others in
  /// its block, which then keep their levels; then the difference is kept.
  enum class Hole { zero, neighbours };
  Hole hole = Hole::neighbours;
  /// Blocks make up for what those before them in their row lost, and each row and channel of the
  /// rest is scaled so that it adds up as it did (the paper does neither).
  bool keep_sums = true;
  /// Divides columns by their means first, so that patches of all sizes and colours look alike, and
  /// those that much light comes from are known as well as others (the paper does not).
  bool even_columns = true;
};

/// All as the paper says.
Bc1Params paper_params();

/// K = rest + kept. "Place" r of the rest is row `row[r]` of K, place c its column `column[c]`.
struct Bc1 {
  uint32_t n = 0;
  float log_range = 25.0f;  ///< as in Bc1Params; 25 is the paper's [Shcherbakov17, section 3.5]
  std::vector<uint32_t> row, column;  ///< permutations of 0..n-1
  /// Per place of a row: by how much the rest is scaled, the channel's maximum included.
  std::vector<Rgb> row_scale;
  std::vector<Rgb> column_scale;  ///< per place of a column: by how much what it sends is scaled
  /// 4 x 4 places each, block rows one after another, blocks_per_row() each, as Direct3D 10 defines
  /// BC1: 5:6:5 bits of colour 0 and 1, then 2 bits per entry. All in four-colour mode (colour 0 >
  /// colour 1), or of one colour.
  std::vector<uint64_t> blocks;
  /// Entries that one channel keeps all three keep: it costs 8 bytes once instead of 4 bytes each.
  struct Kept {
    std::array<uint16_t, 3> value{};  ///< halves, in units of kept_unit
    uint16_t place = 0;               ///< of the column
  };
  std::array<float, 3> kept_unit{};  ///< per channel
  std::vector<uint32_t> first_kept;  ///< per place of a row, one extra entry
  std::vector<Kept> kept;            ///< row by row, places ascending

  size_t size() const { return n; }
  size_t blocks_per_row() const { return (size_t(n) + 3) / 4; }
};

/// Columns have 16 bits.
inline constexpr uint32_t kMaxBc1Patches = 65536;

/// Takes a copy of the matrix to work on, which may be moved in. Errors: too many patches, a share
/// outside [0, 1), a range that cannot be, cancelled.
Result<Bc1> make_bc1(ColourMatrix matrix, Bc1Params params, Progress& progress);

/// True: a matrix from elsewhere may be multiplied. Looks at sizes, permutations, columns and
/// blocks' modes, and for numbers that are not finite.
bool is_valid(const Bc1& matrix);

/// Row `row[place]` of the matrix, its columns in K's order, straight from the definition of BC1.
void decode_row(const Bc1& matrix, size_t place, std::span<Rgb> out);

/// The 8 bits of an entry as a part of the maximum: 0 is 0.
float value_of_byte(uint32_t byte, float log_range);

/// Room for one product, and what blocks' colours mean.
struct Bc1Scratch {
  using Levels = std::array<float, 4>;  ///< the values of indices 0..3
  std::vector<Levels> five, six;        ///< of two ends of 5 (6) bits: end 0 + 32 (64) * end 1
  DenseScratch light;                   ///< by place
  std::vector<Levels> color;            ///< the same light, pixel by pixel
};
/// Allocates for one product at a time.
Bc1Scratch make_bc1_scratch(const Bc1& matrix);

/// E = K B. Allocates nothing. On AVX-512, AVX2 and any other processor the same bits.
void multiply(const Bc1& matrix, std::span<const Rgb> radiosity, std::span<Rgb> irradiance,
              Bc1Scratch& scratch);
/// By instructions that this processor has, for tests.
void multiply(const Bc1& matrix, std::span<const Rgb> radiosity, std::span<Rgb> irradiance,
              Bc1Scratch& scratch, Instructions instructions);

/// Bytes that the codec keeps.
uint64_t bytes_of(const Bc1& matrix);

}  // namespace luxel::matrix
