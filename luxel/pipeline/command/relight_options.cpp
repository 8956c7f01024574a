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
                    "Where light is wanted: texels of a lightmap, vertices, none")
          .unit("texels|vertices|none"),
      LxrRows::number("--resolution", &RelightSettings::resolution, {1, 16384},
                      "Side of the lightmap in texels")
          .unit("TEXELS"),
      LxrRows::number("--texels-per-metre", &RelightSettings::texels_per_metre,
                      {0, kNoLimit, "is not a density; give a number > 0", "", true},
                      "Density; the side becomes the smallest power of two that holds the scene")
          .unit("DENSITY")
          .never_with({"--resolution"}),
      LxrRows::choice("--uv", &RelightSettings::uv,
                      {{"auto", atlas::UvMode::automatic},
                       {"keep", atlas::UvMode::keep},
                       {"unwrap", atlas::UvMode::unwrap}},
                      std::string(kUvHelp)),
  };
}

/// How light is carried, and how the file is made.
LxrOptions transport_options() {
  return {
      LxrRows::text("--codec", &RelightSettings::codec, any_text, json_of_text,
                    "How it is kept: " + codec_names())
          .unit("NAME"),
      LxrRows::number("--max-error", &RelightSettings::max_error,
                      {1e-5, 1, "is outside 0.00001 to 1"},
                      "What the codec may lose of indirect light, root mean square")
          .unit("ERROR"),
      LxrRows::text(
          "--bounces", &RelightSettings::bounces, parse_bounces,
          [](int bounces) { return bounces < 0 ? nlohmann::json("inf") : nlohmann::json(bounces); },
          "Reflections to count, or inf")
          .unit("COUNT"),
      LxrRows::text(
          "--max-memory", &RelightSettings::max_memory_bytes, parse_size,
          [](uint64_t bytes) { return nlohmann::json(bytes); },
          "Memory to stay under, as 900M or 1.5G (default: most of what is free)")
          .unit("SIZE")
          .leaves(Changes::nothing),
      LxrRows::number("--seed", &RelightSettings::seed, {0}, "Seed of all random numbers"),
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
