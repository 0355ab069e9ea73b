#pragma once

#include "patchlight/gather/readings.h"
#include "patchlight/output/write_result.h"
#include "patchlight/scene/sensor.h"
#include "patchlight/simulate.h"
#include "patchlight/views/views.h"

#include "plan/survey.h"

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

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

/// Irradiance H_k in W/m^2 of one iterate, one row per patch, narrowed to float. The iterate is B_k = E + rho o H_k.
using IterateIrradiance = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Writes a time series for ParaView: FILE.pvd and, in the folder FILE_series beside it, one .vtp per iterate with
/// radiance, irradiance and rgb, the iteration as its time. `iterates` has one entry per row of the solution's history.
/// Everything is whole at any moment: the .pvd is replaced last and names new files only; those of an older series are
/// removed after that. \throws OutputError, Canceled; then the older series is still there.
void write_series(const std::filesystem::path& pvd, const Scene& scene, const Simulation& simulation,
                  const std::vector<IterateIrradiance>& iterates, const Provenance& provenance,
                  const Observer& observer = {});

/// Makes the .pvd file appear with this text.
using PublishCollection = std::function<void(const std::string& collection)>;

/// The same; the .pvd is left to `publish`, which may let other files appear with it. When it throws, the older series
/// is still there. Runs that write one series do so one after the other.
void write_series(const std::filesystem::path& pvd, const Scene& scene, const Simulation& simulation,
                  const std::vector<IterateIrradiance>& iterates, const Provenance& provenance,
                  const Observer& observer, const PublishCollection& publish);

/// The folder of a series' .vtp files.
std::filesystem::path series_folder(const std::filesystem::path& pvd);

/// Fails early: \throws OutputError when write_series could not write here.
void check_series_writable(const std::filesystem::path& pvd);

/// The extensions that write_points() knows, with their dots.
std::vector<std::string> points_extensions();

/// Writes the readings of sensors in the format of the file's extension.
///
/// .csv: a header line and a line for each sensor, with:
/// - x, y, z, nx, ny, nz as in the input, or in meters without such text;
/// - irradiance, its standard error and the parts of the error per band in W/m^2 (E_r, E_g, E_b for three bands),
/// - with photometric lights, illuminance and its standard error in lx;
/// - under an overcast sky, the daylight factor in percent,
/// - 1 inside a wall, where values are nan, else 0;
/// - the group.
/// .vtp: the same for ParaView, with cells of grids as polygons and other sensors as vertices. \throws OutputError.
void write_points(const std::filesystem::path& file, std::span<const SensorGroup> groups, const Readings& readings);

/// Writes a scene and the faces that are wrong in it as VTK XML PolyData (.vtp) for ParaView. Cell arrays: problem_kind
/// (0: a polygon with nothing wrong; else the place of its problem in the field array problem_names, from 1), severity
/// (0 nothing, 1 remark, 2 warning, 3 error), source_file, source_line and source_polygon. A face with several problems
/// is there once for each; faces that were left out are there as the model has them. \throws OutputError.
void write_problems(const std::filesystem::path& file, const Scene& scene, const SceneReport& report);

}  // namespace patchlight
