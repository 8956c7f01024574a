#include "luxel/solve/matrix/lxr.h"

#include <gmock/gmock.h>

#include "luxel/solve/matrix/codec.h"
#include "luxel/solve/matrix/lxr_test_support.h"

namespace luxel::matrix {
namespace {

using testing::Bytes;
using testing::forged;
using ::testing::HasSubstr;
using testing::small_data;
using testing::small_dense;

/// -0 and 0 are different.
template <class T>
bool same(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}
template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const CoarseScene& a, const CoarseScene& b) {
  EXPECT_TRUE(same(a.cluster_of, b.cluster_of) && same(a.area_m2, b.area_m2));
  for (size_t c = 0; c < 3; ++c) EXPECT_TRUE(same(a.response[c], b.response[c]));
}
void expect_same(const HierarchicalCodec& a, const HierarchicalCodec& b) {
  const Hierarchical &m = a.matrix, &n = b.matrix;
  EXPECT_TRUE(same(m.clusters, n.clusters) && same(m.up, n.up) && same(m.phi, n.phi));
  EXPECT_TRUE(same(m.area_m2, n.area_m2) && same(m.first_far, n.first_far));
  EXPECT_TRUE(same(m.far, n.far) && same(m.first_near, n.first_near));
  EXPECT_TRUE(same(m.near, n.near) && same(m.entries, n.entries));
  expect_same(a.coarse, b.coarse);
  EXPECT_EQ(a.sweeps, b.sweeps);
}
void expect_same(const DenseCodec& a, const DenseCodec& b) {
  EXPECT_EQ(a.matrix.n, b.matrix.n);
  EXPECT_TRUE(same(a.matrix.single, b.matrix.single) && same(a.matrix.half, b.matrix.half));
  expect_same(a.coarse, b.coarse);
  EXPECT_EQ(a.sweeps, b.sweeps);
}
void expect_same(const Bc1Codec& a, const Bc1Codec& b) {
  const Bc1 &m = a.matrix, &n = b.matrix;
  EXPECT_TRUE(m.n == n.n && same(m.log_range, n.log_range) && same(m.kept_unit, n.kept_unit));
  EXPECT_TRUE(same(m.row, n.row) && same(m.column, n.column) && same(m.row_scale, n.row_scale));
  EXPECT_TRUE(same(m.column_scale, n.column_scale));
  EXPECT_TRUE(same(m.blocks, n.blocks) && same(m.first_kept, n.first_kept));
  EXPECT_TRUE(same(m.kept, n.kept));
}
void expect_same(const LowRankCodec& a, const LowRankCodec& b) {
  const LowRank &m = a.matrix, &n = b.matrix;
  EXPECT_TRUE(same(m.root_area_m, n.root_area_m) && same(m.vector, n.vector));
  EXPECT_TRUE(same(m.eigenvalue, n.eigenvalue));
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_TRUE(same(m.reflected[c], n.reflected[c]));
    EXPECT_TRUE(same(m.all_bounces[c], n.all_bounces[c]));
  }
}
void expect_same(const Target& a, const Target& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_TRUE(a.width == b.width && a.height == b.height && same(a.texel, b.texel));
  EXPECT_TRUE(same(a.position, b.position) && same(a.normal, b.normal));
  EXPECT_TRUE(same(a.geometric_normal, b.geometric_normal));
  EXPECT_TRUE(same(a.transfer.first, b.transfer.first) && same(a.transfer.patch, b.transfer.patch));
  EXPECT_TRUE(same(a.transfer.weight, b.transfer.weight));
}
void expect_same(const scene::PunctualLight& a, const scene::PunctualLight& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_TRUE(same(a.intensity, b.intensity) && same(a.position, b.position));
  EXPECT_TRUE(same(a.direction, b.direction) && same(a.range_m, b.range_m));
  EXPECT_TRUE(same(a.inner_cone_rad, b.inner_cone_rad));
  EXPECT_TRUE(same(a.outer_cone_rad, b.outer_cone_rad));
  EXPECT_TRUE(same(a.angular_radius_rad, b.angular_radius_rad));
}
/// Field by field, by hand: what the format forgets must not be forgotten here.
void expect_same(const RelightData& a, const RelightData& b) {
  EXPECT_TRUE(same(a.position, b.position) && same(a.normal, b.normal));
  EXPECT_TRUE(same(a.area_m2, b.area_m2) && same(a.reflectance, b.reflectance));
  EXPECT_TRUE(same(a.emission, b.emission) && same(a.sky, b.sky) && same(a.material, b.material));
  EXPECT_TRUE(same(a.first_probe, b.first_probe) && same(a.probe, b.probe));
  EXPECT_EQ(a.material_name, b.material_name);
  EXPECT_EQ(a.bounces, b.bounces);
  EXPECT_EQ(a.codec_error, b.codec_error);
  EXPECT_EQ(a.usual_codec_error, b.usual_codec_error);
  EXPECT_TRUE(a.baked_error == b.baked_error && a.lamp_error == b.lamp_error);
  EXPECT_TRUE(same(a.glow.first, b.glow.first) && same(a.glow.material, b.glow.material));
  EXPECT_TRUE(same(a.glow.irradiance, b.glow.irradiance));
  ASSERT_EQ(a.codec.index(), b.codec.index());
  std::visit(
      [&](const auto& codec) {
        expect_same(codec, std::get<std::decay_t<decltype(codec)>>(b.codec));
      },
      a.codec);
  expect_same(a.target, b.target);
  EXPECT_TRUE(same(a.occluders.position, b.occluders.position));
  EXPECT_TRUE(same(a.occluders.triangle, b.occluders.triangle));
  ASSERT_EQ(a.lights.size(), b.lights.size());
  for (size_t k = 0; k < a.lights.size(); ++k) expect_same(a.lights[k], b.lights[k]);
  EXPECT_TRUE(same(a.background, b.background));
  EXPECT_TRUE(same(a.scene_glb, b.scene_glb));
  EXPECT_EQ(a.origin, b.origin);
}

