// Wrong files and wrong settings: one clear sentence, the right exit code, nothing written.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

/// A small valid glTF (one triangle, base64 buffer) with one piece of its text replaced.
std::string gltf_with(const std::string& from = "", const std::string& to = "") {
  // Positions (0,0,0) (1,0,0) (0,1,0) as floats, then indices 0 1 2 as unsigned shorts.
  std::string text = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"buffers":[{"byteLength":42,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA"}]})";
  const size_t at = from.empty() ? std::string::npos : text.find(from);
  if (!from.empty()) {
    EXPECT_NE(at, std::string::npos) << from;
  }
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

/// Bakes and expects failure: code, a sentence with `words`, and no output folder.
void expect_refused(const std::string& scene_and_options, int code, const std::string& words) {
  const ScratchFolder scratch;
  const auto output = scratch.path / "baked";
  const CommandResult r = luxel("bake " + scene_and_options + " -o " + output.string());
  EXPECT_EQ(r.code, code) << scene_and_options << "\n" << r.err;
  EXPECT_THAT(r.err, HasSubstr(words)) << scene_and_options;
  // The sentence is the last line, after those of the stages.
  const size_t line = r.err.rfind('\n', r.err.size() - 2);
  EXPECT_EQ(r.err.find("luxel: "), line == std::string::npos ? 0 : line + 1) << r.err;
  EXPECT_THAT(r.out, "") << scene_and_options;
  EXPECT_FALSE(std::filesystem::exists(output)) << scene_and_options;
}

TEST(BadFiles, AreRefusedWithASentence) {
  const ScratchFolder s;
  expect_refused((s.path / "none.glb").string(), 1, "no such file");
  expect_refused(s.path.string(), 1, "folder");
  expect_refused(s.write("empty.glb", "").string(), 1, "empty.glb");
  expect_refused(s.write("what.xyz", "hello").string(), 1, "what.xyz");
  expect_refused(s.write("json.gltf", "{\"asset\": ").string(), 1, "json.gltf");
  const std::string whole = slurp(scene_file("cornell-box.glb"));
  expect_refused(s.write("cut.glb", whole.substr(0, whole.size() / 2)).string(), 1, "cut.glb");
  expect_refused(s.write("head.glb", whole.substr(0, 9)).string(), 1, "head.glb");
}

/// Words before a command that root's rights must not help. As root, runs it as nobody.
std::string without_rights() {
  return ::geteuid() == 0 ? "setpriv --reuid 65534 --clear-groups" : "";
}
bool can_run_without_rights() { return luxel("--help", without_rights()).code == 0; }

TEST(BadFiles, ThatMayNotBeReadAreRefused) {
  if (!can_run_without_rights()) GTEST_SKIP() << "nobody else may run the program here";
  const ScratchFolder s;
  namespace fs = std::filesystem;
  fs::permissions(s.path, fs::perms(0755));
  const auto file = s.write("secret.glb", "x");
  fs::permissions(file, fs::perms::none);
  const CommandResult r = luxel("info " + file.string(), without_rights());
  EXPECT_EQ(r.code, 1);
  EXPECT_EQ(r.err, "luxel: cannot read " + file.string() + ": Permission denied\n");
}

// Debian's Assimp is built with its assertions: without care, a wrong file ends the process.
TEST(BadFiles, OfOtherFormatsDoNotAbort) {
  const ScratchFolder s;
  for (const char* name : {"a.fbx", "a.dae", "a.x", "a.3ds", "a.blend", "a.stl", "a.x3d"})
    for (const char* content :
         {"hello", "<COLLADA/>", "xof 0303txt 0032\nMesh { 3; 0;0;0;,", "solid\nfacet\nvertex 1"}) {
      const CommandResult r = luxel("info --any-format " + s.write(name, content).string());
      EXPECT_EQ(r.code, 1) << name << " " << content << ": " << r.err;
      EXPECT_THAT(r.err, HasSubstr(name));
    }
}

TEST(BadFiles, AnAssertionOfAssimpIsAnError) {
  const ScratchFolder s;
  const auto file = s.write("faceless.ply",
                            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                            "property float y\nproperty float z\nelement face 1\n"
                            "property list uchar int vertex_indices\nend_header\n"
                            "0 0 0\n1 0 0\n0 1 0\n0\n");
  expect_refused(file.string(), 1, "faceless.ply");
}

TEST(BadFiles, WrongContentIsNamed) {
  const ScratchFolder s;
  const auto refused = [&](const std::string& from, const std::string& to,
                           const std::string& words) {
    expect_refused(s.write("bad.gltf", gltf_with(from, to)).string(), 1, words);
  };
  refused("AAABAAIA", "AAABAAkA", "mesh 0");  // index 9 of 3 vertices
  refused("\"count\":3,\"type\":\"VEC3\"", "\"count\":30,\"type\":\"VEC3\"", "accessor 0");
  refused("\"indices\":1", "\"indices\":7", "7");
  refused("AAAAAAAAAAAAAAAAAACAPw", "AADAfwAAAAAAAAAAAACAPw", "vertex 0");  // NaN
  refused("AAAAAAAAAAAAAAAAAACAPw", "AACAfwAAAAAAAAAAAACAPw", "vertex 0");  // infinity
  refused("\"scene\":0,",
          R"("extensionsRequired":["EXT_strange"],"extensionsUsed":["EXT_strange"],"scene":0,)",
          "EXT_strange");
  refused("\"nodes\":[0]", "\"nodes\":[]", "triangle");
}

TEST(BadFiles, MissingAndCorruptTexturesAreNamed) {
  const ScratchFolder s;
  const auto with_image = [&](const std::string& uri) {
    std::string text = gltf_with("\"indices\":1", "\"indices\":1,\"material\":0");
    text.insert(
        1,
        R"("materials":[{"name":"wall","pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0}}],
"textures":[{"source":0}],"images":[{"uri":")" +
            uri + "\"}],");
    return s.write("textured.gltf", text).string();
  };
  const CommandResult missing = luxel("info " + with_image("none.png"));
  EXPECT_EQ(missing.code, 0);
  EXPECT_THAT(missing.err, HasSubstr("none.png, which is missing"));
  s.write("corrupt.png", "\x89PNG\r\n\x1a\nnonsense");
  expect_refused(with_image("corrupt.png"), 1, "corrupt.png");
}

TEST(BadFiles, CompressedPartsThatAreDamagedAreNamed) {
  const ScratchFolder s;
  const auto refused = [&](const std::string& from, const std::string& to,
                           const std::string& words) {
    expect_refused(s.write("bad.gltf", gltf_with(from, to)).string(), 1, words);
  };
  // The 36 bytes of the positions, which are compressed by nobody.
  refused("\"indices\":1", R"("indices":1,"extensions":{"KHR_draco_mesh_compression":
{"bufferView":0,"attributes":{"POSITION":0}}})",
          "mesh 0, primitive 0: its 36 bytes do not start as Draco data do");
  const auto meshopt = [](const char* count) {
    return fmt::format(R"({{"buffer":0,"byteLength":36,"extensions":{{"EXT_meshopt_compression":
{{"buffer":0,"byteLength":36,"byteStride":12,"count":{},"mode":"ATTRIBUTES"}}}}}})",
                       count);
  };
  const std::string view = R"({"buffer":0,"byteLength":36})";
  refused(view, meshopt("3"),
          "buffer view 0: the 36 compressed bytes at 0 of buffer 0 are damaged");
  refused(view, meshopt("3000000000"),
          "count 3000000000 times byteStride 12 is not the byteLength");
}

