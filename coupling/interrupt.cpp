#include "coupling/interrupt.hpp"

#include <csignal>
#include <initializer_list>

namespace coupling {
namespace {

volatile std::sig_atomic_t seen = 0, wished = 0;

void remember(int signal) {
  seen = signal;
  std::signal(signal, SIG_DFL);
}

void wish(int) { wished = 1; }

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

int InterruptWatch::signal() { return seen; }

const char* InterruptWatch::name(int signal) { return signal == SIGINT ? "SIGINT" : "SIGTERM"; }

CheckpointWatch::CheckpointWatch() {
  wished = 0;
  std::signal(SIGUSR1, wish);
}

CheckpointWatch::~CheckpointWatch() { std::signal(SIGUSR1, SIG_DFL); }

bool CheckpointWatch::asked() { return wished != 0; }

void CheckpointWatch::answered() { wished = 0; }

}  // namespace coupling
