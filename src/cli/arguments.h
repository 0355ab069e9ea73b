#pragma once

#include "patchlight/base/geometry.h"
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

/// The command line cannot be understood; the message is one sentence that names the option.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A picture that is wanted.
struct PictureSettings {
  std::filesystem::path file;       ///< .png, .hdr or .exr; empty: none
  std::filesystem::path error_map;  ///< .png; empty: none
  std::optional<Camera> camera;     ///< model units
  std::vector<std::string> views;   ///< or the names of cameras of the scene; if none, its first one
  PictureColors colors = PictureColors::natural;
  PictureQuality quality = PictureQuality::draft;
  std::array<int, 2> size{800, 800};  ///< width and height, pixels
  double error = 0.01;                ///< PictureOptions::error
  int most_samples = 64;              ///< PictureOptions::most_samples
};

/// A lightmap that is wanted.
struct LightmapSettings {
  std::filesystem::path folder;  ///< empty: none
  LightmapOptions options;
};

/// The models that a command reads, together one scene. A path that is empty stands, here and below, for a file that is
/// not wanted.
struct ModelArguments {
  std::vector<std::filesystem::path> models;  ///< "-" is the standard input
  ReadOptions read;
};

/// A scene that is solved, or prepared for it.
struct RunArguments : ModelArguments {
  Request request;           ///< meters
  std::string command_line;  ///< for the record
  bool quiet = false;
};

/// Arguments of `patchlight solve` or `patchlight relight`; without models the scene is the one stored with the form
/// factors.
struct SolveArguments : RunArguments {
  std::vector<std::filesystem::path> results;  ///< .vtp, .vtu, .ply, .glb
  std::filesystem::path series;                ///< .pvd
  std::filesystem::path report;                ///< .json
  std::filesystem::path page;                  ///< .html
  PictureSettings picture;
  LightmapSettings lightmap;

  std::filesystem::path form_factors;  ///< input: a folder; empty: they are computed
  std::filesystem::path checkpoint;    ///< a folder for rows of rays while the run lasts

  std::filesystem::path points;            ///< input: where irradiance is wanted, besides the scene's sensors
  std::optional<double> ambient_distance;  ///< m; none: results have no ambient occlusion
  std::vector<std::filesystem::path> points_outputs;  ///< .csv, .vtp; none: default_points_output
  MapOptions map;                                     ///< of those that are .svg or .png
  std::filesystem::path default_points_output;        ///< .csv, where sensors are but no output for them is named

  bool solver_given = false;  ///< the user chose Request::solver
  bool discards = false;      ///< a run that is stopped writes nothing
  bool verbose = false;
};

struct PlanArguments : RunArguments {
  std::filesystem::path json;  ///< .json
};

struct CheckArguments : ModelArguments {
  std::optional<Sides> sides;              ///< whose number is wanted, if any
  std::filesystem::path problems;          ///< .vtp
  PictureSettings picture;                 ///< file, camera, views and size of it
  std::optional<double> ambient_distance;  ///< m, of the picture
  std::filesystem::path json;              ///< .json
  bool json_on_stdout = false;             ///< instead of the text
  bool all = false;                        ///< lists everything, not what fits on a screen
};

struct InitArguments : ModelArguments {
  std::filesystem::path output;  ///< .toml
};

struct FormFactorArguments : RunArguments {
  std::filesystem::path output;  ///< a folder, or a file .npy or .mtx for the matrix alone
  MatrixFormat format = MatrixFormat::npy;
  std::optional<GroupBy> by;  ///< the table of groups that is wanted
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
  std::optional<double> bar;   ///< the relative standard error that every irradiance is granted; none: its error bars
  std::filesystem::path json;  ///< .json
};

struct SelftestArguments {
  std::filesystem::path json;   ///< .json
  bool json_on_stdout = false;  ///< instead of the table
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

/// A text that the user asked for: --help or --version; or the short help of a command that was given nothing.
struct Information {
  std::string text;
  ExitCode code = good;
};

using Arguments =
    std::variant<Information, SolveArguments, CheckArguments, InitArguments, PlanArguments, FormFactorArguments,
                 ComparisonArguments, ConvergenceArguments, CrosscheckArguments, SelftestArguments, RenderArguments>;

/// Understands the command line; nothing is read or written. \throws UsageError.
Arguments parse_arguments(int count, const char* const* values);

}  // namespace patchlight::cli
