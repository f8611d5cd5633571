#include "boxgrasp/objects/shapes.h"

namespace boxgrasp::shapes {
namespace {

// The part and its mirror image in the plane y = 0.
Field pair(const Field& part) {
  return unite({part, [part](const Vector3d& p) { return part({p.x(), -p.y(), p.z()}); }});
}

}  // namespace

Shape duck() {
  const Field body = ellipsoid({0, 0, 38}, {58, 42, 37});
  const Field tail = cone({-40, 0, 48}, {-66, 0, 66}, 16, 4);
  const Field head = sphere({36, 0, 88}, 27);
  const Field beak = ellipsoid({66, 0, 84}, {17, 14, 6});
  const Field wings = pair(ellipsoid({-8, 36, 44}, {30, 10, 18}));
  return {blend({body, tail, head, beak, wings}, 10), {Vector3d(-78, -54, -6), Vector3d(90, 54, 122)}, 2.2};
}

Shape bunny() {
  const Field body = ellipsoid({-8, 0, 42}, {48, 36, 40});
  const Field head = ellipsoid({38, 0, 86}, {27, 23, 24});
  const Field ears = pair(tube({{28, 9, 102}, {16, 15, 128}, {8, 19, 148}}, {7, 9, 5}));
  const Field tail = sphere({-56, 0, 30}, 14);
  const Field feet =
      pair(unite({ellipsoid({30, 22, 9}, {22, 11, 9}), ellipsoid({-12, 30, 16}, {28, 14, 16})}));
  return {blend({body, head, ears, tail, feet}, 8), {Vector3d(-76, -52, -6), Vector3d(72, 52, 162)}, 2.4};
}

Shape goose() {
  const Field body = ellipsoid({-12, 0, 46}, {66, 36, 34});
  const Field base = roundedCylinder({-10, 0, 6}, Vector3d::UnitZ(), 30, 6, 3);
  const Field neck = tube({{38, 0, 58}, {54, 0, 84}, {52, 0, 112}, {46, 0, 138}}, {18, 12, 10, 10});
  const Field head = ellipsoid({54, 0, 148}, {19, 14, 14});
  const Field beak = cone({66, 0, 146}, {88, 0, 141}, 8, 4);
  const Field tail = cone({-60, 0, 54}, {-92, 0, 68}, 18, 5);
  return {
      blend({body, base, neck, head, beak, tail}, 8), {Vector3d(-104, -44, -6), Vector3d(98, 44, 170)}, 2.5};
}

Shape horse() {
  const Field body = ellipsoid({0, 0, 92}, {62, 25, 27});
  const Field legs = pair(unite({tube({{42, 15, 84}, {44, 16, 44}, {44, 16, 8}}, {13, 7, 7.5}),
                                 tube({{-44, 15, 84}, {-50, 16, 44}, {-45, 16, 8}}, {15, 7.5, 7.5})}));
  const Field neck = tube({{44, 0, 100}, {62, 0, 128}, {74, 0, 148}}, {20, 15, 12});
  const Field head = cone({74, 0, 152}, {104, 0, 128}, 13, 8);
  const Field ears = pair(cone({70, 7, 160}, {70, 9, 172}, 5, 3));
  const Field tail = tube({{-58, 0, 102}, {-76, 0, 84}, {-80, 0, 52}}, {7, 8, 4});
  return {
      blend({body, legs, neck, head, ears, tail}, 6), {Vector3d(-92, -36, -6), Vector3d(120, 36, 182)}, 2.5};
}

Shape human() {
  const Field torso = tube({{0, 0, 96}, {0, 0, 118}, {0, 0, 146}}, {20, 18, 22});
  const Field head = ellipsoid({0, 0, 192}, {16, 15, 19});
  const Field neck = capsule({0, 0, 160}, {0, 0, 180}, 8);
  const Field arms = pair(tube({{0, 24, 156}, {2, 40, 128}, {10, 48, 98}}, {10, 8, 7}));
  const Field legs = pair(tube({{0, 12, 96}, {2, 16, 52}, {-2, 18, 12}}, {14, 11, 9}));
  const Field feet = pair(roundedBox({7, 18, 7}, {20, 10, 7}, 5));
  return {
      blend({torso, head, neck, arms, legs, feet}, 7), {Vector3d(-30, -62, -6), Vector3d(36, 62, 218)}, 2.3};
}

// Standing with the arms away from the belly: a tall round head with bulging eyes and a broad muzzle.
Shape homer() {
  const Field belly = blend({ellipsoid({4, 0, 74}, {33, 34, 32}), ellipsoid({-2, 0, 112}, {22, 27, 24})}, 14);
  const Field neck = roundedCylinder({-2, 0, 140}, Vector3d::UnitZ(), 13, 12, 3);
  const Field head = tube({{-2, 0, 158}, {-1, 0, 176}, {-2, 0, 194}}, {21, 21, 17});
  const Field muzzle = ellipsoid({16, 0, 158}, {17, 17, 11});
  const Field eyes = pair(sphere({17, 8.5, 181}, 9));
  const Field nose = capsule({20, 0, 172}, {32, 0, 170}, 4.5);
  const Field ears = pair(sphere({-4, 22, 170}, 5));
  const Field arms = pair(tube({{-2, 24, 120}, {0, 44, 96}, {8, 54, 68}}, {11, 8, 7}));
  const Field hands = pair(ellipsoid({10, 55, 58}, {8, 6, 10}));
  const Field legs = pair(tube({{0, 16, 58}, {0, 18, 36}, {-2, 18, 12}}, {18, 15, 11}));
  const Field shoes = pair(ellipsoid({10, 19, 8}, {25, 13, 8}));
  const Field body = blend({belly, neck, arms, hands, legs, shoes}, 6);
  const Field face = blend({head, muzzle, eyes, nose, ears}, 2);
  return {blend({body, face}, 3), {Vector3d(-38, -68, -6), Vector3d(45, 68, 218)}, 2.2};
}

Shape squirrel() {
  const Field body = tube({{-6, 0, 32}, {0, 0, 56}, {8, 0, 80}}, {30, 25, 19});
  const Field head = ellipsoid({20, 0, 108}, {24, 19, 20});
  const Field ears = pair(cone({10, 11, 124}, {6, 14, 138}, 6, 3));
  const Field tail =
      tube({{-28, 0, 14}, {-56, 0, 30}, {-62, 0, 66}, {-52, 0, 100}, {-62, 0, 124}, {-78, 0, 126}},
           {11, 15, 19, 19, 14, 9});
  const Field arms = pair(tube({{12, 18, 76}, {28, 18, 62}, {36, 8, 68}}, {8, 7, 6}));
  const Field feet = pair(ellipsoid({16, 20, 9}, {26, 11, 9}));
  return {
      blend({body, head, ears, tail, arms, feet}, 7), {Vector3d(-98, -46, -6), Vector3d(56, 46, 150)}, 2.4};
}

Shape toyDog() {
  const Field body = capsule({-38, 0, 62}, {30, 0, 64}, 24);
  const Field legs =
      pair(unite({capsule({28, 15, 56}, {32, 17, 11}, 11), capsule({-38, 15, 56}, {-40, 17, 11}, 11)}));
  const Field head = sphere({56, 0, 98}, 25);
  const Field snout = cone({72, 0, 92}, {92, 0, 88}, 14, 10);
  const Field ears = pair(tube({{50, 21, 110}, {50, 30, 96}, {54, 31, 80}}, {7, 8, 7}));
  const Field tail = tube({{-56, 0, 74}, {-72, 0, 94}, {-76, 0, 112}}, {8, 6, 5});
  return {
      blend({body, legs, head, snout, ears, tail}, 7), {Vector3d(-92, -48, -6), Vector3d(110, 48, 134)}, 2.5};
}

}  // namespace boxgrasp::shapes
