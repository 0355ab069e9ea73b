#include "cli/storage_option.h"

#include "cli/add_option.h"
#include "cli/parse_value.h"

#include <string>

namespace patchlight::cli {
namespace {

Storage storage_named(const std::string& text) {
  for (const Storage storage : {Storage::automatic, Storage::tiles, Storage::rays, Storage::on_demand}) {
    if (text == name_of(storage)) return storage;
  }
  throw refusal("--storage", text, "auto, tiles, rays or on-demand");
}

void add_rays_option(CLI::App& command, Request& request) {
  add(command, "--rays", "N",
      "with --storage rays, which it implies: rays of a patch in the mean;\nfour times as many halve their error; "
      "default 64; 256 where the plan takes rays for mirrors,\npanes or faces with few patches",
      [&request](const std::string& text) {
        request.assembly.rays = static_cast<int>(whole_number("--rays", text, 16, 4096));
        if (request.assembly.storage == Storage::automatic) request.assembly.storage = Storage::rays;
      });
}

}  // namespace

void add_storage_options(CLI::App& command, Request& request) {
  command.option_defaults()->group("Form factors and equations");
  command.add_flag_callback(
      "--on-demand", [&request] { request.assembly.storage = Storage::on_demand; },
      "no matrix: form factors are computed whenever the solver asks for\nthem, and not closed; little memory, a first "
      "picture early; by\nprogressive refinement; default: all are computed and kept");
  add(command, "--storage", "auto|tiles|rays|on-demand",
      "how form factors are kept: of all pairs of patches; sparse rows of\nwhat some rays from each patch meet, for "
      "many patches, with a\nstandard error for each; or not at all, as --on-demand; default\nauto: pairs; rays for "
      "more than 10,000 patches, from 1,000 where\nfaces have few each, for mirrors and panes, and where the memory\n"
      "is too small; always pairs where something is asked for that\nrays do not have: a solver by single rows or cg, "
      "another\nestimator and the like",
      [&request](const std::string& text) { request.assembly.storage = storage_named(text); });
  add_rays_option(command, request);
}

void add_stored_options(CLI::App& command, Request& request) {
  command.option_defaults()->group("Form factors and equations");
  add(command, "--storage", "tiles|rays",
      "form factors of all pairs of patches, or sparse rows of what some\nrays from each patch meet, for many patches; "
      "default tiles",
      [&request](const std::string& text) {
        const Storage storage = storage_named(text);
        if (storage != Storage::tiles && storage != Storage::rays) throw refusal("--storage", text, "tiles or rays");
        request.assembly.storage = storage;
      });
  add_rays_option(command, request);
}

Request with_fitting_solver(Request request, bool solver_given) {
  Storage& storage = request.assembly.storage;
  if (solver_given) {
    const Solver solver = request.solver.solver;
    if (storage == Storage::automatic && (takes_rows(solver) || takes_reciprocity(solver))) storage = Storage::tiles;
  } else if (storage == Storage::rays) {
    request.solver.solver = Solver::gmres;
  } else if (storage == Storage::on_demand) {
    request.solver.solver = Solver::progressive;
  }
  return request;
}

}  // namespace patchlight::cli