std::string error_of(const Bytes& file) {
  const auto data = decode_lxr(file, "a.lxr");
  return data ? "none" : data.error().message;
}

TEST(Lxr, ComesBackBitForBit) {
  RelightData data = small_data();
  data.position[3].x = -0.0f, data.position[4].x = 1e-44f;  // a denormal
  data.origin = {512256, -1e-300, -5403200.1};
  for (const Codec& codec : {data.codec, Codec(small_dense(false)), Codec(small_dense(true)),
                             Codec(testing::small_bc1()), Codec(testing::small_low_rank())}) {
    data.codec = codec;
    const auto back = decode_lxr(encode_lxr(data), "a.lxr");
    ASSERT_TRUE(back) << back.error().message;
    expect_same(*back, data);
  }
}

TEST(Lxr, HoldsAsLittleAsThereIs) {
  RelightData data = small_data();
  data.target = {}, data.occluders = {}, data.scene_glb = {}, data.probe = {}, data.bounces = 3;
  data.lights = {}, data.glow = {};
  data.first_probe.assign(data.size() + 1, 0);
  const auto back = decode_lxr(encode_lxr(data), "a.lxr");
  ASSERT_TRUE(back) << back.error().message;
  expect_same(*back, data);
}

TEST(Lxr, ComesBackFromARealScene) {
  const testing::Cut cut(scene::cornell_box(), 300, 24);
  const Patches& p = cut.patches();
  const FormFactors factors = cut.reciprocal_factors(256);
  Progress progress;
  auto matrix = compress(factors, cut.patched.tree, p.centroid, p.area_m2, {}, progress);
  ASSERT_TRUE(matrix);
  RelightData data = small_data();
  data.position = copied(p.elements.position), data.normal = copied(p.elements.normal);
  data.area_m2 = p.area_m2;
  data.reflectance = copied(p.elements.reflectance), data.emission = p.emission;
  data.sky.assign(cut.size(), 0), data.material.assign(cut.size(), 1);
  data.first_probe = p.first_point, data.probe = p.points, data.glow = {};
  data.codec = HierarchicalCodec{
      std::move(*matrix),
      make_coarse_scene(factors, cut.patched.tree, p.area_m2, p.elements.reflectance, 64)};
  const auto back = decode_lxr(encode_lxr(data), "a.lxr");
  ASSERT_TRUE(back) << back.error().message;
  expect_same(*back, data);
}