TEST(BadFiles, TexturesThatNeedADecoderOrAllMemoryAreNamed) {
  const ScratchFolder s;
  const auto with_texture = [&](const std::string& texture) {
    std::string text = gltf_with("\"indices\":1", "\"indices\":1,\"material\":0");
    // The header of a PNG of 100,000 x 100,000 pixels, with its checksums, and no pixels.
    text.insert(
        1,
        R"("materials":[{"name":"wall","pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0}}],
"images":[{"mimeType":"image/png","uri":"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgABhqAAAYagCAYAAACoUgvIAAAACElEQVR4nAMAAAAAAUgGidIAAAAASUVORK5CYII="}],
"textures":[)" +
            texture + "],");
    return s.write("textured.gltf", text).string();
  };
  expect_refused(with_texture(R"({"source":0})"), 1,
                 "the picture has 100000 x 100000 pixels, must be 1 to 16384 a side");
  const CommandResult only_ktx2 =
      luxel("info " + with_texture(R"({"extensions":{"KHR_texture_basisu":{"source":0}}})"));
  EXPECT_EQ(only_ktx2.code, 0);
  EXPECT_THAT(only_ktx2.err, HasSubstr("texture 0 of material 0 (wall) exists only as KTX2"));
}

TEST(BadFiles, OnlyTrianglesWithoutAreaAreNothing) {
  const ScratchFolder s;
  const auto file = s.write("flat.gltf", gltf_with("AAABAAIA", "AAABAAEA"));  // indices 0 1 1
  expect_refused(file.string(), 1, "triangle");
}

