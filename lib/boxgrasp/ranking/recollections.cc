#include "boxgrasp/ranking/recollections.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kSide = Constellation::kSide;
constexpr std::size_t kTurns = 24;
// A weight below this adds nothing that anyone could see.
constexpr double kLeastWeight = 1e-3;

// The turns of a cube: all ways to name its axes anew that keep them right-handed.
std::array<Matrix3d, kTurns> turnsOfACube() {
  std::array<Matrix3d, kTurns> turns;
  std::size_t count = 0;
  std::array<int, 3> axes{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Matrix3d turn = Matrix3d::Zero();
      for (int i = 0; i < 3; ++i) turn(i, axes[static_cast<std::size_t>(i)]) = (signs >> i) & 1 ? -1.0 : 1.0;
      if (turn.determinant() > 0) turns[count++] = turn;
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  return turns;
}

const std::array<Matrix3d, kTurns>& turns() {
  static const auto all = turnsOfACube();
  return all;
}

// Where each cell goes in each turn.
using CellMap = std::array<std::uint16_t, static_cast<std::size_t>(kSide* kSide* kSide)>;

CellMap cellMap(const Matrix3d& turn) {
  constexpr double centre = (kSide - 1) / 2.0;
  CellMap map;
  for (int cell = 0; cell < kSide * kSide * kSide; ++cell) {
    const Vector3d from(cell % kSide, cell / kSide % kSide, cell / (kSide * kSide));
    const Vector3d to = turn * (from.array() - centre).matrix() + Vector3d::Constant(centre);
    map[static_cast<std::size_t>(cell)] = static_cast<std::uint16_t>(
        std::lround(to.x()) + kSide * (std::lround(to.y()) + kSide * std::lround(to.z())));
  }
  return map;
}

const std::array<CellMap, kTurns>& cellMaps() {
  static const auto all = [] {
    std::array<CellMap, kTurns> maps;
    for (std::size_t i = 0; i < kTurns; ++i) maps[i] = cellMap(turns()[i]);
    return maps;
  }();
  return all;
}

Constellation::Cells turned(const Constellation::Cells& cells, const CellMap& map) {
  Constellation::Cells result;
  for (std::size_t cell = 0; cell < map.size(); ++cell) {
    if (cells[cell]) result.set(map[cell]);
  }
  return result;
}

double bell(double x, double deviation) { return std::exp(-0.5 * x * x / (deviation * deviation)); }

double angleBetween(const Vector3d& a, const Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

// A remembered object, in one of the turns that lay it over the one to grasp.
struct Turned {
  double weight = 0.0;  // of the overlap, and of the size
  std::vector<GraspPlace> places;
};

std::vector<Turned> turnsThatCount(const Constellation& here, const Recollection& there,
                                   const RecallOptions& options) {
  std::vector<Turned> result;
  const double size = bell(std::log(here.unit_m / there.constellation.unit_m), options.size);
  if (size < kLeastWeight) return result;
  const std::vector<double> shares = overlaps(here, there.constellation);
  for (std::size_t i = 0; i < kTurns; ++i) {
    const double weight = size * bell(1 - shares[i], options.overlap);
    if (weight < kLeastWeight) continue;
    Turned& turned = result.emplace_back(Turned{weight, there.places});
    for (GraspPlace& place : turned.places)
      place = {turns()[i] * place.contacts, turns()[i] * place.approach, turns()[i] * place.thumb};
  }
  return result;
}

double nearness(const GraspPlace& here, const GraspPlace& there, double weight,
                const RecallOptions& options) {
  weight *= bell((here.contacts - there.contacts).norm(), options.contacts);
  if (weight < kLeastWeight) return 0.0;
  return weight * bell(angleBetween(here.approach, there.approach), options.angle_rad) *
         bell(angleBetween(here.thumb, there.thumb), options.angle_rad);
}

struct Evidence {
  double weight = 0.0, sum = 0.0;  // of surprises times weights
};

void recallFrom(const Recollection& there, const std::vector<Turned>& turned, const GraspPlace& here,
                const RecallOptions& options, Evidence& evidence) {
  for (std::size_t i = 0; i < there.places.size(); ++i) {
    double weight = 0.0;
    for (const Turned& one : turned)
      weight = std::max(weight, nearness(here, one.places[i], one.weight, options));
    evidence.weight += weight;
    evidence.sum += weight * there.surprises[static_cast<Eigen::Index>(i)];
  }
}

bool isUnit(const Vector3d& v) { return std::abs(v.norm() - 1) < 1e-2; }

}  // namespace

void Recollection::validate() const {
  requireOption(constellation.unit_m > 0 && std::isfinite(constellation.unit_m), "unit_m",
                constellation.unit_m, "positive and finite");
  requireOption(!places.empty() && places.size() <= kMaxGrasps, "the number of places", places.size(),
                "in [1, 1024]");
  requireOption(static_cast<std::size_t>(surprises.size()) == places.size(), "the number of surprises",
                surprises.size(), "that of the places");
  requireOption(surprises.allFinite(), "the sum of surprises", surprises.sum(), "finite");
  for (const GraspPlace& place : places) {
    requireOption(place.contacts.norm() < 10, "the distance of contacts", place.contacts.norm(),
                  "below 10 units");
    requireOption(isUnit(place.approach), "the length of an approach", place.approach.norm(), "1");
    requireOption(isUnit(place.thumb), "the length of a thumb's direction", place.thumb.norm(), "1");
  }
}

void RecallOptions::validate() const {
  requireOption(overlap > 0, "overlap", overlap, "positive");
  requireOption(size > 0, "size", size, "positive");
  requireOption(contacts > 0, "contacts", contacts, "positive");
  requireOption(angle_rad > 0, "angle_rad", angle_rad, "positive");
  requireOption(own_weight > 0, "own_weight", own_weight, "positive");
}

std::vector<double> overlaps(const Constellation& a, const Constellation& b) {
  std::vector<double> shares;
  for (const CellMap& map : cellMaps()) {
    const Constellation::Cells cells = turned(b.cells, map);
    const auto either = static_cast<double>((a.cells | cells).count());
    shares.push_back(either > 0 ? static_cast<double>((a.cells & cells).count()) / either : 0.0);
  }
  return shares;
}

Eigen::VectorXd corrections(const Constellation& constellation, const std::vector<GraspPlace>& places,
                            const std::vector<Recollection>& recollections, const RecallOptions& options) {
  std::vector<Evidence> evidence(places.size());
  for (const Recollection& recollection : recollections) {
    const std::vector<Turned> turned = turnsThatCount(constellation, recollection, options);
    if (turned.empty()) continue;
    for (std::size_t i = 0; i < places.size(); ++i)
      recallFrom(recollection, turned, places[i], options, evidence[i]);
  }
  Eigen::VectorXd result(static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i)
    result[static_cast<Eigen::Index>(i)] = evidence[i].sum / (options.own_weight + evidence[i].weight);
  return result;
}

}  // namespace boxgrasp
