#include "luxel/pipeline/reuse/same_work.h"

#include "luxel/base/bytes.h"
#include "luxel/base/digest.h"
#include "luxel/scene/digest.h"

namespace luxel::pipeline {
namespace {

/// A digest of all that is in a scene.
uint64_t digest_of_items(const scene::Scene& scene) {
  Digest digest;
  for (const scene::ItemDigest& item : scene::digests_of(scene)) {
    digest.add(item.kind), digest.add(item.name), digest.add(item.digest);
  }
  return digest.value();
}

}  // namespace

Status check_same_work(Team* team, const scene::Scene& scene, uint64_t more, Progress& progress) {
  if (!team) return {};
  ByteWriter own;
  own.put_value(digest_of_items(scene)), own.put_value(more);
  LUXEL_TRY(const auto all, team->all_gather(own.bytes, progress));
  for (size_t rank = 1; rank < all.size(); ++rank) {
    ByteReader here{all[0]}, there{all[rank]};
    if (here.get_value<uint64_t>() != there.get_value<uint64_t>())
      return fail(
          ErrorCode::bad_input,
          "process {} has another scene than process 0; check that both read the same files", rank);
    if (here.get_value<uint64_t>() != there.get_value<uint64_t>())
      return fail(ErrorCode::bad_input,
                  "process {} has other options or another layout of the scene than process 0; "
                  "check that their nodes have processors of the same kind",
                  rank);
  }
  return {};
}

}  // namespace luxel::pipeline
