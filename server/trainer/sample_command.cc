#include "sample_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/cloud/write_cloud.h"
#include "boxgrasp/objects/parametric.h"
#include "print_json.h"

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
    const std::vector<std::string> names = parametricNames();
    if (command.json)
      printJson(nlohmann::ordered_json{{"schema", 1}, {"objects", names}});
    else
      fmt::print("{}\n", fmt::join(names, "\n"));
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
  if (command.json)
    printJson(nlohmann::ordered_json{{"schema", 1},
                                     {"object", command.object},
                                     {"points", cloud.size()},
                                     {"file", command.out.string()},
                                     {"seed", command.seed}});
  else
    fmt::print("{} points on a {} written to {}\n", cloud.size(), command.object, command.out.string());
}

}  // namespace boxgrasp
