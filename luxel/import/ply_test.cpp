// .ply files: text and binary, what they hold beside faces, and what is damaged.
#include <gmock/gmock.h>

#include <numeric>

#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kText = "ply\nformat ascii 1.0\n";
const std::string kVertices =
    "element vertex 4\nproperty float x\nproperty float y\n"
    "property float z\n";
const std::string kFaces = "element face 1\nproperty list uchar int vertex_indices\n";
/// A square of 1 m2.
const std::string kCorners = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

TEST(Ply, VertexColoursBecomeLinear) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 255 0 188\n3 0 1 2\n";
  const scene::Scene scene = scene_of(import_text("a.ply", text));
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.meshes[0].colors.size(), 3u);
  EXPECT_EQ(scene.meshes[0].colors[0], (Rgb{1, 0, 0}));
  EXPECT_NEAR(scene.meshes[0].colors[2].z, 0.503f, 0.001f) << "sRGB 188 is half the light";
}

TEST(Ply, BinaryFilesAreRead) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n";
  const std::string vertices = bytes_of<float>({0, 0, 0, 2, 0, 0, 0, 1, 0});
  const auto face = [](int last) { return "\x03" + bytes_of<int>({0, 1, last}); };
  EXPECT_NEAR(drawn_area(scene_of(import_text("a.ply", header + vertices + face(2)))), 1, 1e-6f);
  const auto bad = import_text("a.ply", header + vertices + face(3));
  ASSERT_FALSE(bad);
  EXPECT_THAT(bad.error().message, HasSubstr("vertex index 3"));
}

TEST(Ply, ErrorsNameTheElement) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n";
  ASSERT_TRUE(import_text("a.ply", header + vertices + "3 0 1 2\n"));
  EXPECT_THAT(error_of(import_text("a.ply", header + vertices + "3 0 1 3\n")),
              AllOf(HasSubstr("face 0"), HasSubstr("vertex index 3")));
  EXPECT_THAT(error_of(import_text("a.ply", header + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n")),
              HasSubstr("vertex 1"));
  EXPECT_THAT(error_of(import_text("a.ply", header + vertices + "3 0 1")), HasSubstr("face 0"));
  for (const char* face : {"3.5 0 1 2", "-3 0 1 2", "3 0 1 2.5", "3 0 1 99999999999", "3, 0 1 2"})
    EXPECT_THAT(error_of(import_text("a.ply", header + vertices + face + "\n")),
                HasSubstr("face 0: the file ends early, or a number is broken"));
  EXPECT_THAT(error_of(import_text("a.ply", header + vertices + "0\n")),
              HasSubstr("face 0: it has no corner"));
  // Each element has a line of its own.
  EXPECT_THAT(error_of(import_text("a.ply", header + "0 0\n0 1 0 0 0 1 0\n3 0 1 2\n")),
              HasSubstr("vertex 0: the file ends early, or a number is broken"));
  EXPECT_TRUE(import_text("a.ply", header + "0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n"));
  EXPECT_TRUE(import_text("a.ply", header + "0 +0 -0.0\n1e0 .0 0.\n0 1 0\n3 0 +1 2\n"));
  EXPECT_THAT(error_of(import_text("a.ply", "ply\nformat ascii 1.0\n")), HasSubstr("header"));
  EXPECT_THAT(error_of(import_text("a.ply", kText + kVertices + "end_header\n" + kCorners)),
              HasSubstr("a.ply: it has points but no faces"));
}

// Assimp would find a vertex element in a comment, and a count in an element's name.
TEST(Ply, HeadersAreReadLineByLine) {
  const auto area = [](const std::string& header) {
    const auto imported = import_text("a.ply", header + "end_header\n" + kCorners + "4 0 1 2 3\n");
    return imported ? drawn_area(imported->scene) : 0.0f;
  };
  const auto error = [](const std::string& header) {
    return error_of(import_text("a.ply", header + "end_header\n" + kCorners + "4 0 1 2 3\n"));
  };
  for (const char* comment : {"comment by hand\n", "comment vertex 1000000000\n", "obj_info 1\n",
                              "comment element face 9\n", "\n"}) {
    EXPECT_EQ(area(kText + comment + kVertices + comment + kFaces), 1) << comment;
    EXPECT_EQ(area(kText + "element vertex 4\n" + comment +
                   "property float x\nproperty float y\nproperty float z\n" + kFaces),
              1)
        << comment;
  }
  EXPECT_EQ(area(kText + kVertices + kFaces + "element 99999999edges 0\nproperty int a\n"), 1);
  const char* nonsense = "cannot understand this line of the header";
  EXPECT_THAT(error("ply\n" + kVertices + kFaces), HasSubstr("a.ply: its header states no format"));
  EXPECT_THAT(error(kText + kVertices + "format ascii 1.0\n" + kFaces), HasSubstr(nonsense));
  EXPECT_THAT(error(kText + "property float x\n" + kVertices + kFaces), HasSubstr(nonsense));
  EXPECT_THAT(error(kText + kVertices + "property string name\n" + kFaces), HasSubstr(nonsense));
  EXPECT_THAT(error(kText + kVertices + kVertices + kFaces),
              HasSubstr("line 7: cannot understand this line of the header"));
  EXPECT_THAT(error(kText + kVertices + kFaces + "element edge 4000000000\n"),
              HasSubstr("a.ply: 4000000000 entries of the element edge have no properties"));
}

// Assimp would read their numbers as vertices.
TEST(Ply, UnknownElementsAndPropertiesAreSteppedOver) {
  const std::string camera =
      "element camera 2\nproperty float focus\n"
      "property list uchar float lens\n";
  const auto text = import_text("a.ply", kText + camera + kVertices + "property float quality\n" +
                                             kFaces + "property uchar flags\nend_header\n" +
                                             "35 2 1 nan\n-1 0\n0 0 0 nan\n1 0 0 1\n1 1 0 2\n" +
                                             "0 1 0 3\n4 0 1 2 3 7\n");
  EXPECT_EQ(drawn_area(scene_of(text)), 1);
  const std::string cameras =
      bytes_of<float>({35}) + '\1' + bytes_of<float>({7}) + bytes_of<float>({35}) + '\0';
  const std::string binary = "ply\nformat binary_little_endian 1.0\n" + camera + kVertices +
                             kFaces + "end_header\n" + cameras +
                             bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) + '\4' +
                             bytes_of<int>({0, 1, 2, 3});
  EXPECT_EQ(drawn_area(scene_of(import_text("a.ply", binary))), 1);
}

