#include "luxel/view/relight/kept_lxr.h"

#include <nlohmann/json.hpp>

#include "luxel/base/digest.h"
#include "luxel/base/file.h"
#include "luxel/base/shown_text.h"
#include "luxel/pipeline/command/relight_options.h"
#include "luxel/pipeline/reuse/checkpoint.h"
#include "luxel/solve/matrix/lxr.h"

namespace luxel::view {
namespace {

using nlohmann::json;

std::filesystem::path words_beside(const std::filesystem::path& lxr) {
  std::filesystem::path out = lxr;
  return out.replace_extension(".json");
}

json made_of(const scene::Scene& scene, const pipeline::RelightSettings& settings) {
  return pipeline::checkpoint_header(pipeline::settings_of_lxr(settings), scene);
}

/// Names of things may be no UTF-8, which JSON knows nothing else of.
std::string text_of_made(const json& made) { return json_text(made, 1); }

std::string digest_of_file(std::span<const std::byte> bytes) {
  Digest digest;
  digest.add(bytes);
  return fmt::format("{:016x}", digest.value());
}

/// May throw json::exception: the file may hold anything.
std::optional<pipeline::Relightable> read_kept(const json& words, const std::string& wanted,
                                               DVec3 origin, const std::filesystem::path& lxr) {
  if (text_of_made(words.at("made_of")) != wanted) return std::nullopt;
  const auto bytes = read_file(lxr);
  if (!bytes || words.at("file") != digest_of_file(*bytes)) return std::nullopt;
  auto data = matrix::decode_lxr(*bytes, lxr.string());
  // Light does not depend on the origin, so that digests leave it out.
  if (!data || data->origin != origin) return std::nullopt;
  return pipeline::Relightable{std::move(*data),
                               words.at("warnings").get<std::vector<std::string>>()};
}

}  // namespace

std::filesystem::path lxr_in(const std::filesystem::path& folder) { return folder / "relight.lxr"; }

std::optional<pipeline::Relightable> kept_lxr(const scene::Scene& scene,
                                              const pipeline::RelightSettings& settings) try {
  const auto text = read_file(words_beside(settings.output));
  if (!text) return std::nullopt;
  const char* begin = reinterpret_cast<const char*>(text->data());
  const json words = json::parse(begin, begin + text->size());
  return read_kept(words, text_of_made(made_of(scene, settings)), scene.origin, settings.output);
} catch (const json::exception&) {
  return std::nullopt;
}

Status keep_lxr(const scene::Scene& scene, const pipeline::RelightSettings& settings,
                const std::vector<std::string>& warnings) {
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(settings.output));
  const json words{{"made_of", made_of(scene, settings)},
                   {"file", digest_of_file(bytes)},
                   {"warnings", warnings}};
  const std::string text = text_of_made(words);
  return write_file_atomically(words_beside(settings.output),
                               std::as_bytes(std::span<const char>(text)));
}

}  // namespace luxel::view
