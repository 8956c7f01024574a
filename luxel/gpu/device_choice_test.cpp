#include "luxel/gpu/device_choice.h"

#include <gmock/gmock.h>

namespace luxel::gpu {
namespace {

using ::testing::HasSubstr;
using Kind = DeviceChoice::Kind;

TEST(DeviceChoice, ReadsWhatAUserMayWrite) {
  EXPECT_EQ(parse_device("cpu")->kind, Kind::processor);
  EXPECT_EQ(parse_device("gpu")->kind, Kind::device);
  EXPECT_EQ(parse_device("auto")->kind, Kind::any);
  EXPECT_EQ(parse_device("gpu:1")->params.number, 1u);
  EXPECT_EQ(parse_device("gpu:4090")->params.name, "4090") << "a card, not a number";
  EXPECT_EQ(parse_device("gpu:llvmpipe")->params.name, "llvmpipe");
  EXPECT_FALSE(parse_device("gpu:llvmpipe")->params.number);
}

TEST(DeviceChoice, SaysWhatThereIsToWrite) {
  for (const char* wrong : {"", "GPU", "gpu:", "cpu:1", "cuda", "gpu 1"}) {
    const auto choice = parse_device(wrong);
    ASSERT_FALSE(choice) << wrong;
    EXPECT_EQ(choice.error().code, ErrorCode::bad_setting);
    EXPECT_THAT(choice.error().message, HasSubstr("give cpu, gpu, auto, or gpu:")) << wrong;
  }
}

TEST(DeviceChoice, OpensNothingForTheProcessor) {
  const auto chosen = open_chosen({});
  ASSERT_TRUE(chosen);
  EXPECT_EQ(chosen->device, nullptr);
}

// Where software on the processor is the only device, as in CI, nobody gets it unasked.
TEST(DeviceChoice, TakesSoftwareOnlyWhereItIsNamed) {
  const auto devices = list_devices();
  if (!devices || devices->front().type != VK_PHYSICAL_DEVICE_TYPE_CPU ||
      !devices->front().lacks.empty())
    GTEST_SKIP() << "software is not the only device here";
  const auto first = open_chosen(*parse_device("gpu"));
  ASSERT_FALSE(first);
  EXPECT_EQ(first.error().code, ErrorCode::no_device);
  EXPECT_THAT(first.error().message, HasSubstr(devices->front().name));
  EXPECT_THAT(first.error().message, HasSubstr("give the name or number of a software device"));
  const auto any = open_chosen(*parse_device("auto"));
  ASSERT_TRUE(any);
  EXPECT_EQ(any->device, nullptr);
  EXPECT_EQ(any->why_none, "");
  const auto numbered = open_chosen(*parse_device("gpu:0"));
  ASSERT_TRUE(numbered) << numbered.error().message;
  EXPECT_EQ(numbered->device->name, devices->front().name);
  const auto named = open_chosen(*parse_device("gpu:" + devices->front().name.substr(0, 8)));
  ASSERT_TRUE(named) << named.error().message;
  EXPECT_EQ(named->device->name, devices->front().name);
}

TEST(DeviceChoice, NamesTheDevicesWhereNoneFits) {
  const auto devices = list_devices();
  if (!devices) GTEST_SKIP() << devices.error().message;
  for (const char* wrong : {"gpu:99", "gpu:no such card"}) {
    const auto device = open_chosen(*parse_device(wrong));
    ASSERT_FALSE(device) << wrong;
    EXPECT_EQ(device.error().code, ErrorCode::no_device);
    EXPECT_THAT(device.error().message, HasSubstr(devices->front().name)) << wrong;
  }
}

}  // namespace
}  // namespace luxel::gpu
