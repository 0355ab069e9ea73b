// Compares the irradiance of the open Cornell box with that of two independent renderers, at points.
// usage: benchmark_cornell_reference FOLDER PATCHES...
// FOLDER holds cornell.obj (millimeters) and cornell_reference.csv:
// sensor,i,j,x,y,z,nx,ny,nz,E_r,E_g,E_b,se_r,se_g,se_b,flag.
#include "patchlight/gather/gather.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"

#include "base/parallel.h"
#include "mesh/patch_lookup.h"
#include "pipeline/radiosity_errors.h"
#include "render/render.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace patchlight;

struct Reference {
  std::vector<Sensor> sensors;
  Field irradiance;
  Field standard_error;
};

// The rows without a flag, in meters.
Reference read_reference(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  Reference reference;
  std::vector<Spectrum> values;
  std::vector<Spectrum> errors;
  while (std::getline(stream, line)) {
    std::vector<double> numbers;
    std::stringstream fields(line.substr(line.find(',') + 1));
    for (std::string field; std::getline(fields, field, ',');) numbers.push_back(std::strtod(field.c_str(), nullptr));
    if (numbers.at(14) != 0) continue;
    reference.sensors.push_back(
        {1e-3 * Point(numbers[2], numbers[3], numbers[4]), Vector(numbers[5], numbers[6], numbers[7])});
    values.push_back(rgb(numbers[8], numbers[9], numbers[10]));
    errors.push_back(rgb(numbers[11], numbers[12], numbers[13]));
  }
  reference.irradiance.resize(static_cast<Eigen::Index>(values.size()), 3);
  reference.standard_error = reference.irradiance;
  for (std::size_t k = 0; k < values.size(); ++k) {
    reference.irradiance.row(static_cast<Eigen::Index>(k)) = values[k];
    reference.standard_error.row(static_cast<Eigen::Index>(k)) = errors[k];
  }
  return reference;
}

// The solution's irradiance, interpolated between the vertices of the patch at each point.
Field interpolated(const Simulation& simulation, const Occluder& occluder, const std::vector<Sensor>& sensors) {
  const PatchLookup lookup(simulation.mesh);
  const SmoothField irradiance =
      smooth(simulation.mesh, simulation.solution.irradiance, simulation.problem.area, occluder);
  Field result = Field::Zero(static_cast<Eigen::Index>(sensors.size()), simulation.solution.irradiance.cols());
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const Ray down{sensors[k].point + 1e-3 * sensors[k].normal, -sensors[k].normal};
    const auto hit = occluder.first_hits(std::vector<Ray>{down})[0];
    const auto patch = hit ? lookup.patch_at(hit->polygon, hit->side, hit->point) : std::nullopt;
    if (patch)
      result.row(static_cast<Eigen::Index>(k)) = value_at(simulation.mesh, irradiance, occluder, *patch, hit->point);
  }
  return result;
}

void print_differences(const char* how, const Field& ours, const Field& reference) {
  std::printf("  %-14s", how);
  for (Eigen::Index band = 0; band < 3; ++band) {
    const Eigen::ArrayXd difference = ours.col(band) - reference.col(band);
    Eigen::ArrayXd relative = difference.abs() / reference.col(band);
    std::nth_element(relative.begin(), relative.begin() + relative.size() / 2, relative.end());
    const double median = relative[relative.size() / 2];
    const double rms = std::sqrt(difference.square().mean()) / reference.col(band).mean();
    const double bias = difference.mean() / reference.col(band).mean();
    std::printf("  %c: median %.3f %%  rms %.3f %%  bias %+.3f %%", "RGB"[band], 100 * median, 100 * rms, 100 * bias);
  }
  std::printf("\n");
}

void print_comparison(const Scene& scene, std::size_t patches, bool contact_lines, const Reference& reference) {
  const double begin = cpu_seconds();
  const Occluder occluder(scene);
  Request request;
  request.mesh.patches = patches;
  request.mesh.sides = Sides::front;
  request.mesh.contact_lines = contact_lines;
  request.assembly.storage = Storage::tiles;
  const Simulation simulation = simulate(scene, request);
  const double solved = cpu_seconds();
  const GatheredIrradiance gathered = gather_irradiance(simulation.mesh, simulation.solution.radiosity, occluder,
                                                        reference.sensors, {.errors = radiosity_errors(simulation)});
  std::printf("%u patches, %zu points: solve %.1f CPU s, gather %.1f CPU s\n", simulation.mesh.size(),
              reference.sensors.size(), solved - begin, cpu_seconds() - solved);
  print_differences("gathered", gathered.irradiance, reference.irradiance);
  const Field allowed = 2.6 * (gathered.errors.total().square() + reference.standard_error.square()).sqrt();
  const auto within = ((gathered.irradiance - reference.irradiance).abs() <= allowed).count();
  std::printf("  %.1f %% of the values within 2.6 errors of the sensor and the reference\n",
              100 * static_cast<double>(within) / static_cast<double>(allowed.size()));
  print_differences("interpolated", interpolated(simulation, occluder, reference.sensors), reference.irradiance);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || !std::filesystem::exists(std::filesystem::path(argv[1]) / "cornell_reference.csv")) {
    std::printf("skipped: expected a folder with cornell_reference.csv, and numbers of patches\n");
    return 0;
  }
  const std::filesystem::path folder = argv[1];
  const Reference reference = read_reference(folder / "cornell_reference.csv");
  ReadOptions options;
  options.metres_per_unit = 1e-3;
  const Scene scene = read_scene(folder / "cornell.obj", options);
  for (const bool contact_lines : {true, false}) {
    std::printf("%s contact lines\n", contact_lines ? "with" : "without");
    for (int k = 2; k < argc; ++k) {
      print_comparison(scene, std::strtoul(argv[k], nullptr, 10), contact_lines, reference);
    }
  }
  return 0;
}