TEST(Lxr, IsWhatItsPageSays) {
  // forged() writes it from docs/format/lxr.md, with a CRC-32 of its own. The check value of CRC-32
  // is published with it.
  const std::string_view digits = "123456789";
  EXPECT_EQ(testing::plain_crc(std::as_bytes(std::span(digits))), 0xcbf43926u);
  EXPECT_EQ(encode_lxr(small_data()), forged(small_data()));
  EXPECT_EQ(encode_lxr(small_data()), encode_lxr(small_data()));
}

TEST(Lxr, NoBitMayFlip) {
  const Bytes file = encode_lxr(small_data());
  for (size_t at = 0; at < file.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      Bytes damaged = file;
      damaged[at] ^= std::byte(1 << bit);
      EXPECT_THAT(error_of(damaged), HasSubstr("a.lxr: ")) << "byte " << at << ", bit " << bit;
    }
}

TEST(Lxr, NoByteMayBeMissing) {
  const Bytes file = encode_lxr(small_data());
  for (size_t length = 0; length < file.size(); ++length)
    EXPECT_THAT(error_of(Bytes(file.begin(), file.begin() + std::ptrdiff_t(length))),
                HasSubstr("a.lxr: "))
        << length;
  // Mended, so that only the content tells.
  for (size_t length = 32; length < file.size(); ++length) {
    Bytes cut(file.begin(), file.begin() + std::ptrdiff_t(length));
    testing::mend(cut);
    EXPECT_THAT(error_of(cut), HasSubstr("a.lxr: ")) << length;
  }
  Bytes longer = file;
  longer.push_back({});
  EXPECT_THAT(error_of(longer), HasSubstr("bytes are promised"));
}

TEST(Lxr, ReadsNothingElse) {
  EXPECT_THAT(error_of({}), HasSubstr("a.lxr: is not an .lxr file"));
  for (const std::string_view text :
       {std::string_view("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\10\2\0\0\0", 29),
        std::string_view("{\"asset\": {\"version\": \"2.0\"}}"), std::string_view("x")}) {
    const auto bytes = std::as_bytes(std::span(text));
    EXPECT_THAT(error_of(Bytes(bytes.begin(), bytes.end())),
                HasSubstr("a.lxr: is not an .lxr file"));
  }
  // Text mode turns the CR LF of the magic into LF.
  Bytes file = encode_lxr(small_data());
  file.erase(file.begin() + 4);
  EXPECT_THAT(error_of(file), HasSubstr("is not an .lxr file"));
}

TEST(Lxr, RefusesAnotherMajorVersion) {
  Bytes file = encode_lxr(small_data());
  testing::put_at(file, 8, uint16_t(2)), testing::put_at(file, 10, uint16_t(7));
  testing::mend(file);
  const auto data = decode_lxr(file, "a.lxr");
  ASSERT_FALSE(data);
  EXPECT_EQ(data.error().code, ErrorCode::unsupported);
  EXPECT_THAT(data.error().message, HasSubstr("a.lxr: has version 2.7"));
  EXPECT_THAT(data.error().message, HasSubstr("use a newer luxel"));
}

TEST(Lxr, SkipsChunksOfANewerMinorVersion) {
  Bytes file = encode_lxr(small_data());
  testing::append_chunk(file, "NEWS", Bytes(24, std::byte(7)));
  testing::mend(file);
  EXPECT_THAT(error_of(file), HasSubstr("chunk 'NEWS', byte"));  // nobody knows it in 1.2
  testing::put_at(file, 10, uint16_t(3));
  testing::mend(file);
  const auto back = decode_lxr(file, "a.lxr");
  ASSERT_TRUE(back) << back.error().message;
  expect_same(*back, small_data());
}

