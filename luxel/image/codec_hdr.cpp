// Radiance pictures (.hdr): a text header, then pixels of three mantissas and a shared exponent,
// flat or run-length encoded in one of two ways. [Ward91]
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>

#include "luxel/base/check.h"
#include "luxel/image/codec.h"
#include "luxel/image/rgbe.h"

namespace luxel::image {
namespace {

using Bytes = std::span<const uint8_t>;

/// A broken header may claim any size: this many pixels (16384 squared) are the most we believe.
constexpr uint64_t kCodecHdrMaxPixels = uint64_t(1) << 28;
constexpr size_t kMaxHdrSide = 65536;
/// Widths for which the newer run-length code exists.
constexpr size_t kMinRunWidth = 8, kMaxRunWidth = 32767;

struct Header {
  std::array<char, 2> axis{}, sign{};    ///< of scan lines, then of pixels in a scan line
  std::array<size_t, 2> count{};         ///< scan lines, pixels in one
  std::array<double, 3> scale{1, 1, 1};  ///< EXPOSURE and COLORCORR: what pixels were scaled by
};

/// The bytes of the file, taken from the front.
struct Reader {
  Bytes rest;
  std::string_view name;
};

Failure ends_early(std::string_view name) {
  return fail(ErrorCode::bad_input, "{}: the HDR file ends too early; fetch or save it again",
              name);
}

Result<std::string_view> take_line(Reader& in) {
  const void* end = in.rest.empty() ? nullptr : std::memchr(in.rest.data(), '\n', in.rest.size());
  if (end == nullptr) return ends_early(in.name);
  const size_t length = size_t(static_cast<const uint8_t*>(end) - in.rest.data());
  std::string_view text(reinterpret_cast<const char*>(in.rest.data()), length);
  in.rest = in.rest.subspan(length + 1);
  if (text.ends_with('\r')) text.remove_suffix(1);
  return text;
}

std::string_view without_blanks(std::string_view text) {
  while (text.starts_with(' ') || text.starts_with('\t')) text.remove_prefix(1);
  return text;
}

/// Takes a number from the front of `text`.
template <class T>
bool take_number(std::string_view& text, T& value) {
  text = without_blanks(text);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return false;
  text.remove_prefix(size_t(end - text.data()));
  return true;
}

/// EXPOSURE=f and COLORCORR=r g b may stand several times: they multiply.
Status read_scale(std::string_view line, std::string_view name, Header& header) {
  const bool exposure = line.starts_with("EXPOSURE=");
  if (!exposure && !line.starts_with("COLORCORR=")) return {};
  std::string_view numbers = line.substr(line.find('=') + 1);
  double factor = 0;
  for (size_t c = 0; c < 3; ++c) {
    const bool found = (exposure && c > 0) || take_number(numbers, factor);
    if (!found || !(factor > 0) || !std::isfinite(factor))
      return fail(ErrorCode::bad_input,
                  "{}: the line '{}' of the HDR file does not hold positive numbers", name, line);
    header.scale[c] *= factor;
  }
  return {};
}

/// "-Y 480 +X 640": 480 scan lines from the top, 640 pixels in each from the left.
bool parse_resolution(std::string_view line, Header& header) {
  for (size_t i = 0; i < 2; ++i) {
    line = without_blanks(line);
    if (line.size() < 2) return false;
    header.sign[i] = line[0], header.axis[i] = line[1];
    line.remove_prefix(2);
    if ((header.sign[i] != '+' && header.sign[i] != '-') || !take_number(line, header.count[i]))
      return false;
  }
  const bool both = (header.axis[0] == 'X' && header.axis[1] == 'Y') ||
                    (header.axis[0] == 'Y' && header.axis[1] == 'X');
  return both && header.count[0] > 0 && header.count[1] > 0;
}

Result<Header> read_header(Reader& in) {
  Header header;
  // Lines of text up to an empty one: format, exposure, colour correction.
  LUXEL_TRY(const std::string_view magic, take_line(in));
  if (!magic.starts_with("#?"))
    return fail(ErrorCode::bad_input, "{}: this is not a Radiance HDR file", in.name);
  for (;;) {
    LUXEL_TRY(const std::string_view line, take_line(in));
    if (line.empty()) break;
    if (line.starts_with("FORMAT=") && line.find("32-bit_rle_rgbe") == std::string_view::npos)
      return fail(ErrorCode::unsupported, "{}: the HDR file has {}; convert it to 32-bit_rle_rgbe",
                  in.name, line);
    LUXEL_TRY_STATUS(read_scale(line, in.name, header));
  }
  // The line of the size, and whether it can be.
  LUXEL_TRY(const std::string_view line, take_line(in));
  if (!parse_resolution(line, header))
    return fail(ErrorCode::bad_input,
                "{}: the HDR file has '{}' where its size should stand, as in '-Y 480 +X 640'",
                in.name, line);
  const auto [lines, width] = header.count;
  if (lines > kMaxHdrSide || width > kMaxHdrSide || lines * width > kCodecHdrMaxPixels)
    return fail(ErrorCode::bad_input,
                "{}: the HDR file claims {} x {} pixels; the most is {}, and {} a side", in.name,
                width, lines, kCodecHdrMaxPixels, kMaxHdrSide);
  return header;
}

/// The newer code: the four components one after the other, each as runs (count above 128, then the
/// byte) and dumps (count, then the bytes).
Status read_new_runs(Reader& in, std::span<Rgbe> line) {
  for (size_t component = 0; component < 4; ++component)
    for (size_t x = 0; x < line.size();) {
      if (in.rest.size() < 2) return ends_early(in.name);
      const bool run = in.rest[0] > 128;
      const size_t count = run ? in.rest[0] - 128u : in.rest[0];
      if (count == 0 || count > line.size() - x)
        return fail(ErrorCode::bad_input,
                    "{}: the HDR file is damaged: a run of {} pixels where {} are left in the line",
                    in.name, count, line.size() - x);
      const size_t used = 1 + (run ? 1 : count);
      if (in.rest.size() < used) return ends_early(in.name);
      for (size_t i = 0; i < count; ++i) line[x + i][component] = in.rest[run ? 1 : 1 + i];
      in.rest = in.rest.subspan(used);
      x += count;
    }
  return {};
}

/// Flat pixels, and the older code among them: (1, 1, 1, n) repeats the pixel before it n times;
/// the next such code in a row counts n 256, and so on.
Status read_old_runs(Reader& in, std::span<Rgbe> line) {
  size_t unit = 1;
  for (size_t x = 0; x < line.size();) {
    if (in.rest.size() < 4) return ends_early(in.name);
    const Rgbe pixel{in.rest[0], in.rest[1], in.rest[2], in.rest[3]};
    in.rest = in.rest.subspan(4);
    if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
      line[x++] = pixel;
      unit = 1;
      continue;
    }
    const size_t count = pixel[3] * unit;
    if (x == 0 || count > line.size() - x)
      return fail(ErrorCode::bad_input,
                  "{}: the HDR file is damaged: {} repeated pixels where {} are left in the line",
                  in.name, count, line.size() - x);
    for (size_t i = 0; i < count; ++i, ++x) line[x] = line[x - 1];
    if (unit > kCodecHdrMaxPixels) unit = kCodecHdrMaxPixels;  // only empty runs get here
    unit *= 256;
  }
  return {};
}

Status read_scan_line(Reader& in, std::span<Rgbe> line) {
  const size_t width = line.size();
  const Bytes head = in.rest.first(std::min<size_t>(4, in.rest.size()));
  const bool has_new_runs = width >= kMinRunWidth && width <= kMaxRunWidth && head.size() == 4 &&
                            head[0] == 2 && head[1] == 2 &&
                            size_t(head[2]) * 256 + head[3] == width;
  if (!has_new_runs) return read_old_runs(in, line);
  in.rest = in.rest.subspan(4);
  return read_new_runs(in, line);
}

/// Puts pixel j of scan line i where it is seen: +X from the left, -Y from the top.
void place(Image& image, const Header& header, size_t i, size_t j, const Rgbe& p) {
  std::array<size_t, 2> from_start{i, j};
  size_t x = 0, y = 0;
  for (size_t k = 0; k < 2; ++k) {
    const bool forward = header.axis[k] == 'X' ? header.sign[k] == '+' : header.sign[k] == '-';
    const size_t at = forward ? from_start[k] : header.count[k] - 1 - from_start[k];
    (header.axis[k] == 'X' ? x : y) = at;
  }
  const std::array<double, 3> color = from_rgbe(p);
  float* out = image.at(int(x), int(y));
  for (size_t c = 0; c < 3; ++c) out[c] = float(color[c] / header.scale[c]);
}

/// One component of a scan line: runs of at least 4 equal bytes, dumps between them.
void append_runs(std::span<const Rgbe> line, size_t component, std::string& out) {
  const auto run_at = [&](size_t x) {
    size_t n = 1;
    while (x + n < line.size() && n < 127 && line[x + n][component] == line[x][component]) ++n;
    return n;
  };
  for (size_t x = 0; x < line.size();) {
    if (const size_t run = run_at(x); run >= 4) {
      out += {char(uint8_t(128 + run)), char(line[x][component])};
      x += run;
      continue;
    }
    size_t end = x + 1;
    while (end < line.size() && end - x < 128 && run_at(end) < 4) ++end;
    out += char(uint8_t(end - x));
    for (; x < end; ++x) out += char(line[x][component]);
  }
}

void append_scan_line(std::span<const Rgbe> line, std::string& out) {
  const size_t width = line.size();
  if (width < kMinRunWidth || width > kMaxRunWidth) {
    for (const Rgbe& p : line)
      for (const uint8_t byte : p) out += char(byte);
    return;
  }
  out += {2, 2, char(uint8_t(width >> 8)), char(uint8_t(width & 255))};
  for (size_t component = 0; component < 4; ++component) append_runs(line, component, out);
}

}  // namespace

