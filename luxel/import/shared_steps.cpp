// Steps that both readers take.
#include <algorithm>
#include <bit>
#include <cstring>
#include <unordered_map>

#include "luxel/base/random.h"
#include "luxel/base/shown_text.h"
#include "luxel/import/readers.h"

namespace luxel::import {
namespace {

/// A vertex as bits: equality of floats would merge -0 with 0 and never NaN with NaN; both are
/// harmless, and bits can be hashed.
using VertexKey = std::array<uint32_t, 14>;

struct HashVertex {
  size_t operator()(const VertexKey& key) const {
    uint64_t h = 0;
    for (const uint32_t word : key) h = hash64(h ^ word);
    return size_t(h);
  }
};

template <class T>
void append_bits(VertexKey& key, size_t& at, const std::vector<T>& values, size_t vertex) {
  constexpr size_t words = sizeof(T) / sizeof(uint32_t);
  if (!values.empty()) std::memcpy(&key[at], &values[vertex], sizeof(T));
  at += words;
}

VertexKey key_of(const scene::Mesh& mesh, size_t vertex) {
  VertexKey key{};
  size_t at = 0;
  append_bits(key, at, mesh.positions, vertex);
  append_bits(key, at, mesh.normals, vertex);
  append_bits(key, at, mesh.uv0, vertex);
  append_bits(key, at, mesh.uv1, vertex);
  append_bits(key, at, mesh.colors, vertex);
  append_bits(key, at, mesh.alphas, vertex);
  return key;
}

template <class T>
void gather(std::vector<T>& values, const std::vector<uint32_t>& from) {
  if (values.empty()) return;
  std::vector<T> gathered(from.size());
  for (size_t i = 0; i < from.size(); ++i) gathered[i] = values[from[i]];
  values = std::move(gathered);
}

}  // namespace

void join_identical_vertices(scene::Mesh& mesh) {
  std::unordered_map<VertexKey, uint32_t, HashVertex> first;
  first.reserve(mesh.positions.size());
  std::vector<uint32_t> kept, new_index(mesh.positions.size());
  for (uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const auto [it, is_new] = first.try_emplace(key_of(mesh, v), uint32_t(kept.size()));
    if (is_new) kept.push_back(v);
    new_index[v] = it->second;
  }
  if (kept.size() == mesh.positions.size()) return;
  gather(mesh.positions, kept);
  gather(mesh.normals, kept);
  gather(mesh.uv0, kept);
  gather(mesh.uv1, kept);
  gather(mesh.colors, kept);
  gather(mesh.alphas, kept);
  for (auto& triangle : mesh.triangles)
    for (uint32_t& corner : triangle) corner = new_index[corner];
}

void drop_alphas_of_one(scene::Mesh& mesh) {
  if (std::ranges::all_of(mesh.alphas, [](float alpha) { return alpha == 1; })) mesh.alphas = {};
}

std::string one_sentence(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '.' || text.back() == ' '))
    text.pop_back();
  for (size_t at; (at = text.find('\n')) != std::string::npos;) text.replace(at, 1, "; ");
  constexpr size_t kMostBytes = 400;  // Assimp may quote the rest of the file
  return text.empty() ? "no reason is known" : short_message(text, kMostBytes);
}

scene::Material default_material() {
  scene::Material material;
  material.name = "default";
  material.base_color = {0.8f, 0.8f, 0.8f};
  return material;
}

std::string label(const char* kind, size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, index)
                      : fmt::format("{} {} ({})", kind, index, name);
}

}  // namespace luxel::import
