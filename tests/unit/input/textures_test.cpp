#include "input/picture_colours.h"
#include "light/texture.h"
#include "model_files.h"

#include <cstring>
#include <gtest/gtest.h>

namespace patchlight::textures_test {
namespace {

using Textures = ModelFiles;

// Red, green, blue, white: from the top left, row by row.
const std::string four_colours("\xFF\0\0\0\xFF\0\0\0\xFF\xFF\xFF\xFF", 12);

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

// The reflectance at a point of the first polygon.
Spectrum at(const Scene& scene, const Point& point) {
  const TextureMap* map = texture_map_on(scene, scene.polygons[0], Side::front);
  if (!map) return scene.materials[scene.polygons[0].material].reflectance;
  return reflectance_at(*scene.materials[scene.polygons[0].material].texture, map->linear * point + map->offset);
}

void expect_corners(const Scene& scene, const std::array<Spectrum, 4>& expected) {
  const std::array<Point, 4> points = {Point(.25, .75, 0), Point(.75, .75, 0), Point(.25, .25, 0), Point(.75, .25, 0)};
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_TRUE((at(scene, points[k]) == expected[k]).all()) << "place " << k << ": " << at(scene, points[k]);
}

const Spectrum red = rgb(1, 0, 0);
const Spectrum green = rgb(0, 1, 0);
const Spectrum blue = rgb(0, 0, 1);
const Spectrum white = rgb(1, 1, 1);

TEST_F(Textures, OfObjLieWhereVtSays) {
  write("four.png", png_of(2, 2, four_colours));
  write("m.mtl", "newmtl paint\nKd 1 1 1\nmap_Kd four.png\n");
  const std::string head = "mtllib m.mtl\n" + square + "usemtl paint\n";
  expect_corners(read_scene(write("m.obj", head + "f 1/1 2/2 3/3 4/4\n")), {red, green, blue, white});
  expect_corners(read_scene(write("turned.obj", head + "f 1/2 2/3 3/4 4/1\n")), {blue, red, white, green});
  expect_corners(read_scene(write("mirrored.obj", head + "f 1/2 2/1 3/4 4/3\n")), {green, red, white, blue});
  // With negative indices, in triangles, which become one polygon again.
  const Scene triangles = read_scene(write("t.obj", head + "f 1/-4/1 2/-3/1 3/-2/1\nf 1/1 3/3 4/4\n"));
  EXPECT_EQ(triangles.polygons.size(), 1U);
  expect_corners(triangles, {red, green, blue, white});
}

TEST_F(Textures, OfObjAreScaledAndMovedByTheirOptionsAndTimesKd) {
  write("four.png", png_of(2, 2, four_colours));
  write("m.mtl", "newmtl paint\nKd .5 .5 .25\nmap_Kd -o .5 0 0 four.png\n");
  const Scene scene = read_scene(write("m.obj", "mtllib m.mtl\n" + square + "usemtl paint\nf 1/1 2/2 3/3 4/4\n"));
  expect_corners(scene, {.5 * green, .5 * red, rgb(.5, .5, .25), .25 * blue});
  EXPECT_TRUE((scene.materials[0].reflectance - rgb(.25, .25, .125)).abs().maxCoeff() < 1e-15);
}

TEST_F(Textures, KeepTheirPlaceInOtherUnits) {
  write("four.png", png_of(2, 2, four_colours));
  write("m.mtl", "newmtl paint\nKd 1 1 1\nmap_Kd four.png\n");
  const auto file = write("m.obj", "mtllib m.mtl\n" + square + "usemtl paint\nf 1/1 2/2 3/3 4/4\n");
  const Scene inches = read_scene(file, {.metres_per_unit = 0.25, .settings = {}});
  EXPECT_TRUE((at(inches, {.05, .2, 0}) == red).all());
  EXPECT_TRUE((at(inches, {.2, .05, 0}) == white).all());
}

TEST_F(Textures, OfOneColourAreTheMaterialWithoutPicture) {
  write("one.png", png_of(3, 2, std::string(18, '\x80')));
  write("m.mtl", "newmtl paint\nKd .7 .6 .5\nmap_Kd one.png\n");
  const Scene scene = read_scene(write("m.obj", "mtllib m.mtl\n" + square + "usemtl paint\nf 1/1 2/2 3/3 4/4\n"));
  const double linear = std::pow((128 / 255.0 + 0.055) / 1.055, 2.4);
  EXPECT_FALSE(scene.materials[0].texture);
  EXPECT_TRUE((scene.materials[0].reflectance == Spectrum(rgb(.7, .6, .5) * rgb(linear, linear, linear))).all());
}

TEST_F(Textures, WithBadPlacesCountByTheirMeanAndNameTheLine) {
  write("four.png", png_of(2, 2, four_colours));
  write("m.mtl", "newmtl paint\nKd 1 1 1\nmap_Kd four.png\n");
  for (const char* face :
       {"f 1 2 3 4\n", "f 1/1 2/2 3/3 4/9\n", "f 1/1 2/2 3/3 4/x\n", "vt nan 0\nf 1/5 2/2 3/3 4/4\n"}) {
    const auto file = write("m.obj", "mtllib m.mtl\n" + square + "usemtl paint\n" + face);
    const Scene scene = read_scene(file);
    EXPECT_TRUE((at(scene, {.25, .25, 0}) == scene.materials[0].reflectance).all()) << face;
    const std::string line = face[0] == 'v' ? "12" : "11";
    EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_picture, {"1 ", file.string() + ":" + line})) << face;
  }
}

