// The buffers that relighting reads and writes, in a device's memory.
#pragma once

#include <deque>

#include "luxel/gpu/commands.h"
#include "luxel/solve/matrix/relight_data.h"

namespace luxel::device {

/// Clusters of one depth of the hierarchy: a part of the list of all, depth by depth.
struct DepthPart {
  uint32_t first = 0, count = 0;
};

/// The buffers that shaders/relight_steps.comp reads, and what its steps are for.
struct RelightBuffers {
  std::deque<gpu::Buffer> held;  ///< whose addresses are in `setup`
  gpu::Buffer setup;
  gpu::Buffer at_probe;                            ///< direct light at RelightData::probe
  gpu::Buffer direct, indirect, at_place;          ///< Rgb per patch, per place
  gpu::Buffer radiosity_of_material;               ///< three floats each; the processor writes
  std::vector<DepthPart> depths;                   ///< from the root's on
  uint32_t patches = 0, clusters = 0, leaves = 0;  ///< none of the latter but in a hierarchy
  uint32_t coarse = 0, block_rows = 0, places = 0;
};

/// Sends an .lxr file's data to the device. Errors: a codec that is neither hierarchical nor BC1,
/// or no patch at all (ErrorCode::unsupported), no memory, the device is lost.
Result<RelightBuffers> upload_relight_data(gpu::Commands& commands,
                                           const matrix::RelightData& data);

}  // namespace luxel::device
