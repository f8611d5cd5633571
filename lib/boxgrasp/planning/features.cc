#include "boxgrasp/planning/features.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/wrench/grasp_wrench_space.h"

namespace boxgrasp {
namespace {

using Eigen::Index;

// In the order of the columns. The power of the size by which each grows with the object: areas 2, lengths 1,
// angles and ratios 0.
struct Measure {
  std::string_view name;
  int power;
};
constexpr Measure kMeasures[] = {{"q1", 2},         {"q2", 0},          {"q3", 0},         {"q4", 1},
                                 {"q5", 0},         {"q6", 1},          {"q7", 1},         {"q8", 2},
                                 {"q9", 1},         {"size", 1},        {"epsilon", 0},    {"nu", 0},
                                 {"balance", 0},    {"center", 1},      {"center_off", 1}, {"span_min", 1},
                                 {"span_max", 1},   {"spread_out", 1},  {"depth", 1},      {"palm", 1},
                                 {"spread", 0},     {"finger_bend", 0}, {"thumb_bend", 0}, {"thumb_angle", 0},
                                 {"focus_area", 2}, {"level", 0},       {"leaf", 0},       {"seen", 0}};
constexpr Index kCount = std::size(kMeasures);
constexpr std::string_view kSuffixes[] = {"", "/L", "/L2"};

Index columnOf(std::string_view name) {
  const auto found = std::ranges::find(kMeasures, name, &Measure::name);
  return found == std::end(kMeasures) ? -1 : found - std::begin(kMeasures);
}

// --- features

enum class Form { value, rank, share };

struct Feature {
  Form form = Form::value;
  Index column = -1;
  int power = 0;  // of the size, to divide by
};

std::string_view within(std::string_view text, std::string_view function) {
  const bool fits = text.size() > function.size() + 2 && text.starts_with(function) &&
                    text[function.size()] == '(' && text.ends_with(')');
  return fits ? text.substr(function.size() + 1, text.size() - function.size() - 2) : std::string_view();
}

Feature parsed(std::string_view text) {
  if (const auto name = within(text, "rank"); !name.empty()) return {Form::rank, columnOf(name)};
  if (const auto name = within(text, "share"); !name.empty()) return {Form::share, columnOf(name)};
  for (int power = 2; power > 0; --power) {
    if (!text.ends_with(kSuffixes[power])) continue;
    return {Form::value, columnOf(text.substr(0, text.size() - kSuffixes[power].size())), power};
  }
  return {Form::value, columnOf(text)};
}

Feature known(const std::string& feature) {
  const Feature result = parsed(feature);
  if (result.column >= 0) return result;
  throw InputError(fmt::format(
      "the model's feature '{}' is unknown: features are {}, each alone, followed by /L or /L2, or as "
      "rank(..) or share(..)",
      feature, fmt::join(measureNames(), ", ")));
}

// Places among all, from 0 to 1; equals share one.
VectorXd places(const VectorXd& values) {
  const Index n = values.size();
  VectorXd result = VectorXd::Constant(n, 0.5);
  if (n < 2) return result;
  std::vector<std::pair<double, Index>> sorted;
  sorted.reserve(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) sorted.emplace_back(values[i], i);
  std::ranges::sort(sorted);
  for (auto first = sorted.begin(); first != sorted.end();) {
    const auto end =
        std::find_if(first, sorted.end(), [&](const auto& other) { return other.first != first->first; });
    const auto below = static_cast<double>(first - sorted.begin());
    const double place = (below + 0.5 * static_cast<double>(end - first - 1)) / static_cast<double>(n - 1);
    for (; first != end; ++first) result[first->second] = place;
  }
  return result;
}

VectorXd shares(const VectorXd& values) {
  const double most = values.size() ? values.maxCoeff() : 0.0;
  return most > 0 ? VectorXd(values.cwiseMax(0.0) / most) : VectorXd(VectorXd::Zero(values.size()));
}

VectorXd column(const Feature& feature, const MatrixXd& measures) {
  const VectorXd values = measures.col(feature.column);
  switch (feature.form) {
    case Form::rank:
      return places(values);
    case Form::share:
      return shares(values);
    case Form::value:
      break;
  }
  return values.array() / measures.col(columnOf("size")).array().pow(feature.power);
}

std::vector<std::string> paperFeaturesWith(bool relative) {
  std::vector<std::string> features;
  for (Index q = 0; q < 9; ++q) {
    const Measure& measure = kMeasures[q];
    features.push_back(fmt::format("{}{}", measure.name, relative ? kSuffixes[measure.power] : ""));
  }
  return features;
}

// --- measures

// Of the friction cones: few, because time grows with the cube of their number, and the order of grasps
// hardly changes.
constexpr int kConeEdges = 6;

// What the grasps of an object are measured against.
struct Reference {
  Vector3d center_C = Vector3d::Zero();
  double radius_m = 0.0;
  double size_m = 0.0;
};

Reference referenceOf(const PlannedObject& object) {
  Reference reference{.size_m = objectSize(object)};
  const std::size_t n = object.cloud_C.size();
  for (std::size_t i = 0; i < n; ++i) reference.center_C += object.cloud_C.point(i);
  reference.center_C /= static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i) {
    reference.radius_m = std::max(reference.radius_m, (object.cloud_C.point(i) - reference.center_C).norm());
  }
  return reference;
}

// Of one grasp, by name.
class Row {
 public:
  explicit Row(Eigen::Ref<Eigen::RowVectorXd> values) : values_(values) {}
  void set(std::string_view name, double value) { values_[columnOf(name)] = value; }

