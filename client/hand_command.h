// boxgrasp hand check: whether a hand description is one, and what it describes.
#pragma once

#include <filesystem>
#include <optional>

namespace boxgrasp {

struct HandCommand {
  std::filesystem::path file;
  std::optional<std::filesystem::path> picture;  // .png or .svg
  bool json = false;
};

// Prints what the hand can do, and hints. Throws InputError with file, line, column, key, value and bound for
// what is wrong.
int runHandCheck(const HandCommand& command);

}  // namespace boxgrasp
