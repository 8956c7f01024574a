#include "luxel/solve/matrix/codec.h"

#include <algorithm>

namespace luxel::matrix {
namespace {

uint64_t bytes_of(const CoarseScene& coarse) {
  uint64_t bytes = 4 * (coarse.cluster_of.size() + coarse.area_m2.size());
  for (const auto& channel : coarse.response) bytes += 4 * channel.size();
  return bytes;
}

template <class Iterated>
void iterate(const Iterated& codec, const Multiply& product, const Sent& sent,
             std::span<Rgb> irradiance, BounceWork& work) {
  if (sent.bounces >= 0)
    count_bounces(product, sent, irradiance, work);
  else
    all_bounces(product, codec.coarse, sent, codec.sweeps, irradiance, work);
}

/// Calls the function for the codec that there is.
template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

}  // namespace

CodecWork make_work(const Codec& codec, size_t patches) {
  CodecWork work;
  std::visit(Overloaded{[&](const HierarchicalCodec& c) {
                          work.hierarchical = make_work(c.matrix);
                          work.bounces = make_bounce_work(patches, c.coarse.count());
                        },
                        [&](const DenseCodec& c) {
                          work.dense = make_dense_work(patches);
                          work.bounces = make_bounce_work(patches, c.coarse.count());
                        },
                        [&](const Bc1Codec& c) { work.bc1 = make_bc1_work(c.matrix); },
                        [&](const LowRankCodec& c) { work.low_rank = make_work(c.matrix); }},
             codec);
  return work;
}

void irradiance_of(const Codec& codec, const Sent& sent, std::span<Rgb> irradiance,
                   CodecWork& work) {
  if (sent.bounces == 0) {
    std::fill(irradiance.begin(), irradiance.end(), Rgb{});
    return;
  }
  std::visit(
      Overloaded{
          [&](const HierarchicalCodec& c) {
            const auto product = [&c, &work](std::span<const Rgb> b, std::span<Rgb> e) {
              multiply(c.matrix, b, e, work.hierarchical);
            };
            iterate(c, product, sent, irradiance, work.bounces);
          },
          [&](const DenseCodec& c) {
            const auto product = [&c, &work](std::span<const Rgb> b, std::span<Rgb> e) {
              multiply(c.matrix, b, e, work.dense);
            };
            iterate(c, product, sent, irradiance, work.bounces);
          },
          [&](const Bc1Codec& c) { multiply(c.matrix, sent.radiosity, irradiance, work.bc1); },
          [&](const LowRankCodec& c) {
            irradiance_of(c.matrix, sent.radiosity, sent.bounces, irradiance, work.low_rank);
          }},
      codec);
}

uint64_t bytes_of(const Codec& codec) {
  return std::visit(
      Overloaded{[](const HierarchicalCodec& c) { return bytes_of(c.matrix) + bytes_of(c.coarse); },
                 [](const DenseCodec& c) { return bytes_of(c.matrix) + bytes_of(c.coarse); },
                 [](const Bc1Codec& c) { return bytes_of(c.matrix); },
                 [](const LowRankCodec& c) { return bytes_of(c.matrix); }},
      codec);
}

}  // namespace luxel::matrix
