// PNG files, compressed by all threads: strips of rows on their own, each with the end of the one
// before it as its dictionary, then put together as one stream. Strips do not depend on the number
// of threads, and so no byte of the file does.
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <string_view>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/image/codec.h"

namespace luxel::image {
namespace {

/// Bytes of a strip, about, and of what deflate looks back.
constexpr size_t kStripBytes = size_t(1) << 17, kWindowBytes = size_t(1) << 15;
/// zlib's. At 6 pictures take half as long again and more, and are 1 to 11 % smaller.
constexpr int kEffort = 4;

/// A row as filters see it: all bytes, and the bytes of the pixel to the left, of the row above and
/// of its pixel to the left; 0 outside of the picture.
struct FilterRow {
  std::span<const uint8_t> here, left, above, above_left;
};

/// A byte x after one of PNG's filters. (PNG specification, 9.2; the names are its own)
constexpr uint8_t kFilters = 5;
uint8_t left_by(uint8_t filter, int x, int a, int b, int c) {
  switch (filter) {
    case 0:
      return uint8_t(x);
    case 1:
      return uint8_t(x - a);
    case 2:
      return uint8_t(x - b);
    case 3:
      return uint8_t(x - (a + b) / 2);
    default:
      break;
  }
  const int pa = std::abs(b - c), pb = std::abs(a - c), pc = std::abs(a + b - 2 * c);
  return uint8_t(x - (pa <= pb && pa <= pc ? a : pb <= pc ? b : c));
}

template <uint8_t kFilter>
uint64_t filter_row(const FilterRow& row, std::span<uint8_t> out) {
  uint64_t sum = 0;
  for (size_t i = 0; i < out.size(); ++i) {
    out[i] = left_by(kFilter, row.here[i], row.left[i], row.above[i], row.above_left[i]);
    sum += uint64_t(std::abs(int(int8_t(out[i]))));
  }
  return sum;
}

/// Filters a row by the filter that leaves the least sum of absolute values, as the specification
/// advises (12.8). `out`: the filter's number and the row.
void filter_best(const FilterRow& row, std::span<uint8_t> scratch, std::span<uint8_t> out) {
  constexpr std::array<uint64_t (*)(const FilterRow&, std::span<uint8_t>), kFilters> kAll{
      filter_row<0>, filter_row<1>, filter_row<2>, filter_row<3>, filter_row<4>};
  uint64_t least = UINT64_MAX;
  for (uint8_t filter = 0; filter < kFilters; ++filter) {
    const uint64_t sum = kAll[filter](row, scratch);
    if (sum >= least) continue;
    least = sum, out[0] = filter;
    std::copy(scratch.begin(), scratch.end(), out.begin() + 1);
  }
}

/// The picture's rows filtered, each after its filter's number.
std::vector<uint8_t> filtered(const Image8& image, size_t rows_of_strip) {
  const size_t pixel = size_t(image.channels), row_bytes = size_t(image.width) * pixel;
  std::vector<uint8_t> out(size_t(image.height) * (1 + row_bytes));
  parallel_for(size_t(image.height), rows_of_strip, [&](size_t begin, size_t end) {
    // Rows after a pixel of zeros.
    std::vector<uint8_t> above(pixel + row_bytes), here(pixel + row_bytes), scratch(row_bytes);
    const auto read = [&](size_t y, std::vector<uint8_t>& row) {
      std::copy_n(image.data.begin() + long(y * row_bytes), row_bytes, row.begin() + long(pixel));
    };
    if (begin > 0) read(begin - 1, above);
    for (size_t y = begin; y < end; ++y, std::swap(above, here)) {
      read(y, here);
      const std::span<const uint8_t> h = here, a = above;
      filter_best({h.subspan(pixel), h.first(row_bytes), a.subspan(pixel), a.first(row_bytes)},
                  scratch, std::span(out).subspan(y * (1 + row_bytes), 1 + row_bytes));
    }
  });
  return out;
}

/// A part of a deflate stream that stands for bytes [begin, end) of `all`. (RFC 1951)
std::vector<uint8_t> deflated(std::span<const uint8_t> all, size_t begin, size_t end) {
  constexpr size_t kFlush = 16;  // bytes of the empty block that ends a part
  std::vector<uint8_t> out(compressBound(uLong(end - begin)) + kFlush);
  z_stream z{};
  constexpr int kRaw = -15, kMemory = 8;
  LUXEL_CHECK(deflateInit2(&z, kEffort, Z_DEFLATED, kRaw, kMemory, Z_FILTERED) == Z_OK);
  const size_t before = std::min(begin, kWindowBytes);
  if (before > 0) deflateSetDictionary(&z, all.data() + begin - before, uInt(before));
  z.next_in = const_cast<uint8_t*>(all.data()) + begin, z.avail_in = uInt(end - begin);
  z.next_out = out.data(), z.avail_out = uInt(out.size());
  const int done = deflate(&z, end == all.size() ? Z_FINISH : Z_SYNC_FLUSH);
  LUXEL_CHECK(done == (end == all.size() ? Z_STREAM_END : Z_OK) && z.avail_in == 0);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}

void append_number(uint32_t number, std::vector<uint8_t>& out) {
  for (const int shift : {24, 16, 8, 0}) out.push_back(uint8_t(number >> shift));
}

/// A zlib stream of all bytes. (RFC 1950)
std::vector<uint8_t> zipped(std::span<const uint8_t> all, size_t strip) {
  const size_t strips = (all.size() + strip - 1) / strip;
  std::vector<std::vector<uint8_t>> parts(strips);
  std::vector<uint32_t> sums(strips);
  const auto size_of = [&](size_t k) { return std::min(strip, all.size() - k * strip); };
  parallel_for(strips, 1, [&](size_t k, size_t) {
    parts[k] = deflated(all, k * strip, k * strip + size_of(k));
    sums[k] = uint32_t(adler32_z(1, all.data() + k * strip, size_of(k)));
  });
  std::vector<uint8_t> out{0x78, 0x5e};  // deflate, a window of 32 KiB, fast
  uint32_t sum = 1;
  for (size_t k = 0; k < strips; ++k) {
    out.insert(out.end(), parts[k].begin(), parts[k].end());
    sum = uint32_t(adler32_combine(sum, sums[k], z_off_t(size_of(k))));
  }
  append_number(sum, out);
  return out;
}

/// A chunk: length of its data, type (4 letters), data, CRC over type and data.
void append_chunk(std::string_view type, std::span<const uint8_t> data, std::vector<uint8_t>& out) {
  append_number(uint32_t(data.size()), out);
  const size_t begin = out.size();
  out.insert(out.end(), type.begin(), type.end());
  out.insert(out.end(), data.begin(), data.end());
  append_number(uint32_t(crc32_z(0, out.data() + begin, out.size() - begin)), out);
}

}  // namespace

std::vector<std::byte> encode_png(const Image8& image) {
  LUXEL_CHECK(image.width > 0 && image.height > 0);
  LUXEL_CHECK(image.channels >= 1 && image.channels <= 4);
  const size_t row_bytes = size_t(image.width) * size_t(image.channels);
  LUXEL_CHECK(image.data.size() == row_bytes * size_t(image.height));
  constexpr std::array<uint8_t, 5> kColorType{0, 0, 4, 2, 6};  // grey, with alpha, RGB, with alpha
  std::vector<uint8_t> header;
  append_number(uint32_t(image.width), header), append_number(uint32_t(image.height), header);
  const uint8_t color = kColorType[size_t(image.channels)];
  header.insert(header.end(), {8, color, 0, 0, 0});  // 8 bits; deflate, five filters, no interlace
  const size_t rows_of_strip = std::max<size_t>(1, kStripBytes / (1 + row_bytes));
  const std::vector<uint8_t> rows = filtered(image, rows_of_strip);

  std::vector<uint8_t> out{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  append_chunk("IHDR", header, out);
  // A chunk has less than 2^31 bytes; data may go on in the next.
  constexpr size_t kMostOfChunk = size_t(1) << 30;
  const std::vector<uint8_t> data = zipped(rows, rows_of_strip * (1 + row_bytes));
  for (size_t at = 0; at < data.size(); at += kMostOfChunk)
    append_chunk("IDAT", std::span(data).subspan(at, std::min(kMostOfChunk, data.size() - at)),
                 out);
  append_chunk("IEND", {}, out);
  const auto* bytes = reinterpret_cast<const std::byte*>(out.data());
  return {bytes, bytes + out.size()};
}

}  // namespace luxel::image
