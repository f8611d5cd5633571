// libFuzzer's way in. With --write-seeds=FOLDER the program writes the target's seeds and ends.
#include <cstdlib>

#include "write_seeds.h"

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  if (boxgrasp::fuzz::writesSeeds(*argc, *argv)) std::exit(0);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  boxgrasp::fuzz::feed({data, size});
  return 0;
}
