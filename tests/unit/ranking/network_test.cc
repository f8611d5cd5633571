#include "boxgrasp/ranking/network.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "boxgrasp/base/error.h"
#include "random_network.h"

namespace boxgrasp {
namespace {

using test::randomMatrix;
using test::randomNetwork;
using ::testing::HasSubstr;

std::string messageOf(const Network& network) {
  try {
    network.validate();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

// One input in [2, 6], one hidden node, output in [10, 20].
Network byHand() {
  Network network;
  network.input = {VectorXd::Constant(1, 2.0), VectorXd::Constant(1, 6.0)};
  network.output = {VectorXd::Constant(1, 10.0), VectorXd::Constant(1, 20.0)};
  network.layers = {{MatrixXd::Constant(1, 1, 3.0), VectorXd::Constant(1, -1.0)},
                    {MatrixXd::Constant(1, 1, 0.5), VectorXd::Constant(1, 0.25)}};
  return network;
}

TEST(Normalisation, MapsTheRangeToMinusOneToOneAndBack) {
  const Normalisation n{Eigen::Vector3d(0, -4, 1e300), Eigen::Vector3d(10, -2, 1.5e308)};
  EXPECT_EQ(n.apply(n.min), Eigen::Vector3d(-1, -1, -1));
  EXPECT_EQ(n.apply(n.max), Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(n.apply(Eigen::Vector3d(5, -3, 1e300)).head(2), Eigen::Vector2d(0, 0));
  EXPECT_TRUE(
      n.invert(n.apply(Eigen::Vector3d(1, -2.5, 1e307))).isApprox(Eigen::Vector3d(1, -2.5, 1e307), 1e-14));
}

TEST(Normalisation, MapsAConstantFeatureToZeroAndBackToItself) {
  const Normalisation n{VectorXd::Constant(1, 7.5), VectorXd::Constant(1, 7.5)};
  EXPECT_EQ(n.apply(VectorXd::Constant(1, 7.5))[0], 0.0);
  EXPECT_EQ(n.apply(VectorXd::Constant(1, 99.0))[0], 0.0);
  EXPECT_EQ(n.invert(VectorXd::Constant(1, 0.3))[0], 7.5);
}

TEST(Normalisation, DoesNotOverflowForTheLargestRange) {
  const double most = std::numeric_limits<double>::max();
  const Normalisation n{VectorXd::Constant(1, -most), VectorXd::Constant(1, most)};
  EXPECT_EQ(n.apply(VectorXd::Constant(1, most))[0], 1.0);
  EXPECT_EQ(n.invert(VectorXd::Constant(1, -1.0))[0], -most);
}

// x = 5 is 0.5 in normalised units: output 0.25 + 0.5 tanh(3 * 0.5 - 1), then 15 + 5 times that.
TEST(Network, ScoresAsComputedByHand) {
  EXPECT_NEAR(score(byHand(), VectorXd::Constant(1, 5.0)), 15.0 + 5.0 * (0.25 + 0.5 * std::tanh(0.5)), 1e-13);
}

TEST(Network, ClampsInputsTo1Point5TimesTheirRange) {
  const Network network = byHand();
  const auto at = [&](double x) { return score(network, VectorXd::Constant(1, x)); };
  EXPECT_EQ(at(7.0), at(1e9)) << "4 + 1.5 * 2 = 7 is the clamp's upper end";
  EXPECT_EQ(at(1.0), at(-1e300)) << "4 - 1.5 * 2 = 1 is its lower end";
  EXPECT_NE(at(6.9), at(7.0));
  EXPECT_TRUE(std::isnan(at(std::nan(""))));
}

TEST(Network, ScoresEachRowToTheBitAsAlone) {
  const Network network = randomNetwork({9, 8, 5}, 3);
  std::mt19937_64 random(4);
  const MatrixXd measures = randomMatrix(77, 9, random);
  const VectorXd all = scores(network, measures);
  ASSERT_EQ(all.size(), 77);
  for (Eigen::Index i = 0; i < 77; ++i)
    EXPECT_EQ(all[i], score(network, measures.row(i).transpose())) << "row " << i;
}

TEST(Network, ScoresNoGraspsAtAll) { EXPECT_EQ(scores(byHand(), MatrixXd(0, 1)).size(), 0); }

TEST(Network, WithoutHiddenLayersIsLinear) {
  Network network = randomNetwork({3}, 5);
  const VectorXd a = network.input.min, b = network.input.max;
  EXPECT_NEAR(score(network, 0.5 * (a + b)), 0.5 * (score(network, a) + score(network, b)), 1e-12);
}

TEST(Network, AcceptsWhatFitsTogether) {
  EXPECT_EQ(messageOf(randomNetwork({9, 8}, 1)), "accepted");
  EXPECT_EQ(messageOf(randomNetwork({1, 2, 3, 4, 5, 6, 7, 8}, 1)), "accepted");
  EXPECT_EQ(messageOf(randomNetwork({1024, 1}, 1)), "accepted");
}

TEST(Network, NamesWhatDoesNotFit) {
  const auto spoil = [](const std::function<void(Network&)>& change) {
    Network network = randomNetwork({9, 8}, 1);
    change(network);
    return messageOf(network);
  };
  EXPECT_THAT(spoil([](Network& n) { n.layers[0].weights.resize(8, 7); }),
              HasSubstr("layers[0] takes 7 inputs, but is given 9"));
  EXPECT_THAT(spoil([](Network& n) { n.layers[1].bias.resize(2); }),
              HasSubstr("layers[1] has 2 biases for 1 nodes"));
  EXPECT_THAT(spoil([](Network& n) { n.layers[1].weights(0, 3) = NAN; }),
              HasSubstr("layers[1] has a number that is not finite"));
  EXPECT_THAT(spoil([](Network& n) { n.layers[0].bias[0] = INFINITY; }),
              HasSubstr("layers[0] has a number that is not finite"));
  EXPECT_THAT(spoil([](Network& n) { n.layers.pop_back(); }), HasSubstr("the last layer has 8 nodes"));
  EXPECT_THAT(spoil([](Network& n) { n.layers.clear(); }), HasSubstr("layers are 0"));
  EXPECT_THAT(spoil([](Network& n) { n.input.max.resize(8); }), HasSubstr("input has 9 minima and 8 maxima"));
  EXPECT_THAT(spoil([](Network& n) { n.input.min[2] = NAN; }),
              HasSubstr("input has a number that is not finite"));
  EXPECT_THAT(spoil([](Network& n) { n.output.min[0] = 2.0; }),
              HasSubstr("output has a minimum above its maximum"));
  EXPECT_THAT(spoil([](Network& n) { n.output.max.resize(2); }),
              HasSubstr("output has 1 minima and 2 maxima"));
  EXPECT_THAT(messageOf(randomNetwork({1, 1, 1, 1, 1, 1, 1, 1, 1}, 1)),
              HasSubstr("layers are 9, but must be 1 to 8"));
  EXPECT_THAT(messageOf(randomNetwork({1, 1025}, 1)), HasSubstr("has 1025 nodes"));
  EXPECT_THAT(messageOf(randomNetwork({1025}, 1)), HasSubstr("input has 1025 features"));
  EXPECT_THAT(messageOf(Network{}), HasSubstr("input has 0 features"));
}

}  // namespace
}  // namespace boxgrasp
