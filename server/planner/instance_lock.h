// One server on one LCM bus: two would answer every request twice.
#pragma once

#include <string>

namespace boxgrasp {

// Held from construction to destruction, and let go by the kernel when the process dies. Sees servers of this
// machine (this network namespace), whoever runs them.
class InstanceLock {
 public:
  // Throws InputError when another process holds the lock for this bus.
  explicit InstanceLock(const std::string& lcm_url);
  ~InstanceLock();
  InstanceLock(const InstanceLock&) = delete;
  InstanceLock& operator=(const InstanceLock&) = delete;

 private:
  int socket_;
};

}  // namespace boxgrasp
