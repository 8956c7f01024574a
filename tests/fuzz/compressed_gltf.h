// .glb files around compressed data, for the fuzzers of its decoders.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace luxel::fuzz {

/// A mesh that KHR_draco_mesh_compression fills: two bytes with its vertices and two with its
/// triangles, little-endian, then Draco's data. Attributes 0, 1 and 2 are positions, normals and
/// texture coordinates.
std::vector<std::byte> draco_glb(std::span<const std::byte> input);

/// A mesh whose positions and indices meshopt fills. The first byte has the filter (bits 0 and 1),
/// whether the indices are a list of triangles (bit 2) and have two bytes (bit 3), whether the
/// extension is KHR_meshopt_compression (bit 4), and the filter COLOR instead (bit 5); then come a
/// vertex' size in units of 4 bytes, and in two bytes each the vertices, the indices and the length
/// of the vertices' data; then both data. Vertices too small for floats are bytes.
std::vector<std::byte> meshopt_glb(std::span<const std::byte> input);

}  // namespace luxel::fuzz
