#include "boxgrasp/objects/shapes.h"

namespace boxgrasp::shapes {
namespace {

// Turned from the line along its outside, from the middle of its foot to the rim, and back along its inside.
Field turned(const std::vector<Vector2d>& outside, const std::vector<Vector2d>& inside) {
  std::vector<Vector2d> profile = smoothed(outside);
  const std::vector<Vector2d> back = smoothed(inside);
  profile.insert(profile.end(), back.begin(), back.end());
  return revolved(profile, 1);
}

const Vector3d kX = Vector3d::UnitX(), kY = Vector3d::UnitY(), kZ = Vector3d::UnitZ();

}  // namespace

// The cavity is cut after the handle is joined, so that the handle does not reach into it.
Shape mug() {
  const Field body = roundedCylinder({0, 0, 45}, kZ, 41, 45, 2);
  const Field handle = torus({40, 0, 46}, kY, 26, 6);
  const Field cavity = roundedCylinder({0, 0, 66}, kZ, 36.5, 60, 4);
  return {
      subtract(blend({body, handle}, 5), cavity, 1.5), {Vector3d(-45, -45, -4), Vector3d(76, 45, 94)}, 1.8};
}

Shape cup() {
  const Field body =
      turned({{0, 1}, {24, 1}, {24, 5}, {38, 24}, {43, 61}}, {{40, 61}, {34, 27}, {21, 9}, {0, 8}});
  const Field handle = tube({{44, 0, 52}, {56, 0, 53}, {64, 0, 45}, {62, 0, 33}, {52, 0, 24}, {39, 0, 21}},
                            {3.5, 3.5, 4, 4, 3.5, 3.5});
  return {blend({body, handle}, 3), {Vector3d(-48, -48, -4), Vector3d(72, 48, 66)}, 1.6};
}

Shape goblet() {
  const Field body =
      turned({{0, 1}, {36, 1}, {36, 3}, {8, 7}, {5, 22}, {5, 66}, {6, 84}, {34, 90}, {40, 125}, {35, 158}},
             {{32, 158}, {37, 125}, {29, 95}, {0, 90}});
  return {body, {Vector3d(-41, -41, -4), Vector3d(41, 41, 163)}, 1.7};
}

// A frustum with a recessed bottom and a rolled rim.
Shape paperCup() {
  const Field body =
      revolved({{0, 8}, {25, 8}, {24.5, 1}, {27.5, 1}, {38, 94}, {35, 94}, {28, 12}, {0, 12}}, 0.8);
  return {
      blend({body, torus({0, 0, 94}, kZ, 37, 3)}, 1), {Vector3d(-45, -45, -4), Vector3d(45, 45, 101)}, 1.7};
}

Shape bowl() {
  const Field body = turned({{0, 3}, {26, 3}, {27, 1}, {31, 1}, {32, 5}, {62, 22}, {75, 64}},
                            {{71.5, 64}, {57, 27}, {30, 9}, {0, 8}});
  return {body, {Vector3d(-80, -80, -4), Vector3d(80, 80, 69)}, 2.0};
}

Shape bottle() {
  const Field body = revolved(smoothed<Vector2d>({{0, 2},
                                                  {34, 2},
                                                  {34, 12},
                                                  {34, 60},
                                                  {34, 118},
                                                  {32, 146},
                                                  {13, 158},
                                                  {12, 178},
                                                  {12, 190},
                                                  {0, 190}}),
                              2);
  const Field cap = roundedCylinder({0, 0, 201}, kZ, 15.5, 11, 1.5);
  return {blend({body, cap}, 1.5), {Vector3d(-40, -40, -4), Vector3d(40, 40, 216)}, 2.0};
}

Shape sprayCan() {
  const Field body =
      revolved({{0, 1}, {31, 1}, {32, 3}, {32, 146}, {30, 150}, {22, 160}, {14, 163}, {0, 163}}, 1);
  const Field button = roundedCylinder({0, 0, 172}, kZ, 10, 13, 2);
  const Field nozzle = roundedCylinder({8, 0, 178}, kX, 3.5, 5, 1);
  return {blend({body, button, nozzle}, 2), {Vector3d(-37, -37, -4), Vector3d(37, 37, 189)}, 1.8};
}

// With its lid on: closed.
Shape teapot() {
  const Field belly = ellipsoid({0, 0, 48}, {62, 62, 46});
  const Field foot = roundedCylinder({0, 0, 5}, kZ, 36, 5, 2);
  const Field lid = unite({roundedCylinder({0, 0, 92}, kZ, 30, 4, 2), sphere({0, 0, 103}, 9)});
  const Field spout = tube({{48, 0, 36}, {74, 0, 50}, {88, 0, 74}, {102, 0, 88}}, {17, 13, 9, 7});
  const Field handle =
      tube({{-50, 0, 74}, {-74, 0, 84}, {-94, 0, 74}, {-98, 0, 54}, {-86, 0, 36}, {-56, 0, 26}},
           {6.5, 6.5, 6.5, 6.5, 6.5, 6.5});
  return {
      blend({belly, foot, lid, spout, handle}, 6), {Vector3d(-109, -67, -4), Vector3d(114, 67, 117)}, 2.5};
}

}  // namespace boxgrasp::shapes
