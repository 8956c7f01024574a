// Parts of `luxel bench scenes`: each adds its notes and numbers to the table.
#pragma once

#include "bench/bench.h"

namespace luxel::bench {

/// Time at equal error in a hall with 4 and with 400 lamps.
Status measure_lamps(Table& table);
/// A dark house, a floor of tiles, and leaves: scenes of our own that must show certain things.
Status measure_own(Table& table);
/// Gather against the path tracer in a room under a map with a sun. Nothing where the shared data
/// is not on this machine.
Status measure_map(const std::filesystem::path& shared, Table& table);

}  // namespace luxel::bench
