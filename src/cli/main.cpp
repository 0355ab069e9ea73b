#include "patchlight/base/error.h"

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/messages.h"
#include "cli/option_names.h"
#include "cli/progress.h"

#include <algorithm>
#include <csignal>
#include <exception>
#include <iostream>
#include <new>
#include <string_view>
#include <system_error>
#include <variant>

namespace {

using namespace patchlight;
using namespace patchlight::cli;

// Former names still work; a remark prints the current ones.
void remark_on_former_names(int count, const char* const* values) {
  const PresentNames names = with_present_names(count, values);
  const auto is_quiet = [](const std::string& word) { return word == "-q" || word == "--quiet"; };
  if (std::any_of(names.words.begin(), names.words.end(), is_quiet)) return;
  for (const std::string& remark : names.remarks) print_message("note", remark);
}

ExitCode run(const Information& information) {
  (information.code == good ? std::cout : std::cerr) << information.text;
  return information.code;
}

ExitCode run(const SelftestArguments& arguments) { return patchlight::cli::run(arguments, validation_cases()); }

ExitCode run_command_line(int count, const char* const* values) {
  remark_on_former_names(count, values);
  const Arguments arguments = parse_arguments(count, values);
  return std::visit([](const auto& asked) { return run(asked); }, arguments);
}

// The process limit of a user or container. TBB throws a runtime_error that names the function.
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
  // Exceeding the file size limit is a write error and does not end the program.
  std::signal(SIGXFSZ, SIG_IGN);
  // The same holds for a closed pipe.
  std::signal(SIGPIPE, SIG_IGN);
  StandardOutput output;
  try {
    const ExitCode code = run_command_line(count, values);
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
    return failed(out_of_memory, "out of memory\nhint: fewer --patches, or a larger --max-edge");
  } catch (const Canceled&) {
    return failed(interrupted_run(), "interrupted; no further file was written");
  } catch (const std::exception& error) {
    if (is_process_limit(error)) {
      return failed(out_of_memory,
                    "no further thread or process can start: the limit of processes or of memory is reached\n"
                    "hint: use --threads 1, or raise the limit (ulimit -u, ulimit -v)");
    }
    return failed(internal_error, (std::string("internal error: ") + error.what()).c_str());
  }
}
