// Where a scene's files may lie, and what happens to the others: none of them is opened.
#include "luxel/import/scene_files.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <algorithm>

#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

/// scene/pics/in.png, scene/in.png, more/extra.png and secret.png, each with its own name in it.
struct Places {
  TemporaryFolder root;
  SceneFiles files{root.path() / "scene", {}, false};

  Places() {
    for (const char* folder : {"scene", "scene/pics", "more"})
      fs::create_directory(root.path() / folder);
    for (const char* file : {"scene/pics/in.png", "scene/in.png", "more/extra.png", "secret.png"})
      root.write(file, file);
  }
  /// Contents of the file, or the error's sentence.
  std::string read(const std::string& stated) const {
    ReadingMemory memory(0);
    const auto bytes = read_named_file(files, stated, "a.obj: the texture of wall", memory);
    if (!bytes) return bytes.error().message;
    return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
  }
};

TEST(SceneFiles, LieInTheScenesFolderOrBelow) {
  const Places places;
  EXPECT_EQ(places.read("in.png"), "scene/in.png");
  EXPECT_EQ(places.read("pics/in.png"), "scene/pics/in.png");
  EXPECT_EQ(places.read("pics\\in.png"), "scene/pics/in.png") << "as Windows writes it";
  EXPECT_EQ(places.read("pics/../in.png"), "scene/in.png");
  EXPECT_EQ(places.read("C:\\work\\in.png"), "scene/in.png") << "its last part";
  EXPECT_EQ(places.read("/lost/folder/in.png"), "scene/in.png");
  EXPECT_EQ(places.read("none.png"),
            "a.obj: the texture of wall is none.png, which is missing; put it beside the scene or "
            "name its folder with --search-path");
}

TEST(SceneFiles, ElsewhereTheyAreRefusedAndNotRead) {
  Places places;
  fs::create_symlink(places.root.path() / "secret.png", places.root.path() / "scene/link.png");
  fs::create_directory_symlink(places.root.path(), places.root.path() / "scene/up");
  for (const std::string& stated :
       {std::string("../secret.png"), (places.root.path() / "secret.png").string(),
        std::string("pics/../../secret.png"), std::string("..\\secret.png"),
        std::string("link.png"), std::string("up/secret.png"), std::string("/etc/passwd")})
    EXPECT_THAT(places.read(stated), HasSubstr("which lies outside of the scene's folder; copy it "
                                               "there, name its folder with --search-path, or "
                                               "allow all files with --trust-paths"))
        << stated;
  // A sibling whose name begins with the folder's is not below it.
  fs::create_directory(places.root.path() / "scene2");
  places.root.write("scene2/x.png", "");
  EXPECT_THAT(places.read("../scene2/x.png"), HasSubstr("lies outside"));
  places.files.trust_paths = true;
  EXPECT_EQ(places.read("../secret.png"), "secret.png");
  EXPECT_EQ(places.read("link.png"), "secret.png");
}

TEST(SceneFiles, LieInSearchPathsToo) {
  Places places;
  EXPECT_THAT(places.read("extra.png"), HasSubstr("is missing"));
  places.files.search_paths = {places.root.path() / "more"};
  EXPECT_EQ(places.read("extra.png"), "more/extra.png");
  EXPECT_EQ(places.read("../more/extra.png"), "more/extra.png");
  EXPECT_EQ(places.read("D:\\x\\extra.png"), "more/extra.png");
  EXPECT_THAT(places.read("../secret.png"), HasSubstr("lies outside"));
}

TEST(SceneFiles, PipesAndFoldersAreRefusedAtOnce) {
  const Places places;
  ASSERT_EQ(::mkfifo((places.root.path() / "scene/pipe.png").c_str(), 0600), 0);
  EXPECT_THAT(places.read("pipe.png"), HasSubstr("is a pipe or a device"));
  EXPECT_THAT(places.read("pics"), HasSubstr("is missing"));
  EXPECT_THAT(places.read(".."), HasSubstr("is missing"));
  EXPECT_THAT(places.read(""), HasSubstr("the texture of wall names no file"));
}

TEST(SceneFiles, AreFoundInAnyCase) {
  const Places places;
  EXPECT_EQ(places.read("PICS/In.PNG"), "scene/pics/in.png");
  EXPECT_EQ(places.read("C:\\Work\\IN.png"), "scene/in.png");
  places.root.write("scene/IN.png", "scene/IN.png");
  EXPECT_EQ(places.read("IN.png"), "scene/IN.png") << "the name as it stands comes first";
  EXPECT_EQ(places.read("in.png"), "scene/in.png");
  EXPECT_EQ(places.read("iN.png"), "scene/IN.png") << "then the alphabet decides";
  EXPECT_THAT(places.read("../SECRET.png"), HasSubstr("is missing"));
}

TEST(SceneFiles, AreFoundInAnyCaseInTheFolderThatTheProgramStartsIn) {
  Places places;
  const fs::path before = fs::current_path();
  fs::current_path(*places.files.folder);
  places.files.folder = fs::path();  // as that of "a.obj"
  EXPECT_EQ(places.read("Pics/IN.png"), "scene/pics/in.png");
  fs::current_path(before);
}

