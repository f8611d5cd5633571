// Model files (JSON).
#include "boxgrasp/ranking/model_file.h"
#include "fuzz_target.h"
#include "test_model.h"

namespace boxgrasp::fuzz {

void feed(Bytes bytes) {
  accepts([&] {
    const Model model = parseModel(std::string(text(bytes)), "fuzz.json");
    promise(modelVersion(model) == model.version);
    promise(scores(model.ensemble, MatrixXd::Zero(1, model.ensemble.inputs())).size() == 1);
  });
}

std::vector<std::string> seeds() {
  const Folder folder;
  Model model = test::linearModel();
  model.metrics["s_net"] = 0.5;
  writeModel(model, folder.path() / "plain.json");
  model.ensemble.networks.push_back(model.ensemble.networks.front());
  model.ensemble.calibration = Calibration{};
  writeModel(model, folder.path() / "calibrated.json");
  return {folder.read("plain.json"), folder.read("calibrated.json")};
}

}  // namespace boxgrasp::fuzz
