// The nodes of a .dae file, before Assimp gets it: Assimp calls itself for each node that another
// one holds or instances, and asks neither for depth nor for circles.
#include <map>

#include "luxel/import/nesting.h"
#include "luxel/import/text_lines.h"
#include "luxel/import/xml_text.h"

namespace luxel::import {
namespace {

/// Nodes, and those of other places that they instance. Part 0 is the scene.
struct ColladaNodes {
  std::vector<std::vector<uint32_t>> parts{1};
  std::vector<size_t> at{0};
  std::vector<std::pair<uint32_t, std::string_view>> instances;  // node, name
  // Assimp looks for a name in the library first, where ids of the last ones count, then in the
  // scene, where ids and names of the first ones do.
  std::map<std::string_view, uint32_t> in_library, in_scene;
};

void open_node(ColladaNodes& nodes, const XmlTag& tag, const std::vector<uint32_t>& open,
               bool library) {
  const auto node = uint32_t(nodes.at.size());
  nodes.at.push_back(tag.at);
  nodes.parts.emplace_back();
  const std::string_view id = attribute(tag.text, "id");
  if (open.empty() && library) {
    nodes.in_library[id] = node;
    return;
  }
  nodes.parts[open.empty() ? 0 : open.back()].push_back(node);
  if (library) return;
  nodes.in_scene.try_emplace(id, node);
  nodes.in_scene.try_emplace(attribute(tag.text, "name"), node);
}

}  // namespace

Status check_collada_nodes(const SourceFile& source) {
  const std::string_view text = text_of(source.bytes);
  ColladaNodes nodes;
  std::vector<uint32_t> open;
  bool library = false;
  size_t at = 0;
  while (const auto tag = next_tag(text, at)) {
    at = tag->end();
    if (tag->name == "library_nodes") library = tag->opens && !tag->closes;
    if (tag->name == "instance_node" && tag->opens && !open.empty())
      nodes.instances.emplace_back(open.back(), name_referred_to(attribute(tag->text, "url")));
    if (tag->name != "node") continue;
    if (tag->opens) {
      open_node(nodes, *tag, open, library);
      open.push_back(uint32_t(nodes.at.size() - 1));
    }
    if (tag->closes && !open.empty()) open.pop_back();
  }
  for (const auto& [holder, name] : nodes.instances) {
    auto found = nodes.in_library.find(name);
    if (found == nodes.in_library.end() &&
        (found = nodes.in_scene.find(name)) == nodes.in_scene.end())
      continue;
    nodes.parts[holder].push_back(found->second);
  }
  const auto wrong = wrong_nesting(nodes.parts);
  if (!wrong) return {};
  if (wrong->part == 0)
    return fail(ErrorCode::bad_input, "{}: the scene {}", source.name, wrong->what);
  return fail(ErrorCode::bad_input, "{}, line {}: the node {}", source.name,
              line_of(text, nodes.at[wrong->part]), wrong->what);
}

}  // namespace luxel::import
