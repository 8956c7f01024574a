#include "luxel/trace/vulkan/faster_hierarchy.h"

#include "luxel/gpu/device_test_support.h"

namespace luxel::trace {
namespace {

TEST(FasterHierarchy, IsTheDriversOnlyWhereThatIsClearlyFaster) {
  const auto with = [](double driver) {
    return faster_of({{HierarchyKind::binary, 1e9}, {HierarchyKind::driver, driver}});
  };
  EXPECT_EQ(with(3e9), HierarchyKind::driver);
  EXPECT_EQ(with(1.1e9), HierarchyKind::binary);
  EXPECT_EQ(with(1e8), HierarchyKind::binary);
  EXPECT_EQ(faster_of({{HierarchyKind::wide, 1}}), HierarchyKind::wide);
}

using HierarchiesOnDevice = gpu::testing::OnDevice;

TEST_F(HierarchiesOnDevice, AreMeasured) {
  const auto measured = measure_hierarchies(*device_, 1000);
  ASSERT_TRUE(measured) << measured.error().message;
  ASSERT_EQ(measured->size(), device_->has_ray_queries ? 2u : 1u);
  EXPECT_EQ(measured->front().kind, own_hierarchy(*device_));
  for (const HierarchyRate& one : *measured) EXPECT_GT(one.rays_per_s, 0);
}

}  // namespace
}  // namespace luxel::trace
