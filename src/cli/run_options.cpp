#include "cli/run_options.h"

#include "base/rounded.h"
#include "cli/add_option.h"
#include "cli/parse_value.h"

#include <utility>

namespace patchlight::cli {
namespace {

void add_rays_option(CLI::App& command, Request& request) {
  add(command, "--rays", [&request](const std::string& text) {
    request.assembly.rays = static_cast<int>(whole_number("--rays", text, 16, 4096));
    if (request.assembly.storage == Storage::automatic) request.assembly.storage = Storage::rays;
  });
}

void add_effects(CLI::App& command, const std::string& option, const std::vector<Effect>& effects,
                 std::vector<Effect>& chosen) {
  std::vector<std::pair<std::string, Effect>> allowed;
  for (const Effect effect : effects) allowed.emplace_back(name_of(effect), effect);
  option_text(command.get_name(), option);
  const auto take = [option, allowed, &chosen](const std::vector<std::string>& words) {
    for (const std::string& word : words) chosen.push_back(choice<Effect>(option, word, allowed));
  };
  command.add_option_function<std::vector<std::string>>(option, take)->allow_extra_args(false);
}

}  // namespace

Request in_metres(const RequestGiven& given, double metres_per_unit) {
  Request request = given;
  if (request.mesh.max_edge && !given.max_edge_in_metres) *request.mesh.max_edge *= metres_per_unit;
  return request;
}

void add_sides_option(CLI::App& command, Request& request) {
  add(command, "--sides", [&request](const std::string& text) { request.mesh.sides = sides_named(text); });
}

Sides sides_named(const std::string& text) {
  return choice<Sides>("--sides", text, {{"auto", Sides::automatic}, {"front", Sides::front}, {"both", Sides::both}});
}

void add_patch_options(CLI::App& command, RequestGiven& request) {
  add(command, "--max-edge", [&request](const std::string& text) {
    request.max_edge_in_metres = !to_number(text);
    request.mesh.max_edge = length("--max-edge", text);
  });
  add(command, "--patches", [&request](const std::string& text) {
    request.mesh.patches = whole_number("--patches", text, 1, 1'000'000'000);
  });
  add_flag(command, "--no-contact-lines", [&request] { request.mesh.contact_lines = false; });
}

void add_graded_option(CLI::App& command, Request& request) {
  add_flag(command, "--graded-edges", [&request] { request.mesh.graded_edges = true; });
}

void add_refinement_options(CLI::App& command, Request& request) {
  CLI::Option* const error = add(command, "--accuracy", [&request](const std::string& text) {
    request.accuracy.relative_error = relative_error("--accuracy", text);
  });
  CLI::Option* const time = add(command, "--time-limit", [&request](const std::string& text) {
    request.accuracy.seconds = seconds("--time-limit", text);
  });
  add_list(command, "--focus", request.accuracy.interest);
  request.accuracy.local_cuts = true;
  add_flag(command, "--no-refine", [&request] { request.accuracy.local_cuts = false; })
      ->excludes(error)
      ->excludes(time);
}

void add_accuracy_options(CLI::App& command, Request& request) {
  add_refinement_options(command, request);
  request.accuracy.cheap_error_bars = true;
  CLI::Option* const bars = add_flag(command, "--error-bars", [&request] { request.accuracy.error_bars = true; });
  add_flag(command, "--no-error-bars", [&request] { request.accuracy.cheap_error_bars = false; })->excludes(bars);
}

std::optional<std::string> note_on_accuracy(const Request& request) {
  if (!request.accuracy.relative_error) return std::nullopt;
  return "refining until the estimated error of mesh, form factors and solver is below " +
         percent(*request.accuracy.relative_error, 4) + " %";
}

void add_method_options(CLI::App& command, Request& request) {
  add(command, "--method", [&request](const std::string& text) {
    request.assembly.storage = choice<Storage>("--method", text,
                                               {{"auto", Storage::automatic},
                                                {"pairs", Storage::tiles},
                                                {"rays", Storage::rays},
                                                {"on-demand", Storage::on_demand}});
  });
  add_rays_option(command, request);
}

void add_stored_method_options(CLI::App& command, Request& request) {
  add(command, "--method", [&request](const std::string& text) {
    request.assembly.storage = choice<Storage>("--method", text, {{"pairs", Storage::tiles}, {"rays", Storage::rays}});
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

void add_closure_option(CLI::App& command, Request& request) {
  add_flag(command, "--no-closure", [&request] { request.assembly.close = false; });
}

void add_relaxation_option(CLI::App& command, std::optional<double>& relaxation) {
  add(command, "--relaxation", [&relaxation](const std::string& text) {
    const auto inside = [](double x) { return x > 0 && x < 2; };
    relaxation = number("--relaxation", text, "a number above 0 and below 2", inside);
  });
}

void add_tolerance_option(CLI::App& command, double least, const std::function<void(double)>& take) {
  add(command, "--tolerance", [take, least](const std::string& text) {
    const auto inside = [least](double x) { return x > 0 && x >= least && x < 1; };
    const std::string lower = least > 0 ? "from " + rounded(least) + " to" : "above 0 and";
    take(number("--tolerance", text, "a number " + lower + " below 1", inside));
  });
}

void add_sampling_options(CLI::App& command, Request& request) {
  add(command, "--samples", [&request](const std::string& text) {
    request.assembly.samples = static_cast<int>(whole_number("--samples", text, 4, 16384));
  });
  add(command, "--estimator", [&request](const std::string& text) {
    request.assembly.estimator = choice<Estimator>("--estimator", text,
                                                   {{"auto", Estimator::automatic},
                                                    {"area", Estimator::area},
                                                    {"point-polygon", Estimator::point_polygon},
                                                    {"hemisphere", Estimator::hemisphere},
                                                    {"contour", Estimator::contour}});
  });
  add(command, "--seed", [&request](const std::string& text) {
    request.assembly.seed = whole_number("--seed", text, 0, ~std::uint64_t{0});
  });
}

std::vector<Effect> effects_but(const std::vector<Effect>& without) {
  std::vector<Effect> effects = simulated_effects();
  std::erase_if(effects, [&](Effect effect) { return effect == Effect::closure || contains(without, effect); });
  return effects;
}

void add_effect_options(CLI::App& command, Request& request, const std::vector<Effect>& effects) {
  add_effects(command, "--enable", effects, request.effects.force);
  add_effects(command, "--disable", effects, request.effects.skip);
}

void add_threads_option(CLI::App& command, int& threads) {
  add(command, "--threads",
      [&threads](const std::string& text) { threads = static_cast<int>(whole_number("--threads", text, 0, 1024)); });
}

void add_machine_options(CLI::App& command, Request& request) {
  add_threads_option(command, request.resources.threads);
  add(command, "--memory", [&request](const std::string& text) { request.resources.memory = bytes("--memory", text); });
}

void add_quiet_option(CLI::App& command, bool& quiet) {
  add_flag(command, "-q,--quiet", [&quiet] { quiet = true; });
}

}  // namespace patchlight::cli
