#include "boxgrasp/simulation/object.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "boxgrasp/base/error.h"
#include "solids.h"

namespace boxgrasp {
namespace {

using ::testing::HasSubstr;

std::string refusal(const TriangleMesh& mesh) {
  try {
    makeSimulatedObject(mesh);
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(SimulatedObject, OfABoxHasTheMassOfItsVolume) {
  const SimulatedObject box =
      makeSimulatedObject(boxMesh({0.1, 0.06, 0.04}), {.density_kg_m3 = 1000, .field = {}});
  EXPECT_NEAR(box.mass_kg, 0.24, 1e-9);
  EXPECT_NEAR(box.inertia_O(0, 0), 0.24 * (0.06 * 0.06 + 0.04 * 0.04) / 12, 1e-9);
  EXPECT_NEAR(box.largest_distance_m, 0.5 * Vector3d(0.1, 0.06, 0.04).norm(), 1e-9);
}

TEST(SimulatedObject, RefusesWhatIsNoSolidAndSaysWhy) {
  TriangleMesh open = boxMesh({0.1, 0.1, 0.1});
  open.triangles.pop_back();
  EXPECT_THAT(refusal(open), HasSubstr("open edges"));
  TriangleMesh flipped = boxMesh({0.1, 0.1, 0.1});
  std::swap(flipped.triangles[3][0], flipped.triangles[3][1]);
  EXPECT_THAT(refusal(flipped), HasSubstr("orient"));
  TriangleMesh inside_out = boxMesh({0.1, 0.1, 0.1});
  for (auto& triangle : inside_out.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_THAT(refusal(inside_out), HasSubstr("inside out"));
  EXPECT_THAT(refusal({}), HasSubstr("no triangles"));
  TriangleMesh broken = boxMesh({0.1, 0.1, 0.1});
  broken.vertices[2].y() = NAN;
  EXPECT_THAT(refusal(broken), HasSubstr("vertex 2"));
}

TEST(SimulatedObject, RefusesMillimetres) {
  EXPECT_THAT(refusal(boxMesh({100, 100, 100})), HasSubstr("scale it to metres"));
  EXPECT_THAT(refusal(boxMesh({1e-5, 1e-5, 1e-5})), HasSubstr("scale it to metres"));
}

TEST(SimulatedObject, RefusesANegativeDensity) {
  EXPECT_THROW(makeSimulatedObject(boxMesh({0.1, 0.1, 0.1}), {.density_kg_m3 = -1, .field = {}}), InputError);
}

}  // namespace
}  // namespace boxgrasp
