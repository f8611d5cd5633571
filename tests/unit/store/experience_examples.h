// Made-up experience that has every kind of field and number in it.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "boxgrasp/base/random.h"
#include "boxgrasp/store/experience_store.h"
#include "random_pose.h"

namespace boxgrasp::test {

inline constexpr const char* kSettings = "hand = barrett\nseed = 1\nversion = 0.1.0\n";

// A folder of its own for each test, taken away at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "boxgrasp-store-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder for the test");
    path_ = name;
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

// Any double at all, the awkward ones often.
inline double awkward(std::mt19937_64& random) {
  constexpr double kOnes[] = {-0.0, 0.0, 0.1, 1.0, -3.0, 5e-324, 1e308, 0x1p53, 1e300, NAN, INFINITY};
  const std::uint64_t i = uniformIndex(random, 2 * std::size(kOnes));
  return i < std::size(kOnes) ? kOnes[i] : normal(random);
}

inline ModelRecord someModel(const std::string& object, double scale, std::mt19937_64& random) {
  ModelRecord model;
  model.key = {object, scale, "whole"};
  model.mesh_hash = "c0ffee";
  model.mass_kg = awkward(random);
  model.size_m = awkward(random);
  model.boxes = 7;
  model.triplets = std::int64_t{1} << 40;
  model.message = "a 'quoted'; \"message\"\nin two lines, with \xc3\xa9";
  return model;
}

inline HypothesisRecord someHypothesis(GraspSource source, int index, std::mt19937_64& random) {
  HypothesisRecord grasp;
  grasp.source = source;
  grasp.index = index;
  grasp.X_OP = randomPose(random);
  grasp.joints = {awkward(random), {0.1, -0.0, 1.0 / 3}};
  grasp.approach_m = awkward(random);
  for (double& q : grasp.quality) q = awkward(random);
  grasp.box = 3;
  return grasp;
}

inline std::vector<HypothesisRecord> someHypotheses(GraspSource source, int count, std::mt19937_64& random) {
  std::vector<HypothesisRecord> grasps;
  for (int i = 0; i < count; ++i) grasps.push_back(someHypothesis(source, i, random));
  return grasps;
}

inline TrialContact someContact(std::mt19937_64& random) {
  const Vector3d p(awkward(random), normal(random), -0.0);
  return {uniform(random) < 0.5 ? "palm" : "F2 outer link", 1, p, Vector3d::UnitX(),
          randomRotation(random).col(0)};
}

inline GraspLabel someLabel(int perturbation, std::mt19937_64& random) {
  GraspLabel label;
  label.perturbation = perturbation;
  label.seed = random();
  label.friction = awkward(random);
  label.outcome = static_cast<TrialOutcome>(uniformIndex(random, 6));
  label.force_closure = uniform(random) < 0.5;
  label.epsilon = awkward(random);
  label.lift_slip_m = awkward(random);
  label.contacts.resize(uniformIndex(random, 4));
  for (TrialContact& contact : label.contacts) contact = someContact(random);
  return label;
}

inline std::vector<IndexedLabel> someLabels(int hypotheses, int perturbations, std::mt19937_64& random) {
  std::vector<IndexedLabel> labels;
  for (int i = 0; i < hypotheses; ++i) {
    for (int k = 0; k <= perturbations; ++k) labels.push_back({i, someLabel(k, random)});
  }
  return labels;
}

inline std::string dumpOf(const ExperienceStore& store) {
  std::string text;
  store.dump([&](std::string_view line) { (text += line) += '\n'; });
  return text;
}

}  // namespace boxgrasp::test
