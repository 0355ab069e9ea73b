#pragma once

#include "patchlight/transport/exchange.h"

#include "mesh/mesher.h"
#include "pipeline/problem_of.h"
#include "scene/coverings.h"
#include "transport/closure.h"
#include "visibility/occluder.h"

#include <memory>
#include <utility>

// A scene prepared for the solvers, as simulate() does it.
namespace patchlight::test {

struct Assembled {
  PatchMesh mesh;
  std::unique_ptr<RowTransport> transport;
  RadiosityProblem problem;
  bool closed = false;  ///< no ray of any patch is lost
};

inline Assembled assembled(const Scene& scene, double max_edge) {
  const KeptSides kept = kept_sides(scene, Sides::automatic);
  PatchMesh mesh = tessellate(scene, kept, max_edge);
  const Occluder occluder(scene, Occluder::Blockers::inside_hull, find_coverings(scene, kept));
  Exchange exchange = trace_exchange(mesh, occluder, {});
  const bool closed = exchange.lost.closed();
  const Eigen::VectorXd area = exchange.area;
  RadiosityProblem problem = problem_of(scene, mesh, area, kept.emit_from_back);
  auto transport = dense_transport(close_exchange(std::move(exchange)), area);
  return {std::move(mesh), std::move(transport), std::move(problem), closed};
}

}  // namespace patchlight::test
