#include "cli/solve_input.h"

#include "patchlight/base/error.h"

#include "archive/form_factor_files.h"
#include "archive/scene_file.h"
#include "cli/option_names.h"
#include "input/tables/read_tables.h"
#include "input/text.h"
#include "optics/surface_optics.h"
#include "output/file/whole_file.h"
#include "plan/choose_storage.h"

#include <cmath>
#include <sstream>
#include <system_error>
#include <utility>

namespace patchlight::cli {
namespace {

void require_same_unit(const std::filesystem::path& folder, const FormFactorInfo& info, const Scene& scene) {
  if (info.metres_per_unit == scene.metres_per_unit) return;
  std::ostringstream text;
  text << "these form factors are of a model with " << info.metres_per_unit << " m per unit; now it has "
       << scene.metres_per_unit << "\nhint: give the same --unit";
  throw InputError(folder.string(), text.str());
}

// A patch with edges up to max_edge has at most the area max_edge^2. A model with more area than that allows is a
// different one, and is refused before it is meshed into very many patches.
void require_room_for(const std::filesystem::path& folder, const FormFactorInfo& info, const Scene& scene,
                      const Request& request) {
  const double largest = info.max_edge * info.max_edge;
  const double least = std::ceil(kept_area(scene, sides_for(scene, request)) / largest * (1 - 1e-9));
  if (request.mesh.patches || request.mesh.max_edge != info.max_edge || least <= info.patches) return;
  std::ostringstream text;
  text << "found form factors of " << info.patches << " patches with edges up to " << info.max_edge << " m, made from "
       << info.model << "; this model takes at least " << least
       << " such patches\nhint: give the same model, or compute them again: patchlight form-factors MODEL -o FOLDER";
  throw InputError(folder.string(), text.str());
}

// Fractions of light that the front (0) and the back (1) of each polygon do not pass on specularly.
using NonspecularFractions = std::vector<std::array<double, 2>>;

NonspecularFractions nonspecular_fractions(const Scene& scene, Reflections reflections) {
  const SurfaceOptics specular(scene, reflections);
  NonspecularFractions nonspecular;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p)
    nonspecular.push_back(
        {specular.nonspecular_fraction(p, Side::front), specular.nonspecular_fraction(p, Side::back)});
  return nonspecular;
}

// Stored form factors and patch areas depend on the specular reflectance and transmittance of panes and mirrors.
void require_same_panes(const std::filesystem::path& folder, const StoredShares& stored, const PatchMesh& mesh,
                        const NonspecularFractions& nonspecular) {
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const double then = stored.area[i] / mesh.area[i];
    const double now = nonspecular[mesh.polygon[i]][static_cast<std::size_t>(mesh.side[i])];
    if (stored.lost.covered[i] > 0 || std::abs(then - now) <= 1e-5 * now /* single precision */) continue;
    std::ostringstream text;
    text << "these form factors have a face that passes the fraction " << 1 - then
         << " of diffuse light as glazing or mirror; now it passes " << 1 - now
         << "\nhint: restore the material, or compute them again: patchlight form-factors MODEL -o FOLDER";
    throw InputError(folder.string(), text.str());
  }
}

// The request with the options of the stored form factors.
Request request_as_then(const SolveArguments& arguments, const FormFactorInfo& info) {
  Request request = arguments.request;
  if (!request.mesh.max_edge && !request.mesh.patches) request.mesh.max_edge = info.max_edge;
  if (request.mesh.sides == Sides::automatic) request.mesh.sides = info.sides;
  if (!request.mesh.contact_lines && info.contact_lines)
    throw InputError(arguments.form_factors.string(),
                     "the patches of these form factors follow contact lines\nhint: leave --no-contact-lines out");
  request.mesh.contact_lines = info.contact_lines;
  request.mesh.contact_line_count = info.contact_line_count;
  if (request.mesh.graded_edges && !info.graded_edges)
    throw InputError(arguments.form_factors.string(),
                     "the patches of these form factors are not graded\nhint: leave --graded-edges out");
  request.mesh.graded_edges = info.graded_edges;
  request.assembly.seed = info.seed;
  if (info.storage == Storage::rays) {
    request.assembly.rays = info.rays;
    const Solver solver = request.solver.solver;
    if (arguments.solver_given && (takes_rows(solver) || takes_reciprocity(solver)))
      throw InputError(arguments.form_factors.string(),
                       std::string("form factors by rays cannot be used with --solver ") + name_of(solver) +
                           "\nhint: --solver gmres, bicgstab, jacobi or chebyshev");
    return by_rays(std::move(request));
  }
  request.assembly.samples = info.samples;
  request.assembly.estimator = info.estimator;
  if (!is_closed(info)) return request;
  if (request.assembly.close && !contains(request.effects.skip, Effect::closure)) {
    request.effects.force.push_back(Effect::closure);
    return request;
  }
  throw InputError(arguments.form_factors.string(),
                   "these form factors are closed, but --no-closure needs them without closure\n"
                   "hint: compute them again: patchlight form-factors MODEL --no-closure -o FOLDER");
}

}  // namespace

