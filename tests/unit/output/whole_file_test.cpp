#include "output/file/whole_file.h"

#include "patchlight/base/error.h"

#include "temporary_folder.h"

#include <chrono>
#include <filesystem>
#include <gtest/gtest.h>
#include <stdexcept>
#include <sys/fsuid.h>
#include <sys/stat.h>

namespace patchlight::whole_file_test {
namespace {

namespace fs = std::filesystem;

TEST(WholeFile, IsOldUntilItIsWholeAndNew) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "result.vtp";
  put(file, "old");
  write_whole_file(file, [&](const fs::path& temporary) {
    EXPECT_EQ(temporary.parent_path(), folder.path());
    EXPECT_EQ(temporary.extension(), ".vtp");
    put(temporary, "new");
    EXPECT_EQ(content_of(file), "old");
  });
  EXPECT_EQ(content_of(file), "new");
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(WholeFile, StaysUntouchedWhenWritingFails) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "result.vtp";
  put(file, "old");
  EXPECT_THROW(write_whole_file(file,
                                [](const fs::path& temporary) {
                                  put(temporary, "half");
                                  throw Canceled();
                                }),
               Canceled);
  EXPECT_THROW(write_whole_file(file,
                                [](const fs::path& temporary) {
                                  put(temporary, "half");
                                  throw fs::filesystem_error("no", std::make_error_code(std::errc::io_error));
                                }),
               OutputError);
  EXPECT_EQ(content_of(file), "old");
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(WholeFile, IsAnErrorWhenNothingWasWritten) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_whole_file(folder.path() / "result.vtp", [](const fs::path&) {}), OutputError);
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(WholeFile, NamesNestWithoutCollision) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "result.vtp";
  write_whole_file(file, [&](const fs::path& outer) {
    put(outer, "outer");
    write_whole_file(file, [](const fs::path& inner) { put(inner, "inner"); });
    EXPECT_EQ(content_of(file), "inner");
  });
  EXPECT_EQ(content_of(file), "outer");
}

TEST(WholeFile, KeepsPermissionsAndFollowsLinks) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "result.vtp";
  const fs::path link = folder.path() / "link.vtp";
  put(file, "old");
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink(file, link);
  write_whole_file(link, [](const fs::path& temporary) { put(temporary, "new"); });
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(content_of(file), "new");
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

// A killed run leaves its file unlocked. A file that is being written is locked.
TEST(CheckWritable, RemovesLeftTemporariesButNoneInUse) {
  const TemporaryFolder folder;
  put(folder.path() / ".patchlight-1-0.vtp", "half");
  put(folder.path() / ".patchlightrc", "not ours");
  fs::create_directory(folder.path() / ".patchlight-1-1.vtp");
  write_whole_file(folder.path() / "result.vtp", [&](const fs::path& in_use) {
    put(in_use, "being written");
    check_writable(folder.path() / "other.vtp");
    EXPECT_TRUE(fs::exists(in_use));
    EXPECT_FALSE(fs::exists(folder.path() / ".patchlight-1-0.vtp"));
  });
  EXPECT_EQ(content_of(folder.path() / "result.vtp"), "being written");
  EXPECT_EQ(folder.entries(), 3U);
}

// A second lock of the same folder would wait for two seconds.
TEST(WholeFiles, OfOneFolderByTwoNamesAppearTogether) {
  const TemporaryFolder folder;
  const fs::path place = folder.path() / "place";
  const fs::path link = folder.path() / "link";
  fs::create_directory(place);
  fs::create_directory_symlink(place, link);
  const auto begin = std::chrono::steady_clock::now();
  WholeFiles files;
  files.write(place / "a.vtp", [](const fs::path& temporary) { put(temporary, "a"); });
  files.write(link / "b.vtp", [](const fs::path& temporary) { put(temporary, "b"); });
  EXPECT_FALSE(fs::exists(place / "a.vtp"));
  files.publish();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
  EXPECT_EQ(content_of(place / "a.vtp"), "a");
  EXPECT_EQ(content_of(place / "b.vtp"), "b");
  EXPECT_EQ(std::distance(fs::directory_iterator(place), fs::directory_iterator()), 2);
}

// A link to itself replaces the folder, so no name in it can be looked up.
TEST(WholeFiles, WhoseFolderCannotBeSearchedAnyMoreAreRefusedInWords) {
  const TemporaryFolder folder;
  const fs::path place = folder.path() / "place";
  fs::create_directory(place);
  WholeFiles files;
  files.write(place / "a.vtp", [](const fs::path& temporary) { put(temporary, "a"); });
  fs::rename(place, folder.path() / "elsewhere");
  fs::create_directory_symlink(place, place);
  try {
    files.publish();
    FAIL() << "a file was published in a folder that is not there";
  } catch (const OutputError& error) {
    EXPECT_NE(std::string(error.what()).find(place.string()), std::string::npos) << error.what();
  }
  fs::remove(place);
}

TEST(CheckWritable, LeavesNoTrace) {
  const TemporaryFolder folder;
  check_writable(folder.path() / "result.vtp");
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(CheckWritable, RefusesWhatIsNotAFileToWrite) {
  const TemporaryFolder folder;
  put(folder.path() / "plain", "");
  EXPECT_THROW(check_writable(""), OutputError);
  EXPECT_THROW(check_writable(folder.path()), OutputError);
  EXPECT_THROW(check_writable(folder.path() / ""), OutputError);
  EXPECT_THROW(check_writable(folder.path() / "missing" / "result.vtp"), OutputError);
  EXPECT_THROW(check_writable(folder.path() / "plain" / "result.vtp"), OutputError);
  EXPECT_THROW(check_writable("/dev/null"), OutputError);
}

TEST(CheckWritable, RefusesAFolderWithoutPermission) {
  const TemporaryFolder folder;
  fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
  // The superuser may write everywhere, so the test changes the user if it can.
  const int before = setfsuid(65534);
  EXPECT_THROW(check_writable(folder.path() / "result.vtp"), OutputError);
  setfsuid(static_cast<uid_t>(before));
  fs::permissions(folder.path(), fs::perms::owner_all);
}

}  // namespace
}  // namespace patchlight::whole_file_test