 private:
  Eigen::Ref<Eigen::RowVectorXd> values_;
};

void measureContacts(const Grasp& grasp, const Reference& reference, Row& row) {
  const auto& [a, b, c] = grasp.contacts;
  const Vector3d mean_C = (a.p_C + b.p_C + c.p_C) / 3.0, arm_C = mean_C - reference.center_C;
  const double along = arm_C.dot(grasp.approach_C);
  const auto sides = {(a.p_C - b.p_C).norm(), (b.p_C - c.p_C).norm(), (c.p_C - a.p_C).norm()};
  const auto heights = {grasp.approach_C.dot(a.p_C), grasp.approach_C.dot(b.p_C),
                        grasp.approach_C.dot(c.p_C)};
  const Vector3d p_CP = grasp.X_CP.translation();
  row.set("balance", (a.normal_C + b.normal_C + c.normal_C).norm());
  row.set("center", arm_C.norm());
  row.set("center_off", (arm_C - along * grasp.approach_C).norm());
  row.set("span_min", std::min(sides));
  row.set("span_max", std::max(sides));
  row.set("spread_out", std::max(heights) - std::min(heights));
  row.set("depth", (mean_C - p_CP).dot(grasp.approach_C));
  row.set("palm", (p_CP - reference.center_C).norm());
  row.set("seen", (a.seen + b.seen + c.seen) / 3.0);
}

void measureHand(const Grasp& grasp, const BoxNode& box, Row& row) {
  const auto& inner = grasp.joints.inner;
  row.set("spread", grasp.joints.spread);
  row.set("finger_bend", (inner[kF1] + inner[kF2]) / 2);
  row.set("thumb_bend", inner[kThumb]);
  row.set("thumb_angle", std::abs(grasp.configuration.thumb_angle));
  row.set("focus_area", grasp.triplet.focus_area_m2);
  row.set("level", box.depth);
  row.set("leaf", box.leaf());
}

void measureWrenches(const Grasp& grasp, const Reference& reference, double friction, Row& row) {
  WrenchOptions options;
  options.friction = friction;
  options.cone_edges = kConeEdges;
  options.p_CG = reference.center_C;
  options.torque_scale_m = reference.radius_m;
  std::vector<Contact> contacts;
  for (const SurfaceContact& contact : grasp.contacts) contacts.push_back({contact.p_C, contact.normal_C});
  const GraspQuality quality = graspQuality(contacts, options);
  row.set("epsilon", std::max(quality.epsilon, 0.0));
  row.set("nu", quality.volume);
}

}  // namespace

bool asksForWrenches(const std::vector<std::string>& features) {
  return std::ranges::any_of(features, [](const std::string& feature) {
    const Index asked = known(feature).column;
    return asked == columnOf("epsilon") || asked == columnOf("nu");
  });
}

std::vector<std::string> measureNames() {
  std::vector<std::string> names;
  for (const Measure& measure : kMeasures) names.emplace_back(measure.name);
  return names;
}

std::vector<std::string> paperFeatures() { return paperFeaturesWith(false); }

std::vector<std::string> relativeFeatures() { return paperFeaturesWith(true); }

std::vector<std::string> allFeatures() {
  std::vector<std::string> features;
  for (const Measure& measure : kMeasures) {
    features.push_back(measure.name == "size" ? "size"
                                              : fmt::format("{}{}", measure.name, kSuffixes[measure.power]));
    if (measure.name != "size") features.push_back(fmt::format("rank({})", measure.name));
  }
  for (const std::string_view name : {"q1", "epsilon", "nu"})
    features.push_back(fmt::format("share({})", name));
  return features;
}

void checkFeatures(const std::vector<std::string>& features) {
  for (const std::string& feature : features) known(feature);
}

double objectSize(const PlannedObject& object) { return object.tree.nodes.front().box.extents.norm() / 2; }

MatrixXd graspMeasures(const PlannedObject& object, const std::vector<const Grasp*>& grasps,
                       const MeasuringOptions& options, const StopToken& stop) {
  const Reference reference = referenceOf(object);
  const bool wrenches = asksForWrenches(options.features);
  // A grasp a row in memory, so that threads write apart.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> measures =
      MatrixXd::Zero(static_cast<Index>(grasps.size()), kCount);
  parallelFor(grasps.size(), options.threads, [&](std::size_t i) {
    stop.check();
    const Grasp& grasp = *grasps[i];
    auto values = measures.row(static_cast<Index>(i));
    values.head(9) = Eigen::Map<const Eigen::RowVectorXd>(grasp.quality.data(), 9);
    Row row(values);
    row.set("size", reference.size_m);
    measureContacts(grasp, reference, row);
    measureHand(grasp, object.tree.nodes[static_cast<std::size_t>(grasp.box)], row);
    if (wrenches) measureWrenches(grasp, reference, options.friction, row);
  });
  return measures;
}

MatrixXd networkInputs(const std::vector<std::string>& features, const MatrixXd& measures) {
  MatrixXd inputs(measures.rows(), static_cast<Index>(features.size()));
  for (std::size_t i = 0; i < features.size(); ++i)
    inputs.col(static_cast<Index>(i)) = column(known(features[i]), measures);
  return inputs;
}

}  // namespace boxgrasp
