#include "luxel/pipeline/solver/bake_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "luxel/pipeline/solver/solvers.h"

namespace luxel::pipeline {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// A row holds all that the command line, the checks and bake.json need. An option without a row
// cannot be given.
TEST(BakeOptions, RowsAreWhole) {
  for (const auto& row : bake_options()) {
    SCOPED_TRACE(row.flag);
    EXPECT_TRUE(row.flag.starts_with("--"));
    EXPECT_FALSE(row.help.empty());
    EXPECT_NE(row.help.back(), '.');
    EXPECT_TRUE(row.read_text && row.read_json && row.to_json && row.check && row.default_text);
    if (!row.solver.empty()) {
      EXPECT_NE(find_solver(row.solver), nullptr);
    }
  }
}

// Each solver has one reading of a flag, and each key of bake.json one row.
TEST(BakeOptions, AreOfOneMeaningForEachSolver) {
  for (const Solver& solver : solvers()) {
    std::set<std::string> flags;
    for (const auto& row : bake_options())
      if (looks_at(solver, row)) {
        EXPECT_TRUE(flags.insert(row.flag).second) << solver.name << " " << row.flag;
      }
  }
  std::set<std::string> keys;
  for (const auto& row : bake_options())
    if (!row.key.empty()) {
      EXPECT_TRUE(keys.insert(row.solver + "." + row.key).second) << row.key;
    }
}

TEST(BakeOptions, DefaultsAreAllowedAndReadBack) {
  for (const Solver& solver : solvers()) {
    BakeSettings settings;
    settings.scene = "box.glb", settings.solver = solver.name;
    ASSERT_TRUE(check(settings)) << solver.name << ": " << check(settings).error().message;
    BakeSettings back;
    ASSERT_TRUE(read_json(to_json(settings), back)) << solver.name;
    EXPECT_EQ(to_json(back), to_json(settings));
    for (const Solver& other : solvers())
      EXPECT_TRUE(other.name == solver.name || !to_json(settings).contains(other.name))
          << "options of " << other.name << " in a bake by " << solver.name;
  }
}

/// A value that is not the default.
std::string other_value(const Option<BakeSettings>& row) {
  static const std::map<std::string, std::string> texts{
      {"--bounces", "3"},         {"--pages", "2"},
      {"--formats", "exr,hdr"},   {"--max-memory", "3G"},
      {"--background", "1,2,3"},  {"--sun", "10,20,30"},
      {"--sky", "10,20"},         {"--environment", "a.hdr,5,2"},
      {"--ies", "left=b.ies,2"},  {"--hemicube", "32"},
      {"--element-size", "0.25"}, {"--max-error", "0.125"},
      {"--time-budget", "2"},     {"--seed", "77"},
  };
  if (const auto text = texts.find(row.flag); text != texts.end()) return text->second;
  return row.value.find('|') != std::string::npos ? row.value.substr(row.value.rfind('|') + 1)
                                                  : "7";
}

// Each option that the command line sets comes back out of bake.json.
TEST(BakeOptions, ValuesComeBackFromBakeJson) {
  int tried = 0;
  for (const auto& row : bake_options()) {
    if (row.key.empty()) continue;
    SCOPED_TRACE(row.flag);
    BakeSettings given;
    given.solver = row.solver.empty() ? "gather" : row.solver;
    const json before = to_json(given);
    const Status read = row.read_text(given, other_value(row));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_NE(to_json(given), before);
    BakeSettings back;
    const Status again = read_json(to_json(given), back);
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(to_json(back), to_json(given));
    ++tried;
  }
  EXPECT_GT(tried, 30);
}

// A checkpoint belongs to the bits of all results, a kept bake to the light alone.
TEST(BakeOptions, SayWhichEarlierBakesFit) {
  BakeSettings a;
  const auto changed = [&](const char* flag, const char* text) {
    BakeSettings b = a;
    EXPECT_TRUE((*option_of(*find_solver(a.solver), flag))->read_text(b, text)) << flag;
    return std::pair{settings_of_checkpoint(b) != settings_of_checkpoint(a),
                     settings_of_kept_bake(b) != settings_of_kept_bake(a)};
  };
  EXPECT_EQ(changed("--samples", "9"), std::pair(true, true));
  EXPECT_EQ(changed("--no-stitch", ""), std::pair(true, false));
  EXPECT_EQ(changed("--threads", "3"), std::pair(false, false));
}

}  // namespace
}  // namespace luxel::pipeline
