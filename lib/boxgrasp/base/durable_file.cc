#include "boxgrasp/base/durable_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

InputError cannotWrite(const std::filesystem::path& file, const char* step) {
  return InputError(
      fmt::format("'{}' cannot be written: {}: {}; check the folder, its permissions and the free space",
                  file.string(), step, std::strerror(errno)));
}

// Closes the descriptor on every path out.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  operator int() const { return fd_; }

 private:
  int fd_;
};

bool writeBytes(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno != EINTR) return false;
    if (n > 0) bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

// Creates a temporary file beside `file` with the bytes safely on disk, and returns its path.
std::string writeTemporary(const std::filesystem::path& file, std::string_view bytes, Readers readers) {
  std::string temporary = file.string() + ".XXXXXX";
  const Descriptor fd(::mkstemp(temporary.data()));
  if (fd < 0) throw cannotWrite(file, "creating a temporary file beside it");
  const mode_t mode = readers == Readers::owner ? 0600 : 0644;
  if (!writeBytes(fd, bytes) || ::fchmod(fd, mode) != 0 || ::fsync(fd) != 0) {
    const InputError error = cannotWrite(file, "writing");
    ::unlink(temporary.c_str());
    throw error;
  }
  return temporary;
}

// Without this a crash of the machine could undo the rename.
void syncFolderOf(const std::filesystem::path& file) {
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd < 0 || ::fsync(fd) != 0) throw cannotWrite(file, "syncing its folder");
}

}  // namespace

void writeDurably(const std::filesystem::path& file, std::string_view bytes, Readers readers) {
  const std::string temporary = writeTemporary(file, bytes, readers);
  if (::rename(temporary.c_str(), file.c_str()) != 0) {
    const InputError error = cannotWrite(file, "renaming the temporary file");
    ::unlink(temporary.c_str());
    throw error;
  }
  syncFolderOf(file);
}

std::string readWhole(const std::filesystem::path& file, std::uintmax_t most) {
  const auto fail = [&](const std::string& why) {
    return InputError(fmt::format("'{}' {}; check the path and its permissions", file.string(), why));
  };
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw fail("is no regular file");
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) throw fail("has no size: " + error.message());
  if (size > most) throw fail(fmt::format("has {} bytes, more than the {} that are read", size, most));
  std::ifstream stream(file, std::ios::binary);
  std::string text(size, '\0');
  if (!stream || !stream.read(text.data(), static_cast<std::streamsize>(size))) throw fail("cannot be read");
  return text;
}

}  // namespace boxgrasp