TEST(Repairs, ATriangleWithoutAreaIsDroppedAndCounted) {
  const ScratchFolder s;
  const auto file = s.write("some.obj", "v 0 0 0\nv 0 0 1\nv 1 0 1\nf 1 2 3\nf 1 2 2\nf 3 3 3\n");
  const CommandResult r = luxel("bake " + file.string() + " --resolution 16 --samples 4 -o " +
                                (s.path / "baked").string() + " --json");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, ::testing::ContainsRegex("warning: .*some.obj: 2 zero-area triangles dropped"))
      << r.err;
  EXPECT_THAT(r.out, HasSubstr("\"triangles\": 1"));
}

TEST(Repairs, AReflectanceOver99PercentIsClamped) {
  const ScratchFolder s;
  s.write("white.mtl", "newmtl snow\nKd 1 1 1\n");
  const auto file =
      s.write("white.obj", "mtllib white.mtl\nv 0 0 0\nv 0 0 1\nv 1 0 1\nusemtl snow\nf 1 2 3\n");
  const CommandResult r = luxel("bake " + file.string() + " --resolution 16 --samples 4 -o " +
                                (s.path / "baked").string());
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, ::testing::ContainsRegex("warning: .*white.obj: .*0.99 clamped.*snow"))
      << r.err;
}

/// Blender's exporter leaves lights out by default; others write what there is.
TEST(NoLight, NamesTheBoxToTickWhereTheExporterHasOne) {
  const ScratchFolder s;
  const auto said = [&](const char* generator) {
    const auto file = s.write(
        "one.gltf",
        gltf_with("\"asset\":{", "\"asset\":{\"generator\":\"" + std::string(generator) + "\","));
    return luxel("render " + file.string() + " --technique path --samples 1 --size 4x4 -o " +
                 (s.path / "one.png").string())
        .err;
  };
  const std::string blender = said("Khronos glTF Blender I/O v4.2.60");
  EXPECT_THAT(blender, HasSubstr("'Punctual Lights' is ticked")) << blender;
  const std::string other = said("THREE.GLTFExporter");
  EXPECT_THAT(other, HasSubstr("the scene has no light")) << other;
  EXPECT_EQ(other.find("ticked"), std::string::npos) << other;
}

TEST(BadSettings, NameTheOptionAndTheValue) {
  const std::string box = scene_file("cornell-box.glb");
  for (const auto& [option, words] : {std::pair{"--resolution 0", "--resolution 0"},
                                      {"--resolution 100000", "--resolution 100000"},
                                      {"--samples -5", "--samples -5"},
                                      {"--samples 0", "--samples 0"},
                                      {"--resolution -5", "--resolution -5"},
                                      {"--samples 99999999", "--samples 99999999"},
                                      {"--bounces x", "'x'"},
                                      {"--sun 10,95,1", "'10,95,1'"},
                                      {"--max-memory 0", "'0'"},
                                      {"--max-memory 0.4", "'0.4'"},
                                      {"--direct-samples 0", "--direct-samples 0"},
                                      {"--supersample 0", "--supersample 0"},
                                      {"--threads -1", "--threads -1"},
                                      {"--bounces -1", "--bounces '-1'"},
                                      {"--bounces many", "'many'"},
                                      {"--sun noon", "'noon'"},
                                      {"--background 1,2", "'1,2'"},
                                      {"--background 1,2,-3", "r,g,b"},
                                      {"--max-memory lots", "'lots'"},
                                      {"--solver magic", "gather"},
                                      {"--texels-per-metre -2", "-2"},
                                      {"--uv keep", "TEXCOORD_1"},
                                      {"--resolution 4", "smallest"}})
    expect_refused(box + " " + option, 1, words);
}

