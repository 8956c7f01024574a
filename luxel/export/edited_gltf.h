// A glTF file in which parts of the scene are otherwise, and all else is as it was.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::export_ {

/// Changes to a file's scene. Instances, lights and materials have the numbers with which the file
/// was read.
struct GltfEdits {
  std::vector<uint32_t> node_of_instance, node_of_light;  ///< import::Imported has them
  struct Placed {
    uint32_t instance = 0;
    Mat34 world_from_object;
  };
  std::vector<Placed> placed;            ///< instances that stand otherwise
  std::vector<Mat34> world_from_object;  ///< of each instance as it was read
  DVec3 origin{};                        ///< scene::Scene::origin: coordinates here are less that
  std::vector<DVec3> object_origin;      ///< import::Imported has them
  struct Light {
    uint32_t light = 0;
    scene::PunctualLight before, now;  ///< what is the same in both is left as it is
  };
  std::vector<Light> lights;
  std::vector<uint32_t> deleted_lights;
  std::vector<scene::PunctualLight> new_lights;
  struct Material {
    uint32_t material = 0;
    scene::Material before, now;  ///< base colour, emission and metallic count
  };
  std::vector<Material> materials;
};

/// The bytes of a file that a glTF file names by a URI; `what` is for messages.
using ReadUri =
    std::function<Result<std::vector<std::byte>>(const std::string& uri, const std::string& what)>;

/// The file with other transforms of nodes, lights and factors of materials. Members of its JSON
/// that these do not touch stay with their values and their order, and all chunks but JSON stay
/// byte by byte. Files that it names become data URIs, so that it can lie anywhere. Nodes below one
/// that has moved stay where they were; so do a camera and a light of its own, which get nodes of
/// their own. Copies of EXT_mesh_gpu_instancing become nodes where one has moved. Errors: no glTF;
/// those of `read`.
Result<std::vector<std::byte>> edited_gltf(std::span<const std::byte> file, const std::string& name,
                                           const GltfEdits& edits, const ReadUri& read);

}  // namespace luxel::export_
