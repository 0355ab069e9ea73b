#include "problem_of.h"

#include "patchlight/base/error.h"
#include "patchlight/transport/exchange_areas.h"

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <unistd.h>

namespace patchlight {
namespace {

// Share of the machine's memory that the exchange areas may take.
constexpr double usable_share = 0.8;

double installed_bytes() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

std::string gigabytes(double bytes) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << bytes / 1e9 << " GB";
  return text.str();
}

}  // namespace

RadiosityProblem problem_of(const Scene& scene, const PatchMesh& mesh, const Eigen::VectorXd& exposed_area,
                            bool emit_from_back) {
  const Eigen::Index bands = scene.materials.front().reflectance.size();
  RadiosityProblem problem{Field(mesh.size(), bands), Field::Zero(mesh.size(), bands), exposed_area};
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const Material& material = scene.materials[mesh.material[i]];
    problem.reflectance.row(i) = material.reflectance;
    const bool is_a_front = mesh.side[i] == Side::front || scene.polygons[mesh.polygon[i]].back_material.has_value();
    if (is_a_front || emit_from_back) problem.exitance.row(i) = material.exitance;
  }
  return problem;
}

void require_memory(PatchIndex patches) {
  const auto needed = static_cast<double>(ExchangeAreas::bytes(patches));
  const double usable = usable_share * installed_bytes();
  if (needed > usable) {
    throw MemoryError(std::to_string(patches) + " patches need " + gigabytes(needed) + " for their form factors, and " +
                      gigabytes(usable) + " may be used here; ask for at most " +
                      std::to_string(static_cast<long>(std::sqrt(usable / 2))) + " patches with --patches");
  }
}

}  // namespace patchlight
