// A walk through a .dae file before Assimp gets it: Assimp takes sizes, counts and indices on
// trust, and waits for ever for a word in a list that is no number.
#include <array>
#include <map>

#include "luxel/import/nesting.h"
#include "luxel/import/text_lines.h"
#include "luxel/import/xml_text.h"

namespace luxel::import {
namespace {

/// Characters that Assimp skips between the numbers of a list.
constexpr std::string_view kListBlanks = " \t\r\n\f";

/// A limit for indices into what the file does not say.
constexpr uint64_t kNoLimit = INT32_MAX;

struct ColladaArray {
  std::string_view kind;  ///< float_array, Name_array, IDREF_array
  uint64_t size = 0;
};

struct ColladaAccessor {
  std::string_view text, array;
  uint64_t params = 0;
  size_t at = 0;
};

struct ColladaInput {
  std::string_view semantic, source;
  uint64_t offset = 0;
};

/// Lists of indices that share their inputs: triangles, polylist, ...; the weights of a skin.
struct ColladaLists {
  std::string_view kind;
  uint64_t count = 0;  ///< as the file states it
  std::vector<ColladaInput> inputs;
  uint64_t vcounts = 0, vcount_sum = 0;

  /// Indices per point.
  uint64_t stride() const {
    uint64_t most = 0;
    for (const ColladaInput& input : inputs) most = std::max(most, input.offset);
    return most + 1;
  }
};

/// A skin tells Assimp where the vertices of a geometry go; both must be of one size.
struct ColladaSkin {
  std::string_view geometry;
  uint64_t vertices = 0;
  size_t at = 0;
};

/// The file as far as it has been walked. What a name stands for may change on the way.
struct ColladaWalk {
  const SourceFile& source;
  std::string_view text;
  std::map<std::string_view, ColladaArray> arrays{};
  std::map<std::string_view, ColladaAccessor> accessors{};               // of sources, by their ids
  std::map<std::string_view, std::vector<std::string_view>> vertices{};  // sources, by their ids
  std::map<std::string_view, uint64_t> geometry_sizes{};                 // vertices
  std::vector<ColladaSkin> skins{};

  std::string_view geometry_id{}, source_id{}, vertices_id{};  // that were opened last
  bool in_accessor = false;
  std::optional<ColladaLists> lists{};
  std::map<std::string_view, std::string_view> joints{};  // sources, by semantic

  template <class... Parts>
  Failure error(size_t at, fmt::format_string<Parts...> format, Parts&&... parts) const {
    return fail(ErrorCode::bad_input, "{}, line {}: {}", source.name, line_of(text, at),
                fmt::format(format, std::forward<Parts>(parts)...));
  }
};

/// Entries of an accessor, all of which its array must hold.
Result<uint64_t> entries_of(const ColladaWalk& walk, const ColladaAccessor& accessor) {
  const auto array = walk.arrays.find(accessor.array);
  if (array == walk.arrays.end()) return kNoLimit;
  const uint64_t size = array->second.size;
  const auto count = attribute_number(accessor.text, "count", 0),
             stride = attribute_number(accessor.text, "stride", 1),
             offset = attribute_number(accessor.text, "offset", 0);
  // Each of `count` entries begins a stride after the one before and has one number per param.
  const uint64_t entry = std::max(accessor.params, stride.value_or(0));
  if (!count || !stride || !offset || *offset > size ||
      (*count > 0 && *offset + (*count - 1) * *stride + entry > size))
    return walk.error(accessor.at, "an accessor reads past the {} '{}', which holds {} {}",
                      array->second.kind, array->first, size,
                      array->second.kind == "float_array" ? "numbers" : "names");
  return *count;
}

Result<uint64_t> entries_of(const ColladaWalk& walk, std::string_view source) {
  const auto accessor = walk.accessors.find(source);
  if (accessor != walk.accessors.end()) return entries_of(walk, accessor->second);
  const auto vertices = walk.vertices.find(source);
  if (vertices == walk.vertices.end()) return kNoLimit;
  uint64_t fewest = kNoLimit;
  for (const std::string_view its : vertices->second) {
    if (its == source) continue;
    const auto one = walk.accessors.find(its);
    if (one == walk.accessors.end()) continue;
    LUXEL_TRY(const uint64_t entries, entries_of(walk, one->second));
    fewest = std::min(fewest, entries);
  }
  return fewest;
}

/// The words between an element's tag and the next one.
struct ColladaWords {
  std::string_view file;
  size_t at = 0, end = 0;

