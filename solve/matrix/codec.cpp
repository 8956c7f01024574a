#include "solve/matrix/codec.h"

namespace luxel::matrix {
namespace {

/// Sweeps of the two-grid iteration: each loses some thirty times less than the one before, so what
/// is left after two is less than what a codec may lose.
constexpr int kSweeps = 2;

uint64_t bytes_of(const CoarseScene& coarse) {
  uint64_t bytes = 4 * (coarse.cluster_of.size() + coarse.area_m2.size());
  for (const auto& channel : coarse.response) bytes += 4 * channel.size();
  return bytes;
}

void iterate(const Multiply& product, const CoarseScene& coarse, const Sent& sent,
             std::span<Rgb> irradiance, BounceWork& work) {
  if (sent.bounces >= 0)
    count_bounces(product, sent.reflectance, sent.radiosity, sent.bounces, irradiance, work);
  else
    all_bounces(product, coarse, sent.reflectance, sent.area_m2, sent.radiosity, kSweeps,
                irradiance, work);
}

}  // namespace

CodecWork make_work(const Codec& codec, size_t patches) {
  CodecWork work;
  if (const auto* h = std::get_if<HierarchicalCodec>(&codec)) {
    work.hierarchical = make_work(h->matrix);
    work.bounces = make_bounce_work(patches, h->coarse.count());
  }
  return work;
}

void irradiance_of(const Codec& codec, const Sent& sent, std::span<Rgb> irradiance,
                   CodecWork& work) {
  if (const auto* h = std::get_if<HierarchicalCodec>(&codec)) {
    const auto product = [h, &work](std::span<const Rgb> b, std::span<Rgb> e) {
      multiply(h->matrix, b, e, work.hierarchical);
    };
    iterate(product, h->coarse, sent, irradiance, work.bounces);
  }
}

uint64_t bytes_of(const Codec& codec) {
  if (const auto* h = std::get_if<HierarchicalCodec>(&codec))
    return bytes_of(h->matrix) + bytes_of(h->coarse);
  return 0;
}

}  // namespace luxel::matrix
