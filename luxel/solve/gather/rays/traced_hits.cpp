#include "luxel/solve/gather/rays/traced_hits.h"

#include "luxel/base/check.h"

namespace luxel::gather {

uint64_t TracedHits::bytes_in_memory() const {
  uint64_t bytes = 0;
  for (const HitStore& round : rounds) bytes += round.bytes_in_memory();
  return bytes;
}

uint64_t TracedHits::bytes_in_file() const {
  uint64_t bytes = 0;
  for (const HitStore& round : rounds) bytes += round.bytes_in_file();
  return bytes;
}

float rays_per_sample(const TracedHits& hits, size_t element) {
  if (!is_guided(hits, element)) return 1;
  const GuidedGroup& group = hits.guide.groups[hits.guide.of_element[element]];
  return group.level(hits.guided[element]).rays / float(kCells);
}

void begin_guided(TracedHits& hits, size_t element, int level) {
  LUXEL_CHECK(hits.guide.of_element[element] != kNoGuide);
  LUXEL_CHECK(level >= 1 && level <= kGuideLevels);
  hits.guided[element] = uint8_t(level);
  hits.first_round[element] = hits.last_round[element] = uint8_t(hits.rounds.size());
  hits.samples[element] = 0;
  hits.sky[element] = {};
  hits.sky_luminance2[element] = hits.sky_first_less_second[element] = 0;
  const size_t layers = hits.sky_by_layer.size() / hits.size();
  for (size_t l = 0; l < layers; ++l) hits.sky_by_layer[element * layers + l] = {};
}

TracedHits no_hits(size_t elements, size_t layers, std::shared_ptr<MappedMemory> memory) {
  TracedHits out;
  out.sky = MappedVector<Rgb>(memory);
  out.sky_luminance2 = MappedVector<float>(memory);
  out.sky_first_less_second = MappedVector<float>(memory);
  out.samples.resize(elements), out.last_round.resize(elements);
  out.first_round.resize(elements), out.guided.resize(elements), out.counted.resize(elements);
  out.escaped.resize(elements), out.met_back.resize(elements);
  out.met_double_sided_back.resize(elements);
  out.sky.resize(elements), out.sky_by_layer.resize(elements * layers);
  out.sky_luminance2.resize(elements), out.sky_first_less_second.resize(elements);
  return out;
}

}  // namespace luxel::gather
