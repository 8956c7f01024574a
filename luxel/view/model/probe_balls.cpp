#include "luxel/view/model/probe_balls.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/base/shown_text.h"
#include "luxel/image/codec.h"

namespace luxel::view {
namespace {

/// Where probes stand. May throw json::exception.
ProbeBalls places_of(const nlohmann::json& from, DVec3 origin) {
  ProbeBalls out;
  out.spacing_m = from.at("spacing").get<float>();
  for (const auto& place : from.at("position")) {
    const auto p = place.get<std::array<double, 3>>();
    out.probes.push_back({.position = to_float(DVec3{p[0], p[1], p[2]} - origin)});
  }
  return out;
}

Result<ProbeBalls> read_places(const std::filesystem::path& file, DVec3 origin) {
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(file));
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  try {
    ProbeBalls out = places_of(nlohmann::json::parse(text, text + bytes.size()), origin);
    if (!(out.spacing_m > 0) || !std::isfinite(out.spacing_m))
      return fail(ErrorCode::bad_input, "{}: its spacing, {}, is not above 0", file.string(),
                  out.spacing_m);
    for (const light::Probe& probe : out.probes)
      if (!is_finite(probe.position))
        return fail(ErrorCode::bad_input, "{}: a probe has no position", file.string());
    return out;
  } catch (const nlohmann::json::exception& e) {
    return fail(ErrorCode::bad_input, "{}: {}", file.string(), short_message(e.what(), 400));
  }
}

}  // namespace

Result<ProbeBalls> read_probes(const std::filesystem::path& folder, DVec3 origin) {
  std::error_code ignored;
  if (!std::filesystem::exists(folder / "probes.json", ignored))
    return fail(ErrorCode::bad_input,
                "there are no probes in {}; `luxel bake` with --probes 0.5 puts one every half "
                "metre",
                folder.string());
  LUXEL_TRY(ProbeBalls out, read_places(folder / "probes.json", origin));
  const std::filesystem::path exr = folder / "probes.exr";
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(exr));
  LUXEL_TRY(const image::Image rows, image::decode_exr(bytes, exr.string()));
  // Where none is placed there is a row all the same.
  const size_t needed = std::max<size_t>(out.probes.size(), 1);
  if (size_t(rows.width) != kSh2 || size_t(rows.height) != needed || rows.channels < 3)
    return fail(ErrorCode::bad_input,
                "{} has {} x {} pixels, and probes.json {} probes of {} coefficients: they belong "
                "to different bakes",
                exr.string(), rows.width, rows.height, out.probes.size(), kSh2);
  for (size_t i = 0; i < out.probes.size(); ++i)
    for (size_t k = 0; k < kSh2; ++k) out.probes[i].irradiance[k] = rows.rgb(int(k), int(i));
  return out;
}

}  // namespace luxel::view
