#include "base/parallel.h"
#include "base/words.h"
#include "cli/commands.h"
#include "cli/messages.h"
#include "cli/progress.h"
#include "output/file/whole_file.h"
#include "output/report/write_checks.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

namespace patchlight::cli {
namespace {

TextRow row_of(const ValidationResult& result) {
  const Measured& measured = result.measured;
  return {result.name,
          rounded(result.exact, 9),
          rounded(measured.value, 9),
          rounded(std::abs(measured.value - result.exact), 2),
          rounded(measured.error_bar, 2),
          within_bar(result) ? "good" : "OUTSIDE",
          result.source,
          measured.bar_from};
}

std::string table(const std::vector<ValidationResult>& results) {
  std::vector<TextRow> rows{{"case", "exact", "ours", "error", "bar", "verdict", "exact value from", "bar from"}};
  for (const ValidationResult& result : results) rows.push_back(row_of(result));
  return text_table(rows);
}

// Runs the cases in sequence and reports the current one.
std::vector<ValidationResult> results_of(std::span<const ValidationCase> cases) {
  ProgressLine line(progress_shown(false));
  std::vector<ValidationResult> results;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    line.name("case " + std::to_string(k + 1) + " of " + std::to_string(cases.size()) + ": ");
    results.push_back(patchlight::validate(cases.subspan(k, 1), observer_on(line)).front());
  }
  return results;
}

}  // namespace

ExitCode run(const SelftestArguments& arguments, std::span<const ValidationCase> cases) {
  if (!arguments.json.empty()) check_writable(arguments.json);
  const ThreadLimit limit(arguments.threads);
  const double begin = wall_seconds();
  const std::vector<ValidationResult> results = results_of(cases);
  const double seconds = wall_seconds() - begin;

  const WritingGuard guard;
  if (!arguments.json.empty()) write_bytes(arguments.json, validation_json(results));
  const auto outside = std::count_if(results.begin(), results.end(), [](const auto& r) { return !within_bar(r); });
  if (arguments.json_on_stdout) {
    std::cout << validation_json(results) << std::flush;
  } else {
    std::cout << table(results) << results.size() << " cases, " << outside << " outside their error bars; "
              << rounded(seconds, 3) << " s" << std::endl;
  }
  return outside == 0 ? good : validation_failed;
}

}  // namespace patchlight::cli
