// A step as a child process.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "boxgrasp/base/stop_token.h"

namespace boxgrasp {

// Runs this very program in a folder, its output and messages in files, and returns its exit code; -N if
// signal N ended it. Told to stop, it asks the child to end, then kills it, and throws Stopped; a child does
// not outlive this process. Throws InputError when the files cannot be made or no process can be started.
int runStep(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
            const std::filesystem::path& out, const std::filesystem::path& messages, const StopToken& stop);

// Tells this build of the program from every other: a sum over the executable, in hexadecimal digits.
std::string programBuild();

}  // namespace boxgrasp
