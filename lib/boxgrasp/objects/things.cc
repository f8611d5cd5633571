#include <cmath>
#include <numbers>

#include "boxgrasp/objects/shapes.h"

namespace boxgrasp::shapes {
namespace {

const Vector3d kX = Vector3d::UnitX(), kY = Vector3d::UnitY(), kZ = Vector3d::UnitZ();

double square(double x) { return x * x; }

double pillowDistance(const Vector3d& p) {
  constexpr double kSeam = 4.0, kHeight = 30.0;
  const double u = std::abs(p.x()) / (100.0 - 11.0 * std::max(0.0, 1.0 - square(p.y() / 70.0)));
  const double v = std::abs(p.y()) / (70.0 - 8.0 * std::max(0.0, 1.0 - square(p.x() / 100.0)));
  const double outside = std::hypot(95.0 * std::max(u - 1.0, 0.0), 65.0 * std::max(v - 1.0, 0.0));
  const double bulge = std::max(0.0, 1.0 - u * u) * std::max(0.0, 1.0 - v * v);
  const double above = std::abs(p.z() - 34.0) - kHeight * std::pow(bulge, 0.6);
  return (outside > 0.0 ? std::hypot(outside, std::max(above, 0.0)) : above) - kSeam;
}

// Taubin's heart, about 110 wide; only the sign of the polynomial matters.
double heartPolynomial(const Vector3d& p_mm) {
  const Vector3d p = (p_mm - Vector3d(0, 0, 46)) / 47.0;
  const double x = p.x() * p.x(), y = p.y() * p.y(), z3 = p.z() * p.z() * p.z();
  const double ball = x + 2.25 * y + p.z() * p.z() - 1.0;
  return ball * ball * ball - x * z3 - 0.1125 * y * z3;
}

}  // namespace

Shape pen() {
  const Field barrel = roundedCylinder({-4, 0, 6}, kX, 5.5, 58, 1);
  const Field tip = tube({{50, 0, 6}, {66, 0, 6}, {72, 0, 6}}, {5.3, 1.8, 1.2});
  const Field cap = roundedCylinder({-36, 0, 6}, kX, 6.2, 28, 1);
  const Field clip =
      unite({roundedBox({-46, 0, 15.2}, {20, 2.2, 1.2}, 1), roundedBox({-63, 0, 12}, {3, 2.2, 4.4}, 1)});
  return {blend({barrel, tip, cap, clip}, 0.8), {Vector3d(-70, -9, -3), Vector3d(77, 9, 20)}, 0.8};
}

Shape pillow() { return {pillowDistance, {Vector3d(-108, -78, -4), Vector3d(108, 78, 72)}, 2.5}; }

Shape radio() {
  const Field housing = roundedBox({0, 0, 45}, {80, 24, 45}, 6);
  const Field handle =
      tube({{-58, 0, 86}, {-58, 0, 108}, {-50, 0, 116}, {50, 0, 116}, {58, 0, 108}, {58, 0, 86}},
           {5, 5, 5, 5, 5, 5});
  const Field antenna = capsule({72, 12, 86}, {92, 12, 168}, 2.6);
  const Field speaker = torus({-36, -24, 44}, kY, 28, 3);
  const Field knobs =
      unite({roundedCylinder({38, -27, 28}, kY, 12, 7, 1.5), roundedCylinder({60, -27, 62}, kY, 9, 7, 1.5),
             roundedBox({34, -24, 64}, {14, 3, 8}, 1.5)});
  return {blend({housing, handle, antenna, speaker, knobs}, 2),
          {Vector3d(-86, -40, -5), Vector3d(100, 30, 176)},
          2.3};
}

Shape heart() { return {heartPolynomial, {Vector3d(-62, -42, -6), Vector3d(62, 42, 112)}, 2.0}; }

Shape car() {
  const Field body = roundedBox({0, 0, 27}, {80, 33, 15}, 9);
  const Field cabin = roundedBox({-10, 0, 48}, {40, 29, 15}, 12);
  std::vector<Field> wheels;
  for (const double x : {-48.0, 48.0}) {
    for (const double y : {-30.0, 30.0}) wheels.push_back(roundedCylinder({x, y, 15}, kY, 15, 7, 3));
  }
  return {blend({blend({body, cabin}, 14), unite(wheels)}, 2),
          {Vector3d(-85, -42, -4), Vector3d(85, 42, 68)},
          2.0};
}

Shape hammer() {
  const Field handle = tube({{-108, 0, 16}, {-60, 0, 16}, {10, 0, 16}, {95, 0, 16}}, {14, 13, 10, 9});
  const Field head =
      unite({roundedBox({95, 0, 16}, {13, 20, 13}, 3), roundedCylinder({95, -34, 16}, kY, 10, 18, 2),
             roundedCylinder({95, -50, 16}, kY, 14, 9, 2)});
  const Field claw = unite({tube({{95, 14, 20}, {93, 38, 20}, {84, 58, 22}}, {9, 6, 3.5}),
                            tube({{95, 14, 12}, {93, 38, 12}, {84, 58, 10}}, {9, 6, 3.5})});
  return {blend({handle, head, claw}, 4), {Vector3d(-127, -64, -4), Vector3d(114, 67, 36)}, 2.0};
}

// Thick in the middle, bent over 130 degrees, with a stem.
Shape banana() {
  std::vector<Vector3d> points;
  std::vector<double> radii;
  for (double t = -1.0; t <= 1.001; t += 0.1) {
    const double angle = 65.0 * std::numbers::pi / 180.0 * t;
    points.push_back({90.0 * std::sin(angle), 90.0 * (std::cos(angle) - 0.8), 18});
    radii.push_back(t < -0.85 ? 5.0 : 5.0 + 13.0 * std::sqrt(1.0 - square((t - 0.05) / 1.1)));
  }
  return {blend({tube(points, radii), sphere(points.front(), 6)}, 2),
          {Vector3d(-95, -48, -4), Vector3d(98, 42, 40)},
          1.8};
}

Shape dumbbell() {
  const Field grip = tube({{-60, 0, 34}, {0, 0, 34}, {60, 0, 34}}, {12, 14, 12});
  const Field weights =
      unite({roundedCylinder({-72, 0, 34}, kX, 34, 20, 5), roundedCylinder({72, 0, 34}, kX, 34, 20, 5)});
  return {blend({grip, weights}, 4), {Vector3d(-97, -39, -5), Vector3d(97, 39, 73)}, 2.2};
}

// The grip has six grooves.
Shape screwdriver() {
  Field grip =
      tube({{-100, 0, 16}, {-60, 0, 16}, {-22, 0, 16}, {-10, 0, 16}, {0, 0, 16}}, {12.5, 15.5, 14, 10, 11});
  for (int i = 0; i < 6; ++i) {
    const double angle = std::numbers::pi / 3.0 * i;
    const Vector3d side = 18.0 * Vector3d(0, std::cos(angle), std::sin(angle)) + Vector3d(0, 0, 16);
    grip = subtract(grip, capsule(side - 98 * kX, side - 30 * kX, 5), 2);
  }
  const Field shaft = roundedCylinder({52, 0, 16}, kX, 3.5, 58, 1);
  const Field blade = roundedBox({106, 0, 16}, {8, 4.5, 1.5}, 1);
  return {blend({grip, shaft, blade}, 3), {Vector3d(-117, -20, -4), Vector3d(119, 20, 36)}, 1.5};
}

Shape ring() { return {torus({0, 0, 16}, kZ, 50, 16), {Vector3d(-70, -70, -4), Vector3d(70, 70, 36)}, 2.0}; }

}  // namespace boxgrasp::shapes
