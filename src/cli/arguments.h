#pragma once

#include "patchlight/annual/annual.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/plan/plan.h"
#include "patchlight/views/picture.h"

#include "archive/form_factor_files.h"
#include "cli/messages.h"
#include "output/plot/write_sensor_map.h"
#include "study/compare.h"
#include "study/study.h"
#include "study/verify.h"

#include <array>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace patchlight::cli {

/// The command line is invalid; the message is one sentence that names the option.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A requested exposure; by default, a series of images has that of its first.
struct Exposure {
  std::optional<double> factor = {};  ///< PictureOptions::exposure
  double stops = 0;                   ///< PictureOptions::stops
  bool each = false;                  ///< each image of a series has its own
};

/// A requested image.
struct PictureSettings {
  std::filesystem::path file;       ///< .png, .hdr or .exr; empty: none
  std::filesystem::path error_map;  ///< .png; empty: none
  std::optional<Camera> camera;     ///< model units
  std::vector<std::string> views;   ///< names of cameras of the scene, instead of `camera`; empty: the first camera
  PictureColors colors = PictureColors::natural;
  Exposure exposure;
  std::optional<double> brightest;  ///< PictureOptions::brightest
  PictureQuality quality = PictureQuality::draft;
  std::array<int, 2> size{800, 800};  ///< width and height, pixels
  double error = 0.01;                ///< PictureOptions::error
  int most_samples = 64;              ///< PictureOptions::most_samples
};

/// A requested lightmap.
struct LightmapSettings {
  std::filesystem::path folder;  ///< empty: none
  LightmapOptions options;
};

/// The models of a command, which form one scene. Here and below an empty path means that a file is not requested.
struct ModelArguments {
  std::vector<std::filesystem::path> models;  ///< "-" is the standard input
  ReadOptions read;
};

/// Arguments for solving a scene, or preparing it.
struct RunArguments : ModelArguments {
  Request request;           ///< meters
  std::string command_line;  ///< for the record
  bool quiet = false;
};

/// Arguments of `patchlight solve` or `patchlight relight`. Without models the scene is the one stored with the form
/// factors.
struct SolveArguments : RunArguments {
  std::vector<std::filesystem::path> results;  ///< .vtp, .vtu, .ply, .glb
  std::filesystem::path series;                ///< .pvd
  std::filesystem::path report;                ///< .json
  std::filesystem::path page;                  ///< .html
  PictureSettings picture;
  LightmapSettings lightmap;

  std::filesystem::path form_factors;  ///< input: a folder; empty: computed
  std::filesystem::path checkpoint;    ///< a folder that keeps the matrix rows of the ray method during the run

  std::filesystem::path points;            ///< input: points for irradiance, in addition to the scene's sensors
  std::optional<double> ambient_distance;  ///< m; empty: no ambient occlusion in results
  std::vector<std::filesystem::path> points_outputs;  ///< .csv, .vtp; empty: default_points_output
  MapOptions map;                                     ///< for outputs .svg or .png
  std::filesystem::path default_points_output;        ///< .csv, for scenes with sensors and no named output

  bool solver_given = false;  ///< the user chose Request::solver
  bool discards = false;      ///< an interrupted run writes nothing
  bool verbose = false;
};

struct PlanArguments : RunArguments {
  std::filesystem::path json;  ///< .json
};

struct CheckArguments : ModelArguments {
  std::optional<Sides> sides;              ///< sides to count, if requested
  std::filesystem::path problems;          ///< .vtp
  PictureSettings picture;                 ///< only file, camera, views and size
  std::optional<double> ambient_distance;  ///< m, for the image
  std::filesystem::path json;              ///< .json
  bool json_on_stdout = false;             ///< instead of text
  bool all = false;                        ///< lists everything instead of one screen
};

struct InitArguments : ModelArguments {
  std::filesystem::path output;  ///< .toml
};

struct AnnualArguments : RunArguments {
  std::filesystem::path output;   ///< a folder
  std::filesystem::path weather;  ///< input: .epw; empty: that of the scene file
  std::filesystem::path points;   ///< input: points, in addition to the scene's sensors
  int first_hour = 8, last_hour = 18;
  AnnualOptions options;
};

struct FormFactorArguments : RunArguments {
  std::filesystem::path output;  ///< a folder, or a .npy or .mtx file for the matrix only
  MatrixFormat format = MatrixFormat::npy;
  std::optional<GroupBy> by;  ///< the table of groups, if requested
};

struct ComparisonArguments : RunArguments {
  CompareOptions options;
  std::filesystem::path output;  ///< a folder
  std::filesystem::path page;    ///< .html
};

struct ConvergenceArguments : RunArguments {
  StudyOptions options;
  std::filesystem::path output;  ///< a folder
  std::filesystem::path page;    ///< .html
};

struct CrosscheckArguments : RunArguments {
  VerifyOptions options;
  std::optional<double> bar;   ///< allowed relative standard error of every irradiance; empty: the error bars of the
                               ///< solution
  std::filesystem::path json;  ///< .json
};

struct SelftestArguments {
  std::filesystem::path json;   ///< .json
  bool json_on_stdout = false;  ///< instead of a table
  int threads = 0;              ///< 0: all processors
};

struct RenderArguments : ModelArguments {
  std::filesystem::path solution;  ///< input: .vtp
  std::filesystem::path page;      ///< .html
  PictureSettings picture;
  LightmapSettings lightmap;
  std::filesystem::path observers;   ///< .csv
  std::filesystem::path difference;  ///< input: another solution, .vtp
  int threads = 0;                   ///< 0: all processors
  bool quiet = false;
  std::string command_line;  ///< for the record
};

/// The text of --help or --version, or the short help of a command without arguments.
struct Information {
  std::string text;
  ExitCode code = good;
};

using Arguments = std::variant<Information, SolveArguments, CheckArguments, InitArguments, PlanArguments,
                               AnnualArguments, FormFactorArguments, ComparisonArguments, ConvergenceArguments,
                               CrosscheckArguments, SelftestArguments, RenderArguments>;

/// Parses the command line without reading or writing files. \throws UsageError.
Arguments parse_arguments(int count, const char* const* values);

}  // namespace patchlight::cli
