#include "luxel/import/ies.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "luxel/base/file.h"
#include "luxel/base/vec_double.h"
#include "luxel/import/ies_numbers.h"
#include "luxel/import/text_lines.h"

namespace luxel::import {
namespace {

using Angles = scene::LightProfile::Angles;

constexpr double kMany = 1e9;       // lumens, candela, metres, watts: nothing real has more
constexpr int kMostAngles = 36001;  // a hundredth of a degree apart
constexpr size_t kMostCandela = size_t(1) << 26;  // 256 MiB of floats
/// Files write angles with two decimals or so.
constexpr double kAngleRounding = 0.01;

/// The part of a file before its numbers.
struct Header {
  bool has_lamp_factor = true;  ///< up to 1991; later the number at its place has other meanings
  std::string tilt;
  std::string_view numbers;
  int line = 1;  ///< at which they begin
};

std::string_view without_mark(std::string_view text) {
  constexpr std::string_view kUtf8 = "\xef\xbb\xbf";
  return text.starts_with(kUtf8) ? text.substr(kUtf8.size()) : text;
}

/// Free lines or keywords up to TILT=. Files of 1986 have no line that says what they are.
Result<Header> read_header(std::string_view text, const std::string& name) {
  Header out;
  text = without_mark(text);
  for (bool first = true; !text.empty(); first = false, ++out.line) {
    const std::string_view line = trimmed(next_line(text));
    if (first)
      out.has_lamp_factor = !line.starts_with("IES:LM-63-") && !line.starts_with("IESNA:LM-63-");
    if (!line.starts_with("TILT=")) continue;
    out.tilt = trimmed(line.substr(5));
    out.numbers = text, ++out.line;
    return out;
  }
  return fail(ErrorCode::bad_input,
              "{}: no line begins with TILT=, so it is not an IES photometric file (LM-63)", name);
}

/// Lamps of some kinds shine less when their luminaire is tilted. Nobody says how this one hangs
/// compared with its measurement, so the table is read and left alone.
Status skip_tilt(const Header& header, IesNumbers& numbers, Ies& out) {
  if (header.tilt == "NONE") return {};
  if (header.tilt != "INCLUDE")
    return fail(ErrorCode::unsupported,
                "{}: line {}: TILT={} names another file, which luxel does not read; write "
                "TILT=NONE, or INCLUDE and the table",
                numbers.name(), header.line - 1, header.tilt);
  LUXEL_TRY_STATUS(numbers.count("the lamp's position (1 to 3)", 1, 3));
  LUXEL_TRY(const int count, numbers.count("the number of tilts", 1, kMostAngles));
  for (int i = 0; i < count; ++i) LUXEL_TRY_STATUS(numbers.within("a tilt", -360, 360));
  for (int i = 0; i < count; ++i) LUXEL_TRY_STATUS(numbers.within("a factor of tilt", 0, kMany));
  out.warnings.push_back(
      fmt::format("{}: its TILT table is ignored: lamps shine as measured, however they are tilted",
                  numbers.name()));
  return {};
}

/// The thirteen numbers before the angles, as far as they matter.
struct Dimensions {
  int vertical = 0, horizontal = 0;
  Angles angles = Angles::c;
  double factor = 1;  ///< on candela
};

Result<Dimensions> read_dimensions(const Header& header, IesNumbers& numbers, Ies& out) {
  Dimensions d;
  constexpr double kLeast = 1e-9;
  LUXEL_TRY(const int lamps, numbers.count("the number of lamps", 1, 1000000));
  LUXEL_TRY(const double lumens, numbers.within("lumens per lamp", -1, kMany));
  out.lumens = lumens > 0 ? lamps * lumens : 0;
  LUXEL_TRY(const double multiplier, numbers.within("the multiplier", kLeast, kMany));
  LUXEL_TRY(d.vertical, numbers.count("the number of vertical angles", 2, kMostAngles));
  LUXEL_TRY(d.horizontal, numbers.count("the number of horizontal angles", 1, kMostAngles));
  if (size_t(d.vertical) * size_t(d.horizontal) > kMostCandela)
    return fail(ErrorCode::bad_input, "{}: line {}: {} x {} angles are more than luxel can read",
                numbers.name(), numbers.line(), d.vertical, d.horizontal);
  LUXEL_TRY(const int type, numbers.count("the photometric type", 1, 3));
  d.angles = std::array{Angles::c, Angles::b, Angles::a}[size_t(type - 1)];
  LUXEL_TRY_STATUS(numbers.count("the unit of length (1 feet, 2 metres)", 1, 2));
  for (const char* size : {"the width", "the length", "the height"})  // negative: round
    LUXEL_TRY_STATUS(numbers.within(size, -kMany, kMany));
  LUXEL_TRY(const double ballast, numbers.within("the ballast factor", kLeast, kMany));
  LUXEL_TRY(const double lamp_factor,
            numbers.within("the number after the ballast factor", 0, kMany));
  LUXEL_TRY_STATUS(numbers.within("input watts", 0, kMany));
  d.factor = multiplier * ballast;
  if (!header.has_lamp_factor) return d;
  if (!(lamp_factor >= kLeast))
    return fail(ErrorCode::bad_input, "{}: the ballast-lamp factor {} leaves no light",
                numbers.name(), lamp_factor);
  d.factor *= lamp_factor;
  return d;
}

Result<std::vector<double>> read_angles(IesNumbers& numbers, int count, std::string_view what) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) {
    LUXEL_TRY(const double angle, numbers.within(what, -360, 360));
    if (!out.empty() && !(angle > out.back()))
      return fail(ErrorCode::bad_input, "{}: line {}: {} {} does not follow {} in ascending order",
                  numbers.name(), numbers.line(), what, angle, out.back());
    out.push_back(angle);
  }
  return out;
}

