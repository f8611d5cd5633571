#include "boxgrasp/rendering/hand_mesh.h"

#include <cmath>
#include <numbers>

namespace boxgrasp {
namespace {

constexpr std::uint32_t kSides = 20;
constexpr int kCapRings = 5;  // from the equator to the pole of a capsule's end

// One ring of vertices about the axis; `height` along z from `origin`.
void addRing(TriangleMesh& mesh, const Vector3d& origin, const Matrix3d& axes, double radius, double height) {
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    mesh.vertices.push_back(origin +
                            axes * Vector3d(radius * std::cos(angle), radius * std::sin(angle), height));
  }
}

void joinRings(TriangleMesh& mesh, std::uint32_t rings) {
  for (std::uint32_t r = 0; r + 1 < rings; ++r) {
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const std::uint32_t a = r * kSides + i, b = r * kSides + (i + 1) % kSides;
      mesh.triangles.push_back({a, b, b + kSides});
      mesh.triangles.push_back({a, b + kSides, a + kSides});
    }
  }
}

Matrix3d axesAlong(const Vector3d& a, const Vector3d& b) {
  const Vector3d z = (b - a).norm() > 0 ? Vector3d((b - a).normalized()) : Vector3d::UnitZ();
  const Vector3d x = z.unitOrthogonal();
  Matrix3d axes;
  axes << x, z.cross(x), z;
  return axes;
}

}  // namespace

TriangleMesh capsuleMesh(const Vector3d& a, const Vector3d& b, double radius) {
  TriangleMesh mesh;
  const Matrix3d axes = axesAlong(a, b);
  for (int ring = -kCapRings; ring <= kCapRings; ++ring) {
    const double latitude = std::numbers::pi / 2 * ring / kCapRings;
    addRing(mesh, ring < 0 ? a : b, axes, radius * std::cos(latitude), radius * std::sin(latitude));
    if (ring == 0) addRing(mesh, a, axes, radius, 0.0);
  }
  joinRings(mesh, 2 * kCapRings + 2);
  return mesh;
}

TriangleMesh cylinderMesh(const Vector3d& a, const Vector3d& b, double radius) {
  TriangleMesh mesh;
  const Matrix3d axes = axesAlong(a, b);
  addRing(mesh, a, axes, 0.0, 0.0);
  addRing(mesh, a, axes, radius, 0.0);
  addRing(mesh, b, axes, radius, 0.0);
  addRing(mesh, b, axes, 0.0, 0.0);
  joinRings(mesh, 4);
  return mesh;
}

DrawnPart palmMesh(const HandDescription& hand) {
  return {cylinderMesh({0, 0, -hand.palm_thickness}, {0, 0, 0}, hand.palm_radius), -1};
}

DrawnPart linkMesh(const Capsule& link) { return {capsuleMesh(link.a, link.b, link.radius), link.finger}; }

std::vector<DrawnPart> handMesh(const HandDescription& hand, const HandJoints& joints) {
  std::vector<DrawnPart> parts{palmMesh(hand)};
  for (const Capsule& link : forwardKinematics(hand, joints).links) parts.push_back(linkMesh(link));
  return parts;
}

Colour fingerColour(int finger) {
  constexpr std::array<Colour, 4> kColours{{{150, 150, 160}, {214, 90, 60}, {60, 130, 214}, {70, 170, 90}}};
  return kColours[static_cast<std::size_t>(finger + 1)];
}

}  // namespace boxgrasp