// Assimp would keep the last triangle of a strip.
TEST(Ply, StripsBecomeTriangles) {
  const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\n";
  const auto of = [&](const char* indices) {
    return import_text("a.ply", kText + kVertices + strips + "end_header\n" + kCorners + indices);
  };
  // A zigzag over the square, whose triangles all face up; the same two by a restart.
  for (const char* indices : {"4 0 1 3 2\n", "7 0 1 3 -1 1 2 3\n", "5 -1 0 1 3 2\n"}) {
    const scene::Scene scene = scene_of(of(indices));
    ASSERT_EQ(scene.meshes.at(0).triangles.size(), 2u) << indices;
    EXPECT_EQ(drawn_area(scene), 1);
    for (const uint32_t triangle : {0u, 1u})
      expect_near(scene::front_normal(scene, 0, triangle), {0, 0, 1}, 1e-6f);
  }
  EXPECT_THAT(error_of(of("4 0 1 3 4\n")),
              AllOf(HasSubstr("tristrips 0"), HasSubstr("vertex index 4 is out of range")));
  EXPECT_THAT(error_of(of("4 0 1 -2 2\n")), HasSubstr("vertex index -2 is out of range"));
}

// Assimp would give both faces the u and v of the second.
TEST(Ply, CornersHaveTheirOwnTextureCoordinates) {
  const std::string faces =
      "element face 2\nproperty list uchar int vertex_indices\n"
      "property list uchar float texcoord\n";
  const TemporaryFolder folder;
  folder.write("white.png", png_of(1, 1, {255, 255, 255, 255}));
  const auto imported = import_scene(folder.write(
      "a.ply", kText + "comment TextureFile white.png\n" + kVertices + faces + "end_header\n" +
                   kCorners + "3 0 1 2 6 0 0 1 0 1 1\n" + "3 0 2 3 6 .5 .5 .75 .75 .5 .75\n"));
  const scene::Scene scene = scene_of(imported);
  EXPECT_EQ(scene.textures.size(), 1u);
  const scene::Mesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  ASSERT_EQ(mesh.uv0.size(), 6u);
  const auto u_of_corner = [&](size_t triangle, size_t corner) {
    return mesh.uv0[mesh.triangles[triangle][corner]].x;
  };
  EXPECT_EQ(u_of_corner(0, 0), 0);
  EXPECT_EQ(u_of_corner(0, 2), 1);
  EXPECT_EQ(u_of_corner(1, 0), 0.5f);
  EXPECT_EQ(u_of_corner(1, 1), 0.75f);
}

