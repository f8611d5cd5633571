#include "reproduction_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

#include "boxgrasp/base/durable_file.h"
#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

constexpr const char* kSelf = "/proc/self/exe";
constexpr std::chrono::milliseconds kPoll{50};
constexpr std::chrono::seconds kPatience{10};  // until a child that was asked to end is killed

int opened(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor >= 0) return descriptor;
  throw InputError(fmt::format("cannot write {}: {}", file.string(), std::strerror(errno)));
}

// In the child, between fork and exec: async-signal-safe calls alone.
[[noreturn]] void becomeStep(char* const* arguments, const char* folder, int out, int messages,
                             pid_t parent) {
  setpgid(0, 0);  // Ctrl-C reaches the parent alone, which then decides
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  signal(SIGINT, SIG_DFL);
  signal(SIGTERM, SIG_DFL);
  if (getppid() == parent && chdir(folder) == 0 && dup2(out, STDOUT_FILENO) >= 0 &&
      dup2(messages, STDERR_FILENO) >= 0)
    execv(kSelf, arguments);
  _exit(127);
}

int codeOf(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status); }

bool ended(pid_t child, int& status) { return waitpid(child, &status, WNOHANG) == child; }

void end(pid_t child) {
  kill(child, SIGTERM);
  int status = 0;
  const auto patience = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < patience) {
    if (ended(child, status)) return;
    std::this_thread::sleep_for(kPoll);
  }
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
}

int waitFor(pid_t child, const StopToken& stop) {
  int status = 0;
  while (!ended(child, status)) {
    if (const auto reason = stop.stopped()) {
      end(child);
      throw Stopped(*reason);
    }
    std::this_thread::sleep_for(kPoll);
  }
  return codeOf(status);
}

}  // namespace

int runStep(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
            const std::filesystem::path& out, const std::filesystem::path& messages, const StopToken& stop) {
  std::vector<std::string> words{"boxgrasp-trainer"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const int out_file = opened(out), messages_file = opened(messages);
  const pid_t self = getpid(), child = fork();
  if (child == 0) becomeStep(pointers.data(), folder.c_str(), out_file, messages_file, self);
  close(out_file);
  close(messages_file);
  if (child < 0) throw InputError(fmt::format("cannot start a process: {}", std::strerror(errno)));
  return waitFor(child, stop);
}

std::string programBuild() {
  constexpr std::uintmax_t kMost = std::uintmax_t{1} << 30;
  std::uint64_t sum = 0xcbf29ce484222325;  // FNV-1a
  for (const char c : readWhole(std::filesystem::read_symlink(kSelf), kMost))
    sum = (sum ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return fmt::format("{:016x}", sum);
}

}  // namespace boxgrasp