  /// Empty at the end.
  std::string_view next() {
    at = std::min(file.find_first_not_of(kListBlanks, at), end);
    const size_t start = at;
    at = std::min(file.find_first_of(kListBlanks, at), end);
    return file.substr(start, at - start);
  }
};

/// All that stands in an element that holds no others, comments too: Assimp stops at them.
ColladaWords words_in(const ColladaWalk& walk, const XmlTag& tag) {
  if (tag.closes) return {walk.text, tag.end(), tag.end()};
  const auto next = next_tag(walk.text, tag.end());
  return {walk.text, tag.end(), next ? next->at : walk.text.size()};
}

Result<uint64_t> index_in(const ColladaWalk& walk, std::string_view word, std::string_view list) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc() && end == word.data() + word.size() && value <= kNoLimit) return value;
  return walk.error(size_t(word.data() - walk.text.data()),
                    "'{}' in <{}> is not a whole number of 0 or more", word.substr(0, 40), list);
}

Status check_vcount(ColladaWalk& walk, const XmlTag& tag) {
  ColladaLists& lists = *walk.lists;
  ColladaWords words = words_in(walk, tag);
  for (std::string_view word; !(word = words.next()).empty(); ++lists.vcounts) {
    LUXEL_TRY(const uint64_t number, index_in(walk, word, "vcount"));
    lists.vcount_sum += number;
  }
  if (lists.vcounts == lists.count) return {};
  return walk.error(tag.at, "<vcount> holds {} numbers, but <{}> states a count of {}",
                    lists.vcounts, lists.kind, lists.count);
}

struct ColladaLimit {
  uint64_t entries = kNoLimit;
  std::string_view source;
};

/// Upper limits (exclusive) of each of a point's indices.
Result<std::vector<ColladaLimit>> limits_of(const ColladaWalk& walk, const XmlTag& tag) {
  const ColladaLists& lists = *walk.lists;
  constexpr uint64_t kMostOffsets = 1000;
  if (lists.stride() > kMostOffsets)
    return walk.error(tag.at, "an input has the offset {}, more than {}", lists.stride() - 1,
                      kMostOffsets);
  std::vector<ColladaLimit> limits(lists.stride());
  for (const ColladaInput& input : lists.inputs) {
    LUXEL_TRY(const uint64_t entries, entries_of(walk, input.source));
    if (entries < limits[input.offset].entries) limits[input.offset] = {entries, input.source};
  }
  return limits;
}

/// Numbers in a list. `may_be_none`: the first of each point may be -1.
Result<uint64_t> check_indices(const ColladaWalk& walk, const XmlTag& tag, bool may_be_none) {
  LUXEL_TRY(const std::vector<ColladaLimit> limits, limits_of(walk, tag));
  ColladaWords words = words_in(walk, tag);
  uint64_t count = 0;
  for (std::string_view word; !(word = words.next()).empty(); ++count) {
    const ColladaLimit& limit = limits[count % limits.size()];
    if (may_be_none && count % limits.size() == 0 && word == "-1") continue;
    LUXEL_TRY(const uint64_t index, index_in(walk, word, tag.name));
    if (index >= limit.entries)
      return walk.error(size_t(word.data() - walk.text.data()),
                        "index {} in <{}> is out of range, '{}' has {} entries", word, tag.name,
                        limit.source, limit.entries);
  }
  return count;
}

/// Points that a <p> must have; none when it may have any number. SketchUp states wrong counts for
/// lines, which Assimp knows.
std::optional<uint64_t> points_needed(const ColladaLists& lists) {
  if (lists.kind == "polylist") return lists.vcount_sum;
  if (lists.kind == "triangles") return 3 * lists.count;
  return std::nullopt;
}

