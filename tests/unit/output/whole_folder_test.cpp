#include "patchlight/base/error.h"

#include "output/file/whole_file.h"
#include "temporary_folder.h"

#include <gtest/gtest.h>

namespace patchlight::whole_folder_test {
namespace {

namespace fs = std::filesystem;

bool always(const fs::path&) { return true; }
bool never(const fs::path&) { return false; }

TEST(WholeFolder, IsOldUntilItIsWholeAndNew) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "room.ff";
  write_whole_folder(target / "", never, [](const fs::path& in) { put(in / "a", "old"); });
  write_whole_folder(target, always, [&](const fs::path& in) {
    EXPECT_EQ(in.parent_path(), folder.path());
    put(in / "b", "new");
    EXPECT_EQ(content_of(target / "a"), "old");
  });
  EXPECT_EQ(content_of(target / "b"), "new");
  EXPECT_FALSE(fs::exists(target / "a"));
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(WholeFolder, StaysUntouchedWhenWritingFails) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "room.ff";
  write_whole_folder(target, never, [](const fs::path& in) { put(in / "a", "old"); });
  const auto half = [](const fs::path& in) {
    put(in / "a", "half");
    throw Canceled();
  };
  EXPECT_THROW(write_whole_folder(target, always, half), Canceled);
  EXPECT_EQ(content_of(target / "a"), "old");
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(WholeFolder, AFullDiskIsAnErrorThatNamesTheUsersFile) {
  const TemporaryFolder folder;
  const FullDisk full(1000);
  const auto write = [](const fs::path& in) { write_bytes(in / "F.npy", std::string(100000, 'x')); };
  try {
    write_whole_folder(folder.path() / "room.ff", never, write);
    FAIL() << "more was written than the disk holds";
  } catch (const OutputError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with((folder.path() / "room.ff" / "F.npy").string() + ": "));
  }
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(WholeFolder, ReplacesAnEmptyFolderAndWhatItMay) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "room.ff";
  fs::create_directory(target);
  const auto fill = [](const fs::path& in) { put(in / "a", "new"); };
  write_whole_folder(target, never, fill);
  EXPECT_EQ(content_of(target / "a"), "new");
  EXPECT_THROW(write_whole_folder(target, never, fill), OutputError);
  EXPECT_THROW(check_folder_writable(target, never), OutputError);
  EXPECT_NO_THROW(check_folder_writable(target, always));
}

TEST(WholeFolder, RefusesFilesAndMissingPlaces) {
  const TemporaryFolder folder;
  put(folder.path() / "plain", "mine");
  EXPECT_THROW(check_folder_writable(folder.path() / "plain", always), OutputError);
  EXPECT_THROW(check_folder_writable(folder.path() / "missing" / "room.ff", always), OutputError);
  EXPECT_THROW(check_folder_writable("", always), OutputError);
  EXPECT_EQ(folder.entries(), 1U);
}

// A killed run leaves its folder unlocked. A folder that is being written is locked.
TEST(WholeFolder, RemovesLeftFoldersButNoneInUse) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / ".patchlight-1-0.partial");
  put(folder.path() / ".patchlight-1-0.partial" / "F.npy", "half");
  write_whole_folder(folder.path() / "room.ff", never, [&](const fs::path& in_use) {
    put(in_use / "a", "being written");
    check_folder_writable(folder.path() / "other.ff", never);
    EXPECT_TRUE(fs::exists(in_use));
  });
  EXPECT_EQ(content_of(folder.path() / "room.ff" / "a"), "being written");
  EXPECT_EQ(folder.entries(), 1U);
}

}  // namespace
}  // namespace patchlight::whole_folder_test
