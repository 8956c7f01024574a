#include "tests/fuzz/target_scenes.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "luxel/base/process_memory.h"
#include "luxel/import/import.h"
#include "luxel/validate/prepared.h"
#include "tests/fuzz/compressed_gltf.h"
#include "tests/fuzz/fbx_binary.h"
#include "tests/fuzz/support.h"

namespace luxel::fuzz {
namespace {

constexpr uint64_t kReadingBytes = 256 * 1024 * 1024;

uint64_t most_memory() { return resident_bytes() + kReadingBytes; }

void read(std::span<const std::byte> input, const char* name) {
  is_read(import::import_bytes(copy_of(input), name, most_memory()));
}

/// Lengths of the file and of its chunks, as far as they go.
std::vector<std::byte> repaired_glb(std::span<const std::byte> input) {
  std::vector<std::byte> out = copy_of(input);
  if (out.size() < 28) return out;
  const auto put32 = [&](size_t at, size_t value) { put_number(out, at, value, 4); };
  std::memcpy(out.data(), "glTF\2\0\0\0", 8);
  put32(8, out.size());
  // The JSON ends where its braces do.
  int depth = 0;
  size_t end = 20;
  for (; end < out.size(); ++end) {
    const char c = char(out[end]);
    depth += c == '{' ? 1 : c == '}' ? -1 : 0;
    if (depth == 0) break;
  }
  const size_t length = std::min((end + 1 - 20 + 3) / 4 * 4, out.size() - 20);
  put32(12, length);
  std::memcpy(out.data() + 16, "JSON", 4);
  if (20 + length + 8 <= out.size()) put32(20 + length, out.size() - 28 - length);
  return out;
}

}  // namespace

void run_gltf(std::span<const std::byte> input) { read(input, "a.gltf"); }
void run_glb(std::span<const std::byte> input) {
  read(input, "a.glb");
  read(repaired_glb(input), "a.glb");
}
void run_ply(std::span<const std::byte> input) { read(input, "a.ply"); }
void run_x(std::span<const std::byte> input) { read(input, "a.x"); }
void run_dae(std::span<const std::byte> input) { read(input, "a.dae"); }
void run_fbx(std::span<const std::byte> input) { read(input, "a.fbx"); }
void run_fbx_binary(std::span<const std::byte> input) { read(binary_fbx(text_of(input)), "a.fbx"); }
void run_draco(std::span<const std::byte> input) { read(draco_glb(input), "a.glb"); }
void run_meshopt(std::span<const std::byte> input) { read(meshopt_glb(input), "a.glb"); }
void run_stl(std::span<const std::byte> input) { read(input, "a.stl"); }

void run_obj(std::span<const std::byte> input) {
  static const auto scratch = scratch_in_memory();
  constexpr std::string_view kDivider = "\n#mtl\n";
  const std::string_view text = text_of(input);
  const size_t at = std::min(text.find(kDivider), text.size());
  scratch.write("a.mtl", std::string(text.substr(std::min(at + kDivider.size(), text.size()))));
  is_read(import::import_scene(scratch.write("a.obj", std::string(text.substr(0, at))), {},
                               most_memory()));
}

void run_bake(std::span<const std::byte> input) {
  Result<import::Imported> imported = import::import_bytes(copy_of(input), "a.gltf", most_memory());
  if (!is_read(imported)) return;
  Progress progress;
  const auto prepared = validate::prepare(std::move(imported->scene), 8, progress);
  if (!is_read(prepared)) return;
  pipeline::BakeSettings settings;
  settings.samples = 4, settings.direct_samples = 2, settings.threads = 1, settings.bounces = 3;
  const auto solved = validate::solve(**prepared, "gather", settings, progress);
  if (!is_read(solved)) return;
  for (const Rgb e : solved->light.irradiance)
    LUXEL_CHECK(std::isfinite(e.x) && std::isfinite(e.y) && std::isfinite(e.z));
}

}  // namespace luxel::fuzz
