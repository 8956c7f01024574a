#include "luxel/solve/gather/budget/guide.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "luxel/base/random.h"
#include "luxel/base/share_out.h"
#include "luxel/scene/sides.h"
#include "luxel/solve/gather/bounce/radiosity_map.h"
#include "luxel/solve/gather/trace/sort_rays.h"
#include "luxel/transport/own_side.h"

namespace luxel::gather {
namespace {

/// Texels along a side of a group.
constexpr uint32_t kGroupSide = 8;
/// Rays that tell of each cell of a whole group, and of the smallest.
constexpr size_t kMostRaysPerCell = 16, kFewestRaysPerCell = 8;
/// So many rays with the mean variance of all cells are added to those of each: what few rays have
/// seen of a cell may not be all that there is.
constexpr double kPriorRays = 1;
/// Groups that a thread, or a member of a team, takes at a time.
constexpr size_t kGroupsPerPiece = 4;
/// Any number: it sets these random numbers apart from those of the light.
constexpr uint64_t kGuideSeed = 0x6d1de;

/// Elements by group.
struct Groups {
  std::vector<uint32_t> of_element;
  std::vector<std::vector<uint32_t>> elements;
};
/// Small groups are none.
Groups without_small(Groups all) {
  Groups out;
  std::vector<uint32_t> number(all.elements.size(), kNoGuide);
  for (size_t g = 0; g < number.size(); ++g) {
    if (all.elements[g].size() < kFewestInGroup) continue;
    number[g] = uint32_t(out.elements.size());
    out.elements.push_back(std::move(all.elements[g]));
  }
  out.of_element = std::move(all.of_element);
  for (uint32_t& g : out.of_element)
    if (g != kNoGuide) g = number[g];
  return out;
}

Groups groups_of(const light::TexelScene& in, const TracedHits& hits, std::span<const float> asks) {
  Groups out;
  out.of_element.assign(hits.size(), kNoGuide);
  std::unordered_map<uint64_t, uint32_t> number;
  for (uint32_t i = 0; i < hits.size(); ++i) {
    if (is_hidden(hits, i) || (!asks.empty() && !(asks[i] > 0))) continue;
    const atlas::Texel& texel = in.map.texels[i];
    const uint64_t chart = in.atlas.chart[texel.triangle_number];
    // Maps have 16,384 texels a side at most.
    const uint64_t key = chart << 24 | uint64_t(texel.y / kGroupSide) << 12 | texel.x / kGroupSide;
    const auto [found, is_new] = number.try_emplace(key, uint32_t(out.elements.size()));
    if (is_new) out.elements.emplace_back();
    out.of_element[i] = found->second;
    out.elements[found->second].push_back(i);
  }
  return without_small(std::move(out));
}

/// The scene that rays meet, and the light that its texels send.
struct GuideScene {
  const light::TexelScene& in;
  const transport::OwnSides& sides;
  const RadiosityMap& sent;
  uint64_t seed = 0;
};
struct GuideBuffers {
  RayBatch batch;
  std::vector<trace::Hit> hits;
};

/// Luminance that a ray brings; where rays would be followed on, what the map has there.
float brought(const GuideScene& from, const trace::Ray& ray, const trace::Hit& hit) {
  const light::TexelScene& in = from.in;
  if (!hit.found())
    return kPi * luminance(light::soft_radiance(in.scene, in.lights.around, ray.direction));
  if (hit.back_face && !scene::reflects_from_behind(scene::material_at(in.scene, hit.point())))
    return 0;
  const Float4 b = lookup(from.sent, store(transport::own_lookup(from.sides, hit.point()), {}));
  return luminance({b[0], b[1], b[2]});
}

/// Sums over the rays of a cell.
struct CellSums {
  double count = 0, sum = 0, sum2 = 0;

