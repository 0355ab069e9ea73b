#include "patchlight/base/error.h"
#include "patchlight/views/picture.h"

#include "glb_parts.h"
#include "output/image/write_image.h"
#include "support/scenes.h"
#include "temporary_folder.h"

#include <Imath/ImathBox.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::write_lightmap_test {
namespace {

using namespace test;

// A room with a lamp and a pane, in which z is up.
struct Baked {
  Scene scene;
  Simulation simulation;
  Lightmap map;
};

const Baked& baked() {
  static const Baked one = [] {
    Scene scene = furnished_room(0.5);
    Material pane = grey(0);
    pane.name = "pane";
    pane.transmittance = Spectrum::Constant(1, 0.8);
    scene.materials.push_back(pane);
    scene =
        with_quad(std::move(scene), {Point(3, 0.5, 0.5), Point(3, 2, 0.5), Point(3, 2, 1.5), Point(3, 0.5, 1.5)}, 2);
    Request request;
    request.mesh.max_edge = 0.5;
    Simulation simulation = simulate(scene, request);
    Lightmap map = bake_lightmap(simulation, {.texel = 0.25});
    return Baked{std::move(scene), std::move(simulation), std::move(map)};
  }();
  return one;
}

// Its folder, and the contents.
class Written {
 public:
  Written() { write_lightmap(path(), baked().scene, baked().simulation, baked().map, {.command_line = "made"}); }
  std::filesystem::path path() const { return folder_.path() / "map"; }
  Glb glb(const char* name) const { return taken_apart(content_of(path() / name)); }

 private:
  TemporaryFolder folder_;
};

std::vector<float> channel(const std::filesystem::path& file, const char* name) {
  Imf::InputFile in(file.c_str());
  const Imath::Box2i window = in.header().dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x + 1), height = static_cast<std::size_t>(window.max.y + 1);
  EXPECT_NE(in.header().channels().findChannel(name), nullptr);
  std::vector<float> values(width * height);
  Imf::FrameBuffer pixels;
  pixels.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 4 * width));
  in.setFrameBuffer(pixels);
  in.readPixels(0, window.max.y);
  return values;
}

TEST(WriteLightmap, FilesKeepTheRulesOfTheFormat) {
  const Written written;
  for (const char* name : {"lightmap.glb", "baked.glb"}) {
    SCOPED_TRACE(name);
    expect_valid(written.glb(name));
  }
}

// Direct light from lamps and the rest add up to all light, W/m^2, texel by texel.
TEST(WriteLightmap, DirectAndIndirectAreAllLight) {
  const Written written;
  const std::vector<float> all = channel(written.path() / "irradiance.exr", "G");
  const std::vector<float> direct = channel(written.path() / "direct.exr", "G");
  const std::vector<float> indirect = channel(written.path() / "indirect.exr", "G");
  ASSERT_EQ(all.size(), baked().map.patch.size());
  bool any = false;
  for (std::size_t texel = 0; texel < all.size(); ++texel) {
    EXPECT_FLOAT_EQ(all[texel], direct[texel] + indirect[texel]);
    EXPECT_FLOAT_EQ(direct[texel], baked().map.direct(static_cast<Eigen::Index>(texel), 0));
    any = any || (direct[texel] > 0 && indirect[texel] > 0);
  }
  EXPECT_TRUE(any);
  for (const float error : channel(written.path() / "indirect.exr", "error.Y")) EXPECT_GE(error, 0);
}

// The second coordinates lead to the texel of their patch: the middle of each triangle is on a texel of its face.
TEST(WriteLightmap, CoordinatesLeadToTheTexelsOfTheFace) {
  const Written written;
  const Glb glb = written.glb("lightmap.glb");
  const Lightmap& map = baked().map;
  std::size_t triangles = 0;
  for (const auto& primitive : glb.json["meshes"][0]["primitives"]) {
    if (glb.json["materials"].at(primitive["material"].get<std::size_t>())["name"] == "pane") continue;
    const auto attribute = [&](const char* name) {
      return values_of(glb, glb.json["accessors"].at(primitive["attributes"][name].get<std::size_t>()));
    };
    const std::vector<double> positions = attribute("POSITION"), places = attribute("TEXCOORD_1");
    const std::vector<double> corners =
        values_of(glb, glb.json["accessors"].at(primitive["indices"].get<std::size_t>()));
    for (std::size_t t = 0; t < corners.size(); t += 3, ++triangles) {
      Eigen::Vector2d middle(0, 0);
      Point point(0, 0, 0);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto vertex = static_cast<std::size_t>(corners[t + k]);
        middle += Eigen::Vector2d(places[2 * vertex], places[2 * vertex + 1]) / 3;
        point += Point(positions[3 * vertex], -positions[3 * vertex + 2], positions[3 * vertex + 1]) / 3;
      }
      const auto x = static_cast<std::size_t>(middle.x() * map.width),
                 y = static_cast<std::size_t>(middle.y() * map.height);
      const PatchIndex patch = map.patch[y * static_cast<std::size_t>(map.width) + x];
      ASSERT_NE(patch, no_patch);
      // Relative to the middle of the bounds.
      const Vector from = point + Vector(bounds(baked().scene).center()) - baked().simulation.mesh.centroid[patch];
      EXPECT_NEAR(from.dot(baked().simulation.mesh.normal[patch]), 0, 1e-5);
      EXPECT_LT(from.norm(), 1);
    }
  }
  EXPECT_GT(triangles, baked().simulation.mesh.size());
}

