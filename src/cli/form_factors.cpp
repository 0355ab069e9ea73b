#include "archive/ray_row_files.h"
#include "base/parallel.h"
#include "cli/commands.h"
#include "cli/distinct_files.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/summary.h"
#include "output/file/whole_file.h"

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <sstream>

namespace patchlight::cli {
namespace {

// More groups than fit on a line are left to the CSV.
constexpr std::size_t most_columns = 12;

bool is_one_file(const FormFactorArguments& arguments) {
  return arguments.output.extension() == ".npy" || arguments.output.extension() == ".mtx";
}

std::string table(const GroupFactors& groups) {
  if (groups.names.size() > most_columns) {
    return std::to_string(groups.names.size()) + " " + name_of(groups.by) + "s: too many to print\n";
  }
  std::size_t width = 0;
  for (const std::string& name : groups.names) width = std::max(width, shown_name(name).size());
  std::ostringstream text;
  text << "form factors from each " << name_of(groups.by) << " to the others, in their order, and their sum:\n"
       << std::fixed << std::setprecision(5);
  for (std::size_t from = 0; from < groups.names.size(); ++from) {
    const auto row = groups.form_factor.row(static_cast<Eigen::Index>(from));
    text << "  " << std::left << std::setw(static_cast<int>(width)) << shown_name(groups.names[from]) << std::right;
    for (const double form_factor : row) text << "  " << form_factor;
    text << "  = " << row.sum() << '\n';
  }
  return text.str();
}

// What the figures of a group are shares of.
Diagnostics note_on_groups(const KeptSides& sides) {
  std::size_t both = 0;
  for (std::size_t p = 0; p < sides.front.size(); ++p) both += sides.front[p] != 0 && sides.back[p] != 0 ? 1 : 0;
  if (both == 0) return {};
  return {{DiagnosticCode::both_sides,
           "both sides of " + std::to_string(both) +
               " faces take part: the form factor from a group is a share of what leaves all of its sides together, "
               "half of that from the fronts where backs see nothing; --sides front leaves the backs out",
           both}};
}

std::string summary(const Scene& scene, const FormFactors& form_factors) {
  const Exchange& exchange = form_factors.exchange;
  const Eigen::ArrayXd sums = row_sums(exchange.exchange_areas).cwiseQuotient(exchange.area).array();
  std::ostringstream text;
  text << shown_name(scene.file) << ": " << form_factors.mesh.size() << " patches with edges up to "
       << std::setprecision(3) << form_factors.plan.max_edge << " m; estimator "
       << name_of(form_factors.plan.assembly.estimator) << "; row sums " << std::setprecision(6) << sums.minCoeff()
       << " to " << sums.maxCoeff() << ", before closure " << exchange.raw_row_sum.minCoeff() << " to "
       << exchange.raw_row_sum.maxCoeff()
       << "; closure: " << (exchange.closure.empty() ? "not asked for" : exchange.closure) << '\n';
  return text.str();
}

// What is told of them.
struct Written {
  Diagnostics notes;
  std::string summary;
};

// Of either kind of form factors.
template <class Found>
Diagnostics notes_on(const FormFactorArguments& arguments, const Scene& scene, const Found& found) {
  Diagnostics all = merged({remarks_of(scene), found.plan.sides.notes, found.plan.notes, found.notes});
  if (found.request.mesh.sides != arguments.request.mesh.sides)
    all.push_back({DiagnosticCode::unlit_sides, "no light source, so --sides auto uses the front sides"});
  return all;
}

Written write_pairs(const FormFactorArguments& arguments, const Scene& scene, const Observer& observer) {
  const FormFactors found = find_form_factors(scene, arguments.request, observer);
  std::vector<GroupFactors> groups;
  if (arguments.by) groups.push_back(group_factors(scene, found, *arguments.by));
  const WritingGuard guard;
  if (is_one_file(arguments)) {
    write_matrix(arguments.output, found.exchange, arguments.format, observer);
  } else {
    write_form_factors(arguments.output, {scene, found, groups, arguments.command_line, arguments.format}, observer);
  }
  Written written{notes_on(arguments, scene, found), summary(scene, found)};
  if (!groups.empty()) written.notes = merged({std::move(written.notes), note_on_groups(found.plan.sides)});
  for (const GroupFactors& table_of : groups) written.summary += table(table_of);
  return written;
}

Written write_rays(const FormFactorArguments& arguments, const Scene& scene, const Observer& observer) {
  const RayFormFactors found = find_ray_form_factors(scene, arguments.request, observer);
  const WritingGuard guard;
  write_ray_rows(arguments.output, scene, found, arguments.command_line, observer);
  std::ostringstream text;
  text << shown_name(scene.file) << ": " << found.mesh.size() << " patches with edges up to " << std::setprecision(3)
       << found.plan.max_edge << " m; " << found.exchange.rows.rays << " rays over hemispheres, "
       << found.exchange.rows.shadow_rays << " towards bright patches, " << found.exchange.lamps.size()
       << (found.exchange.lamps.size() == 1 ? " lamp" : " lamps") << " apart\n";
  return {notes_on(arguments, scene, found), text.str()};
}

}  // namespace

ExitCode form_factors(const FormFactorArguments& arguments) {
  if (is_one_file(arguments)) {
    check_writable(arguments.output);
  } else {
    check_form_factors_writable(arguments.output);
  }
  const ThreadLimit limit(arguments.request.resources.threads);
  ProgressLine line(progress_shown(arguments.quiet));
  const Observer observer = observer_on(line);

  // 1. Read the model
  const Scene scene = read_models(arguments.models, arguments.read, observer);
  if (is_one_file(arguments)) {
    require_not_read({{"-o", arguments.output}}, scene.inputs);
  } else {
    require_not_read_from({"-o", arguments.output}, scene.inputs);
  }

  // 2. Find the form factors and write them
  const Written written = arguments.request.assembly.storage == Storage::rays ? write_rays(arguments, scene, observer)
                                                                              : write_pairs(arguments, scene, observer);
  line.hide();
  print_notes(written.notes, arguments.quiet);
  if (arguments.quiet) return good;
  std::cout << written.summary << "wrote " << shown_name(arguments.output.string()) << std::endl;
  return good;
}

}  // namespace patchlight::cli
