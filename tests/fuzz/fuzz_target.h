// What a fuzz target is. Two programs can drive one: libFuzzer (libfuzzer.cc, with clang), and a loop of
// plain mutations that needs no more than any compiler (mutations.cc).
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "boxgrasp/base/error.h"

namespace boxgrasp::fuzz {

using Bytes = std::span<const std::uint8_t>;

// Each target defines the following two.
//
// Gives the bytes to what reads them. InputErrors are the right answer to bad bytes; whatever else leaves it
// is a finding, and so is a broken promise(), a crash, too much memory or time.
void feed(Bytes bytes);
// What our own writers make.
std::vector<std::string> seeds();

// Ends the program, as a crash, when it does not hold.
inline void promise(bool holds) {
  if (!holds) __builtin_trap();
}

inline std::string_view text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

template <typename Container>
std::string textOf(const Container& bytes) {
  return {bytes.begin(), bytes.end()};
}

// Calls the reader, and takes an InputError for its answer. True if it accepted.
template <typename Reader>
bool accepts(const Reader& read) {
  try {
    read();
    return true;
  } catch (const InputError&) {
    return false;
  }
}

// A folder in memory for readers that want files; it goes with the program.
class Folder {
 public:
  Folder() {
    const std::filesystem::path memory = "/dev/shm";
    const auto base = std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path();
    std::string name = base / "boxgrasp-fuzz-XXXXXX";
    if (mkdtemp(name.data()) == nullptr)
      throw InputError("no folder for files can be made in " + base.string());
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  // Writes a file and returns its path.
  std::filesystem::path file(const std::string& name, Bytes bytes) const {
    std::ofstream(path_ / name, std::ios::binary) << text(bytes);
    return path_ / name;
  }
  // The bytes of a file in it.
  std::string read(const std::string& name) const {
    std::ifstream stream(path_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

 private:
  std::filesystem::path path_;
};

}  // namespace boxgrasp::fuzz
