#include "cli/messages.h"
#include "cli/progress.h"

#include <atomic>
#include <csignal>
#include <sys/time.h>
#include <unistd.h>

namespace patchlight::cli {
namespace {

// A signal handler can access only static state.
std::atomic<bool> stop_asked{false};
std::atomic<int> last_signal{SIGINT};
std::atomic<bool> end_asked{false};
std::atomic<bool> keeping{false};
std::atomic<bool> writing{false};
std::atomic<bool> on_terminal{false};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may use lock-free atomics only");

constexpr suseconds_t patience_microseconds = 500'000;

// Async-signal-safe. The line break leaves the progress line.
void say(std::string_view message) {
  if (!on_terminal) message.remove_prefix(1);
  [[maybe_unused]] const ssize_t count = write(STDERR_FILENO, message.data(), message.size());
}

extern "C" void end_at_once(int) {
  if (writing) return;
  say("\npatchlight: error: interrupted; no further file was written\n");
  _exit(interrupted_run());
}

extern "C" void ask_to_stop(int signal) {
  last_signal = signal;
  const bool again = stop_asked.exchange(true);
  if (keeping && !again) {
    say("\npatchlight: note: stopping to write the results so far; a second signal (Ctrl-C) ends without them\n");
    return;
  }
  end_asked = true;
  itimerval timer{};
  timer.it_value.tv_usec = patience_microseconds;
  setitimer(ITIMER_REAL, &timer, nullptr);
}

// A signal that the caller ignores stays ignored: nohup, and background jobs of scripts.
void handle(int signal, void (*handler)(int)) {
  struct sigaction action {};
  if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN) return;
  action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(signal, &action, nullptr);
}

}  // namespace

void watch_interrupts() {
  on_terminal = isatty(STDERR_FILENO) == 1;
  handle(SIGALRM, end_at_once);
  handle(SIGINT, ask_to_stop);
  handle(SIGTERM, ask_to_stop);
  handle(SIGHUP, ask_to_stop);
}

bool interrupted() { return stop_asked; }

ExitCode interrupted_run() { return static_cast<ExitCode>(signal_base + last_signal); }

void keep_what_is_there() { keeping = true; }

bool may_write_what_is_there() {
  keeping = false;
  if (end_asked) return false;
  stop_asked = false;
  return !end_asked;
}

WritingGuard::WritingGuard() { writing = true; }

WritingGuard::~WritingGuard() { writing = false; }

}  // namespace patchlight::cli