/// Data as decode_lxr() makes it of a file before 1.2, whose places lie on the surface. Each is
/// lifted by 2^-18 of its largest coordinate, or of the diagonal of the occluders' box, the root of
/// 3, where that is larger.
RelightData lifted(RelightData data) {
  const auto lift = [](Vec3& p, Vec3 normal, float size) { p += normal * (0x1p-18f * size); };
  for (size_t i = 0; i < data.position.size(); ++i)
    lift(data.position[i], data.normal[i], std::max(std::sqrt(3.0f), float(i)));
  for (size_t k = 0; k < data.probe.size(); ++k)
    lift(data.probe[k].position, data.probe[k].normal, k == 3 ? 3.0f : 2.0f);
  for (size_t k = 0; k < data.target.position.size(); ++k)
    lift(data.target.position[k], data.target.geometric_normal[k], 3);
  return data;
}

TEST(Lxr, LiftsThePlacesOfVersion11) {
  const Bytes file = testing::of_earlier(encode_lxr(small_data()), 1, {"ORIG"});
  const auto back = decode_lxr(file, "a.lxr");
  ASSERT_TRUE(back) << back.error().message;
  expect_same(*back, lifted(small_data()));
}

TEST(Lxr, ReadsVersion10) {
  RelightData data = small_data();
  const Bytes file = testing::of_earlier(encode_lxr(small_data()), 0, {"ORIG", "GLOW"});
  const auto back = decode_lxr(file, "a.lxr");
  ASSERT_TRUE(back) << back.error().message;
  data.glow = {}, data.usual_codec_error = data.baked_error = data.lamp_error = 0;
  expect_same(*back, lifted(std::move(data)));
}

TEST(Lxr, NeedsEachChunkOnce) {
  const Bytes file = encode_lxr(small_data());
  for (size_t at = 32; at < file.size();) {
    const size_t end = at + 16 + size_t(testing::value_at<uint64_t>(file, at + 8));
    Bytes twice = file, none = file;
    const auto begin = none.begin() + std::ptrdiff_t(at), stop = none.begin() + std::ptrdiff_t(end);
    twice.insert(twice.end(), begin, stop);
    none.erase(begin, stop);
    testing::put_at(twice, 12, testing::value_at<uint32_t>(file, 12) + 1), testing::mend(twice);
    testing::put_at(none, 12, testing::value_at<uint32_t>(file, 12) - 1), testing::mend(none);
    EXPECT_THAT(error_of(twice), HasSubstr("two chunks '"));
    EXPECT_THAT(error_of(none), HasSubstr("no chunk '"));
    at = end;
  }
}

TEST(Lxr, LeavesNothingOver) {
  const Bytes file = encode_lxr(small_data());
  for (size_t at = 32; at < file.size();) {
    const auto bytes = testing::value_at<uint64_t>(file, at + 8);
    Bytes longer = file;
    testing::put_at(longer, at + 8, bytes + 8);
    at += 16 + size_t(bytes);
    longer.insert(longer.begin() + std::ptrdiff_t(at), 8, std::byte{});
    testing::mend(longer);
    EXPECT_THAT(error_of(longer), HasSubstr("8 bytes are left over"));
  }
}

TEST(Lxr, SaysWhereAListIsTooLong) {
  Bytes file = encode_lxr(small_data());
  testing::put_at(file, 48, uint64_t(1) << 60);  // the length of the first list of the first chunk
  testing::mend(file);
  EXPECT_THAT(error_of(file),
              HasSubstr("a.lxr: chunk 'PTCH', byte 56: a list of 1152921504606846976"
                        " elements of 12 bytes or more"));
}

/// Plays data as a player does; the sanitizers watch.
void play(const RelightData& data) {
  CodecScratch scratch = make_scratch(data.codec, data.size());
  std::vector<Rgb> e(data.size()), of_place(data.target.transfer.size());
  const int bounces = std::min(data.bounces, 3);
  irradiance_of(data.codec, {data.emission, data.reflectance, data.area_m2, bounces}, e, scratch);
  transfer(data.target.transfer, e, of_place);
  const std::vector<Rgb> glowing(data.material_name.size());
  if (!data.glow.first.empty()) add_glow(data.glow, glowing, e);
}

