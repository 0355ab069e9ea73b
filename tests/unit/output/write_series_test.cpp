#include "patchlight/base/error.h"

#include "output/vtk/write_vtk.h"
#include "render/tone_map.h"
#include "temporary_folder.h"
#include "tiny_simulation.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <numbers>
#include <regex>
#include <sys/fsuid.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>

namespace patchlight::write_series_test {
namespace {

namespace fs = std::filesystem;

constexpr double exposure = 0.125;

// Two iterates, the number of rows in the tiny simulation's history: first zero, then `brightness` everywhere.
std::vector<IterateIrradiance> iterates(float brightness = 1) {
  return {IterateIrradiance::Zero(3, 3), IterateIrradiance::Constant(3, 3, brightness)};
}

void write(const fs::path& pvd, float brightness = 1, const Observer& observer = {}) {
  write_series(pvd, tiny_scene(), tiny_simulation(), iterates(brightness), {"patchlight solve", exposure}, observer);
}

// The files in the .pvd, with their times.
std::vector<std::pair<std::string, fs::path>> named_by(const fs::path& pvd) {
  const std::string text = content_of(pvd);
  const std::regex entry("timestep=\"([^\"]*)\" part=\"0\" file=\"([^\"]*)\"");
  std::vector<std::pair<std::string, fs::path>> files;
  for (std::sregex_iterator match(text.begin(), text.end(), entry), end; match != end; ++match) {
    files.emplace_back((*match)[1], pvd.parent_path() / (*match)[2].str());
  }
  return files;
}

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(WriteSeries, HoldsTheIteratesFromTheLampsOn) {
  const TemporaryFolder folder;
  const fs::path pvd = folder.path() / "room.pvd";
  write(pvd);
  const auto files = named_by(pvd);
  ASSERT_EQ(files.size(), 2U);
  const Simulation simulation = tiny_simulation();
  for (std::size_t k = 0; k < files.size(); ++k) {
    EXPECT_EQ(files[k].first, std::to_string(k));
    const vtkNew<vtkXMLPolyDataReader> reader;
    reader->SetFileName(files[k].second.c_str());
    reader->Update();
    vtkPolyData* const polygons = reader->GetOutput();
    ASSERT_EQ(polygons->GetNumberOfCells(), 3);
    EXPECT_EQ(polygons->GetFieldData()->GetArray("TimeValue")->GetComponent(0, 0), k);
    EXPECT_EQ(polygons->GetFieldData()->GetArray("exposure")->GetComponent(0, 0), exposure);
    // B_k = E + rho o H_k
    const Field H = iterates()[k].cast<double>();
    const Field radiance =
        (simulation.problem.exitance + simulation.problem.scattering.reflectance * H) / std::numbers::pi;
    const auto colours = tone_map(radiance, exposure, usual_bands(3));
    for (int i = 0; i < 3; ++i) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(polygons->GetCellData()->GetArray("irradiance")->GetComponent(i, c), H(i, c));
        EXPECT_EQ(polygons->GetCellData()->GetArray("radiance")->GetComponent(i, c),
                  static_cast<float>(radiance(i, c)));
        EXPECT_EQ(polygons->GetCellData()->GetArray("rgb")->GetComponent(i, c),
                  colours[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)]);
      }
    }
    EXPECT_NE(polygons->GetFieldData()->GetAbstractArray("unit_radiance"), nullptr);
  }
}

TEST(WriteSeries, ReplacesAnOlderSeriesAndNothingElse) {
  const TemporaryFolder folder;
  const fs::path pvd = folder.path() / "room.pvd";
  write(pvd, 1);
  const auto older = named_by(pvd);
  put(series_folder(pvd) / "mine.vtp", "mine");
  put(series_folder(pvd) / "room_0000.vtp", "mine, too");
  write(pvd, 2);
  const auto newer = named_by(pvd);
  EXPECT_EQ(files_in(series_folder(pvd)), 2U + newer.size());
  for (const auto& [time, file] : newer) EXPECT_TRUE(fs::exists(file)) << file;
  for (const auto& [time, file] : older) EXPECT_FALSE(fs::exists(file)) << file;
  // The same series again: the same names, and no extra files.
  write(pvd, 2);
  EXPECT_EQ(named_by(pvd), newer);
  EXPECT_EQ(files_in(series_folder(pvd)), 2U + newer.size());
}

