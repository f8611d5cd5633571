// A thread for work that must hold up neither plans nor the bus.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace boxgrasp {

// Does one task after the other, in order. Thread-safe.
class Background {
 public:
  using Task = std::function<void()>;

  // `most` tasks wait at most. A std::exception that leaves a task goes to on_error, as text.
  Background(std::size_t most, std::function<void(const std::string&)> on_error);
  // Finishes what waits.
  ~Background();
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  // False, and nothing done, when too many wait.
  bool post(Task task);
  bool idle() const;

 private:
  void work();

  const std::size_t most_;
  const std::function<void(const std::string&)> on_error_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Task> tasks_;
  bool busy_ = false, ending_ = false;
  std::thread thread_;
};

}  // namespace boxgrasp