Status check_p(ColladaWalk& walk, const XmlTag& tag) {
  const ColladaLists& lists = *walk.lists;
  const auto is_vertex = [](const ColladaInput& input) { return input.semantic == "VERTEX"; };
  if (std::none_of(lists.inputs.begin(), lists.inputs.end(), is_vertex))
    return walk.error(tag.at, "a <p> comes before an input with the semantic VERTEX");
  if (lists.kind == "polylist" && lists.vcounts != lists.count)
    return walk.error(tag.at, "a <p> comes before its <vcount>");
  LUXEL_TRY(const uint64_t count, check_indices(walk, tag, false));
  const uint64_t stride = lists.stride();
  const auto needed = points_needed(lists);
  if (needed && count != *needed * stride)
    return walk.error(tag.at, "<p> holds {} numbers where {} are needed, {} for each of {} points",
                      count, *needed * stride, stride, *needed);
  if (count % stride != 0)
    return walk.error(tag.at, "<p> holds {} numbers, which cannot be {} for each point", count,
                      stride);
  // Assimp reads none when the stated count is 0.
  const uint64_t points = lists.count == 0 ? 0 : count / stride;
  const uint64_t fewest = lists.kind == "tristrips" ? 3 : lists.kind == "linestrips" ? 2 : 0;
  if (points < fewest)
    return walk.error(tag.at, "a strip of {} points; it needs {}", points, fewest);
  return {};
}

/// The pairs of a skin's weights.
Status check_v(ColladaWalk& walk, const XmlTag& tag) {
  const ColladaLists& lists = *walk.lists;
  if (lists.stride() != 2 || lists.vcounts != lists.count)
    return walk.error(tag.at, "a <v> needs two inputs and a <vcount> before it");
  LUXEL_TRY(const uint64_t count, check_indices(walk, tag, true));
  if (count == 2 * lists.vcount_sum) return {};
  return walk.error(tag.at, "<v> holds {} numbers where {} are needed", count,
                    2 * lists.vcount_sum);
}

Status open_lists(ColladaWalk& walk, const XmlTag& tag) {
  const auto count = attribute_number(tag.text, "count", 0);
  // Each of them takes a byte at least.
  if (!count || *count > walk.text.size())
    return walk.error(tag.at,
                      "<{}> states a count of '{}', which is not one or more than the file "
                      "holds",
                      tag.name, attribute(tag.text, "count").substr(0, 40));
  walk.lists = ColladaLists{.kind = tag.name, .count = *count, .inputs = {}};
  if (tag.name == "vertex_weights" && !walk.skins.empty()) walk.skins.back().vertices = *count;
  return {};
}

Status note_input(ColladaWalk& walk, const XmlTag& tag) {
  const auto offset = attribute_number(tag.text, "offset", 0);
  if (!offset)
    return walk.error(tag.at, "an input's offset '{}' is not a whole number",
                      attribute(tag.text, "offset").substr(0, 40));
  const ColladaInput input{attribute(tag.text, "semantic"),
                           name_referred_to(attribute(tag.text, "source")), *offset};
  if (walk.lists)
    walk.lists->inputs.push_back(input);
  else if (!walk.vertices_id.empty())
    walk.vertices[walk.vertices_id].push_back(input.source);
  else
    walk.joints[input.semantic] = input.source;
  return {};
}

/// Assimp reads as many matrices as there are names of joints.
Status check_joints(const ColladaWalk& walk, const XmlTag& tag) {
  const auto names = walk.joints.find("JOINT"), matrices = walk.joints.find("INV_BIND_MATRIX");
  if (names == walk.joints.end() || matrices == walk.joints.end()) return {};
  const auto accessor = walk.accessors.find(names->second);
  if (accessor == walk.accessors.end()) return {};
  const auto array = walk.arrays.find(accessor->second.array);
  if (array == walk.arrays.end()) return {};
  LUXEL_TRY(const uint64_t count, entries_of(walk, matrices->second));
  if (array->second.size <= count) return {};
  return walk.error(tag.at, "a skin has {} joints and {} matrices", array->second.size, count);
}

