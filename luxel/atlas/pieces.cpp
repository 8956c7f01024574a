#include "luxel/atlas/pieces.h"

#include <unordered_map>
#include <utility>

#include "luxel/base/digest.h"
#include "luxel/base/parallel.h"

namespace luxel::atlas {
namespace {

uint64_t mask_digest(const Mask& mask) {
  Digest digest;
  digest.add(mask.width);
  digest.add(std::span<const Span>(mask.runs));
  digest.add(std::span<const uint32_t>(mask.first_run));
  return digest.value();
}

/// Masks by their digests.
struct Known {
  std::vector<Mask> masks;
  std::unordered_map<uint64_t, uint32_t> by_digest{};

  /// The number of a mask that is equal to this one, which is added when there is none. Should two
  /// that differ have one digest, the later ones are added each time.
  uint32_t number_of(Mask&& mask, uint64_t digest) {
    const auto [at, added] = by_digest.try_emplace(digest, uint32_t(masks.size()));
    if (!added && masks[at->second] == mask) return at->second;
    masks.push_back(std::move(mask));
    return uint32_t(masks.size() - 1);
  }
};

/// A mask with what it turns into, and their digests.
struct Turned {
  std::vector<Mask> masks;
  std::vector<uint64_t> digests;
};

Turned more_turns(const Mask& upright) {
  // Half a turn makes no difference to a shape that nearly fills its rectangle.
  const bool full = double(upright.texels) > 0.95 * upright.width * upright.height;
  Turned out;
  for (int t = 1; t < (full ? 2 : 4); ++t) {
    out.masks.push_back(turned(t == 1 ? upright : out.masks.back()));
    out.digests.push_back(mask_digest(out.masks.back()));
  }
  return out;
}

/// All turns of the masks that are known, which are added to them; per mask known before.
std::vector<Turns> add_turns(Known& known) {
  std::vector<Turned> more(known.masks.size());
  parallel_for(more.size(), 16, [&](size_t begin, size_t end) {
    for (size_t m = begin; m < end; ++m) more[m] = more_turns(known.masks[m]);
  });
  std::vector<Turns> turns(more.size());
  for (uint32_t m = 0; m < more.size(); ++m) {
    turns[m] = {{m}, 1};
    for (size_t t = 0; t < more[m].masks.size(); ++t)
      turns[m].mask[turns[m].count++] =
          known.number_of(std::move(more[m].masks[t]), more[m].digests[t]);
  }
  return turns;
}

}  // namespace

Pieces make_pieces(std::vector<std::vector<Mask>> charts) {
  std::vector<Mask*> masks;
  for (std::vector<Mask>& directions : charts)
    for (Mask& mask : directions) masks.push_back(&mask);
  std::vector<uint64_t> digests(masks.size());
  parallel_for(masks.size(), 64, [&](size_t begin, size_t end) {
    for (size_t m = begin; m < end; ++m) digests[m] = mask_digest(*masks[m]);
  });
  Known known;
  std::vector<uint32_t> numbers(masks.size());
  for (size_t m = 0; m < masks.size(); ++m)
    numbers[m] = known.number_of(std::move(*masks[m]), digests[m]);
  const std::vector<Turns> turns = add_turns(known);

  Pieces pieces;
  pieces.charts.resize(charts.size());
  for (size_t c = 0, m = 0; c < charts.size(); ++c) {
    pieces.charts[c].reserve(charts[c].size());
    for (size_t d = 0; d < charts[c].size(); ++d) pieces.charts[c].push_back(turns[numbers[m++]]);
  }
  pieces.masks = std::move(known.masks);
  pieces.shapes.resize(pieces.masks.size());
  parallel_for(pieces.masks.size(), 16, [&](size_t begin, size_t end) {
    for (size_t m = begin; m < end; ++m) pieces.shapes[m] = make_shape(pieces.masks[m]);
  });
  return pieces;
}

}  // namespace luxel::atlas