// A run may stop or the disk may be full at any file. The older series stays complete, without other files.
TEST(WriteSeries, KeepsTheOlderSeriesWhenItFails) {
  const TemporaryFolder folder;
  const fs::path pvd = folder.path() / "room.pvd";
  write(pvd, 1);
  const std::string old = content_of(pvd);
  for (int files = 0; files < 2; ++files) {
    EXPECT_THROW(write(pvd, 2, [files](const Progress& progress) { return 2 * progress.fraction < files; }), Canceled);
    EXPECT_EQ(content_of(pvd), old);
    EXPECT_EQ(files_in(series_folder(pvd)), 2U);
    for (const auto& [time, file] : named_by(pvd)) EXPECT_TRUE(fs::exists(file)) << file;
  }
  {
    const FullDisk disk(100);
    EXPECT_THROW(write(pvd, 2), OutputError);
  }
  EXPECT_EQ(content_of(pvd), old);
  EXPECT_EQ(files_in(series_folder(pvd)), 2U);
}

TEST(WriteSeries, LeavesNothingWhereNothingWas) {
  const TemporaryFolder folder;
  EXPECT_THROW(write(folder.path() / "room.pvd", 1, [](const Progress&) { return false; }), Canceled);
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(WriteSeries, EscapesNamesInTheCollection) {
  const TemporaryFolder folder;
  const fs::path pvd = folder.path() / "a & <b> 'c' \u00e9.pvd";
  write(pvd);
  const std::string text = content_of(pvd);
  EXPECT_NE(text.find("a &amp; &lt;b&gt; &apos;c&apos; \u00e9_series/"), std::string::npos) << text;
  EXPECT_EQ(files_in(series_folder(pvd)), 2U);
}

TEST(CheckSeriesWritable, RefusesWhatXmlCannotHold) {
  const TemporaryFolder folder;
  EXPECT_THROW(check_series_writable(folder.path() / "caf\xe9.pvd"), OutputError);
}

TEST(CheckSeriesWritable, RefusesAFileInTheWayOfTheFolder) {
  const TemporaryFolder folder;
  check_series_writable(folder.path() / "room.pvd");
  EXPECT_EQ(folder.entries(), 0U);
  put(folder.path() / "room_series", "a file");
  EXPECT_THROW(check_series_writable(folder.path() / "room.pvd"), OutputError);
  EXPECT_THROW(check_series_writable(folder.path() / "missing" / "room.pvd"), OutputError);
}

// Files may be created in it, but it cannot be opened for a lock. The program does not wait in vain.
TEST(WriteSeries, IntoAFolderThatCannotBeOpenedIsRefused) {
  const TemporaryFolder folder;
  const fs::path pvd = folder.path() / "room.pvd";
  fs::create_directory(series_folder(pvd));
  for (const fs::path& place : {folder.path(), series_folder(pvd)}) fs::permissions(place, fs::perms::all);
  fs::permissions(series_folder(pvd), fs::perms::owner_write | fs::perms::owner_exec | fs::perms::others_write);
  // The superuser may open everything, so the test changes the user if it can.
  const int before = setfsuid(65534);
  int asked = 0;
  const Observer few_times = [&asked](const Progress&) { return ++asked < 10; };
  EXPECT_THROW(write(pvd, 1, few_times), OutputError);
  setfsuid(static_cast<uid_t>(before));
  fs::permissions(series_folder(pvd), fs::perms::owner_all);
  EXPECT_FALSE(fs::exists(pvd));
}

}  // namespace
}  // namespace patchlight::write_series_test
