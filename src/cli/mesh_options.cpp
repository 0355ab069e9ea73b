#include "cli/mesh_options.h"

#include "cli/add_option.h"
#include "cli/parse_value.h"

#include <string>

namespace patchlight::cli {

void add_sides_option(CLI::App& command, Request& request) {
  command.option_defaults()->group("Patches");
  add(command, "--sides", "auto|front|both",
      "sides of the polygons that take part; auto leaves out those\nno light can reach; default auto",
      [&request](const std::string& text) { request.mesh.sides = sides_named(text); });
}

Sides sides_named(const std::string& text) {
  return choice<Sides>("--sides", text, {{"auto", Sides::automatic}, {"front", Sides::front}, {"both", Sides::both}});
}

void add_patch_options(CLI::App& command, RequestGiven& request) {
  command.option_defaults()->group("Patches");
  add(command, "--max-edge", "LENGTH",
      "longest edge of a patch, in model units or with its unit, as in\n30cm; default: from --patches",
      [&request](const std::string& text) {
        request.max_edge_in_metres = !to_number(text);
        request.mesh.max_edge = length("--max-edge", text);
      });
  add(command, "--patches", "N",
      "number of patches, met within 10 %; more where the model's\nmany faces take more; default " +
          std::to_string(default_patches),
      [&request](const std::string& text) {
        request.mesh.patches = whole_number("--patches", text, 1, 1'000'000'000);
      });
  command.add_flag_callback(
      "--no-contact-lines", [&request] { request.mesh.contact_lines = false; },
      "patches follow the outlines of faces alone; default: they also end\nwhere other faces touch, cross or end close "
      "before a face and at the\nedges of hard shadows, and none is left under what stands on a face");
}

void add_graded_option(CLI::App& command, Request& request) {
  command.option_defaults()->group("Patches");
  command.add_flag_callback(
      "--graded-edges", [&request] { request.mesh.graded_edges = true; },
      "patches of convex four-sided faces that nothing touches inside shrink\ntowards the edges where lit faces meet, "
      "and "
      "are longer in the middle, by\nup to .57 of the longest edge that was asked for; default: even patches");
}

void add_closure_option(CLI::App& command, Request& request) {
  command.option_defaults()->group("Form factors and equations");
  command.add_flag_callback(
      "--no-closure", [&request] { request.assembly.close = false; },
      "form factors as computed; default: rows closed, so that no light\nis lost or made by their errors");
}

void add_relaxation_option(CLI::App& command, std::optional<double>& relaxation) {
  command.option_defaults()->group("Form factors and equations");
  add(command, "--relaxation", "NUMBER",
      "relaxation factor of the solver sor, above 0 and below 2; default:\nestimated from the spectral radius",
      [&relaxation](const std::string& text) {
        const auto inside = [](double x) { return x > 0 && x < 2; };
        relaxation = number("--relaxation", text, "a number above 0 and below 2", inside);
      });
}

void add_sampling_options(CLI::App& command, Request& request) {
  command.option_defaults()->group("Form factors and equations");
  add(command, "--samples", "N", "shadow rays for a partly occluded pair of patches; default 8",
      [&request](const std::string& text) {
        request.assembly.samples = static_cast<int>(whole_number("--samples", text, 4, 16384));
      });
  add(command, "--estimator", "auto|area|point-polygon|hemisphere|contour",
      "how form factors are found; all but auto are slow, for study: by\npoints on both patches, by points on one and "
      "the exact factor to\nthe other, by --samples rays over the hemisphere of each patch, or\nby the contour "
      "integral "
      "and the visible share; default auto",
      [&request](const std::string& text) {
        request.assembly.estimator = choice<Estimator>("--estimator", text,
                                                       {{"auto", Estimator::automatic},
                                                        {"area", Estimator::area},
                                                        {"point-polygon", Estimator::point_polygon},
                                                        {"hemisphere", Estimator::hemisphere},
                                                        {"contour", Estimator::contour}});
      });
  add(command, "--seed", "N", "seed of the sampling; the same seed gives the same bits; default 1",
      [&request](const std::string& text) {
        request.assembly.seed = whole_number("--seed", text, 0, ~std::uint64_t{0});
      });
}

void add_machine_options(CLI::App& command, Request& request) {
  command.option_defaults()->group("The run");
  add(command, "--threads", "N", "number of threads; default 0: one per processor",
      [&request](const std::string& text) {
        request.resources.threads = static_cast<int>(whole_number("--threads", text, 0, 1024));
      });
  add(command, "--memory", "SIZE",
      "memory that may be taken, e.g. 2GB or 500MiB; what needs more is\nrefused before it begins; default: 80 % of "
      "the machine's",
      [&request](const std::string& text) { request.resources.memory = bytes("--memory", text); });
}

Request in_metres(const RequestGiven& given, double metres_per_unit) {
  Request request = given;
  if (request.mesh.max_edge && !given.max_edge_in_metres) *request.mesh.max_edge *= metres_per_unit;
  return request;
}

}  // namespace patchlight::cli