SolveInput read_input(const SolveArguments& arguments) {
  const std::filesystem::path& folder = arguments.form_factors;
  if (folder.empty()) return {with_option_names(read_scene(arguments.models, arguments.read)), arguments.request};

  SolveInput input;
  std::optional<KeptSides> sides;
  const bool from_folder = arguments.models.empty();
  if (!from_folder) input.scene = with_option_names(read_scene(arguments.models, arguments.read));
  const FormFactorInfo info = read_form_factor_info(folder);
  if (from_folder) {
    StoredScene stored = read_stored_scene(folder);
    input.scene = with_option_names(with_options(std::move(stored.scene), arguments.read));
    sides = std::move(stored.sides);
  }
  require_same_unit(folder, info, input.scene);
  input.request = request_as_then(arguments, info);
  input.request.mesh.kept_sides = std::move(sides);
  require_room_for(folder, info, input.scene, input.request);
  if (info.storage == Storage::rays) {
    input.ray_exchange = [folder, info](const PatchMesh& mesh) { return read_ray_rows(folder, info, mesh); };
    return input;
  }
  input.exchange = [folder, info,
                    nonspecular = nonspecular_fractions(input.scene, Reflections::kept)](const PatchMesh& mesh) {
    Exchange exchange = read_exchange(folder, info, mesh);
    require_same_panes(folder, {exchange.area, exchange.lost}, mesh, nonspecular);
    return exchange;
  };
  return input;
}

Scene with_points(Scene scene, const SolveArguments& arguments) {
  if (arguments.points.empty()) return scene;
  require_within(arguments.read.confine, arguments.points, "--points");
  scene.sensors.push_back(read_points(arguments.points, scene.metres_per_unit));
  return scene;
}

std::vector<std::filesystem::path> points_outputs(const SolveArguments& arguments, const Scene& scene) {
  if (!scene.sensors.empty()) {
    if (!arguments.points_outputs.empty()) return arguments.points_outputs;
    return {arguments.default_points_output};
  }
  if (arguments.points_outputs.empty()) return {};
  throw InputError("--points-output",
                   "the scene file has no sensors\nhint: add a table [[sensors]], or give --points FILE");
}

Checkpoint::Checkpoint(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  made_ = std::filesystem::create_directories(folder_, error);
  if (error) throw OutputError(folder_.string(), "cannot make this folder for --checkpoint: " + error.message());
  check_writable(folder_ / "rows.npy");
}

RowBlocksOf Checkpoint::blocks(const RowScene& of) {
  if (folder_.empty()) return {};
  return [this, of](const PatchMesh& mesh, const RayOptions& options, std::span<const float> bright_densities) {
    keys_.push_back(row_key(of, mesh, options, bright_densities));
    RowBlocks blocks = row_blocks_in(folder_, keys_.back());
    blocks.read = [this, read = std::move(blocks.read)](std::size_t block) {
      auto words = read(block);
      if (words) ++taken_;
      return words;
    };
    return blocks;
  };
}

void Checkpoint::remove() const {
  if (folder_.empty()) return;
  remove_row_blocks(folder_, keys_);
  std::error_code ignored;
  if ((made_ || taken_ > 0) && !std::filesystem::is_symlink(folder_, ignored))
    std::filesystem::remove(folder_, ignored);
}

Diagnostics Checkpoint::notes() const {
  if (taken_ == 0) return {};
  return {{DiagnosticCode::checkpoint,
           "--checkpoint: " + std::to_string(taken_) + (taken_ == 1 ? " block of rows" : " blocks of rows") +
               " that an earlier run had kept in " + folder_.string(),
           taken_}};
}

}  // namespace patchlight::cli
