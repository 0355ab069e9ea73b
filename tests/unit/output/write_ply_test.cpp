#include "number_at.h"
#include "output/mesh/write_mesh.h"
#include "render/render.h"
#include "render/tone_map.h"
#include "temporary_folder.h"
#include "tiny_simulation.h"
#include "visibility/occluder.h"

#include <gtest/gtest.h>
#include <numbers>
#include <vtkCell.h>
#include <vtkNew.h>
#include <vtkPLYReader.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

namespace patchlight::write_ply_test {
namespace {

using test::number_at;

constexpr double exposure = 0.125;

std::string written(const std::filesystem::path& file) {
  write_ply(file, tiny_surface(), {"patchlight solve tiny.obj\nend_header", exposure});
  return content_of(file);
}

// The layout of the header, byte for byte.
TEST(WritePly, BytesAreWhatTheHeaderSays) {
  const TemporaryFolder folder;
  const std::string bytes = written(folder.path() / "result.ply");
  const PatchMesh mesh = tiny_simulation().mesh;
  EXPECT_NE(bytes.find("format binary_little_endian 1.0\n"), std::string::npos);
  EXPECT_NE(bytes.find("element vertex 5\nproperty double x\n"), std::string::npos);
  EXPECT_NE(bytes.find("element face 3\nproperty list uchar int vertex_indices\n"), std::string::npos);
  const std::string end = "\nend_header\n";
  std::size_t offset = bytes.find(end) + end.size();
  constexpr std::size_t vertex_size = 3 * 8 + 3;
  for (std::size_t k = 0; k < 5; ++k, offset += vertex_size) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(number_at<double>(bytes, offset + 8 * axis), mesh.vertices[k][static_cast<Eigen::Index>(axis)]);
    }
  }
  for (std::size_t patch = 0; patch < 3; ++patch) {
    const std::size_t count = patch == 0 ? 4 : 3;
    ASSERT_EQ(number_at<std::uint8_t>(bytes, offset), count);
    for (std::size_t k = 0; k < count; ++k) {
      EXPECT_EQ(number_at<std::int32_t>(bytes, offset + 1 + 4 * k), static_cast<int>(mesh.corners[patch][k]));
    }
    offset += 1 + 4 * count;
  }
  EXPECT_EQ(offset, bytes.size());
}

TEST(WritePly, AnotherReaderFindsFacesAndColours) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "result.ply";
  written(file);
  const vtkNew<vtkPLYReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkPolyData* const polygons = reader->GetOutput();
  const Simulation simulation = tiny_simulation();
  ASSERT_EQ(polygons->GetNumberOfPoints(), 5);
  ASSERT_EQ(polygons->GetNumberOfCells(), 3);
  EXPECT_EQ(polygons->GetCell(0)->GetNumberOfPoints(), 4);
  EXPECT_EQ(polygons->GetCell(2)->GetPointId(1), 1);

  const Field radiance = simulation.solution.radiosity / std::numbers::pi;
  const auto colours =
      tone_map(smooth(simulation.mesh, radiance, simulation.problem.area, Occluder(tiny_scene())).at_vertices, exposure,
               usual_bands(3));
  vtkDataArray* const read = polygons->GetPointData()->GetScalars();
  ASSERT_NE(read, nullptr);
  for (int k = 0; k < 5; ++k) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(read->GetComponent(k, c), colours[static_cast<std::size_t>(k)][static_cast<std::size_t>(c)]);
    }
  }
}

}  // namespace
}  // namespace patchlight::write_ply_test