TEST(Lxr, MendedDamageIsAnErrorOrOtherData) {
  // No damage may be read as something that is written differently, or that cannot be played.
  for (const Codec& codec : {small_data().codec, Codec(small_dense(true)),
                             Codec(testing::small_bc1()), Codec(testing::small_low_rank())}) {
    const Bytes file = encode_lxr(small_data(codec));
    size_t errors = 0;
    for (size_t at = 12; at < file.size(); ++at)
      for (const int change : {0x01, 0x80, 0xff}) {
        Bytes damaged = file;
        damaged[at] ^= std::byte(change);
        testing::mend(damaged);
        const auto data = decode_lxr(damaged, "a.lxr");
        errors += !data;
        if (data) {
          EXPECT_EQ(encode_lxr(*data), damaged) << "byte " << at;
          play(*data);
        }
      }
    EXPECT_GE(errors, 3u * 4u * 9u);  // the tags of nine chunks, at least
  }
}

// Checksums are right: only the numbers tell.
TEST(Lxr, HoldsNoPlaceThatTheRayTracerDoesNot) {
  const auto error_with = [](const auto& change) {
    RelightData data = small_data();
    change(data);
    Bytes file = forged(data);
    return error_of(file);
  };
  for (const float far : {-2e9f, 1e19f, 3e38f}) {
    EXPECT_THAT(
        error_with([&](RelightData& d) { d.occluders.position[3].y = far; }),
        HasSubstr(fmt::format("corners of occluders: number 3, (0, {}, 1), is not in", far)));
    EXPECT_THAT(error_with([&](RelightData& d) { d.position[1].x = far; }),
                HasSubstr("positions of patches: number 1, "));
    EXPECT_THAT(error_with([&](RelightData& d) { d.target.position[2].z = far; }),
                HasSubstr("positions of places: number 2, "));
    EXPECT_THAT(error_with([&](RelightData& d) { d.probe[0].position.z = far; }),
                HasSubstr("probes: number 0 at "));
  }
  EXPECT_THAT(error_with([&](RelightData& d) { d.lights[1].position.z = 1e19f; }),
              HasSubstr("lights: the position of number 1, "));
  EXPECT_THAT(error_with([&](RelightData& d) { d.occluders.position[3].y = 9e8f; }), "none");
  for (const double far : {-1.1e9, double(INFINITY), double(NAN)})
    EXPECT_THAT(error_with([&](RelightData& d) { d.origin.y = far; }),
                HasSubstr(fmt::format("origin: number 1, {}, is not in", far)));
}

TEST(Lxr, HoldsNoLightThatIsTooBright) {
  const auto error_with = [](const auto& change) {
    RelightData data = small_data();
    change(data);
    return error_of(forged(data));
  };
  EXPECT_THAT(error_with([](RelightData& d) { d.emission[1].x = 1e37f; }),
              HasSubstr("emissions of patches: number 1, "));
  EXPECT_THAT(error_with([](RelightData& d) { d.background.x = 1e38f; }), HasSubstr("background"));
  EXPECT_THAT(error_with([](RelightData& d) { d.lights[0].intensity.y = 1e16f; }),
              HasSubstr("lights: number 0 is of no kind, not finite or brighter than 1e+15"));
  EXPECT_EQ(error_with([](RelightData& d) { d.lights[1].intensity.y = 1e27f; }), "none");
}

TEST(Lxr, KnowsItsCodecs) {
  Bytes file = encode_lxr(small_data());
  size_t at = 32;
  while (std::memcmp(file.data() + at + 4, "CODC", 4) != 0)
    at += 16 + size_t(testing::value_at<uint64_t>(file, at + 8));
  testing::put_at(file, at + 16 + 12, uint32_t(99));  // after bounces and error
  testing::mend(file);
  EXPECT_THAT(error_of(file), HasSubstr("chunk 'CODC', byte"));
  EXPECT_THAT(error_of(file), HasSubstr("kind 99"));
}

}  // namespace
}  // namespace luxel::matrix
