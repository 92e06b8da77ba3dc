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

/// In the child process: becomes the X server, which writes its display number to `report`. Never returns. It goes when
/// we go, however we go.
[[noreturn]] void become_server(int report) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  const int nothing = open("/dev/null", O_RDWR);
  dup2(nothing, STDIN_FILENO);
  dup2(nothing, STDOUT_FILENO);
  dup2(nothing, STDERR_FILENO);
  dup2(report, 3);  // 3 or above: not one of the three streams
  execlp("Xvfb", "Xvfb", "-displayfd", "3", "-screen", "0", "1280x1024x24", "-nolisten", "tcp",
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

}  // namespace

VirtualDisplay::VirtualDisplay() {
  int ends[2];
  if (pipe(ends) != 0) throw base::MachineError("cannot make a pipe to a virtual display");
  server_ = fork();
  if (server_ == 0) become_server(ends[1]);
  close(ends[1]);
  const std::string number = server_ > 0 ? read_display(ends[0]) : "";
  close(ends[0]);
  if (!number.empty()) {
    setenv("DISPLAY", (":" + number).c_str(), 1);
    return;
  }
  if (server_ > 0) stop(server_);
  server_ = -1;
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
