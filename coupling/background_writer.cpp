#include "coupling/background_writer.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include "base/error.hpp"

namespace coupling {

BackgroundWriter::~BackgroundWriter() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(guard_);
    ends_ = true;
  }
  news_.notify_all();
  thread_.join();
}

void BackgroundWriter::await(Kind kind) {
  std::unique_lock lock(guard_);
  news_.wait(lock, [&] { return !busy_[kind]; });
}

void BackgroundWriter::await_all() {
  for (int kind = 0; kind < kinds; ++kind) await(static_cast<Kind>(kind));
}

void BackgroundWriter::check() {
  FailureText failure;
  {
    const std::lock_guard lock(guard_);
    failure = failure_;
  }
  raise(failure);
}

void BackgroundWriter::start(Kind kind, std::function<void()> write) {
  check();
  try {
    if (!thread_.joinable()) thread_ = std::thread([this] { serve(); });
  } catch (const std::system_error& error) {
    throw base::MachineError(std::string("no thread can be started that writes files: ") + error.what() +
                             "; raise the limit on processes");
  }
  {
    const std::lock_guard lock(guard_);
    base::require_internal(!busy_[kind], "a file is handed over while another one of its kind is being written");
    busy_[kind] = true;
    waiting_.push_back({kind, std::move(write)});
  }
  news_.notify_all();
}

void BackgroundWriter::serve() {
  std::unique_lock lock(guard_);
  while (true) {
    news_.wait(lock, [&] { return ends_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    Work work = std::move(waiting_.front());
    waiting_.pop_front();
    if (failure_.kind == Failure::none) {
      lock.unlock();
      FailureText failure = caught(work.write);
      work.write = nullptr;  // its memory goes before anybody is told that it is done
      lock.lock();
      failure_ = std::move(failure);
    }
    work.write = nullptr;
    busy_[work.kind] = false;
    news_.notify_all();
  }
}

}  // namespace coupling
