#include "background.h"

#include <exception>

namespace boxgrasp {

Background::Background(std::size_t most, std::function<void(const std::string&)> on_error)
    : most_(most), on_error_(std::move(on_error)), thread_([this] { work(); }) {}

Background::~Background() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

bool Background::post(Task task) {
  const std::lock_guard lock(mutex_);
  if (tasks_.size() >= most_) return false;
  tasks_.push_back(std::move(task));
  changed_.notify_one();
  return true;
}

bool Background::idle() const {
  const std::lock_guard lock(mutex_);
  return tasks_.empty() && !busy_;
}

void Background::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return ending_ || !tasks_.empty(); });
    if (tasks_.empty()) return;
    const Task task = std::move(tasks_.front());
    tasks_.pop_front();
    busy_ = true;
    lock.unlock();
    try {
      task();
    } catch (const std::exception& error) {
      on_error_(error.what());
    }
    lock.lock();
    busy_ = false;
  }
}

}  // namespace boxgrasp
