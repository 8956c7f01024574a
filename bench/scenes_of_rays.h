// The five scenes that ray rates are measured in.
#pragma once

#include "bench/bench.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {

struct NamedScene {
  std::string name;
  std::filesystem::path file;  ///< empty: procedural
};

std::vector<NamedScene> scenes_of_rays(const std::filesystem::path& shared);
/// Whether the scene's file is on this machine; notes it in the table when not.
bool is_here(const NamedScene& named, Table& table);
/// Errors: those of the importer.
Result<scene::Scene> load(const NamedScene& named);

}  // namespace luxel::bench
