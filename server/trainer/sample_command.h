// boxgrasp-trainer sample: a point cloud of a parametric object.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace boxgrasp {

struct SampleCommand {
  std::string object;
  std::filesystem::path out;
  std::size_t points = 30'000;
  double scale = 1.0;
  double noise_m = 0.0005;  // standard deviation of Gaussian noise on every coordinate
  std::uint64_t seed = 1;
  bool list = false;  // only print the names of the objects
  bool json = false;
};

// Writes a binary PCD file of points on the object's surface. Throws InputError.
void runSample(const SampleCommand& command);

}  // namespace boxgrasp
