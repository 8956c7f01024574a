// Errors that commands state, and true errors, scene by scene.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/validate/agreement.h"
#include "luxel/validate/random_scenes.h"
#include "luxel/validate/stated_errors.h"

namespace luxel::bench {

/// Stated and true errors of one kind of statement, one entry per scene.
struct Account {
  validate::Claim claim = validate::Claim::bound;
  std::vector<validate::Compared> compared;
  std::vector<uint64_t> seed;        ///< of its scene
  std::vector<validate::Hard> hard;  ///< what is hard about it
};
using Accounts = std::map<std::string, Account>;

/// An entry of the scene of this seed.
struct Entry {
  validate::Claim claim = validate::Claim::bound;
  uint64_t seed = 0;
  validate::Compared compared{};
  validate::Hard hard = validate::Hard::nothing;
};

void add_entry(Accounts& accounts, const std::string& name, const Entry& entry);

/// Paths of the judge, in each of its two answers.
inline constexpr int kPathsEach = 1024;

/// A scene that is ready, and the judge's light of it.
struct JudgedScene {
  const validate::Prepared& scene;
  const validate::Judged& judged;
  uint64_t seed = 1;
  std::string lamp{};  ///< RandomScene::lamp
  validate::Hard hard = validate::Hard::nothing;
  validate::JudgedParts shared{};  ///< of texels, by other charts

  double mean_light() const {
    double sum = 0, count = 0;
    for (size_t i = 0; i < judged.first.size(); ++i)
      if (!judged.hidden[i]) sum += double(luminance(judged.mean(i))), count += 1;
    return count > 0 ? sum / count : 0;
  }
  double area_m2() const {
    double sum = 0;
    const scene::Scene& s = scene.scene;
    for (uint32_t i = 0; i < s.instances.size(); ++i)
      for (uint32_t t = 0; t < s.meshes[s.instances[i].mesh].triangles.size(); ++t)
        sum += scene::area_m2(scene::world_triangle(s, i, t));
    return sum;
  }
};

/// Adds two errors: the codec's loss of light over all patches, against the same matrix without a
/// codec, and the relighter's whole error, against the path tracer. Errors: cancelled.
Status add_relight(const JudgedScene& s, Accounts& accounts, Progress& progress);

}  // namespace luxel::bench
