#pragma once

#include <filesystem>

class vtkPolyData;

namespace patchlight {

/// Writes VTK XML PolyData as a whole file: appended raw data compressed with LZ4. \throws OutputError.
void write_polydata(const std::filesystem::path& file, vtkPolyData& polygons);

}  // namespace patchlight
