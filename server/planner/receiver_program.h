// Where the program is that receives for the server.
#pragma once

#include <filesystem>

namespace boxgrasp {

// boxgrasp-receiver for the server in the given folder: beside it, or in ../libexec/boxgrasp as it is
// installed. Throws InputError naming both places where it is in neither.
std::filesystem::path receiverProgram(const std::filesystem::path& folder);

// The folder of the program that runs. Throws std::filesystem::filesystem_error where /proc is missing.
std::filesystem::path ownFolder();

}  // namespace boxgrasp
