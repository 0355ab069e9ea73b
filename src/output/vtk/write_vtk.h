#pragma once

#include "patchlight/output/provenance.h"
#include "patchlight/views/views.h"

#include <filesystem>

namespace patchlight {

/// Writes the solved patches as VTK XML PolyData (.vtp), appended raw data compressed with LZ4, for ParaView.
/// Cell arrays: radiance, radiosity, irradiance, direct_irradiance, indirect_irradiance, exitance, reflectance (bands,
/// linear), luminance, area, material_id, source_polygon, row_sum, raw_row_sum (both where known), rgb (UInt8 x 3,
/// sRGB); with error bars error_mesh, error_form_factor, error_solver, error_total, display_error, error_irradiance,
/// else error_solver where it is known. Point array: radiance_smooth. FieldData: the unit of every array, material
/// names, version, command line, seed, SHA-256 of the input, exposure, convergence history, relative errors, seconds
/// per stage. docs/reference/outputs/vtp.md lists them all. A file whose name ends in .vtu gets an unstructured grid
/// with the same arrays, compressed with zlib, and of the facts those that are numbers. \throws OutputError.
void write_vtk(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance);

}  // namespace patchlight