// Game artists keep pictures in a folder of their own, in or beside that of the models.
TEST(SceneFiles, PicturesLieInFoldersOfTexturesToo) {
  Places places;
  for (const char* folder : {"scene/Textures", "textures", "more/TEXTURES"})
    fs::create_directory(places.root.path() / folder);
  for (const char* file :
       {"scene/Textures/a.png", "textures/a.png", "textures/b.png", "more/TEXTURES/c.png"})
    places.root.write(file, file);
  const auto picture = [&](const std::string& stated) -> std::string {
    ReadingMemory memory(0);
    const auto bytes = read_named_picture(places.files, stated, "a.obj: the texture", memory);
    if (!bytes) return bytes.error().message;
    return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
  };
  EXPECT_EQ(picture("D:\\art\\A.png"), "scene/Textures/a.png");
  EXPECT_EQ(picture("/home/artist/b.png"), "textures/b.png");
  EXPECT_EQ(picture("../textures/b.png"), "textures/b.png");
  EXPECT_EQ(picture("in.png"), "scene/in.png") << "beside the scene comes first";
  EXPECT_THAT(picture("c.png"), HasSubstr("is missing"));
  places.files.search_paths = {places.root.path() / "more"};
  EXPECT_EQ(picture("c.png"), "more/TEXTURES/c.png");
  EXPECT_THAT(places.read("b.png"), HasSubstr("is missing")) << "pictures only";
  // Links lead no further.
  fs::create_symlink(places.root.path() / "secret.png", places.root.path() / "textures/link.png");
  EXPECT_THAT(picture("link.png"), HasSubstr("is missing"));
  fs::remove_all(places.root.path() / "scene/Textures");
  fs::create_directory_symlink(places.root.path(), places.root.path() / "scene/textures");
  EXPECT_THAT(picture("secret.png"), HasSubstr("is missing"));
}

/// The unit square in a .gltf, whose buffer or texture is the file `uri`.
std::string square_that_names(const std::string& what, const std::string& uri) {
  Gltf gltf = square_gltf();
  gltf.json["buffers"] = {{{"byteLength", gltf.buffer.size()}, {"uri", "square.bin"}}};
  if (what == "buffers") gltf.json["buffers"][0]["uri"] = uri;
  if (what == "images") {
    gltf.json["images"] = {{{"uri", uri}}};
    gltf.json["textures"] = {{{"source", 0}}};
    gltf.json["materials"] = {
        {{"name", "wall"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    gltf.json["meshes"][0]["primitives"][0]["material"] = 0;
  }
  return gltf.json.dump();
}

// In a .gltf, in an .obj and its .mtl; what is refused elsewhere is allowed with the params.
TEST(SceneFiles, HoldForEveryFileThatASceneNames) {
  const TemporaryFolder root;
  fs::create_directory(root.path() / "scene");
  const std::string png = png_of(2, 2, {255, 0, 0, 255});
  for (const char* folder : {"", "scene/"}) {
    root.write(std::string(folder) + "square.bin", square_gltf().buffer);
    root.write(std::string(folder) + "red dot.png", png);
  }
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl wall\nf 1/1 2/1 3/1\n";
  root.write("wall.mtl", "newmtl wall\nKd 0.5 0.25 0.125\n");
  struct Case {
    std::string name, text;
    bool is_picture;
  };
  for (const Case& c :
       {Case{"a.gltf", square_that_names("buffers", "../square.bin"), false},
        Case{"b.gltf", square_that_names("images", "../red%20dot.png"), true},
        Case{"c.gltf", square_that_names("images", (root.path() / "red dot.png").string()),
             true}}) {
    const fs::path file = root.write("scene/" + c.name, c.text);
    fs::rename(root.path() / "scene/square.bin", root.path() / "kept.bin");
    fs::rename(root.path() / "scene/red dot.png", root.path() / "kept.png");
    if (c.is_picture) fs::copy_file(root.path() / "kept.bin", root.path() / "scene/square.bin");
    const auto refused = import_scene(file);
    ASSERT_EQ(refused.has_value(), c.is_picture) << c.name;
    if (!refused) {
      EXPECT_EQ(refused.error().code, ErrorCode::io);
    } else {
      EXPECT_TRUE(refused->scene.textures.empty()) << c.name;
    }
    EXPECT_THAT(refused ? all_of(refused->warnings) : refused.error().message,
                HasSubstr("lies outside of the scene's folder"))
        << c.name;
    ImportParams trusting;
    trusting.trust_paths = true;
    ImportParams searching;
    searching.search_paths = {root.path()};
    for (const ImportParams& params : {trusting, searching}) {
      const auto imported = import_scene(file, params);
      EXPECT_EQ(scene_of(imported).textures.size(), c.is_picture ? 1u : 0u) << c.name;
    }
    fs::remove(root.path() / "scene/square.bin");
    fs::rename(root.path() / "kept.bin", root.path() / "scene/square.bin");
    fs::rename(root.path() / "kept.png", root.path() / "scene/red dot.png");
  }
  const auto refused = import_scene(root.write("scene/d.obj", "mtllib ../wall.mtl\n" + square));
  ASSERT_TRUE(refused) << "an .mtl that is not there is a warning";
  EXPECT_THAT(all_of(refused->warnings), HasSubstr("lies outside"));
  expect_near(refused->scene.materials[0].base_color, {0.8f, 0.8f, 0.8f}, 1e-6f);
  ImportParams trusting;
  trusting.trust_paths = true;
  const auto trusted = import_scene(root.path() / "scene/d.obj", trusting);
  const scene::Scene scene = scene_of(trusted);
  const auto wall = std::ranges::find(scene.materials, "wall", &scene::Material::name);
  ASSERT_NE(wall, scene.materials.end());
  expect_near(wall->base_color, {0.5f, 0.25f, 0.125f}, 1e-6f);
}

// Without a folder of its own nothing can be named: what an .lxr file holds.
TEST(SceneFiles, ASceneInMemoryNamesNone) {
  const SceneFiles none;
  ReadingMemory memory(0);
  const auto read = read_named_file(none, "/etc/hostname", "box.lxr: a buffer", memory);
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, HasSubstr("a scene in memory cannot name files"));
}

}  // namespace
}  // namespace luxel::import
