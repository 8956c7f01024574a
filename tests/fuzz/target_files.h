// Targets that read pictures, photometry and files of luxel's own. For targets.cpp.
#pragma once

#include <cstddef>
#include <span>

namespace luxel::fuzz {

/// A picture as it is, a PNG, JPEG or WebP by its first bytes.
void run_picture(std::span<const std::byte> input);
/// A picture as it is, and as a PNG with its checksums repaired.
void run_png(std::span<const std::byte> input);
/// A picture as it is, and as a WebP with its lengths repaired.
void run_webp(std::span<const std::byte> input);
void run_hdr(std::span<const std::byte> input);
void run_exr(std::span<const std::byte> input);
/// A picture of the surroundings, .hdr or .exr.
void run_environment(std::span<const std::byte> input);
void run_ies(std::span<const std::byte> input);
/// An .lxr file as it is, and with its checksums repaired.
void run_lxr(std::span<const std::byte> input);
/// A file of records, as checkpoints and caches are, as it is and with its digests repaired.
void run_records(std::span<const std::byte> input);
/// The text that a part of a bake begins with, which `luxel merge` takes its settings from.
void run_parts(std::span<const std::byte> input);
/// A part of a kept bake: the first byte says which.
void run_kept_bake(std::span<const std::byte> input);
void run_light_script(std::span<const std::byte> input);
/// A bake.json.
void run_settings(std::span<const std::byte> input);
/// Options of `luxel bake` that have a notation of their own: a line each.
void run_option_texts(std::span<const std::byte> input);

}  // namespace luxel::fuzz
