#include "sample_command.h"

#include <fmt/format.h>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/cloud/write_cloud.h"
#include "boxgrasp/objects/parametric.h"

namespace boxgrasp {
namespace {

void addNoise(PointCloud& cloud, double deviation_m, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (auto* axis : {&cloud.x, &cloud.y, &cloud.z}) {
    for (float& value : *axis) value += static_cast<float>(deviation_m * normal(random));
  }
}

}  // namespace

void runSample(const SampleCommand& command) {
  if (command.list) {
    for (const std::string& name : parametricNames()) fmt::print("{}\n", name);
    return;
  }
  requireOption(command.points >= 1, "--points", command.points, "at least 1");
  requireOption(command.noise_m >= 0, "--noise-m", command.noise_m, "at least 0");
  if (command.object.empty() || command.out.empty())
    throw InputError("sample needs an OBJECT and --out FILE; --list names the objects");
  PointCloud cloud =
      sampleSurface(parametricObject(command.object, command.scale), command.points, command.seed);
  addNoise(cloud, command.noise_m, command.seed + 1);
  writeCloud(cloud, command.out);
  fmt::print("{} points on a {} written to {}\n", cloud.size(), command.object, command.out.string());
}

}  // namespace boxgrasp