constexpr std::array<std::string_view, 8> kLists{"triangles", "lines",         "linestrips",
                                                 "polygons",  "polylist",      "trifans",
                                                 "tristrips", "vertex_weights"};
bool is_lists(std::string_view name) {
  return std::find(kLists.begin(), kLists.end(), name) != kLists.end();
}

Status open_element(ColladaWalk& walk, const XmlTag& tag) {
  const std::string_view id = attribute(tag.text, "id");
  for (const char* name : {"id", "source", "url"})
    if (const std::string_view value = attribute(tag.text, name); needs_decoding(value))
      return walk.error(tag.at, "the {} '{}' holds a reference or a line break; rename it", name,
                        value.substr(0, 40));
  if (tag.name == "geometry") walk.geometry_id = id;
  if (tag.name == "source") walk.source_id = id;
  if (tag.name == "vertices") walk.vertices_id = id, walk.vertices[id].clear();
  if (tag.name == "joints") walk.joints.clear();
  if (tag.name == "skin")
    walk.skins.push_back({name_referred_to(attribute(tag.text, "source")), 0, tag.at});
  if (tag.name == "float_array" || tag.name == "Name_array" || tag.name == "IDREF_array")
    walk.arrays[id] = {tag.name, attribute_number(tag.text, "count", 0).value_or(0)};
  if (tag.name == "accessor")
    walk.accessors[walk.source_id] = {tag.text, name_referred_to(attribute(tag.text, "source")), 0,
                                      tag.at};
  if (tag.name == "accessor") walk.in_accessor = true;
  if (tag.name == "param" && walk.in_accessor) ++walk.accessors[walk.source_id].params;
  if (tag.name == "input") return note_input(walk, tag);
  if (is_lists(tag.name)) return open_lists(walk, tag);
  if (!walk.lists) return {};
  if (tag.name == "vcount") return check_vcount(walk, tag);
  if (tag.name == "p" && walk.lists->kind != "vertex_weights") return check_p(walk, tag);
  if (tag.name == "v" && walk.lists->kind == "vertex_weights") return check_v(walk, tag);
  return {};
}

Status close_element(ColladaWalk& walk, const XmlTag& tag) {
  if (is_lists(tag.name)) walk.lists.reset();
  if (tag.name == "accessor") {
    walk.in_accessor = false;
    return entries_of(walk, walk.accessors[walk.source_id]).map([](uint64_t) {});
  }
  if (tag.name == "joints") return check_joints(walk, tag);
  if (tag.name != "vertices") return {};
  LUXEL_TRY(walk.geometry_sizes[walk.geometry_id], entries_of(walk, walk.vertices_id));
  walk.vertices_id = {};
  return {};
}

Status check_skins(const ColladaWalk& walk) {
  for (const ColladaSkin& skin : walk.skins) {
    const auto size = walk.geometry_sizes.find(skin.geometry);
    if (size != walk.geometry_sizes.end() && size->second != kNoLimit &&
        skin.vertices < size->second)
      return walk.error(skin.at, "a skin has weights for {} vertices, but '{}' has {}",
                        skin.vertices, skin.geometry, size->second);
  }
  return {};
}

Status check_lists(const SourceFile& source) {
  ColladaWalk walk{.source = source, .text = text_of(source.bytes)};
  size_t at = 0;
  while (const auto tag = next_tag(walk.text, at)) {
    at = tag->end();
    if (tag->opens) LUXEL_TRY_STATUS(open_element(walk, *tag));
    if (tag->closes) LUXEL_TRY_STATUS(close_element(walk, *tag));
  }
  // An array that was given again, smaller, after an accessor.
  for (const auto& [id, accessor] : walk.accessors) {
    LUXEL_TRY_STATUS(entries_of(walk, accessor));
  }
  return check_skins(walk);
}

}  // namespace

Status check_collada(const SourceFile& source) {
  LUXEL_TRY_STATUS(check_lists(source));
  return check_collada_nodes(source);
}

}  // namespace luxel::import
