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
/// True: the scene is here, procedural or a file on this machine; else the table gets a note.
bool is_here(const NamedScene& named, Table& table);
/// Errors: those of the importer.
Result<scene::Scene> load(const NamedScene& named);

}  // namespace luxel::bench