TEST(Ply, SurfacesWithoutAMaterialReflectAsInOtherFormats) {
  const std::string material =
      "element material 1\nproperty uchar diffuse_red\n"
      "property uchar diffuse_green\nproperty uchar diffuse_blue\n";
  const scene::Scene plain = scene_of(
      import_text("a.ply", kText + kVertices + kFaces + "end_header\n" + kCorners + "4 0 1 2 3\n"));
  EXPECT_EQ(plain.materials.at(0).base_color, (Rgb{0.8f, 0.8f, 0.8f}));
  const scene::Scene red =
      scene_of(import_text("a.ply", kText + material + kVertices + kFaces + "end_header\n" +
                                        "51 0 0\n" + kCorners + "4 0 1 2 3\n"));
  EXPECT_EQ(red.materials.at(0).base_color, (Rgb{0.2f, 0, 0}));
}

// Assimp would take 0 for the other two colours, and draw in black.
TEST(Ply, ColoursAndNormalsAreWholeOrNone) {
  const auto mesh_with = [](const std::string& property) {
    return scene_of(import_text("a.ply", kText + kVertices + property + kFaces + "end_header\n" +
                                             "0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n4 0 1 2 3\n"))
        .meshes.at(0);
  };
  EXPECT_TRUE(mesh_with("property uchar alpha\n").colors.empty());
  EXPECT_TRUE(mesh_with("property uchar green\n").colors.empty());
  EXPECT_TRUE(mesh_with("property float nz\n").normals.empty());
  EXPECT_TRUE(mesh_with("property float u\n").uv0.empty());
}

// Numbers of every type, of both byte orders, are read as the text says them.
TEST(Ply, AllTypesOfNumbersAreRead) {
  const std::string header =
      "element vertex 4\nproperty char x\nproperty ushort y\n"
      "property double z\nelement face 1\n"
      "property list short uint vertex_index\nend_header\n";
  const auto big = [](auto value) {
    std::string bytes = bytes_of<decltype(value)>({value});
    return std::string(bytes.rbegin(), bytes.rend());
  };
  std::string binary = "ply\nformat binary_big_endian 1.0\n" + header;
  for (const auto& [x, y] : {std::pair(-1, 0), {1, 0}, {1, 300}, {-1, 300}})
    binary += big(int8_t(x)) + big(uint16_t(y)) + big(0.25);
  binary += big(int16_t(4)) + big(0u) + big(1u) + big(2u) + big(3u);
  EXPECT_EQ(drawn_area(scene_of(import_text("a.ply", binary))), 600);
  const std::string face = "4 0 1 2 3\n";
  EXPECT_EQ(drawn_area(scene_of(import_text(
                "a.ply", kText + header + "-1 0 1e-400\n+1 0 0\n1 300 0\n-1 300 .0\n" + face))),
            600);
  for (const char* vertex : {"128 0 0", "-129 0 0", "0 65536 0", "0 -1 0", "0.5 0 0", "0 0 1e400"})
    EXPECT_THAT(
        error_of(import_text("a.ply", kText + header + vertex + "\n1 0 0\n1 3 0\n-1 3 0\n" + face)),
        HasSubstr("vertex 0: the file ends early, or a number is broken"))
        << vertex;
}

// Assimp would take the first bytes of these numbers for more line ends of the header.
TEST(Ply, NumbersMayBeginAsALineEnd) {
  std::vector<float> corners{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const uint32_t line_ends = 0x0d0a200a;
  std::memcpy(corners.data(), &line_ends, 4);  // 4e-31
  const std::string binary = "ply\nformat binary_little_endian 1.0\n" + kVertices + kFaces +
                             "end_header\n" + bytes_of(corners) + '\4' +
                             bytes_of<int>({0, 1, 2, 3});
  EXPECT_EQ(drawn_area(scene_of(import_text("a.ply", binary))), 1);
}

}  // namespace
}  // namespace luxel::import
