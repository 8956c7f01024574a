#include "luxel/solve/gather/rays/traced_hits.h"

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

TracedHits no_hits(size_t elements, size_t layers) {
  TracedHits out;
  out.samples.resize(elements), out.last_round.resize(elements);
  out.escaped.resize(elements), out.met_back.resize(elements);
  out.met_double_sided_back.resize(elements);
  out.sky.resize(elements), out.sky_by_layer.resize(elements * layers);
  out.sky_luminance2.resize(elements), out.sky_first_less_second.resize(elements);
  return out;
}

}  // namespace luxel::gather
