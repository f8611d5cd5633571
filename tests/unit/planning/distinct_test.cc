#include "boxgrasp/planning/distinct.h"

#include <gtest/gtest.h>

#include <random>

#include "boxgrasp/base/random.h"

namespace boxgrasp {
namespace {

constexpr double kDistance = 0.015, kAngle = 0.35;

Grasp graspAt(const Vector3d& palm, double turn_rad, double score) {
  Grasp grasp;
  grasp.object = 0;
  grasp.score = score;
  grasp.X_CP = makePose(Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ()).toRotationMatrix(), palm);
  for (int i = 0; i < 3; ++i) grasp.contacts[i] = {palm + 0.03 * Vector3d::Unit(i), Vector3d::UnitX()};
  return grasp;
}

TEST(NearlyIdentical, NeedsPalmTurnAndContactsAllNear) {
  const Grasp a = graspAt({0, 0, 0}, 0, 1);
  EXPECT_TRUE(nearlyIdentical(a, graspAt({0.01, 0, 0}, 0.3, 0), kDistance, kAngle));
  EXPECT_FALSE(nearlyIdentical(a, graspAt({0.02, 0, 0}, 0.0, 0), kDistance, kAngle))
      << "palms are 20 mm apart";
  EXPECT_FALSE(nearlyIdentical(a, graspAt({0, 0, 0}, 0.4, 0), kDistance, kAngle))
      << "palms are turned by 0.4 rad";
  Grasp moved = a;
  moved.contacts[2].p_C.x() += 0.02;
  EXPECT_FALSE(nearlyIdentical(a, moved, kDistance, kAngle)) << "a contact lies 20 mm away";
  Grasp exchanged = a;
  std::swap(exchanged.contacts[0], exchanged.contacts[1]);
  EXPECT_TRUE(nearlyIdentical(a, exchanged, kDistance, kAngle)) << "F1 and F2 have only changed places";
  Grasp elsewhere = a;
  elsewhere.object = 1;
  EXPECT_FALSE(nearlyIdentical(a, elsewhere, kDistance, kAngle)) << "another object";
}

TEST(DistinctGrasps, KeepsTheBestOfEachGroupInOrder) {
  std::mt19937_64 random(1);
  std::vector<Grasp> ranked;
  for (int i = 0; i < 300; ++i) {
    ranked.push_back(graspAt({uniform(random, 0, 0.1), uniform(random, 0, 0.1), 0}, uniform(random, 0, 1),
                             1.0 - 0.001 * i));
  }
  const std::vector<Grasp> kept = distinctGrasps(ranked, 0, kDistance, kAngle, {});
  for (std::size_t i = 0; i < kept.size(); ++i) {
    for (std::size_t j = i + 1; j < kept.size(); ++j) {
      EXPECT_GT(kept[i].score, kept[j].score);
      EXPECT_FALSE(nearlyIdentical(kept[i], kept[j], kDistance, kAngle)) << i << " and " << j;
    }
  }
  for (const Grasp& grasp : ranked) {
    const bool represented = std::any_of(kept.begin(), kept.end(), [&](const Grasp& k) {
      return k.score >= grasp.score && nearlyIdentical(k, grasp, kDistance, kAngle);
    });
    EXPECT_TRUE(represented) << "a grasp was dropped without a better one near it";
  }
}

TEST(DistinctGrasps, TopKIsThePrefixOfAll) {
  std::vector<Grasp> ranked;
  for (int i = 0; i < 20; ++i) ranked.push_back(graspAt({0.05 * i, 0, 0}, 0, 1.0 - 0.01 * i));
  EXPECT_EQ(distinctGrasps(ranked, 0, kDistance, kAngle, {}).size(), 20u);
  const std::vector<Grasp> top = distinctGrasps(ranked, 3, kDistance, kAngle, {});
  ASSERT_EQ(top.size(), 3u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(top[i].score, ranked[i].score);
}

}  // namespace
}  // namespace boxgrasp
