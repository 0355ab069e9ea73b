#include "patchlight/scene/sides.h"

#include "archive/ray_row_files.h"
#include "mesh/mesher.h"
#include "support/scenes.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <unistd.h>
#include <vector>

namespace patchlight::row_block_files_test {
namespace {

using namespace test;

const std::vector<std::int32_t> words{3, -1, 1 << 30, 0, 7};

struct Folder {
  Folder() { std::filesystem::remove_all(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  // Tests run in parallel.
  std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) /
      ("row_blocks_" + std::to_string(getpid()) + "_" + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST(RowBlockFiles, GiveBackWhatWasKept) {
  const Folder folder;
  const RowBlocks blocks = row_blocks_in(folder.path, "0123");
  EXPECT_FALSE(blocks.read(0).has_value());
  blocks.keep(0, words);
  blocks.keep(12, {});
  EXPECT_EQ(blocks.read(0), words);
  EXPECT_EQ(blocks.read(12), std::vector<std::int32_t>());
  EXPECT_FALSE(blocks.read(1).has_value());
  EXPECT_FALSE(row_blocks_in(folder.path, "4567").read(0).has_value());
}

// Each bit is flipped in turn, and the file is cut to each shorter length.
TEST(RowBlockFiles, TakeNoDamagedOnes) {
  const Folder folder;
  const RowBlocks blocks = row_blocks_in(folder.path, "0123");
  blocks.keep(0, words);
  const std::filesystem::path file = folder.path / "rows_0123_0.npy";
  std::ifstream stream(file, std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(stream)), {});
  const std::size_t numbers = (words.size() + 1) * sizeof(std::int32_t);
  const auto write = [&](const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; };
  for (std::size_t bit = 8 * (whole.size() - numbers); bit < 8 * whole.size(); ++bit) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    write(damaged);
    EXPECT_FALSE(blocks.read(0).has_value()) << bit;
  }
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write(whole.substr(0, size));
    EXPECT_FALSE(blocks.read(0).has_value()) << size;
  }
  write(whole);
  EXPECT_EQ(blocks.read(0), words);
  // A block of another place.
  std::filesystem::rename(file, folder.path / "rows_0123_1.npy");
  EXPECT_FALSE(blocks.read(1).has_value());
  // No file at all.
  std::filesystem::create_directory(file);
  EXPECT_FALSE(blocks.read(0).has_value());
}

TEST(RowBlockFiles, AreRemovedByTheirKeys) {
  const Folder folder;
  row_blocks_in(folder.path, "0123").keep(0, words);
  row_blocks_in(folder.path, "4567").keep(0, words);
  remove_row_blocks(folder.path, std::vector<std::string>{"0123"});
  EXPECT_FALSE(row_blocks_in(folder.path, "0123").read(0).has_value());
  EXPECT_EQ(row_blocks_in(folder.path, "4567").read(0), words);
  remove_row_blocks(folder.path / "missing", std::vector<std::string>{"0123"});
}

TEST(RowBlockFiles, HaveAKeyOfAllThatRowsDependOn) {
  const Scene room = furnished_room(0.5);
  const auto key = [&](const Scene& scene, double edge, const RayOptions& options, const EffectOptions& effects,
                       float density) {
    const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), edge);
    const std::vector<float> densities(mesh.size(), density);
    return row_key({scene, effects}, mesh, options, densities);
  };
  Scene moved_away = room;
  moved_away.vertices.back().z() += 1e-9;
  Scene clear = room;
  clear.materials[1].transmittance = Spectrum::Constant(1, 0.5);
  Scene denser = clear;
  denser.materials[1].index = 1.6;
  const std::set<std::string> keys{key(room, 0.5, {}, {}, 0),
                                   key(moved_away, 0.5, {}, {}, 0),
                                   key(clear, 0.5, {}, {}, 0),
                                   key(denser, 0.5, {}, {}, 0),
                                   key(room, 0.4, {}, {}, 0),
                                   key(room, 0.5, {.rays = 128}, {}, 0),
                                   key(room, 0.5, {.toward_bright = 64}, {}, 0),
                                   key(room, 0.5, {.seed = 2}, {}, 0),
                                   key(room, 0.5, {.doublings = {0, 1}}, {}, 0),
                                   key(room, 0.5, {}, {.skip = {Effect::occlusion}}, 0),
                                   key(room, 0.5, {}, {.force = {Effect::occlusion}}, 0),
                                   key(room, 0.5, {}, {}, 1)};
  EXPECT_EQ(keys.size(), 12U);
  EXPECT_EQ(key(room, 0.5, {}, {}, 0), key(furnished_room(0.8), 0.5, {}, {}, 0));
}

}  // namespace
}  // namespace patchlight::row_block_files_test
