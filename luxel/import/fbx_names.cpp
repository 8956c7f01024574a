// Lights and cameras of an .fbx that share their names with each other or with other nodes, which
// the format allows. Assimp ties a light to its node by name alone, and its validation refuses such
// a file.
#include <assimp/scene.h>

#include <set>

#include "luxel/import/assimp_parts.h"

namespace luxel::import {
namespace {

using NodesByName = std::map<std::string, std::vector<aiNode*>>;

/// Children before their parents: the order in which Assimp's reader makes lights and cameras.
/// Groups and surfaces carry neither.
void collect(aiNode& node, NodesByName& nodes, std::set<std::string>& names) {
  for (unsigned i = 0; i < node.mNumChildren; ++i) collect(*node.mChildren[i], nodes, names);
  names.insert(node.mName.C_Str());
  bool is_group = false;
  if (node.mMetaData != nullptr) node.mMetaData->Get("IsNull", is_group);
  if (node.mNumMeshes == 0 && !is_group) nodes[node.mName.C_Str()].push_back(&node);
}

/// Renames the things (lights or cameras) whose name is not theirs alone, together with their
/// nodes; those whose node cannot be told are taken off the list.
template <class Thing>
void rename(Thing**& things, unsigned& count, const char* kind, NodesByName& nodes,
            std::set<std::string>& names, std::vector<std::string>& warnings) {
  std::map<std::string, std::vector<Thing*>> by_name;
  for (unsigned i = 0; i < count; ++i) by_name[things[i]->mName.C_Str()].push_back(things[i]);
  unsigned kept = 0;
  std::map<std::string, size_t> used;
  for (unsigned i = 0; i < count; ++i) {
    Thing* thing = things[i];
    const std::string name = thing->mName.C_Str();
    if (nodes[name].size() != by_name[name].size()) {
      warnings.push_back(
          fmt::format("{} '{}' shares its name with other nodes and is skipped: its place is not "
                      "known; rename it",
                      kind, name));
      delete thing;
      continue;
    }
    aiNode* node = nodes[name][used[name]++];
    std::string unique = name;
    for (int k = 1; unique == name || names.contains(unique); ++k)
      unique = fmt::format("{} ({} {})", name, kind, k);
    names.insert(unique);
    thing->mName.Set(unique);
    node->mName.Set(unique);
    things[kept++] = thing;
  }
  count = kept;
  if (kept > 0) return;
  delete[] things;  // an empty list must not be there at all
  things = nullptr;
}

}  // namespace

bool is_about_names(std::string_view error) {
  return error.find("has the same name as") != error.npos ||
         error.find("more than one nodes with") != error.npos;
}

void make_names_unique(aiScene& scene, std::vector<std::string>& warnings) {
  NodesByName nodes;
  std::set<std::string> names;
  collect(*scene.mRootNode, nodes, names);
  rename(scene.mLights, scene.mNumLights, "light", nodes, names, warnings);
  rename(scene.mCameras, scene.mNumCameras, "camera", nodes, names, warnings);
}

}  // namespace luxel::import
