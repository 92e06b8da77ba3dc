#include "coupling/virtual_display.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "base/error.hpp"

namespace coupling {
namespace {

/// In the child process: becomes the X server of this display, which writes its number to `report` when it is ready.
/// Never returns. It goes when we go, however we go.
[[noreturn]] void become_server(int report, const std::string& display) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  const int nothing = open("/dev/null", O_RDWR);
  dup2(nothing, STDIN_FILENO);
  dup2(nothing, STDOUT_FILENO);
  dup2(nothing, STDERR_FILENO);
  dup2(report, 3);  // 3 or above: not one of the three streams
  execlp("Xvfb", "Xvfb", display.c_str(), "-displayfd", "3", "-screen", "0", "1280x1024x24", "-nolisten", "tcp",
         static_cast<char*>(nullptr));
  _exit(127);
}

/// The display number that the server reports once it is ready; empty when it ends or stays silent.
std::string read_display(int report) {
  constexpr int patience_ms = 20000;
  std::string number;
  pollfd waiting{report, POLLIN, 0};
  char letter = 0;
  while (poll(&waiting, 1, patience_ms) > 0 && read(report, &letter, 1) == 1) {
    if (letter == '\n') return number;
    number += letter;
  }
  return "";
}

void stop(pid_t server) {
  kill(server, SIGTERM);
  waitpid(server, nullptr, 0);
}

/// Starts a server on this display; -1 when it does not come up.
pid_t start(const std::string& display) {
  int ends[2];
  if (pipe(ends) != 0) throw base::MachineError("cannot make a pipe to a virtual display");
  const pid_t server = fork();
  if (server == 0) become_server(ends[1], display);
  close(ends[1]);
  const std::string number = server > 0 ? read_display(ends[0]) : "";
  close(ends[0]);
  if (!number.empty()) return server;
  if (server > 0) stop(server);
  return -1;
}

}  // namespace

VirtualDisplay::VirtualDisplay() {
  // A number of our own: a server that looks for the first free one can lose its socket to another that is just ending.
  for (int attempt = 0; attempt < 3 && server_ < 0; ++attempt) {
    const std::string display = ":" + std::to_string(1000 + (getpid() + 7919 * attempt) % 50000);
    server_ = start(display);
    if (server_ > 0) setenv("DISPLAY", display.c_str(), 1);
  }
  if (server_ > 0) return;
  const char* display = std::getenv("DISPLAY");
  base::require_user(
      display != nullptr && *display != '\0',
      "pictures need an X display, and there is none: DISPLAY is not set and Xvfb, the X server without a "
      "screen, does not start; install it with `apt-get install xvfb`");
}

VirtualDisplay::~VirtualDisplay() {
  if (server_ > 0) stop(server_);
}

}  // namespace coupling