Result<Image> decode_hdr(std::span<const std::byte> bytes, std::string_view name) {
  Reader in{Bytes(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()), name};
  LUXEL_TRY(const Header header, read_header(in));
  // A short file may claim many pixels: memory grows with the scan lines that are there.
  std::vector<Rgbe> pixels, line(header.count[1]);
  for (size_t i = 0; i < header.count[0]; ++i) {
    LUXEL_TRY_STATUS(read_scan_line(in, line));
    pixels.insert(pixels.end(), line.begin(), line.end());
  }
  const bool by_rows = header.axis[0] == 'Y';
  Image image(int(header.count[by_rows ? 1 : 0]), int(header.count[by_rows ? 0 : 1]), 3);
  for (size_t i = 0; i < header.count[0]; ++i)
    for (size_t j = 0; j < header.count[1]; ++j)
      place(image, header, i, j, pixels[i * header.count[1] + j]);
  for (const float v : image.data)
    if (!std::isfinite(v))
      return fail(ErrorCode::bad_input,
                  "{}: EXPOSURE or COLORCORR of the HDR file is too small for its pixels", name);
  return image;
}

std::vector<std::byte> encode_hdr(const Image& image) {
  LUXEL_CHECK(image.width > 0 && image.height > 0 && image.channels >= 3);
  for (const float v : image.data) LUXEL_CHECK(std::isfinite(v));
  std::string out =
      fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", image.height, image.width);
  std::vector<Rgbe> line(size_t(image.width));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) line[size_t(x)] = to_rgbe(image.rgb(x, y));
    append_scan_line(line, out);
  }
  const auto bytes = std::as_bytes(std::span(out.data(), out.size()));
  return {bytes.begin(), bytes.end()};
}

}  // namespace luxel::image