/// One column of the grid: where it comes from.
struct Column {
  double degrees = 0;
  size_t source = 0;
};

bool is(double angle, double wanted) { return std::abs(angle - wanted) <= kAngleRounding; }

/// Appends columns mirrored at `axis`: h becomes 2 axis - h, in ascending order.
void mirror(std::vector<Column>& columns, double axis) {
  for (size_t k = columns.size(); k-- > 0;) {
    const double degrees = 2 * axis - columns[k].degrees;
    if (degrees > columns.back().degrees + kAngleRounding)
      columns.push_back({degrees, columns[k].source});
  }
}

/// A whole turn that begins at 90 degrees, begun at 0.
std::vector<Column> from_zero(const std::vector<Column>& from_90) {
  std::vector<Column> out;
  for (const Column& c : from_90)
    if (c.degrees >= 360 - kAngleRounding) out.push_back({c.degrees - 360, c.source});
  for (const Column& c : from_90)
    if (c.degrees > out.back().degrees && c.degrees <= 360 + kAngleRounding) out.push_back(c);
  return out;
}

/// Type C from 0 to 360 degrees. Nothing: no symmetry has these angles.
std::optional<std::vector<Column>> all_round(const std::vector<double>& h) {
  if (h.size() == 1) return std::vector<Column>{{0, 0}};
  std::vector<Column> out;
  for (size_t k = 0; k < h.size(); ++k) out.push_back({h[k], k});
  if (is(h.front(), 90) && is(h.back(), 270)) {
    mirror(out, 270);
    out = from_zero(out);
  } else {
    if (is(h.back(), 90)) mirror(out, 90);
    if (is(out.back().degrees, 180)) mirror(out, 180);
    // Some files leave the last column out, which is the first one again.
    if (is(out.back().degrees + h[1] - h[0], 360)) out.push_back({360, 0});
  }
  if (!is(out.front().degrees, 0) || !is(out.back().degrees, 360)) return std::nullopt;
  out.front().degrees = 0, out.back().degrees = 360;
  return out;
}

