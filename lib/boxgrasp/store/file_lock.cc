#include "boxgrasp/store/file_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "boxgrasp/store/store_error.h"

namespace boxgrasp {

FileLock::FileLock(const std::filesystem::path& guarded) {
  const std::string file = guarded.string() + ".lock";
  // For reading: that is enough for a lock, and a file that exists can be opened where nothing can be written.
  descriptor_ = open(file.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ >= 0) return;
  throw StoreError(
      fmt::format("'{}' cannot be opened: {}; check the path, and the permissions of file and folder", file,
                  std::strerror(errno)));
}

FileLock::~FileLock() { close(descriptor_); }

bool FileLock::tryLock() const { return flock(descriptor_, LOCK_EX | LOCK_NB) == 0; }

void FileLock::lock() const {
  while (flock(descriptor_, LOCK_EX) != 0 && errno == EINTR) {
  }
}

}  // namespace boxgrasp