// A reduced texture keeps its mean: each texel is the mean of the part that it replaces.
TEST_F(Textures, ThatAreReducedKeepTheirMeansOverParts) {
  std::string pixels;
  for (int k = 0; k < 3 * 30 * 21; ++k) pixels += static_cast<char>(k * 37 % 251);
  const DecodedPicture whole = decoded_picture(png_of(30, 21, pixels), 1000);
  const Texture small = reduced(*whole.texture, 50);
  EXPECT_LE(small.texels.size(), 50U);
  const Rgb before = mean_colour(*whole.texture);
  const Rgb after = mean_colour(small);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(after[k], before[k], 1e-6);  // of single precision
  // Its first texel, by exact means over the same part.
  const TextureMeans means({whole.texture, {red, green, blue}, {}});
  const double u = 1.0 / small.width;
  const double v = 1.0 / small.height;
  const Rgb part = means.over(std::vector<Eigen::Vector2d>{{0, 0}, {u, 0}, {u, v}, {0, v}});
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(small.texels[0][k], part[k], 1e-6);
}

// A square of two triangles in glTF, with v downwards, and its sampler and texture.
class GltfTextures : public ModelFiles {
 protected:
  Scene read(const std::string& sampler, const std::string& of_texture) {
    const std::array<float, 20> values = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 1, 1, 1, 0, 0, 0};
    const std::array<std::uint16_t, 6> corners = {0, 1, 2, 0, 2, 3};
    std::string bytes(sizeof values + sizeof corners, '\0');
    std::memcpy(bytes.data(), values.data(), sizeof values);
    std::memcpy(bytes.data() + sizeof values, corners.data(), sizeof corners);
    write("square.bin", bytes);
    write("four.png", png_of(2, 2, four_colours));
    const std::string json =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{)"
        R"("attributes":{"POSITION":0,"TEXCOORD_1":1},"indices":2,"material":0}]}],"accessors":[)"
        R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},)"
        R"({"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"},)"
        R"({"bufferView":2,"componentType":5123,"count":6,"type":"SCALAR"}],"bufferViews":[)"
        R"({"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":32},)"
        R"({"buffer":0,"byteOffset":80,"byteLength":12}],"buffers":[{"uri":"square.bin","byteLength":92}],)"
        R"("samplers":[{)" +
        sampler + R"(}],"images":[{"uri":"four.png"}],"textures":[{"source":0,"sampler":0}],"materials":[{)" +
        R"("pbrMetallicRoughness":{"metallicFactor":0,"baseColorTexture":{"index":0)" + of_texture + "}}}]}";
    return read_scene(write("square.gltf", json));
  }
};

TEST_F(GltfTextures, LieWhereTheirSetOfCoordinatesSays) {
  const Scene scene = read("", R"(,"texCoord":1)");
  EXPECT_EQ(scene.polygons.size(), 1U) << "the two triangles become one polygon";
  expect_corners(scene, {red, green, blue, white});
  const Scene without = read("", "");
  EXPECT_FALSE(texture_map_on(without, without.polygons[0], Side::front)) << "there is no set 0";
}

TEST_F(GltfTextures, AreScaledTurnedAndMovedByTheirTransform) {
  const auto with = [&](const std::string& transform) {
    return read("", R"(,"extensions":{"KHR_texture_transform":{"texCoord":1,)" + transform + "}}");
  };
  expect_corners(with(R"("offset":[0.5,0])"), {green, red, white, blue});
  expect_corners(with(R"("scale":[0.5,0.5])"), {red, red, red, red});
  // Counter-clockwise with v downwards: u' = v, v' = -u.
  expect_corners(with(R"("rotation":1.5707963267948966)"), {blue, red, white, green});
}

TEST_F(GltfTextures, GoOnBeyondTheirEdgesAsTheSamplerSays) {
  const std::string moved = R"(,"extensions":{"KHR_texture_transform":{"texCoord":1,"offset":[1,0]}})";
  expect_corners(read("", moved), {red, green, blue, white});
  expect_corners(read(R"("wrapS":33648)", moved), {green, red, white, blue});
  expect_corners(read(R"("wrapS":33071)", moved), {green, green, white, white});
}

}  // namespace
}  // namespace patchlight::textures_test