// An independent reader finds all triangles, both coordinates and the embedded picture.
TEST(WriteLightmap, IsReadByAssimp) {
  const Written written;
  for (const char* name : {"lightmap.glb", "baked.glb"}) {
    SCOPED_TRACE(name);
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile((written.path() / name).string(), aiProcess_ValidateDataStructure);
    ASSERT_NE(scene, nullptr) << importer.GetErrorString();
    EXPECT_EQ(scene->mFlags & AI_SCENE_FLAGS_VALIDATION_WARNING, 0U);
    std::size_t triangles = 0, expected = 0;
    for (unsigned int m = 0; m < scene->mNumMeshes; ++m) {
      triangles += scene->mMeshes[m]->mNumFaces;
      EXPECT_TRUE(scene->mMeshes[m]->HasTextureCoords(1));
    }
    for (const auto& [a, b, c, d] : baked().simulation.mesh.corners) expected += c == d ? 1 : 2;
    EXPECT_EQ(triangles, expected);
    EXPECT_EQ(scene->mNumTextures, std::string(name) == "baked.glb" ? 1U : 0U);
  }
}

// Number of triangles that assimp finds. 0 if it rejects the file or warns about it.
std::size_t triangles_read(const std::string& bytes) {
  Assimp::Importer importer;
  const aiScene* const scene =
      importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_ValidateDataStructure, "glb");
  if (scene == nullptr || (scene->mFlags & AI_SCENE_FLAGS_VALIDATION_WARNING) != 0) return 0;
  std::size_t triangles = 0;
  for (unsigned int m = 0; m < scene->mNumMeshes; ++m) triangles += scene->mMeshes[m]->mNumFaces;
  return triangles;
}

// The reader detects faults: it drops the triangle of a missing vertex, and rejects half of a file.
TEST(WriteLightmap, IsNotReadWholeWhenItIsBroken) {
  const Written written;
  const std::string whole = content_of(written.path() / "lightmap.glb");
  const Glb glb = taken_apart(whole);
  const auto& primitive = glb.json["meshes"][0]["primitives"][0];
  const auto& indices = glb.json["accessors"].at(primitive["indices"].get<std::size_t>());
  const auto& view = glb.json["bufferViews"].at(indices["bufferView"].get<std::size_t>());
  std::string astray = whole;
  astray.replace(whole.size() - glb.binary.size() + view["byteOffset"].get<std::size_t>(), 4, "\xf0\xff\xff\x0f");
  EXPECT_GT(triangles_read(whole), 0U);
  EXPECT_LT(triangles_read(astray), triangles_read(whole));
  EXPECT_EQ(triangles_read(whole.substr(0, whole.size() / 2)), 0U);
}

TEST(WriteLightmap, ReplacesALightmapAndNothingElse) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "map";
  const auto write = [&] { write_lightmap(path, baked().scene, baked().simulation, baked().map, {}); };
  write();
  check_lightmap_writable(path);
  write();
  std::ofstream(path / "mine.txt") << "mine";
  EXPECT_THROW(check_lightmap_writable(path), OutputError);
  EXPECT_THROW(write(), OutputError);
  EXPECT_TRUE(std::filesystem::exists(path / "mine.txt"));
}

TEST(WriteLightmap, TellsItsMemory) {
  // Three fields of one band, error and patch, four bytes each.
  EXPECT_EQ(bytes_of(baked().map), baked().map.patch.size() * 4 * (3 + 1 + 1));
}

}  // namespace
}  // namespace patchlight::write_lightmap_test
