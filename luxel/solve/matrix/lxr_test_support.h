// Helpers for tests of the .lxr file: small data, and files that encode_lxr() has not written.
#pragma once

#include <cstring>
#include <string_view>

#include "luxel/solve/matrix/lxr.h"
#include "luxel/solve/matrix/lxr_fields.h"
#include "luxel/solve/matrix/matrix_test_support.h"

namespace luxel::matrix::testing {

using Bytes = std::vector<std::byte>;

/// CRC-32 by its definition, bit by bit: polynomial 0x04c11db7, reflected.
inline uint32_t plain_crc(std::span<const std::byte> bytes) {
  uint32_t crc = ~0u;
  for (const std::byte b : bytes) {
    crc ^= uint32_t(b);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

template <class T>
T value_at(std::span<const std::byte> bytes, size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}
template <class T>
void put_at(Bytes& bytes, size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// Makes all checksums and the file's length right again, as docs/format/lxr.md says where they
/// are.
inline void mend(Bytes& file) {
  put_at(file, 16, uint64_t(file.size()));
  put_at(file, 28, plain_crc(std::span(file).first(28)));
  for (size_t at = 32; at + 16 <= file.size();) {
    const auto bytes = value_at<uint64_t>(file, at + 8);
    if (bytes > file.size() - at - 16) return;
    put_at(file, at, plain_crc(std::span(file).subspan(at + 4, 12 + bytes)));
    at += 16 + bytes;
  }
}

/// A file as an earlier minor version wrote it, which lacks the last chunks.
inline Bytes of_earlier(Bytes file, uint16_t minor,
                        std::initializer_list<std::string_view> lacking) {
  for (const std::string_view tag : lacking) {
    size_t at = 32, last = 32;
    for (; at < file.size(); at += 16 + size_t(value_at<uint64_t>(file, at + 8))) last = at;
    EXPECT_EQ(std::memcmp(file.data() + last + 4, tag.data(), 4), 0) << tag;
    file.resize(last);
    put_at(file, 12, value_at<uint32_t>(file, 12) - 1);
  }
  put_at(file, 10, minor);
  mend(file);
  return file;
}

inline void append_chunk(Bytes& file, std::string_view tag, const Bytes& content) {
  const size_t start = file.size();
  file.resize(start + 16 + (content.size() + 7) / 8 * 8);
  std::memcpy(file.data() + start + 4, tag.data(), 4);
  put_at(file, start + 8, uint64_t(file.size() - start - 16));
  std::copy(content.begin(), content.end(), file.begin() + std::ptrdiff_t(start + 16));
  put_at(file, 12, value_at<uint32_t>(file, 12) + 1);
}

/// The file of data that need not be right.
inline Bytes forged(const RelightData& data) {
  Bytes file(32);
  std::memcpy(file.data(), "\x89LXR\r\n\x1a\n", 8);
  put_at(file, 8, uint16_t(1)), put_at(file, 10, uint16_t(2));
  for_each_chunk(data, [&](std::string_view tag, int, const auto& write_fields) {
    Writer writer;
    write_fields(writer);
    append_chunk(file, tag, writer.bytes);
  });
  mend(file);
  return file;
}

/// Ten patches on a line in three clusters, and a bit of everything else.
inline RelightData small_data(Codec codec) {
  constexpr uint32_t n = 10;
  RelightData d;
  d.codec = std::move(codec);
  for (uint32_t i = 0; i < n; ++i) d.position.push_back({float(i), 0.5f, -0.25f});
  d.normal.assign(n, {0, 0.6f, 0.8f});
  for (uint32_t i = 0; i < n; ++i) d.area_m2.push_back(1 + 0.125f * float(i));
  d.reflectance = random_light(n, 1), d.emission = random_light(n, 2);
  for (const Rgb& c : random_light(n, 3)) d.sky.push_back(c.x);
  for (uint32_t i = 0; i < n; ++i) d.material.push_back(i % 2);
  d.first_probe = {0, 1, 1, 2, 2, 3, 3, 3, 3, 3, 4};
  for (uint32_t k = 0; k < 4; ++k) d.probe.push_back({{float(k), 1, 2}, {0, 0, -1}});
  d.material_name = {"wall", "Lampe \xc3\xa4"};
  d.bounces = -1, d.codec_error = 0.0078125, d.usual_codec_error = 0.00390625;
  d.baked_error = 0.03125, d.lamp_error = 0.0625;
  d.glow = {{0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 3}, {1, 0, 1}, random_light(3, 5)};
  d.target.kind = Target::Kind::texels;
  d.target.width = 4, d.target.height = 300;
  d.target.texel = {{0, 0}, {3, 299}, {1, 7}};
  for (int k = 0; k < 3; ++k) {
    d.target.position.push_back({float(k), 2, 3});
    d.target.normal.push_back({1, 0, 0}), d.target.geometric_normal.push_back({0, 1, 0});
  }
  d.target.transfer = {{0, 2, 3, 3}, {9, 0, 4}, {0.75f, 0.25f, 1}};
  d.occluders.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  d.occluders.triangle = {{0, 1, 2}, {3, 2, 0}};
  scene::PunctualLight spot{"spot", scene::PunctualLight::Kind::spot, {1, 2, 3}, {4, 5, 6}};
  spot.range_m = 7, spot.inner_cone_rad = 0.125f;
  d.lights = {{}, spot};
  d.lights[0].kind = scene::PunctualLight::Kind::directional;
  d.lights[0].angular_radius_rad = 0.0625f, d.background = {0.25f, 0.5f, 0};
  for (const char c : std::string_view("glTF and so on")) d.scene_glb.push_back(std::byte(c));
  return d;
}

inline CoarseScene small_coarse() {
  CoarseScene coarse;
  coarse.cluster_of = {0, 0, 0, 0, 0, 1, 1, 1, 1, 1};
  coarse.area_m2 = {6.25f, 9.375f};
  coarse.response = {{{1, 2, 3, 4}, {5, 6, 7, 8}, {9, 10, 11, 12}}};
  return coarse;
}

/// Both ways between its two leaves, near and far.
inline HierarchicalCodec small_hierarchical() {
  HierarchicalCodec codec;
  Hierarchical& m = codec.matrix;
  m.clusters = {{0, 10, 1, 0}, {0, 5, 0, 1}, {5, 10, 0, 1}};
  for (uint32_t c = 0; c < 3; ++c) {
    m.up.emplace_back();
    for (size_t k = 0; k < m.up[c].size(); ++k) m.up[c][k] = 0.5f + float(k) - float(c);
  }
  for (const Rgb& c : random_light(10, 4)) m.phi.push_back({c.x, c.y, c.z});
  for (int i = 0; i < 10; ++i) m.area_m2.push_back(1 + 0.125f * float(i));
  m.first_far = {0, 0, 1, 2}, m.first_near = {0, 0, 1, 2};
  m.far = {{{1, -2, 3}, 0.5f, 2}, {{-4, 5, -6}, 0.25f, 1}};
  m.near = {{1, 0, 0.125f}, {2, 40, 0.0625f}};
  for (int k = 0; k < 80; ++k) m.entries.push_back(uint8_t(3 * k));
  codec.coarse = small_coarse();
  return codec;
}

inline DenseCodec small_dense(bool half) {
  DenseCodec codec{{10, {}, {}}, small_coarse()};
  for (uint16_t k = 0; k < 100; ++k)
    if (half)
      codec.matrix.half.push_back(uint16_t(0x2000 + k));
    else
      codec.matrix.single.push_back(0.001f * float(k));
  return codec;
}

inline Bc1Codec small_bc1() {
  Bc1 m;
  m.n = 10, m.kept_unit = {0.5f, 0.25f, 2};
  for (uint32_t k = 0; k < 10; ++k) {
    m.row.push_back(9 - k), m.column.push_back((k + 3) % 10);
    m.row_scale.push_back({0.125f * float(k), 0.5f, 1});
    m.column_scale.push_back({1, float(k), 0.5f});
  }
  for (uint64_t k = 0; k < 9; ++k) m.blocks.push_back((1000 * k + 7) << 32 | k << 16 | (k + 5));
  m.first_kept = {0, 2, 2, 2, 2, 2, 2, 2, 2, 2, 3};
  m.kept = {{{0x3c00, 0x3800, 0}, 1}, {{1, 2, 3}, 9}, {{0x8001, 0, 0x7bff}, 4}};
  return {m};
}

inline LowRankCodec small_low_rank() {
  LowRank m;
  for (int i = 0; i < 10; ++i) m.root_area_m.push_back(1 + 0.125f * float(i));
  for (int k = 0; k < 160; ++k) m.vector.push_back(int16_t(400 * (k - 80)));
  for (int k = 0; k < 16; ++k) m.eigenvalue.push_back(1.0f / float(k + 1));
  for (size_t channel = 0; channel < 3; ++channel)
    for (int k = 0; k < 256; ++k) {
      m.reflected[channel].push_back(float(k) + float(channel));
      m.all_bounces[channel].push_back(-float(k) - float(channel));
    }
  return {m};
}

inline RelightData small_data() { return small_data(small_hierarchical()); }

}  // namespace luxel::matrix::testing
