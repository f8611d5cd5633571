// Running the programs as users do: as processes of their own.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace boxgrasp::test {

namespace fs = std::filesystem;

// A folder of its own that goes with it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  fs::path operator/(const std::string& name) const { return path_ / name; }

 private:
  fs::path path_;
};

// A running program, its output collected in files. Killed at the end of its life.
class Process {
 public:
  explicit Process(const std::vector<std::string>& arguments);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void signal(int number) const;
  // Its exit code; -N if signal N ended it. Kills it after timeout_s, which makes -9.
  int wait(double timeout_s);
  bool running();
  pid_t id() const { return pid_; }
  std::string out() const;
  std::string err() const;

 private:
  TemporaryFolder folder_;
  pid_t pid_ = -1;
  int status_ = 0;
};

struct Finished {
  int code;
  std::string out, err;
};
Finished run(const std::vector<std::string>& arguments, double timeout_s = 60.0);

// Moves this process into a network of its own with nothing but loopback, so that tests on one machine do not
// hear each other. Needs root; returns false where that is not to be had.
bool enterOwnNetwork();

}  // namespace boxgrasp::test
