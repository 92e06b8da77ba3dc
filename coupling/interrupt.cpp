#include "coupling/interrupt.hpp"

#include <csignal>
#include <initializer_list>

namespace coupling {
namespace {

volatile std::sig_atomic_t seen = 0;

void remember(int signal) {
  seen = signal;
  std::signal(signal, SIG_DFL);
}

}  // namespace

InterruptWatch::InterruptWatch() {
  seen = 0;
  for (const int signal : {SIGINT, SIGTERM})
    if (std::signal(signal, remember) == SIG_IGN) std::signal(signal, SIG_IGN);
}

InterruptWatch::~InterruptWatch() {
  for (const int signal : {SIGINT, SIGTERM})
    if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
}

const char* InterruptWatch::signal() { return seen == SIGINT ? "SIGINT" : seen == SIGTERM ? "SIGTERM" : nullptr; }

}  // namespace coupling
