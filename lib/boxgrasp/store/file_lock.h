// A lock between processes that ends with its process, however that ends.
#pragma once

#include <filesystem>

namespace boxgrasp {

// Held from construction to destruction on a file made for it beside the one that it guards ("x.db.lock"),
// which stays, empty. The file itself cannot carry the lock: closing it would take away SQLite's own locks.
class FileLock {
 public:
  // Throws StoreError where the lock's file cannot be made.
  explicit FileLock(const std::filesystem::path& guarded);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  bool tryLock() const;  // false: somebody else holds it
  void lock() const;     // waits

 private:
  int descriptor_;
};

}  // namespace boxgrasp
