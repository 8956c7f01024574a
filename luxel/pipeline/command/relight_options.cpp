#include "luxel/pipeline/command/relight_options.h"

#include <array>

#include "luxel/pipeline/settings/bake_settings_options.h"
#include "luxel/pipeline/settings/option_rows.h"

namespace luxel::pipeline {
namespace {

using LxrRows = Rows<RelightSettings>;
using LxrOptions = Options<RelightSettings>;

Result<std::string> any_text(std::string_view text) { return std::string(text); }
nlohmann::json json_of_text(const std::string& text) { return text; }

/// Where light is wanted.
LxrOptions target_options() {
  return {
      LxrRows::text("--target", &RelightSettings::target, any_text, json_of_text,
                    "Where to compute light: texels of a lightmap, vertices, or none")
          .unit("texels|vertices|none"),
      LxrRows::number("--resolution", &RelightSettings::resolution, {1, 16384},
                      "Lightmap side in texels")
          .unit("TEXELS"),
      LxrRows::number(
          "--texels-per-metre", &RelightSettings::texels_per_metre,
          {0, kNoLimit, "is not a density; give a number > 0", "", true},
          "Texel density; the lightmap side becomes the smallest power of two that fits the scene")
          .unit("DENSITY")
          .never_with({"--resolution"}),
      LxrRows::choice("--uv", &RelightSettings::uv,
                      {{"auto", atlas::UvMode::automatic},
                       {"keep", atlas::UvMode::keep},
                       {"unwrap", atlas::UvMode::unwrap}},
                      std::string(kUvHelp)),
  };
}

/// Options for the transport of light, and for making the file.
LxrOptions transport_options() {
  return {
      LxrRows::text("--codec", &RelightSettings::codec, any_text, json_of_text,
                    "Codec that compresses the matrix: " + codec_names())
          .unit("NAME"),
      LxrRows::number("--max-error", &RelightSettings::max_error,
                      {1e-5, 1, "is outside 0.00001 to 1"},
                      "Largest relative RMS error of indirect light due to the codec")
          .unit("ERROR"),
      LxrRows::text(
          "--bounces", &RelightSettings::bounces, parse_bounces,
          [](int bounces) { return bounces < 0 ? nlohmann::json("inf") : nlohmann::json(bounces); },
          "Number of bounces, or inf")
          .unit("COUNT"),
      LxrRows::text(
          "--max-memory", &RelightSettings::max_memory_bytes, parse_size,
          [](uint64_t bytes) { return nlohmann::json(bytes); },
          "Memory limit, e.g. 900M or 1.5G (default: most of the free memory)")
          .unit("SIZE")
          .leaves(Changes::nothing),
      LxrRows::number("--seed", &RelightSettings::seed, {0}, "Random seed"),
  };
}

}  // namespace

Options<RelightSettings> relight_options() {
  LxrOptions out;
  for (const LxrOptions& part :
       std::array{target_options(),
                  options_of_part<RelightSettings, matrix::MatrixParams>(
                      matrix_options(),
                      [](RelightSettings& s) -> matrix::MatrixParams& { return s.matrix; }),
                  transport_options()})
    out.insert(out.end(), part.begin(), part.end());
  return out;
}

nlohmann::json settings_of_lxr(const RelightSettings& settings) {
  nlohmann::json out;
  for (const Option<RelightSettings>& row : relight_options())
    if (row.changes != Changes::nothing) out[row.key] = row.to_json(settings);
  return out;
}

}  // namespace luxel::pipeline
