// Random contacts for the tests of grasp wrench spaces.
#pragma once

#include <vector>

#include "boxgrasp/base/random.h"
#include "boxgrasp/wrench/contact.h"

namespace boxgrasp::test {

inline constexpr double kGraspRadius = 0.05;  // metres

inline Vector3d randomDirection(std::mt19937_64& random) {
  const double x = normal(random), y = normal(random), z = normal(random);
  return Vector3d(x, y, z).normalized();
}

// On a sphere about the origin, with normals that are off its own by some ten degrees.
inline Contact randomContact(std::mt19937_64& random) {
  const Vector3d outward = randomDirection(random);
  return {kGraspRadius * outward, (0.2 * randomDirection(random) - outward).normalized()};
}

inline std::vector<Contact> randomGrasp(std::mt19937_64& random, std::size_t contacts) {
  std::vector<Contact> result(contacts);
  for (Contact& contact : result) contact = randomContact(random);
  return result;
}

}  // namespace boxgrasp::test
