#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "boxgrasp/wrench/grasp_wrench_space.h"

namespace boxgrasp {
namespace {

using nlohmann::json;

constexpr char kOracle[] = BOXGRASP_SOURCE_DIR "/../shared/oracle/gws_cases.json";

Vector3d vectorOf(const json& value) {
  return Vector3d(value[0].get<double>(), value[1].get<double>(), value[2].get<double>());
}

std::vector<Contact> contactsOf(const json& value) {
  std::vector<Contact> result;
  for (const json& contact : value["contacts"]) {
    result.push_back({vectorOf(contact["position_mm"]) * 1e-3,
                      vectorOf(contact["inward_normal"]).normalized(), contact.value("mu", -1.0)});
  }
  return result;
}

WrenchOptions optionsOf(const json& value) {
  WrenchOptions result;
  if (!value["mu"].is_null()) result.friction = value["mu"];  // null: every contact brings its own
  result.cone_edges = value["cone_edges"];
  result.p_CG = vectorOf(value["cog_mm"]) * 1e-3;
  result.torque_scale_m = value["torque_scale_mm"].get<double>() * 1e-3;
  return result;
}

void expectOracle(const json& value) {
  const auto contacts = contactsOf(value);
  const WrenchOptions options = optionsOf(value);
  const GraspQuality got = graspQuality(contacts, options);
  const double volume = value["volume"];
  EXPECT_NEAR(got.volume, volume, 1e-6 * volume);
  EXPECT_EQ(forceClosure(contacts, options), got.force_closure) << "without the hull, and with it";
  if (value["borderline"]) return;
  EXPECT_EQ(got.force_closure, value["force_closure"].get<bool>());
  const double epsilon = value["epsilon"];
  EXPECT_NEAR(got.epsilon, epsilon, 1e-6 * std::abs(epsilon));
}

TEST(GraspQuality, EqualsACertifiedHull) {
  if (!std::filesystem::exists(kOracle)) GTEST_SKIP() << "no reference values at " << kOracle;
  const json oracle = json::parse(std::ifstream(kOracle));
  ASSERT_FALSE(oracle["cases"].empty());
  for (const json& value : oracle["cases"]) {
    SCOPED_TRACE(value["name"].get<std::string>());
    expectOracle(value);
  }
}

}  // namespace
}  // namespace boxgrasp
