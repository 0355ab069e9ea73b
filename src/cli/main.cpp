#include "patchlight/base/error.h"

#include "cli/arguments.h"
#include "cli/check.h"
#include "cli/compare.h"
#include "cli/exit_code.h"
#include "cli/form_factors.h"
#include "cli/former_names.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/new.h"
#include "cli/plan.h"
#include "cli/render.h"
#include "cli/solve.h"
#include "cli/standard_streams.h"
#include "cli/study.h"
#include "cli/validate.h"
#include "cli/verify.h"

#include <algorithm>
#include <csignal>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <variant>

namespace {

using namespace patchlight;
using namespace patchlight::cli;

// Names of earlier versions still work; a remark shows the present ones.
void remark_on_former_names(int count, const char* const* values) {
  const PresentNames names = with_present_names(count, values);
  const auto is_quiet = [](const std::string& word) { return word == "-q" || word == "--quiet"; };
  if (std::any_of(names.words.begin(), names.words.end(), is_quiet)) return;
  for (const std::string& remark : names.remarks) print_message("note", remark);
}

ExitCode run(int count, const char* const* values) {
  remark_on_former_names(count, values);
  const Arguments arguments = parse_arguments(count, values);
  if (const auto* information = std::get_if<Information>(&arguments)) {
    std::cout << information->text;
    return good;
  }
  if (const auto* to_check = std::get_if<CheckArguments>(&arguments)) return check(*to_check);
  if (const auto* to_begin = std::get_if<NewArguments>(&arguments)) return new_scene(*to_begin);
  if (const auto* to_plan = std::get_if<PlanArguments>(&arguments)) return plan(*to_plan);
  if (const auto* to_find = std::get_if<FormFactorArguments>(&arguments)) return form_factors(*to_find);
  if (const auto* to_compare = std::get_if<CompareArguments>(&arguments)) return compare(*to_compare);
  if (const auto* to_study = std::get_if<StudyArguments>(&arguments)) return study(*to_study);
  if (const auto* to_verify = std::get_if<VerifyArguments>(&arguments)) return verify(*to_verify);
  if (const auto* to_validate = std::get_if<ValidateArguments>(&arguments)) {
    return validate(*to_validate, validation_cases());
  }
  if (const auto* to_render = std::get_if<RenderArguments>(&arguments)) return render(*to_render);
  return solve(std::get<SolveArguments>(arguments));
}

// The limit of processes of a user or a container. TBB reports it as a runtime_error that names the function.
bool is_process_limit(const std::exception& error) {
  const auto* const of_system = dynamic_cast<const std::system_error*>(&error);
  if (of_system != nullptr) return of_system->code() == std::errc::resource_unavailable_try_again;
  return std::string_view(error.what()).starts_with("pthread_create");
}

ExitCode failed(ExitCode code, const char* what) {
  print_message("error", what);
  return code;
}

}  // namespace

int main(int count, char** values) {
  open_standard_streams();
  watch_interrupts();
  // A file that may not grow any further is an error of writing, not the end of the program.
  std::signal(SIGXFSZ, SIG_IGN);
  // A pipe that nobody reads any more, too.
  std::signal(SIGPIPE, SIG_IGN);
  StandardOutput output;
  try {
    const ExitCode code = run(count, values);
    output.finish();
    return code;
  } catch (const UsageError& error) {
    return failed(usage_error, error.what());
  } catch (const InputError& error) {
    return failed(input_error, error.what());
  } catch (const OutputError& error) {
    return failed(output_error, error.what());
  } catch (const MemoryError& error) {
    return failed(out_of_memory, error.what());
  } catch (const std::bad_alloc&) {
    return failed(out_of_memory, "the memory is used up; ask for fewer patches with --patches or --max-edge");
  } catch (const Cancelled&) {
    return failed(interrupted_run(), "interrupted; no further file was written");
  } catch (const std::exception& error) {
    if (is_process_limit(error)) {
      return failed(out_of_memory,
                    "no further thread or process may start, as the limit of processes is reached (ulimit -u, "
                    "RLIMIT_NPROC); use --threads 1, or raise the limit");
    }
    return failed(internal_error, (std::string("internal error: ") + error.what()).c_str());
  }
}
