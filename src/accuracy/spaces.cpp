#include "accuracy/spaces.h"

#include "base/parallel.h"
#include "scene/shells.h"
#include "scene/solids.h"

#include <algorithm>
#include <utility>

namespace patchlight {
namespace {

// How far before a patch its space is looked at, as a share of the shell's extent.
constexpr double step_off = 1e-6;

bool divides(const Scene& scene, const Solid& solid, Dividing by) {
  const bool opaque =
      std::any_of(solid.polygons.begin(), solid.polygons.end(), [&](PolygonIndex p) { return !is_opening(scene, p); });
  return opaque && (solid.has_opening || by == Dividing::all);
}

// A shell, and what is known of the sides of its own polygons.
struct Shell {
  Solid solid;
  std::vector<std::uint8_t> inner;  // at 2 * polygon + side: 0 not of the shell, 1 faces its inside, 2 its outside

  bool is_inside(const PatchMesh& mesh, PatchIndex i) const;
};

Shell shell_of(const Scene& scene, const Shells& shells, Solid solid) {
  std::vector<std::uint8_t> inner(2 * scene.polygons.size(), 0);
  for (const PolygonIndex p : solid.polygons) {
    const auto side = static_cast<std::size_t>(inner_side(solid, shells, p));
    inner[2 * p + side] = 1;
    inner[2 * p + 1 - side] = 2;
  }
  return {std::move(solid), std::move(inner)};
}

bool Shell::is_inside(const PatchMesh& mesh, PatchIndex i) const {
  const std::uint8_t own = inner[2 * mesh.polygon[i] + static_cast<std::size_t>(mesh.side[i])];
  if (own != 0) return own == 1;
  return holds(solid, mesh.centroid[i] + step_off * solid.box.diagonal().norm() * mesh.normal[i]);
}

}  // namespace

Eigen::VectorXd inside_patches(const Scene& scene, const PatchMesh& mesh, const Eigen::VectorXd& enclosed) {
  return enclosed.size() > 0 ? enclosed : inside_shells(scene, mesh, Dividing::with_openings);
}

Eigen::VectorXd inside_shells(const Scene& scene, const PatchMesh& mesh, Dividing by) {
  const Shells shells = shells_of(scene);
  std::vector<Shell> dividing;
  for (Solid& solid : closed_solids(scene, shells)) {
    if (divides(scene, solid, by)) dividing.push_back(shell_of(scene, shells, std::move(solid)));
  }
  Eigen::VectorXd inside = Eigen::VectorXd::Zero(mesh.size());
  if (dividing.empty()) return inside;
  parallel_for(mesh.size(), [&](std::size_t k) {
    const auto i = static_cast<PatchIndex>(k);
    const auto holds_it = [&](const Shell& shell) { return shell.is_inside(mesh, i); };
    if (std::any_of(dividing.begin(), dividing.end(), holds_it)) inside[i] = 1;
  });
  return inside;
}

}  // namespace patchlight
