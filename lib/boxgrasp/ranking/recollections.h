// What held on objects whose boxes lie alike: whole constellations compared, so that what held on a similar
// one informs the ranking (a wish of the paper, V).
#pragma once

#include <Eigen/Core>
#include <bitset>
#include <vector>

namespace boxgrasp {

// The leaf boxes of an object, as the cells of a cube that they fill. The cube is centred on the root box and
// turned like it; its side is the root's longest extent, the unit of lengths here.
struct Constellation {
  static constexpr int kSide = 16;  // cells along each edge of the cube
  using Cells = std::bitset<kSide * kSide * kSide>;

  double unit_m = -1.0;
  Cells cells;  // x runs fastest, from the cube's negative side
};

// Where a hand grasps an object, in the frame and the unit of its constellation.
struct GraspPlace {
  Eigen::Vector3d contacts;  // their mean
  Eigen::Vector3d approach;  // unit
  Eigen::Vector3d thumb;     // unit: from the middle of F1 and F2 to the thumb
};

// An object that was grasped before.
struct Recollection {
  static constexpr std::size_t kMaxObjects = 4096, kMaxGrasps = 1024;

  Constellation constellation;
  std::vector<GraspPlace> places;
  Eigen::VectorXd surprises;  // for each place, what became of it less the score of networks that had not
                              // seen the object
  // Throws InputError for numbers that do not fit together, are not finite, or no places.
  void validate() const;
};

// How near something must be to count: each weight falls as a normal density with these deviations.
struct RecallOptions {
  bool enabled = false;
  double overlap = 0.1;  // of 1 - the share of cells that both fill
  double size = 0.4;     // of the logarithm of the ratio of the units: the hand does not grow with the object
  double contacts = 0.1;   // of the distance of the mean contacts, in units
  double angle_rad = 0.4;  // of the approaches, and of the thumbs
  double own_weight =
      4.0;  // grasps in the same place whose surprises weigh as much as the networks' own score
  void validate() const;
};

// The share of the cells which either fills that both fill, for each of the 24 turns of b's cube onto a's.
std::vector<double> overlaps(const Constellation& a, const Constellation& b);

// What to add to the networks' scores of grasps on one object: the mean of the surprises in the same place on
// similar objects, each as often as it is near, and of `own_weight` times none. A remembered grasp counts in
// the turn of its object that brings it nearest. Turning the object changes nothing.
Eigen::VectorXd corrections(const Constellation& constellation, const std::vector<GraspPlace>& places,
                            const std::vector<Recollection>& recollections, const RecallOptions& options);

}  // namespace boxgrasp
