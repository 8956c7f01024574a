#include "luxel/pipeline/command/probe.h"

#include <gtest/gtest.h>

#include "luxel/viewfactor/rectangle_factor.h"
#include "tests/scratch_folder.h"

namespace luxel::pipeline {
namespace {

/// E at (0.1, 0, 0.2) of a black floor, under a sky of 1 and 1 m below a black sheet, [-1, 1] wide,
/// by closed forms. `opacity`: of the sheet.
Result<Probed> probe_below_sheet(const std::string& opacity) {
  const testing_support::ScratchFolder folder;
  folder.write("a.mtl", "newmtl floor\nKd 0 0 0\nnewmtl sheet\nKd 0 0 0\nd " + opacity + "\n");
  ProbeSettings s;
  s.scene = folder.write("a.obj",
                         "mtllib a.mtl\nv -2 0 -2\nv -2 0 2\nv 2 0 2\nv 2 0 -2\n"
                         "v -1 1 -1\nv 1 1 -1\nv 1 1 1\nv -1 1 1\n"
                         "usemtl floor\nf 1 2 3 4\nusemtl sheet\nf 5 6 7 8\n");
  s.method = ProbeMethod::hierarchical;
  s.at = {0.1f, 0, 0.2f}, s.normal = Vec3{0, 1, 0};
  s.time_budget_s = 60;
  s.outside.background = Rgb{1, 1, 1};
  Progress progress;
  return probe(s, progress);
}

const double kSheetFactor = viewfactor::rectangle_factor(-1.1, 0.9, -1.2, 0.8, 1);

// Nobody had said by how much closed forms err: the error was 0.
TEST(ProbeByFaces, StatesASmallErrorWhereItIsRight) {
  const Result<Probed> probed = probe_below_sheet("1");
  ASSERT_TRUE(probed) << probed.error().message;
  const double truth = kPiDouble * (1 - kSheetFactor);
  EXPECT_NEAR(probed->irradiance.y, truth, 1e-3 * truth);
  for (const float error : {probed->standard_error.y, probed->luminance_error}) {
    EXPECT_GT(error, 0);
    EXPECT_LT(error, 0.02 * truth);
  }
}

// Half of the light stays in the sheet, and half of the rest goes on past a black one. Faces of
// blended materials are solid to closed forms.
TEST(ProbeByFaces, StatesWhatItErrsBy) {
  const Result<Probed> probed = probe_below_sheet("0.5");
  ASSERT_TRUE(probed) << probed.error().message;
  const double off = std::abs(double(probed->irradiance.y) - kPiDouble * (1 - 0.75 * kSheetFactor));
  EXPECT_LT(off, 1.2 * double(probed->standard_error.y));
  EXPECT_LT(off, 1.2 * double(probed->luminance_error));
}

}  // namespace
}  // namespace luxel::pipeline
