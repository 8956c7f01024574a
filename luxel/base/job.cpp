#include "luxel/base/job.h"

#include <numeric>

#include "luxel/base/share_out.h"

namespace luxel {
inline namespace base {
namespace {

void put(const PartWork& work, size_t k, uint64_t rays, ByteWriter& out) {
  out.put_value(rays);
  work.put(k, out);
}

/// Returns the rays.
std::optional<uint64_t> get(const PartWork& work, size_t k, ByteReader& in) {
  const uint64_t rays = in.get_value<uint64_t>();
  return in.ok && work.get(k, in) ? std::optional(rays) : std::nullopt;
}

/// A kept part ends with the number of the bytes before it. One of another size is not taken, even
/// in part: computing begins from values that get() writes.
std::optional<uint64_t> find(const KeptStage& kept, const PartWork& work, size_t k) {
  const auto bytes = kept.find(k);
  if (!bytes) return std::nullopt;
  const std::span<const std::byte> all(*bytes);
  if (all.size() < sizeof(uint64_t)) return std::nullopt;
  ByteReader in{all.first(all.size() - sizeof(uint64_t))}, end{all.last(sizeof(uint64_t))};
  if (end.get_value<uint64_t>() != in.bytes.size()) return std::nullopt;
  return get(work, k, in);
}

}  // namespace

void keep_part(const KeptStage& kept, const PartWork& work, size_t k, uint64_t rays) {
  if (!kept.wants()) return;
  ByteWriter out;
  put(work, k, rays, out);
  out.put_value(uint64_t(out.bytes.size()));
  kept.keep(k, out.bytes);
}

Result<uint64_t> for_each_part(const Job& job, const PartWork& work) {
  std::vector<uint64_t> rays(work.count);
  const auto make = [&](size_t k) {
    const std::optional<uint64_t> found = find(job.kept, work, k);
    rays[k] = found.value_or(0);
    if (found || job.kept.leaves(k)) return job.progress.skip(work.units(k));
    rays[k] = work.compute(k);
    keep_part(job.kept, work, k, rays[k]);
    job.progress.advance(work.units(k));
  };
  LUXEL_TRY(const std::vector<uint32_t> own, share_out(job.team, work.count, job.progress, make));
  const PieceExchange pieces{work.count,
                             [&](size_t k, ByteWriter& out) { put(work, k, rays[k], out); },
                             [&](size_t k, uint32_t, ByteReader& in) {
                               const auto got = get(work, k, in);
                               rays[k] = got.value_or(0);
                               return got.has_value();
                             }};
  LUXEL_TRY_STATUS(exchange(job.team, own, pieces, job.progress));
  return std::accumulate(rays.begin(), rays.end(), uint64_t(0));
}

}  // namespace base
}  // namespace luxel
