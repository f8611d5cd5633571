#include "boxgrasp/ranking/recollections.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kSide = Constellation::kSide;

Vector3d randomUnit(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vector3d(normal(random), normal(random), normal(random)).normalized();
}

// Two boxes in an L, which no turn but one lays over itself.
Constellation anL(double unit_m = 0.1) {
  Constellation constellation{unit_m, {}};
  for (int z = 6; z < 9; ++z)
    for (int y = 2; y < 14; ++y)
      for (int x = 0; x < (y < 5 ? 16 : 4); ++x)
        constellation.cells.set(static_cast<std::size_t>(x + kSide * (y + kSide * z)));
  return constellation;
}

// A quarter turn about z, which takes the middle of a cell to that of another.
Constellation quarterTurned(const Constellation& constellation) {
  Constellation result{constellation.unit_m, {}};
  for (int z = 0; z < kSide; ++z)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        if (constellation.cells[static_cast<std::size_t>(x + kSide * (y + kSide * z))])
          result.cells.set(static_cast<std::size_t>(kSide - 1 - y + kSide * (x + kSide * z)));
  return result;
}
const Matrix3d kQuarter = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()).toRotationMatrix();

Recollection recollection(int grasps, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> anywhere(-0.5, 0.5);
  Recollection result{anL(), {}, VectorXd(grasps)};
  for (int i = 0; i < grasps; ++i) {
    result.places.push_back(
        {{anywhere(random), anywhere(random), anywhere(random)}, randomUnit(random), randomUnit(random)});
    result.surprises[i] = anywhere(random);
  }
  return result;
}

TEST(Overlaps, AreOneForTheSameInOneTurnAlone) {
  const std::vector<double> shares = overlaps(anL(), anL());
  ASSERT_EQ(shares.size(), 24u);
  EXPECT_EQ(std::ranges::count(shares, 1.0), 1) << "the L has no symmetry among the turns";
  for (const double share : shares) EXPECT_LE(share, 1.0);
}

TEST(Overlaps, FindTheTurnedOne) {
  const std::vector<double> shares = overlaps(anL(), quarterTurned(anL()));
  EXPECT_EQ(std::ranges::count(shares, 1.0), 1);
  Constellation half = anL();
  std::size_t kept = half.cells.count() / 2;
  for (std::size_t i = half.cells.size(); i-- > 0 && half.cells.count() > kept;) half.cells.reset(i);
  EXPECT_EQ(std::ranges::max(overlaps(anL(), half)), static_cast<double>(kept) / anL().cells.count());
}

TEST(Corrections, AreTheSurpriseInTheSamePlaceAndNothingElsewhere) {
  RecallOptions options;
  options.own_weight = 1.0;
  options.contacts = 0.01;
  Recollection before = recollection(1, 1);
  before.surprises[0] = 0.8;
  GraspPlace far = before.places[0];
  far.contacts.x() += 0.5;
  GraspPlace turned = before.places[0];
  turned.approach = -turned.approach;
  const VectorXd added = corrections(anL(), {before.places[0], far, turned}, {before}, options);
  EXPECT_NEAR(added[0], 0.4, 1e-12) << "half of it: the networks' own score counts once, as it does";
  EXPECT_EQ(added[1], 0.0);
  EXPECT_NEAR(added[2], 0.0, 1e-9);
  options.own_weight = 1e-9;
  EXPECT_NEAR(corrections(anL(), {before.places[0]}, {before, before}, options)[0], 0.8, 1e-6)
      << "the mean of the surprises, where they outweigh all else";
}

TEST(Corrections, DoNotDependOnHowTheObjectLies) {
  const std::vector<Recollection> memory{recollection(40, 2)};
  const std::vector<GraspPlace> places = recollection(20, 3).places;
  std::vector<GraspPlace> turned;
  for (const GraspPlace& place : places)
    turned.push_back({kQuarter * place.contacts, kQuarter * place.approach, kQuarter * place.thumb});
  RecallOptions options;
  options.contacts = 0.3;
  const VectorXd expected = corrections(anL(), places, memory, options);
  EXPECT_GT(expected.cwiseAbs().maxCoeff(), 1e-3)
      << "something must be recalled for the test to mean anything";
  EXPECT_TRUE(corrections(quarterTurned(anL()), turned, memory, options).isApprox(expected, 1e-9));
}

TEST(Corrections, FadeWithTheDifferenceInSizeAndShape) {
  const std::vector<Recollection> memory{recollection(1, 4)};
  const std::vector<GraspPlace> same = memory[0].places;
  const auto size = [&](double unit_m) { return std::abs(corrections(anL(unit_m), same, memory, {})[0]); };
  EXPECT_GT(size(0.1), size(0.13));
  EXPECT_GT(size(0.13), size(0.2));
  EXPECT_EQ(size(1.0), 0.0);
  Constellation ball{0.1, {}};
  for (std::size_t i = 0; i < ball.cells.size(); ++i) ball.cells.set(i);
  EXPECT_EQ(corrections(ball, same, memory, {})[0], 0.0) << "a full cube is not an L";
  EXPECT_EQ(corrections(anL(), same, {}, {})[0], 0.0) << "nothing is remembered";
}

TEST(Recollection, RefusesWhatDoesNotFitTogether) {
  const auto refused = [](auto change) {
    Recollection damaged = recollection(3, 5);
    change(damaged);
    EXPECT_THROW(damaged.validate(), InputError);
  };
  EXPECT_NO_THROW(recollection(3, 5).validate());
  refused([](Recollection& r) { r.constellation.unit_m = 0.0; });
  refused([](Recollection& r) { r.surprises.conservativeResize(2); });
  refused([](Recollection& r) { r.surprises[1] = NAN; });
  refused([](Recollection& r) {
    r.places.clear();
    r.surprises.resize(0);
  });
  refused([](Recollection& r) { r.places[1].contacts.x() = 1e300; });
  refused([](Recollection& r) { r.places[1].approach *= 2.0; });
  refused([](Recollection& r) { r.places[1].thumb.setConstant(NAN); });
}

}  // namespace
}  // namespace boxgrasp