  void add(double x) { ++count, sum += x, sum2 += x * x; }
  double variance() const {
    return count > 1 ? std::max(0.0, sum2 - sum * sum / count) / (count - 1) : 0;
  }
};

/// Adds what rays of an element bring, one in each cell.
void add_element(const GuideScene& from, uint32_t i, GuideBuffers& buffers,
                 std::array<CellSums, kCells>& sums) {
  const transport::Elements& e = from.in.elements;
  RayBatch& batch = buffers.batch;
  fill_rays(e.position[i], e.normal[i], e.geometric_normal[i], seed_of_rays(from.seed, i),
            {0, uint32_t(kCells)}, batch);
  buffers.hits.resize(batch.rays.size());
  from.in.tracer.closest_hits(batch.rays, buffers.hits, trace::Packets::alike);
  for (size_t c = 0; c < kCells; ++c)
    for (uint32_t k = batch.first_of_cell[c]; k < batch.first_of_cell[c + 1]; ++k)
      sums[c].add(double(brought(from, batch.rays[k], buffers.hits[k])));
}

/// Standard deviations of what rays of a group bring, cell by cell.
std::array<float, kCells> deviations_of(const GuideScene& from, std::span<const uint32_t> elements,
                                        GuideBuffers& buffers) {
  std::array<CellSums, kCells> sums{};
  const size_t rays =
      std::clamp(elements.size() * kMostRaysPerCell / size_t(kGroupSide * kGroupSide),
                 kFewestRaysPerCell, kMostRaysPerCell);
  for (size_t k = 0; k < rays; ++k)
    add_element(from, elements[k * elements.size() / rays], buffers, sums);
  double mean = 0;
  for (const CellSums& cell : sums) mean += cell.variance() / double(kCells);
  std::array<float, kCells> out;
  for (size_t c = 0; c < kCells; ++c)
    out[c] = float(std::sqrt((sums[c].variance() * sums[c].count + mean * kPriorRays) /
                             (sums[c].count + kPriorRays)));
  return out;
}

}  // namespace

Result<Guide> make_guide(const light::TexelScene& in, const transport::OwnSides& sides,
                         const LightToGuide& light, uint64_t seed, Progress& progress) {
  Groups groups = groups_of(in, light.hits, light.asks);
  RadiosityMap sent = empty_radiosity_map(in.map.resolution);
  fill_radiosity(sent, in.map, in.elements, light.hits, light.behind, light.irradiance);
  const GuideScene from{in, sides, sent, hash64(seed, kGuideSeed)};
  Guide out;
  out.groups.resize(groups.elements.size());
  const auto of_piece = [&](size_t piece) {
    const size_t begin = piece * kGroupsPerPiece;
    return std::pair(begin, std::min(begin + kGroupsPerPiece, out.groups.size()));
  };
  const size_t pieces = (out.groups.size() + kGroupsPerPiece - 1) / kGroupsPerPiece;
  LUXEL_TRY(const std::vector<uint32_t> own,
            share_out(light.team, pieces, progress, [&](size_t piece) {
              GuideBuffers buffers;
              const auto [begin, end] = of_piece(piece);
              for (size_t g = begin; g < end && !progress.cancelled(); ++g)
                out.groups[g] = guided_group(deviations_of(from, groups.elements[g], buffers));
            }));
  const auto groups_of_piece = [&](size_t piece) {
    const auto [begin, end] = of_piece(piece);
    return std::span(out.groups).subspan(begin, end - begin);
  };
  LUXEL_TRY_STATUS(exchange(light.team, own,
                            {pieces,
                             [&](size_t piece, ByteWriter& bytes) {
                               bytes.put(std::span<const GuidedGroup>(groups_of_piece(piece)));
                             },
                             [&](size_t piece, uint32_t, ByteReader& bytes) {
                               bytes.get(groups_of_piece(piece));
                               return bytes.ok;
                             }},
                            progress));
  out.of_element = std::move(groups.of_element);
  return out;
}

}  // namespace luxel::gather
