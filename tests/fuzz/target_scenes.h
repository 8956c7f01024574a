// Targets that read scenes. For targets.cpp.
#pragma once

#include <cstddef>
#include <span>

namespace luxel::fuzz {

/// A scene in memory whose extension is EXTENSION, with 256 MiB for reading it.
void run_gltf(std::span<const std::byte> input);
/// A .glb whose lengths are repaired, so that what lies inside is reached.
void run_glb(std::span<const std::byte> input);
/// Draco's data in a .glb (draco_glb).
void run_draco(std::span<const std::byte> input);
/// meshopt's data in a .glb (meshopt_glb).
void run_meshopt(std::span<const std::byte> input);
void run_ply(std::span<const std::byte> input);
void run_x(std::span<const std::byte> input);
void run_dae(std::span<const std::byte> input);
/// An .fbx file, text or binary.
void run_fbx(std::span<const std::byte> input);
/// A text .fbx file, made binary with all lengths right (binary_fbx).
void run_fbx_binary(std::span<const std::byte> input);
void run_stl(std::span<const std::byte> input);
/// An .obj; what follows the line "#mtl" is its material library.
void run_obj(std::span<const std::byte> input);
/// A .gltf, its light gathered at 8 x 8 texels with few rays.
void run_bake(std::span<const std::byte> input);

}  // namespace luxel::fuzz
