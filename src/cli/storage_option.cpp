#include "cli/storage_option.h"

#include "cli/add_option.h"
#include "cli/parse_value.h"

#include <string>

namespace patchlight::cli {
namespace {

Storage method_named(const std::string& text) {
  return choice<Storage>("--method", text,
                         {{"auto", Storage::automatic},
                          {"pairs", Storage::tiles},
                          {"rays", Storage::rays},
                          {"on-demand", Storage::on_demand}});
}

void add_rays_option(CLI::App& command, Request& request) {
  add(command, "--rays", "N",
      "with --method rays, which it implies: rays of a patch in the mean;\nfour times as many halve their error; "
      "default 64; 256 where the plan takes rays for mirrors,\npanes or faces with few patches",
      [&request](const std::string& text) {
        request.assembly.rays = static_cast<int>(whole_number("--rays", text, 16, 4096));
        if (request.assembly.storage == Storage::automatic) request.assembly.storage = Storage::rays;
      });
}

}  // namespace

void add_storage_options(CLI::App& command, Request& request) {
  command.option_defaults()->group("Form factors and equations");
  add(command, "--method", "auto|pairs|rays|on-demand",
      "how form factors are kept: of all pairs of patches; sparse rows of\nwhat some rays from each patch meet, for "
      "many patches, with a\nstandard error for each; or\nnot at all (on-demand): little memory, a first picture "
      "early; default\nauto: pairs; rays for "
      "more than 10,000 patches, from 1,000 where\nfaces have few each, for mirrors and panes, and where the memory\n"
      "is too small; always pairs where something is asked for that\nrays do not have: a solver by single rows or cg, "
      "another\nestimator and the like",
      [&request](const std::string& text) { request.assembly.storage = method_named(text); });
  add_rays_option(command, request);
}

void add_stored_options(CLI::App& command, Request& request) {
  command.option_defaults()->group("Form factors and equations");
  add(command, "--method", "pairs|rays",
      "form factors of all pairs of patches, or sparse rows of what some\nrays from each patch meet, for many patches; "
      "default pairs",
      [&request](const std::string& text) {
        const Storage storage = method_named(text);
        if (storage != Storage::tiles && storage != Storage::rays) throw refusal("--method", text, "pairs or rays");
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