/// Types A and B: one side, which is like the other, or both.
std::optional<std::vector<Column>> side_by_side(const std::vector<double>& h) {
  std::vector<Column> out;
  if (h.size() < 2 || !(is(h.front(), 0) || h.front() < 0)) return std::nullopt;
  if (is(h.front(), 0))
    for (size_t k = h.size(); k-- > 1;) out.push_back({-h[k], k});
  for (size_t k = 0; k < h.size(); ++k) out.push_back({h[k], k});
  return out;
}

float radians(double degrees) { return float(degrees * kPiDouble / 180); }

Status set_vertical(const IesNumbers& numbers, const std::vector<double>& degrees,
                    scene::LightProfile& out) {
  const bool is_c = out.angles == Angles::c;
  const double low = is_c ? 0 : -90, high = is_c ? 180 : 90;
  if (degrees.front() < low - kAngleRounding || degrees.back() > high + kAngleRounding)
    return fail(ErrorCode::bad_input,
                "{}: line {}: vertical angles {} to {} are not within {} to {}", numbers.name(),
                numbers.line(), degrees.front(), degrees.back(), low, high);
  if (!is_c && is(degrees.front(), 0))
    return fail(ErrorCode::unsupported,
                "{}: line {}: vertical angles of Type {} begin at 0, so the light below is "
                "unknown; give them from -90",
                numbers.name(), numbers.line(), out.angles == Angles::b ? "B" : "A");
  for (const double d : degrees) out.vertical_rad.push_back(radians(d));
  return {};
}

/// Reads the columns and lays them where the symmetry has them.
Status set_candela(IesNumbers& numbers, const Dimensions& d, const std::vector<Column>& columns,
                   scene::LightProfile& out) {
  std::vector<float> read;
  for (int h = 0; h < d.horizontal; ++h)
    for (int v = 0; v < d.vertical; ++v) {
      LUXEL_TRY(const double candela, numbers.within("candela", 0, kMany));
      const double scaled = candela * d.factor;
      if (!(scaled <= 1e30))
        return fail(ErrorCode::bad_input, "{}: line {}: candela {} times {} is too large",
                    numbers.name(), numbers.line(), candela, d.factor);
      read.push_back(float(scaled));
    }
  const auto rows = std::ptrdiff_t(d.vertical);
  for (const Column& c : columns) {
    const auto first = read.begin() + std::ptrdiff_t(c.source) * rows;
    out.horizontal_rad.push_back(radians(c.degrees));
    out.candela.insert(out.candela.end(), first, first + rows);
  }
  return {};
}

}  // namespace

Result<Ies> parse_ies(std::string_view text, const std::string& name) {
  LUXEL_TRY(const Header header, read_header(text, name));
  IesNumbers numbers(header.numbers, header.line, name);
  Ies out;
  out.profile.name = name;
  LUXEL_TRY_STATUS(skip_tilt(header, numbers, out));
  LUXEL_TRY(const Dimensions d, read_dimensions(header, numbers, out));
  out.profile.angles = d.angles;
  LUXEL_TRY(const std::vector<double> vertical,
            read_angles(numbers, d.vertical, "the vertical angle"));
  LUXEL_TRY_STATUS(set_vertical(numbers, vertical, out.profile));
  LUXEL_TRY(const std::vector<double> horizontal,
            read_angles(numbers, d.horizontal, "the horizontal angle"));
  const auto columns = d.angles == Angles::c ? all_round(horizontal) : side_by_side(horizontal);
  if (!columns)
    return fail(ErrorCode::bad_input,
                "{}: line {}: horizontal angles {} to {} match no symmetry of LM-63 ({})", name,
                numbers.line(), horizontal.front(), horizontal.back(),
                d.angles == Angles::c ? "0; 0 to 90, 180 or 360; 90 to 270" : "0 or -90 to 90");
  LUXEL_TRY_STATUS(set_candela(numbers, d, *columns, out.profile));
  LUXEL_TRY_STATUS(numbers.end());
  return out;
}

Result<Ies> read_ies(const std::filesystem::path& path) {
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(path));
  return parse_ies(text_of(bytes), path.string());
}

}  // namespace luxel::import
