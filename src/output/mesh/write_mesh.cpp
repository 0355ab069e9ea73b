#include "output/mesh/write_mesh.h"

#include "output/vtk/vtk_polygons.h"

#include <vtkCellData.h>
#include <vtkFieldData.h>

namespace patchlight {

void write_mesh(const std::filesystem::path& file, const Scene& scene, const MeshOfRows& rows) {
  const PatchMesh& mesh = rows.mesh;
  std::vector<std::uint32_t> objects, faces;
  for (const PolygonIndex polygon : mesh.polygon) {
    objects.push_back(scene.polygons[polygon].group);
    faces.push_back(scene.polygons[polygon].face);
  }
  std::vector<std::string> material_names;
  for (const Material& material : scene.materials) material_names.push_back(material.name);

  const Pointer<vtkPolyData> polygons = polygons_of(mesh);
  vtkCellData& cell_data = *polygons->GetCellData();
  cell_data.AddArray(numbers<vtkDoubleArray>("area", rows.area));
  cell_data.AddArray(numbers<vtkDoubleArray>("row_sum", rows.row_sum));
  if (rows.raw_row_sum.size() > 0) cell_data.AddArray(numbers<vtkDoubleArray>("raw_row_sum", rows.raw_row_sum));
  cell_data.AddArray(numbers<vtkIntArray>("material_id", mesh.material));
  cell_data.AddArray(numbers<vtkIntArray>("object_id", objects));
  cell_data.AddArray(numbers<vtkIntArray>("source_polygon", faces));
  cell_data.SetActiveScalars("row_sum");
  vtkFieldData& facts = *polygons->GetFieldData();
  facts.AddArray(strings("material_names", material_names));
  facts.AddArray(strings("object_names", scene.groups));
  facts.AddArray(strings("unit_area", {"m^2"}));
  write_polygons(file, *polygons);
}

}  // namespace patchlight
