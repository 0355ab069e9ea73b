#include "archive/read_solution.h"

#include "patchlight/base/error.h"

#include "../output/temporary_folder.h"
#include "../output/tiny_simulation.h"
#include "archive/scene_hash.h"
#include "output/vtk/write_vtk.h"

#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>

namespace patchlight::read_solution_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

class ReadSolution : public testing::Test {
 protected:
  // The tiny solution, changed after smoothing.
  void write(const std::function<void(Simulation&)>& change = [](Simulation&) {}) {
    Simulation simulation = tiny_simulation();
    const SolvedSurface surface = surface_of(simulation);
    change(simulation);
    Provenance provenance{"patchlight solve tiny.obj", 1};
    provenance.scene_hash = scene_hash(scene);
    write_vtk(file, surface, provenance);
  }

  void expect_refused(const std::function<void(Simulation&)>& change) {
    write(change);
    EXPECT_THROW(read_solution(file, std::make_shared<const Scene>(scene)), InputError);
  }

  // The file with a change in VTK's terms.
  void edit(const std::function<void(vtkPolyData&)>& change) const {
    const vtkNew<vtkXMLPolyDataReader> reader;
    reader->SetFileName(file.c_str());
    reader->Update();
    change(*reader->GetOutput());
    const vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetInputData(reader->GetOutput());
    writer->SetFileName(file.c_str());
    writer->Write();
  }

  std::string bytes() const {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  void put(const std::string& bytes) const { std::ofstream(file, std::ios::binary) << bytes; }

  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "tiny.vtp";
  const Scene scene = tiny_scene();
};

TEST_F(ReadSolution, ReturnsTheSolutionInSinglePrecision) {
  write();
  const Simulation read = read_solution(file, std::make_shared<const Scene>(scene));
  const Simulation written = tiny_simulation();
  ASSERT_EQ(read.mesh.size(), written.mesh.size());
  EXPECT_EQ(read.mesh.vertices, written.mesh.vertices);
  EXPECT_EQ(read.mesh.corners, written.mesh.corners);
  EXPECT_EQ(read.mesh.first_patch, written.mesh.first_patch);
  EXPECT_TRUE((read.solution.radiosity == written.solution.radiosity.cast<float>().cast<double>()).all());
  EXPECT_TRUE(read.solution.converged);
}

TEST_F(ReadSolution, RefusesValuesThatNoSolutionHas) {
  for (const double value : {nan, infinity, -1.0}) {
    expect_refused([=](Simulation& of) { of.solution.radiosity(1, 2) = value; });
    expect_refused([=](Simulation& of) { of.problem.exitance(0, 1) = value; });
    expect_refused([=](Simulation& of) { of.problem.scattering.reflectance(2, 0) = value; });
  }
  expect_refused([](Simulation& of) { of.problem.scattering.reflectance(0, 0) = 1e30; });
}

TEST_F(ReadSolution, RefusesPatchesThatAreNotOfTheScene) {
  for (const double value : {nan, infinity, -1e9, 1e300})
    expect_refused([=](Simulation& of) { of.mesh.vertices[2].y() = value; });
  expect_refused([](Simulation& of) { of.mesh.vertices.assign(5, Point::Zero()); });
  expect_refused([](Simulation& of) { of.mesh.corners[0] = {3, 2, 1, 0}; });        // turned
  expect_refused([](Simulation& of) { of.mesh.corners[1] = of.mesh.corners[2]; });  // of another polygon
}

TEST_F(ReadSolution, RefusesNumbersOfPolygonsThatAreNotThere) {
  for (const double number : {3.0, -1.0, 1e9}) {
    write();
    edit([=](vtkPolyData& of) { of.GetCellData()->GetArray("polygon")->SetComponent(2, 0, number); });
    EXPECT_THROW(read_solution(file, std::make_shared<const Scene>(scene)), InputError) << number;
  }
  write();
  edit([](vtkPolyData& of) { of.GetCellData()->GetArray("polygon")->SetComponent(1, 0, 2); });
  EXPECT_THROW(read_solution(file, std::make_shared<const Scene>(scene)), InputError) << "polygon 1 has no patch";
}

TEST_F(ReadSolution, RefusesSeedsThatAreNoWholeNumbers) {
  for (const char* seed : {"x", "-1", "1.5", "7 ", "99999999999999999999"}) {
    write();
    edit([=](vtkPolyData& of) {
      vtkStringArray::SafeDownCast(of.GetFieldData()->GetAbstractArray("seed"))->SetValue(0, seed);
    });
    EXPECT_THROW(read_solution(file, std::make_shared<const Scene>(scene)), InputError) << seed;
  }
}

TEST_F(ReadSolution, RefusesFactsWithoutValues) {
  for (const char* fact : {"scene_hash", "seed", "effects"}) {
    write();
    edit([=](vtkPolyData& of) {
      const vtkNew<vtkStringArray> none;
      none->SetName(fact);
      of.GetFieldData()->RemoveArray(fact);
      of.GetFieldData()->AddArray(none);
    });
    EXPECT_THROW(read_solution(file, std::make_shared<const Scene>(scene)), InputError) << fact;
  }
}

TEST_F(ReadSolution, DamagedFilesAreReadOrRefused) {
  write();
  const std::string good = bytes();
  std::mt19937 random(1);
  const auto below = [&](std::size_t end) { return std::uniform_int_distribution<std::size_t>(0, end - 1)(random); };
  for (int mutant = 0; mutant < 150; ++mutant) {
    std::string bad = good;
    if (mutant % 3 == 0) bad.resize(below(good.size()));
    if (mutant % 3 == 1) bad[below(good.size())] ^= static_cast<char>(1U << below(8));
    if (mutant % 3 == 2) bad.replace(below(good.size() - 8), 8, "99999999");
    put(bad);
    try {
      read_solution(file, std::make_shared<const Scene>(scene));
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace patchlight::read_solution_test
