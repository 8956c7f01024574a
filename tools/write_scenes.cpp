// Writes the procedural scenes as .glb files into a folder: how scenes/ was made.
//   build/release/bin/luxel_write_scenes scenes
#include <cstdio>
#include <filesystem>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/scene/procedural.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: luxel_write_scenes FOLDER\n", stderr);
    return 2;
  }
  for (const auto& file : luxel::scene::procedural_scenes()) {
    const auto path = std::filesystem::path(argv[1]) / file.file;
    const auto bytes = luxel::export_::scene_glb(file.scene);
    const auto written = bytes ? luxel::write_file_atomically(path, *bytes)
                               : luxel::Status(luxel::Failure{bytes.error()});
    if (!written) {
      std::fprintf(stderr, "%s\n", written.error().message.c_str());
      return 1;
    }
    std::printf("wrote %s\n", path.string().c_str());
  }
  return 0;
}
