// Work in a process of its own, so that its peak memory is its own.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "luxel/base/result.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::bench {

struct ChildOutcome {
  std::string text;  ///< what the work returned
  uint64_t peak_resident_bytes = 0;
};
/// The child begins with what this process holds, but with none of its threads: it comes before any
/// parallel work. Errors: no process; it ended before its time.
Result<ChildOutcome> run_in_child(const std::function<std::string()>& work);

/// Runs one bake in a process of its own. Returns its bake.json. Errors: those of run_in_child()
/// and of the bake.
Result<nlohmann::json> bake_in_child(const pipeline::BakeSettings& settings);

}  // namespace luxel::bench
