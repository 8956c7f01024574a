#include "luxel/arguments/near_miss.h"

#include <gtest/gtest.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <array>

namespace luxel::arguments {
namespace {

TEST(EditsBetween, AreTheFewest) {
  EXPECT_EQ(edits_between("", ""), 0u);
  EXPECT_EQ(edits_between("samples", "samples"), 0u);
  EXPECT_EQ(edits_between("", "abc"), 3u);
  EXPECT_EQ(edits_between("abc", ""), 3u);
  EXPECT_EQ(edits_between("kitten", "sitting"), 3u);    // the textbooks' example
  EXPECT_EQ(edits_between("sampels", "samples"), 1u);   // two letters exchanged
  EXPECT_EQ(edits_between("sample", "samples"), 1u);    // one left out
  EXPECT_EQ(edits_between("ssamples", "samples"), 1u);  // one too many
  EXPECT_EQ(edits_between("ca", "abc"), 3u);            // no letter is moved twice
}

TEST(NearMiss, IsTheNameThatWasMeant) {
  const std::array<std::string, 5> names{"--samples", "--seed", "--resolution", "--solver",
                                         "--max-error"};
  EXPECT_EQ(near_miss("--sampels", names), "--samples");
  EXPECT_EQ(near_miss("--resolutoin", names), "--resolution");
  EXPECT_EQ(near_miss("--res", names), "--resolution");  // a beginning
  EXPECT_EQ(near_miss("--maxerror", names), "--max-error");
  EXPECT_EQ(near_miss("-seed", names), "--seed");
  EXPECT_EQ(near_miss("--sed", names), "--seed");
  EXPECT_EQ(near_miss("--colour", names), "");
  EXPECT_EQ(near_miss("-s", names), "");  // one letter may mean anything
  EXPECT_EQ(near_miss("--", names), "");
  EXPECT_EQ(near_miss(std::string(100000, 'x'), names), "");
  EXPECT_EQ(near_miss("samples", {}), "");
}

TEST(UnknownOptions, AreNamed) {
  CLI::App command;
  double number = 0;
  command.add_option("--samples", number);
  command.add_option("-o,--output", number);
  const auto about = [&](std::vector<std::string> arguments) {
    return about_unknown_option(command, "luxel bake", arguments);
  };
  EXPECT_EQ(about({"a.glb", "--sampels=3", "-o", "out"}),
            "luxel bake has no option '--sampels'; did you mean '--samples'?");
  EXPECT_EQ(about({"--colour"}), "luxel bake has no option '--colour'");
  EXPECT_EQ(about({"-x"}), "luxel bake has no option '-x'");
  EXPECT_EQ(about({"--samples=3", "-oout", "--output", "x", "-1", "-.5", "-"}), "");
  EXPECT_EQ(about({"--", "--sampels"}), "");
}

}  // namespace
}  // namespace luxel::arguments
