#pragma once

#include "patchlight/light/spectrum.h"
#include "patchlight/mesh/patch_mesh.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>

namespace patchlight {

template <class Array>
using Pointer = vtkSmartPointer<Array>;

/// The patches as cells, one each: triangles and quadrilaterals. Coordinates in double.
Pointer<vtkPolyData> polygons_of(const PatchMesh& mesh);

/// One tuple per row, narrowed to float.
Pointer<vtkFloatArray> floats(const char* name, const FieldView& values);

/// Names the components of arrays with one per band, color or axis: "r", "g", "b". Viewers show "X", "Y", "Z"
/// otherwise.
void name_components(vtkFieldData& data, const Bands& bands);

/// One tuple of three bytes per color.
Pointer<vtkUnsignedCharArray> colours(const char* name, const std::vector<std::array<std::uint8_t, 3>>& values);

Pointer<vtkStringArray> strings(const std::string& name, const std::vector<std::string>& values);

/// An array of numbers of any kind, one component, as vtkIntArray, vtkFloatArray or vtkDoubleArray.
template <class Array, class Values>
Pointer<Array> numbers(const char* name, const Values& values) {
  auto array = Pointer<Array>::New();
  array->SetName(name);
  for (const auto value : values) array->InsertNextValue(static_cast<typename Array::ValueType>(value));
  return array;
}

/// Writes a whole .vtp file, appended raw data, LZ4. \throws OutputError.
void write_polygons(const std::filesystem::path& file, vtkPolyData& polygons);

/// Writes the same as an unstructured grid, a whole .vtu file, appended raw data, zlib; facts that are texts are left
/// out. \throws OutputError.
void write_grid(const std::filesystem::path& file, vtkPolyData& polygons);

}  // namespace patchlight
