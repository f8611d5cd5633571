#include "boxgrasp/ranking/ensemble.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "error_of.h"
#include "random_network.h"

namespace boxgrasp {
namespace {

using test::randomMatrix;
using test::randomNetwork;
using ::testing::HasSubstr;

Ensemble threeNetworks() {
  return {{randomNetwork({4, 3}, 1), randomNetwork({4, 8}, 2), randomNetwork({4}, 3)}, std::nullopt};
}

MatrixXd someMeasures() {
  std::mt19937_64 random(5);
  return randomMatrix(40, 4, random);
}

TEST(Ensemble, IsTheMeanOfItsNetworks) {
  const Ensemble ensemble = threeNetworks();
  const MatrixXd measures = someMeasures();
  VectorXd mean = VectorXd::Zero(40);
  for (const Network& network : ensemble.networks) mean += scores(network, measures) / 3;
  EXPECT_TRUE(scores(ensemble, measures).isApprox(mean, 1e-14));
}

TEST(Ensemble, OfOneNetworkIsTheNetworkToTheBit) {
  const Network network = randomNetwork({4, 3}, 1);
  EXPECT_EQ(scores(Ensemble{{network}, std::nullopt}, someMeasures()), scores(network, someMeasures()));
}

TEST(Ensemble, CalibratedGivesProbabilitiesInTheSameOrder) {
  Ensemble ensemble = threeNetworks();
  const VectorXd plain = scores(ensemble, someMeasures());
  ensemble.calibration = {3.0, -1.0};
  const VectorXd probabilities = scores(ensemble, someMeasures());
  for (Eigen::Index i = 0; i < plain.size(); ++i) {
    EXPECT_NEAR(probabilities[i], 1.0 / (1.0 + std::exp(1.0 - 3.0 * plain[i])), 1e-15);
    for (Eigen::Index j = 0; j < i; ++j) EXPECT_EQ(plain[i] < plain[j], probabilities[i] < probabilities[j]);
  }
}

TEST(Ensemble, CalibratedStaysWithinItsBounds) {
  const VectorXd p = calibrated({1.0, 0.0}, Eigen::Vector4d(-1e300, 0.0, 1e300, NAN));
  EXPECT_GE(p[0], 0.0);
  EXPECT_LT(p[0], 1e-16);
  EXPECT_EQ(p[1], 0.5);
  EXPECT_EQ(p[2], 1.0);
  EXPECT_TRUE(std::isnan(p[3]));
}

TEST(Ensemble, RefusesWhatCannotScore) {
  const auto error = [](const Ensemble& ensemble) { return test::errorOf([&] { ensemble.validate(); }); };
  EXPECT_NO_THROW(threeNetworks().validate());
  EXPECT_THAT(error({}), HasSubstr("0 networks"));
  EXPECT_THAT(error({std::vector<Network>(65, randomNetwork({1}, 1)), std::nullopt}),
              HasSubstr("65 networks"));
  Ensemble ensemble = threeNetworks();
  ensemble.networks[2] = randomNetwork({5}, 1);
  EXPECT_THAT(error(ensemble), HasSubstr("networks[2] takes 5 inputs, but networks[0] 4"));
  ensemble = threeNetworks();
  ensemble.networks[1].layers[0].bias[0] = NAN;
  EXPECT_THAT(error(ensemble), HasSubstr("networks[1]: network: layers[0]"));
  for (const double slope : {0.0, -1.0, double(INFINITY), double(NAN)}) {
    ensemble = threeNetworks();
    ensemble.calibration = {slope, 0.0};
    EXPECT_THAT(error(ensemble), HasSubstr("calibration.slope"));
  }
  ensemble.calibration = {1.0, NAN};
  EXPECT_THAT(error(ensemble), HasSubstr("calibration.offset"));
}

}  // namespace
}  // namespace boxgrasp
