#include "patchlight/output/write_result.h"

#include "patchlight/base/error.h"

#include "temporary_folder.h"
#include "tiny_simulation.h"

#include <gtest/gtest.h>

namespace patchlight::write_result_test {
namespace {

TEST(WriteResult, WritesEveryExtensionItNames) {
  const TemporaryFolder folder;
  const std::vector<std::string> beginnings = {
      "<VTKFile type=\"PolyData\"", "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\"", "ply\n", "glTF"};
  ASSERT_EQ(result_extensions().size(), beginnings.size());
  for (std::size_t k = 0; k < beginnings.size(); ++k) {
    const std::filesystem::path file = folder.path() / ("result" + result_extensions()[k]);
    write_result(file, tiny_surface(), {"", 0.125});
    EXPECT_TRUE(content_of(file).starts_with(beginnings[k])) << file;
  }
}

TEST(WriteResult, RefusesOthersAndNamesThose) {
  const TemporaryFolder folder;
  try {
    write_result(folder.path() / "result.stl", tiny_surface(), {"", 1});
    FAIL() << "no error";
  } catch (const OutputError& error) {
    for (const std::string& extension : result_extensions()) {
      EXPECT_NE(std::string(error.what()).find(extension), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(folder.entries(), 0U);
}

// For any number of bytes that fit.
TEST(WriteResult, FullDiskIsAnErrorAndKeepsTheOldFile) {
  for (const std::string& extension : result_extensions()) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / ("result" + extension);
    write_result(file, tiny_surface(), {"", 0.125});
    const std::string old = content_of(file);
    for (const std::size_t bytes : {std::size_t{0}, std::size_t{100}, old.size() - 1}) {
      {
        const FullDisk disk(bytes);
        EXPECT_THROW(write_result(file, tiny_surface(), {"", 0.125}), OutputError) << file << bytes;
      }
      EXPECT_EQ(content_of(file), old);
      EXPECT_EQ(folder.entries(), 1U);
    }
  }
}

}  // namespace
}  // namespace patchlight::write_result_test
