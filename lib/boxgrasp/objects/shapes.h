// The recipes of the parametric objects. Everything here is in millimetres, as one measures such things; z is
// up, and objects stand or lie on the plane z = 0, about the z axis.
#pragma once

#include "boxgrasp/objects/field.h"

namespace boxgrasp::shapes {

struct Shape {
  Field field;
  Eigen::AlignedBox3d bounds;  // holds the surface with at least a cell to spare
  double cell;                 // of the marching cubes: no detail is much smaller
};

// Vessels (vessels.cc). All but bottle, spray can and teapot are open and have a real cavity.
Shape mug();
Shape cup();
Shape goblet();
Shape paperCup();
Shape bowl();
Shape bottle();
Shape sprayCan();
Shape teapot();

// Things (things.cc).
Shape pen();
Shape pillow();
Shape radio();
Shape heart();
Shape car();
Shape hammer();
Shape banana();
Shape dumbbell();
Shape screwdriver();
Shape ring();

// Figures (figures.cc).
Shape duck();
Shape bunny();
Shape goose();
Shape horse();
Shape human();
Shape homer();
Shape squirrel();
Shape toyDog();

}  // namespace boxgrasp::shapes
