#include "luxel/solve/matrix/relight_check.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "luxel/solve/matrix/lxr_test_support.h"

namespace luxel::matrix {
namespace {

using ::testing::HasSubstr;
using testing::small_data;
using testing::small_dense;

/// Content that a right checksum does not make right.
struct Wrong {
  const char* error;
  std::function<void(RelightData&)> make;
};

Hierarchical& hierarchy(RelightData& d) { return std::get<HierarchicalCodec>(d.codec).matrix; }
CoarseScene& coarse(RelightData& d) { return std::get<HierarchicalCodec>(d.codec).coarse; }

const float kNan = std::nanf("");

std::vector<Wrong> wrong_patches() {
  return {
      {"patches: there are none", [](RelightData& d) { d.area_m2.clear(); }},
      {"positions of patches: there are 9, there must be 10",
       [](RelightData& d) { d.position.pop_back(); }},
      {"positions of patches: number 2", [](RelightData& d) { d.position[2].y = kNan; }},
      {"normals of patches", [](RelightData& d) { d.normal[2].z = INFINITY; }},
      {"areas of patches: number 3", [](RelightData& d) { d.area_m2[3] = 0; }},
      {"reflectances of patches", [](RelightData& d) { d.reflectance[9].z = 1.5f; }},
      {"emissions of patches", [](RelightData& d) { d.emission[0].x = -1; }},
      {"background of patches", [](RelightData& d) { d.sky[1] = 1.01f; }},
      {"materials of patches: index 2 at place 5, there are 2",
       [](RelightData& d) { d.material[5] = 2; }},
      {"probes: 5 is followed by 2", [](RelightData& d) { d.first_probe[2] = 5; }},
      {"probes: from 1 to 4", [](RelightData& d) { d.first_probe[0] = 1; }},
      {"probes: there are 10, there must be 11", [](RelightData& d) { d.first_probe.pop_back(); }},
      {"error of the codec", [](RelightData& d) { d.codec_error = -0.1; }},
      {"errors of indirect light", [](RelightData& d) { d.lamp_error = -0.1; }},
      {"glow: there are 10, there must be 11", [](RelightData& d) { d.glow.first.pop_back(); }},
      {"materials of the glow: index 2 at place 1", [](RelightData& d) { d.glow.material[1] = 2; }},
      {"irradiances of the glow: there are 2",
       [](RelightData& d) { d.glow.irradiance.pop_back(); }},
      {"irradiances of the glow: number 0", [](RelightData& d) { d.glow.irradiance[0].y = kNan; }},
      {"probes: number 3", [](RelightData& d) { d.probe[3].normal.x = kNan; }},
  };
}

std::vector<Wrong> wrong_codecs() {
  return {
      {"cluster 0", [](RelightData& d) { hierarchy(d).clusters[0].end = 9; }},
      {"cluster 0: 3 and the next", [](RelightData& d) { hierarchy(d).clusters[0].child = 3; }},
      {"cluster 0: 1 and the next", [](RelightData& d) { hierarchy(d).clusters[1].end = 6; }},
      {"cluster 1: 1 and the next", [](RelightData& d) { hierarchy(d).clusters[1].child = 1; }},
      {"cluster 0: a leaf of 10", [](RelightData& d) { hierarchy(d).clusters[0].child = 0; }},
      {"cluster 3: is no half", [](RelightData& d) { hierarchy(d).clusters.emplace_back(); }},
      {"functions of halves: number 1", [](RelightData& d) { hierarchy(d).up[1][11] = kNan; }},
      {"functions of patches", [](RelightData& d) { hierarchy(d).phi.pop_back(); }},
      {"areas in the matrix", [](RelightData& d) { hierarchy(d).area_m2[0] = -1; }},
      {"first far block", [](RelightData& d) { hierarchy(d).first_far[1] = 2; }},
      {"far block 1: sender 3", [](RelightData& d) { hierarchy(d).far[1].sender = 3; }},
      {"far block 0", [](RelightData& d) { hierarchy(d).far[0].scale = INFINITY; }},
      {"first near block", [](RelightData& d) { hierarchy(d).first_near[3] = 3; }},
      {"near block 1: sender 0", [](RelightData& d) { hierarchy(d).near[1].sender = 0; }},
      {"near block 0: sender 1, receiver 0",
       [](RelightData& d) { hierarchy(d).first_near[1] = 1; }},
      {"near block 1: entries up to 81", [](RelightData& d) { hierarchy(d).near[1].entry = 41; }},
      {"near block 1: entries up to 4294967335",
       [](RelightData& d) { hierarchy(d).near[1].entry = UINT32_MAX; }},
      {"coarse clusters of patches: index 2", [](RelightData& d) { coarse(d).cluster_of[4] = 2; }},
      {"areas of coarse", [](RelightData& d) { coarse(d).area_m2[1] = 0; }},
      {"coarse responses: there are 3", [](RelightData& d) { coarse(d).response[2].pop_back(); }},
      {"coarse responses: number 0", [](RelightData& d) { coarse(d).response[1][0] = kNan; }},
      {"rows of the matrix",
       [](RelightData& d) { d.codec = small_dense(false), std::get<1>(d.codec).matrix.n = 11; }},
      {"form factors: there are 99",
       [](RelightData& d) {
         d.codec = small_dense(true), std::get<1>(d.codec).matrix.half.pop_back();
       }},
      {"form factors: number 7",
       [](RelightData& d) {
         d.codec = small_dense(true), std::get<1>(d.codec).matrix.half[7] = 0x7c01;
       }},
  };
}

LowRank& low_rank(RelightData& d) {
  d.codec = testing::small_low_rank();
  return std::get<LowRankCodec>(d.codec).matrix;
}

std::vector<Wrong> wrong_low_ranks() {
  return {
      {"roots of areas: there are 9", [](RelightData& d) { low_rank(d).root_area_m.pop_back(); }},
      {"roots of areas: number 2", [](RelightData& d) { low_rank(d).root_area_m[2] = 0; }},
      {"eigenvalues: there are 15", [](RelightData& d) { low_rank(d).eigenvalue.pop_back(); }},
      {"eigenvalues: number 15", [](RelightData& d) { low_rank(d).eigenvalue[15] = kNan; }},
      {"entries of eigenvectors: there are 159",
       [](RelightData& d) { low_rank(d).vector.pop_back(); }},
      {"bounces of eigenvectors: there are 255",
       [](RelightData& d) { low_rank(d).reflected[2].pop_back(); }},
      {"bounces of eigenvectors: number 7",
       [](RelightData& d) { low_rank(d).all_bounces[1][7] = kNan; }},
  };
}

std::vector<Wrong> wrong_places() {
  return {
      {"target: kind 3", [](RelightData& d) { d.target.kind = Target::Kind(3); }},
      {"places: there are 3", [](RelightData& d) { d.target.kind = Target::Kind::none; }},
      {"texels of places: there are 3",
       [](RelightData& d) { d.target.kind = Target::Kind::vertices; }},
      {"target: a map of 4 x 65536", [](RelightData& d) { d.target.height = 65536; }},
      {"texels of places: 4, 7 at place 2", [](RelightData& d) { d.target.texel[2][0] = 4; }},
      {"texels of places: 1, 300 at place 2", [](RelightData& d) { d.target.texel[2][1] = 300; }},
      {"positions of places", [](RelightData& d) { d.target.position[0].x = kNan; }},
      {"normals of places: there are 2", [](RelightData& d) { d.target.normal.pop_back(); }},
      {"normals of places", [](RelightData& d) { d.target.geometric_normal[1].y = kNan; }},
      {"transfer: there are 3", [](RelightData& d) { d.target.transfer.first.pop_back(); }},
      {"patches of the transfer: index 10",
       [](RelightData& d) { d.target.transfer.patch[0] = 10; }},
      {"weights of the transfer", [](RelightData& d) { d.target.transfer.weight.pop_back(); }},
      {"weights of the transfer", [](RelightData& d) { d.target.transfer.weight[1] = kNan; }},
      {"corners of occluders", [](RelightData& d) { d.occluders.position[3].x = kNan; }},
      {"triangles of occluders: index 4", [](RelightData& d) { d.occluders.triangle[1][2] = 4; }},
      {"lights: number 1",
       [](RelightData& d) { d.lights[1].kind = scene::PunctualLight::Kind(3); }},
      {"lights: number 0", [](RelightData& d) { d.lights[0].position.y = kNan; }},
      {"lights: number 1", [](RelightData& d) { d.lights[1].inner_cone_rad = kNan; }},
      {"lights: number 1", [](RelightData& d) { d.lights[1].intensity.y = -1; }},
      {"background: number 0", [](RelightData& d) { d.background.z = kNan; }},
      {"not binary glTF", [](RelightData& d) { d.scene_glb[3] = std::byte('f'); }},
  };
}

Bc1& bc1(RelightData& d) {
  d.codec = testing::small_bc1();
  return std::get<Bc1Codec>(d.codec).matrix;
}

std::vector<Wrong> wrong_bc1s() {
  return {{"rows of the BC1 matrix: there are 9", [](RelightData& d) { bc1(d).n = 9; }},
          {"BC1 matrix has lengths", [](RelightData& d) { bc1(d).row[3] = 0; }},
          {"BC1 matrix has lengths", [](RelightData& d) { bc1(d).column[2] = 10; }},
          {"BC1 matrix has lengths", [](RelightData& d) { bc1(d).kept[1].place = 10; }},
          {"BC1 matrix has lengths", [](RelightData& d) { bc1(d).kept[0].value[1] = 0x7c00; }},
          {"BC1 matrix has lengths", [](RelightData& d) { bc1(d).first_kept[4] = 1; }},
          {"BC1 matrix has lengths", [](RelightData& d) { bc1(d).blocks.pop_back(); }},
          {"BC1 matrix has lengths", [](RelightData& d) { bc1(d).row_scale[9].y = kNan; }},
          {"BC1 matrix has lengths", [](RelightData& d) { bc1(d).log_range = 0; }},
          {"sweeps", [](RelightData& d) { std::get<HierarchicalCodec>(d.codec).sweeps = 0; }},
          {"sweeps", [](RelightData& d) { std::get<HierarchicalCodec>(d.codec).sweeps = 65; }}};
}

TEST(Check, FindsWhatChecksumsDoNot) {
  EXPECT_TRUE(check(small_data()));
  for (const auto& list :
       {wrong_patches(), wrong_codecs(), wrong_low_ranks(), wrong_bc1s(), wrong_places()})
    for (const Wrong& wrong : list) {
      RelightData data = small_data();
      wrong.make(data);
      const Status status = check(data);
      ASSERT_FALSE(status) << wrong.error;
      EXPECT_THAT(status.error().message, HasSubstr(wrong.error));
      const auto read = decode_lxr(testing::forged(data), "a.lxr");
      ASSERT_FALSE(read) << wrong.error;
      EXPECT_THAT(read.error().message, HasSubstr("a.lxr: " + status.error().message));
    }
}

}  // namespace
}  // namespace luxel::matrix