/// The words behind "that works is " in an error.
std::string advice(const std::string& options) {
  const ScratchFolder s;
  const CommandResult r = luxel("bake " + options + " -o " + (s.path / "baked").string());
  const std::string words = "that works is ";
  const size_t at = r.err.find(words);
  EXPECT_NE(at, std::string::npos) << r.err;
  if (at == std::string::npos) return {};
  return r.err.substr(at + words.size(), r.err.find('\n', at) - at - words.size());
}

TEST(BadSettings, AdviceWorks) {
  const std::string box = scene_file("cornell-box.glb") + " --samples 4 ";
  expect_refused(box + "--max-memory 10", 3, "--max-memory 10 bytes");
  const ScratchFolder s;
  const std::string out = " -o " + (s.path / "baked").string();
  const std::string side = advice(box + "--resolution 2");
  EXPECT_EQ(luxel("bake " + box + "--resolution " + side + out).code, 0) << side;
  const std::string memory = advice(box + "--resolution 64 --max-memory 1M");
  EXPECT_EQ(luxel("bake " + box + "--resolution 64 --max-memory " + memory + out).code, 0)
      << memory;
}

TEST(Usage, IsWrongWithCodeTwo) {
  const std::string box = scene_file("cornell-box.glb");
  for (const char* arguments :
       {"", "bake", "paint x", "bake --frobnicate x -o y", "bake x", "bake x -o y --resolution abc",
        "render x", "compare x", "factors x"})
    EXPECT_EQ(luxel(arguments).code, 2) << arguments;
  EXPECT_THAT(luxel("paint x").err, HasSubstr("no command 'paint'"));
  EXPECT_THAT(luxel("bake " + box + " -o y --frobnicate").err,
              HasSubstr("'--frobnicate'; 'luxel bake --help'"));
  EXPECT_EQ(luxel("--help").code, 0);
  EXPECT_EQ(luxel("bake --help").code, 0);
  EXPECT_THAT(luxel("--version").out, HasSubstr("luxel"));
}

TEST(OutputFolder, ThatCannotBeMadeIsRefused) {
  const ScratchFolder s;
  const auto file = s.write("in-the-way", "text");
  for (const std::string& folder :
       {file.string(), (file / "below").string(), std::string("/proc/luxel")}) {
    const CommandResult r = luxel("bake " + scene_file("cornell-box.glb") +
                                  " --resolution 32 --samples 4 -o " + folder);
    EXPECT_EQ(r.code, 1) << folder;
    EXPECT_THAT(r.err, HasSubstr("output folder")) << folder;
  }
  EXPECT_EQ(slurp(file), "text");
}

TEST(OutputFolder, ThatMayNotBeWrittenIsRefused) {
  if (!can_run_without_rights()) GTEST_SKIP() << "nobody else may run the program here";
  const ScratchFolder s;
  const std::string triangle = s.write("one.gltf", gltf_with()).string();
  namespace fs = std::filesystem;
  fs::create_directory(s.path / "locked");
  fs::permissions(s.path / "locked", fs::perms(0555));
  fs::permissions(s.path, fs::perms(0755));
  for (const char* folder : {"locked", "locked/new/folder"}) {
    const CommandResult r =
        luxel("bake " + triangle + " -o " + (s.path / folder).string(), without_rights());
    EXPECT_EQ(r.code, 1) << folder;
    EXPECT_THAT(r.err, HasSubstr("output folder " + (s.path / folder).string())) << folder;
    EXPECT_THAT(r.err, HasSubstr("Permission denied")) << folder;
  }
}

// A file system of 64 KiB: the files do not fit, none of them stays.
TEST(OutputFolder, AFullDiskLeavesNothing) {
  const ScratchFolder s;
  const auto disk = s.path / "disk";
  std::filesystem::create_directory(disk);
  const std::string mount = "mount -t tmpfs -o size=64k tmpfs " + disk.string() + " 2>/dev/null";
  if (std::system(mount.c_str()) != 0) GTEST_SKIP() << "mounting a small disk needs root";
  const CommandResult r = luxel("bake " + scene_file("cornell-box.glb") +
                                " --resolution 128 --samples 4 -o " + (disk / "baked").string());
  const bool left = std::filesystem::exists(disk / "baked");
  EXPECT_EQ(std::system(("umount " + disk.string()).c_str()), 0);
  EXPECT_EQ(r.code, 3) << r.err;
  EXPECT_THAT(r.err, HasSubstr("No space"));
  EXPECT_FALSE(left);
}

}  // namespace
}  // namespace luxel::testing_support
