// Direct light as parts that are kept (luxel/base/part_store.h).
#pragma once

#include <span>

#include "luxel/base/bytes.h"
#include "luxel/base/digest.h"
#include "luxel/light/direct_light.h"

namespace luxel::light {

/// The layer that each light belongs to; nothing where light is not told apart.
void add_to(Digest& digest, const LightLayers* layers);
/// Adds the parameters that drawn light depends on.
void add_to(Digest& digest, const DirectParams& params);

/// All that `direct` knows of some elements, in their order.
void put_light(const DirectLight& direct, std::span<const uint32_t> which, ByteWriter& out);
/// Such light back into `direct`. False, with `direct` as it was, where the bytes are too few.
bool get_light(ByteReader& in, std::span<const uint32_t> which, DirectLight& direct);

}  // namespace luxel::light
