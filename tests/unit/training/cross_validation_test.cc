#include "boxgrasp/training/cross_validation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "boxgrasp/base/error.h"
#include "error_of.h"
#include "synthetic_samples.h"

namespace boxgrasp {
namespace {

using test::errorOf;
using ::testing::HasSubstr;

// The same law for every object, up to an offset of its own, as for an object that is easier to grasp.
GroupedSamples objects(int count, Eigen::Index grasps, std::uint64_t seed) {
  GroupedSamples data{
      test::sampled(count * grasps, 3, seed, [](const VectorXd& x) { return x[0] - 0.5 * x[1] * x[1]; }), {}};
  for (int o = 0; o < count; ++o) {
    data.samples.targets.segment(o * grasps, grasps).array() += 0.1 * o;
    data.objects.insert(data.objects.end(), static_cast<std::size_t>(grasps), fmt::format("object{}", o));
  }
  return data;
}

CrossValidationOptions quick(int repeats) {
  CrossValidationOptions options;
  options.repeats = repeats;
  options.training.hidden = {4};
  options.training.max_epochs = 30;
  options.training.starts = 1;
  return options;
}

TEST(LeaveOneObjectOut, RanksUnknownObjectsThatFollowTheSameLaw) {
  const CrossValidation result = leaveOneObjectOut(objects(5, 80, 1), quick(3));
  ASSERT_EQ(result.objects.size(), 5u);
  EXPECT_GT(result.s_net_fraction, 0.97);
  double sum = 0.0;
  for (const ObjectResult& object : result.objects) {
    EXPECT_EQ(object.grasps, 80) << object.object;
    EXPECT_EQ(object.s_net.size(), 3u);
    EXPECT_NEAR(object.mean.value, (object.s_net[0] + object.s_net[1] + object.s_net[2]) / 3.0, 1e-14);
    EXPECT_NEAR(object.mean.value, object.mean.mean_best_tenth - object.mean.mean_worst_tenth, 1e-14);
    sum += object.mean.value;
  }
  EXPECT_NEAR(result.s_net, sum / 5.0, 1e-14);
}

// One object follows the opposite law. If its grasps were in its own training set, they would pull the
// prediction; left out, they are ranked the wrong way round, and their fraction is near 0.
TEST(LeaveOneObjectOut, NeverTrainsOnTheTestedObject) {
  GroupedSamples data = objects(5, 60, 2);
  data.samples.targets.segment(0, 60) *= -1.0;
  const CrossValidation result = leaveOneObjectOut(data, quick(2));
  EXPECT_EQ(result.objects[0].object, "object0");
  EXPECT_LT(result.objects[0].mean.fraction, 0.1);
}

// The same with the rows of the objects interleaved: groups are told by name, not by place.
TEST(LeaveOneObjectOut, TellsObjectsByName) {
  const GroupedSamples data = objects(4, 30, 3);
  GroupedSamples shuffled = data;
  for (Eigen::Index i = 0; i < 120; ++i) {
    const Eigen::Index from = (i % 4) * 30 + i / 4;
    shuffled.samples.inputs.row(i) = data.samples.inputs.row(from);
    shuffled.samples.targets[i] = data.samples.targets[from];
    shuffled.objects[static_cast<std::size_t>(i)] = data.objects[static_cast<std::size_t>(from)];
  }
  const CrossValidation a = leaveOneObjectOut(data, quick(1)), b = leaveOneObjectOut(shuffled, quick(1));
  for (std::size_t o = 0; o < 4; ++o) {
    EXPECT_EQ(a.objects[o].object, b.objects[o].object);
    EXPECT_EQ(a.objects[o].mean.ceiling, b.objects[o].mean.ceiling);
    EXPECT_EQ(a.objects[o].validation_objects, b.objects[o].validation_objects);
  }
}

TEST(LeaveOneObjectOut, ValidatesWithAnyOtherObjectButTheTested) {
  const CrossValidation result = leaveOneObjectOut(objects(4, 4, 4), quick(40));
  for (const ObjectResult& object : result.objects) {
    const std::set<std::string> seen(object.validation_objects.begin(), object.validation_objects.end());
    EXPECT_EQ(seen.size(), 3u) << "each of the 3 others has its turn in 40 repeats";
    EXPECT_FALSE(seen.contains(object.object)) << object.object;
  }
}

TEST(LeaveOneObjectOut, DoesNotDependOnTheNumberOfThreads) {
  const GroupedSamples data = objects(4, 25, 5);
  CrossValidationOptions options = quick(3);
  options.threads = 1;
  const CrossValidation one = leaveOneObjectOut(data, options);
  options.threads = 2;
  const CrossValidation two = leaveOneObjectOut(data, options);
  for (std::size_t o = 0; o < 4; ++o) EXPECT_EQ(one.objects[o].s_net, two.objects[o].s_net) << "object " << o;
  options.seed = 2;
  EXPECT_NE(leaveOneObjectOut(data, options).scores, one.scores) << "another seed, other folds";
}

TEST(LeaveOneObjectOut, LeavesObjectsOfEqualSuccessOutOfTheMeanFraction) {
  GroupedSamples data = objects(4, 30, 6);
  data.samples.targets.segment(30, 30).setConstant(0.5);
  const CrossValidation result = leaveOneObjectOut(data, quick(1));
  EXPECT_TRUE(std::isnan(result.objects[1].mean.fraction));
  EXPECT_GT(result.s_net_fraction, 0.5);
}

TEST(LeaveOneObjectOut, RefusesDataThatCannotBeSplit) {
  EXPECT_THAT(errorOf([] { leaveOneObjectOut(objects(2, 10, 7)); }), HasSubstr("2 objects; give at least 3"));
  EXPECT_THAT(errorOf([] { leaveOneObjectOut({test::noSamples(3), {}}); }), HasSubstr("0 objects"));
  GroupedSamples data = objects(3, 5, 8);
  data.objects[0] = "lonely";
  EXPECT_THAT(errorOf([&] { leaveOneObjectOut(data); }), HasSubstr("object 'lonely' has a single grasp"));
  data = objects(3, 5, 9);
  data.objects.pop_back();
  EXPECT_THAT(errorOf([&] { leaveOneObjectOut(data); }), HasSubstr("15 targets and 14 object names"));
  data = objects(3, 5, 10);
  data.samples.targets[3] = NAN;
  EXPECT_THAT(errorOf([&] { leaveOneObjectOut(data, quick(1)); }),
              HasSubstr("cross validation samples: the target in row 3, column 0 is nan"));
}

TEST(LeaveOneObjectOut, RefusesBadOptionsAndStopsWhenAsked) {
  CrossValidationOptions options = quick(0);
  EXPECT_THAT(errorOf([&] { leaveOneObjectOut(objects(3, 5, 11), options); }), HasSubstr("'repeats' is 0"));
  options = quick(1);
  options.threads = -1;
  EXPECT_THAT(errorOf([&] { leaveOneObjectOut(objects(3, 5, 11), options); }), HasSubstr("'threads' is -1"));
  EXPECT_THROW(leaveOneObjectOut(objects(3, 5, 11), quick(1), StopToken(StopToken::Clock::now())), Stopped);
}

}  // namespace
}  // namespace boxgrasp
