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
             std::span<Rgb> irradiance, BounceScratch& scratch) {
  if (sent.bounces >= 0)
    count_bounces(product, sent, irradiance, scratch);
  else
    all_bounces(product, codec.coarse, sent, codec.sweeps, irradiance, scratch);
}

/// Calls the function for the codec that there is.
template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

}  // namespace

CodecScratch make_scratch(const Codec& codec, size_t patches) {
  CodecScratch scratch;
  std::visit(Overloaded{[&](const HierarchicalCodec& c) {
                          scratch.hierarchical = make_scratch(c.matrix);
                          scratch.bounces = make_bounce_scratch(patches, c.coarse.count());
                        },
                        [&](const DenseCodec& c) {
                          scratch.dense = make_dense_scratch(patches);
                          scratch.bounces = make_bounce_scratch(patches, c.coarse.count());
                        },
                        [&](const Bc1Codec& c) { scratch.bc1 = make_bc1_scratch(c.matrix); },
                        [&](const LowRankCodec& c) { scratch.low_rank = make_scratch(c.matrix); }},
             codec);
  return scratch;
}

void irradiance_of(const Codec& codec, const Sent& sent, std::span<Rgb> irradiance,
                   CodecScratch& scratch) {
  if (sent.bounces == 0) {
    std::fill(irradiance.begin(), irradiance.end(), Rgb{});
    return;
  }
  std::visit(
      Overloaded{
          [&](const HierarchicalCodec& c) {
            const auto product = [&c, &scratch](std::span<const Rgb> b, std::span<Rgb> e) {
              multiply(c.matrix, b, e, scratch.hierarchical);
            };
            iterate(c, product, sent, irradiance, scratch.bounces);
          },
          [&](const DenseCodec& c) {
            const auto product = [&c, &scratch](std::span<const Rgb> b, std::span<Rgb> e) {
              multiply(c.matrix, b, e, scratch.dense);
            };
            iterate(c, product, sent, irradiance, scratch.bounces);
          },
          [&](const Bc1Codec& c) { multiply(c.matrix, sent.radiosity, irradiance, scratch.bc1); },
          [&](const LowRankCodec& c) {
            irradiance_of(c.matrix, sent.radiosity, sent.bounces, irradiance, scratch.low_rank);
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
