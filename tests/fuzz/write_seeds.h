// The command line that both drivers share.
#pragma once

#include <fmt/format.h>

#include "fuzz_target.h"

namespace boxgrasp::fuzz {

inline bool writesSeeds(int argc, char** argv) {
  constexpr std::string_view kOption = "--write-seeds=";
  if (argc != 2 || !std::string_view(argv[1]).starts_with(kOption)) return false;
  const std::filesystem::path folder = argv[1] + kOption.size();
  int number = 0;
  for (const std::string& seed : seeds())
    std::ofstream(folder / fmt::format("seed-{}", number++), std::ios::binary) << seed;
  return true;
}

}  // namespace boxgrasp::fuzz
