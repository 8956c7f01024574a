#include "tests/fuzz/target_files.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "luxel/base/digest.h"
#include "luxel/base/record_file.h"
#include "luxel/image/codec.h"
#include "luxel/import/environment.h"
#include "luxel/import/ies.h"
#include "luxel/pipeline/bake/merge_parts.h"
#include "luxel/pipeline/command/light_script.h"
#include "luxel/pipeline/reuse/kept_bake.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/solve/matrix/lxr.h"
#include "tests/fuzz/support.h"

namespace luxel::fuzz {
namespace {

/// A number out of bytes, in the machine's order, which is little-endian.
template <class T>
T number_at(std::span<const std::byte> bytes, size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}
uint32_t crc_of(std::span<const std::byte> bytes) {
  return uint32_t(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

void put_big_endian(std::span<std::byte> bytes, size_t at, uint32_t value) {
  for (size_t k = 0; k < 4; ++k) bytes[at + k] = std::byte(value >> (24 - 8 * k));
}

/// A PNG's chunks with their checksums right, as far as their lengths lie within the file.
std::vector<std::byte> repaired_png(std::span<const std::byte> input) {
  std::vector<std::byte> out = copy_of(input);
  for (size_t at = 8; at + 12 <= out.size();) {
    size_t length = 0;
    for (size_t k = 0; k < 4; ++k) length = length << 8 | size_t(out[at + k]);
    if (length > out.size() - at - 12) break;
    put_big_endian(out, at + 8 + length, crc_of(std::span(out).subspan(at + 4, 4 + length)));
    at += 12 + length;
  }
  return out;
}

/// A WebP's length, and that of its first chunk where that would be too long.
std::vector<std::byte> repaired_webp(std::span<const std::byte> input) {
  constexpr size_t kStart = 20;
  std::vector<std::byte> out = copy_of(input);
  if (out.size() < kStart) return out;
  std::memcpy(out.data(), "RIFF", 4), std::memcpy(out.data() + 8, "WEBP", 4);
  put_number(out, 4, uint32_t(out.size() - 8), 4);
  const auto rest = uint32_t(out.size() - kStart);
  if (number_at<uint32_t>(out, 16) > rest) put_number(out, 16, rest, 4);
  return out;
}

/// [docs/format/lxr.md]: the header's length and checksum, and those of the chunks.
std::vector<std::byte> repaired_lxr(std::span<const std::byte> input) {
  constexpr size_t kHeader = 32, kChunk = 16;
  std::vector<std::byte> out = copy_of(input);
  if (out.size() < kHeader) return out;
  put_number(out, 16, out.size(), 8);
  put_number(out, 28, crc_of(std::span(out).first(28)), 4);
  for (size_t at = kHeader; at + kChunk <= out.size();) {
    const uint64_t bytes = number_at<uint64_t>(out, at + 8);
    if (bytes > out.size() - at - kChunk) break;
    put_number(out, at, crc_of(std::span(out).subspan(at + 4, kChunk - 4 + bytes)), 4);
    at += kChunk + bytes;
  }
  return out;
}

/// [docs/method/checkpoints.md]: the digests of the header and of each record.
std::vector<std::byte> repaired_records(std::span<const std::byte> input) {
  constexpr size_t kStart = 40, kRecord = 40;
  std::vector<std::byte> out = copy_of(input);
  const std::span<std::byte> all(out);
  if (out.size() < kStart) return out;
  const uint64_t header = number_at<uint64_t>(out, 16);
  if (header > out.size() - kStart) return out;
  put_number(all, 24, digest_of(all.subspan(kStart, header)), 8);
  put_number(all, 32, digest_of(all.first(32)), 8);
  for (size_t at = kStart + header; at + kRecord <= out.size();) {
    const uint64_t bytes = number_at<uint64_t>(out, at + 16);
    if (bytes > out.size() - at - kRecord) break;
    put_number(all, at + 24, digest_of(all.subspan(at + kRecord, bytes)), 8);
    put_number(all, at + 32, digest_of(all.subspan(at, 32)), 8);
    at += kRecord + bytes;
  }
  return out;
}

void open_records(std::span<const std::byte> bytes) {
  static const auto scratch = scratch_in_memory();
  const auto file = RecordFile::open(scratch.write("a.luxel", std::string(text_of(bytes))));
  if (!is_read(file)) return;
  for (const RecordKey key : file->keys()) file->read_whole(key);
}
void open_records_of_others(std::span<const std::byte> bytes) {
  static const auto scratch = scratch_in_memory();
  const auto file = RecordFile::open_to_read(scratch.write("a.luxel", std::string(text_of(bytes))));
  if (!is_read(file)) return;
  for (const RecordKey key : file->keys()) file->read_whole(key);
}

}  // namespace

void run_picture(std::span<const std::byte> input) {
  is_read(image::decode_ldr(input, "a", [](uint32_t, uint32_t) { return Status{}; }));
  is_read(image::decode_display(input, "a"));
}
void run_png(std::span<const std::byte> input) {
  run_picture(input);
  is_read(image::decode_ldr(repaired_png(input), "a"));
}
void run_webp(std::span<const std::byte> input) {
  run_picture(input);
  is_read(image::decode_ldr(repaired_webp(input), "a"));
}
void run_hdr(std::span<const std::byte> input) { is_read(image::decode_hdr(input, "a")); }
void run_exr(std::span<const std::byte> input) { is_read(image::decode_exr(input, "a")); }

void run_environment(std::span<const std::byte> input) {
  const auto picture = input.size() > 0 && input[0] == std::byte{'#'}
                           ? image::decode_hdr(input, "a")
                           : image::decode_exr(input, "a");
  if (is_read(picture)) is_read(import::environment_from(*picture, "a", 1, 2));
}

void run_ies(std::span<const std::byte> input) { is_read(import::parse_ies(text_of(input), "a")); }

void run_lxr(std::span<const std::byte> input) {
  is_read(matrix::decode_lxr(input, "a"));
  is_read(matrix::decode_lxr(repaired_lxr(input), "a"));
}

void run_records(std::span<const std::byte> input) {
  const std::vector<std::byte> repaired = repaired_records(input);
  open_records(input), open_records_of_others(input);
  open_records(repaired), open_records_of_others(repaired);
}
void run_parts(std::span<const std::byte> input) {
  static const auto scratch = scratch_in_memory();
  const std::vector<std::filesystem::path> file{scratch.path / "part.luxel"};
  if (is_read(RecordFile::create(file.front(), text_of(input))))
    is_read(pipeline::settings_of_parts(file));
}

void run_kept_bake(std::span<const std::byte> input) {
  if (input.empty()) return;
  pipeline::KeptBake kept;
  pipeline::read_part(input.subspan(1), size_t(input[0]) % pipeline::kKeptParts, kept);
}

void run_light_script(std::span<const std::byte> input) {
  const auto script = pipeline::parse_light_script(std::string(text_of(input)), "a");
  if (is_read(script)) pipeline::lights_at(*script, 0.5);
}

void run_settings(std::span<const std::byte> input) {
  static const auto scratch = scratch_in_memory();
  pipeline::BakeSettings settings;
  is_read(
      pipeline::read_settings(scratch.write("bake.json", std::string(text_of(input))), settings));
}

void run_option_texts(std::span<const std::byte> input) {
  // "--flag value" a line.
  std::string_view text = text_of(input);
  pipeline::BakeSettings settings;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const size_t blank = std::min(line.find(' '), line.size());
    for (const auto& row : pipeline::bake_options())
      if (row.flag == line.substr(0, blank))
        is_read(row.read_text(settings, line.substr(std::min(blank + 1, line.size()))));
  }
  is_read(pipeline::check(settings));
}

}  // namespace luxel::fuzz
