// What goes into a plan and what comes out.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "boxgrasp/cloud/clean.h"
#include "boxgrasp/cloud/completion.h"
#include "boxgrasp/cloud/scene.h"
#include "boxgrasp/decomposition/decompose.h"
#include "boxgrasp/decomposition/shape.h"
#include "boxgrasp/hand/clearance.h"
#include "boxgrasp/hand/contacts.h"
#include "boxgrasp/planning/robot.h"
#include "boxgrasp/projection/face_image.h"
#include "boxgrasp/quality/measures.h"
#include "boxgrasp/ranking/model_file.h"
#include "boxgrasp/synthesis/triplets.h"

namespace boxgrasp {

// require: grasps without it are dropped. ignore: the network alone decides.
enum class ForceClosureUse { require, prefer, ignore };

struct PlannerOptions {
  ValidationOptions validation;
  SceneOptions scene;
  CleanOptions clean;
  CompletionOptions completion;
  DecompositionOptions decomposition;
  FaceOptions faces;
  ImageOptions image;
  ContourOptions contours;
  RegionOptions regions;
  TripletOptions triplets;
  ConfigurationOptions configurations;
  ContactOptions contacts;
  ClearanceOptions clearance;
  ShapeOptions shapes;
  RecallOptions recall;
  RobotOptions robot;
  // The depth that a finger reaches, for the palm's height and q8: by the hand's kinematics, or by the
  // paper's line.
  DepthModel depth_model = DepthModel::exact;
  // Force closure of a grasp's contacts, as far as the cloud tells their normals. `prefer`: only such grasps,
  // unless an object has none; about a third of the others are held all the same.
  ForceClosureUse force_closure = ForceClosureUse::prefer;
  // Where an object has no grasp on the side that was seen: come to the faces that no sensor saw too, if their
  // points were guessed.
  bool guessed_faces = true;
  // Prefer fingers in slightly concave places (a wish of the paper, III.A): added to a grasp's score
  // are so many standard deviations of its object's scores for each radian that the outline turns inwards
  // along the fingers' regions, on average, or taken off where it turns outwards. 0: the network's score
  // alone.
  double concavity_weight = 0.0;
  double merge_distance_m = 0.010;  // grasps whose palms and contacts are all nearer than this ...
  double merge_angle_rad = 0.26;    // ... and whose palms turn less than this are one grasp; the best stays
  int threads = 0;                  // 0 = all cores; the result does not depend on it
  void validate() const;
};

// What one request may choose.
struct PlanRequest {
  PointCloud cloud_C;
  int top_k = 10;                     // grasps in the answer; 0 = all
  double friction = 0.4;              // Coulomb coefficient of finger on object
  int object = -1;                    // plan this object of a scene alone (largest first); -1: all
  std::optional<Vector3d> gravity_C;  // direction of gravity (any length); else the robot's options say, or
                                      // the table, if there is one
  // Where the sensors stood; several where their views were joined into this cloud.
  Viewpoints viewpoints_C;
  std::optional<Plane> table_C;  // what the objects stand on (normal of any length); else it is looked for
  RobotRequest robot;
};

enum class Outcome { grasps, no_grasp, bad_input, deadline, cancelled };
std::string_view describe(Outcome outcome);

struct Grasp {
  double score = NAN;                      // of the network; higher is better
  Pose X_CP = Pose::Identity();            // the palm in the cloud's frame; see HandDescription for P
  Pose X_CP_pregrasp = Pose::Identity();   // from where it comes straight in
  Pose X_CP_lift = Pose::Identity();       // where it lifts the object to
  HandJoints joints;                       // closed on the object
  HandJoints pregrasp;                     // opened for the approach
  std::array<SurfaceContact, 3> contacts;  // by finger: F1, F2, F3 (thumb)
  Vector3d approach_C = Vector3d::Zero();  // unit
  QualityMeasures quality{};
  std::vector<double> inputs;  // what the network was fed, in the order of the model's features
  int object = -1, box = -1,
      face = -1;  // indices: object of the scene; node of its tree; number of the face or edge
                  // (projection/face.h)
  HandConfiguration configuration;
  Triplet triplet;
};

struct Stage {
  std::string name;
  std::size_t in = 0, out = 0;
  double time_s = 0.0;
};

// Counts and times of every stage, and why candidates fell.
struct PlanReport {
  std::vector<Stage> stages;
  std::map<std::string, std::size_t> rejected;  // reason -> how many candidates
  std::vector<std::string>
      notes;  // what a user should know: points dropped, voxel size used, table found, ...
  std::uint64_t seed = 0;
  double time_s = 0.0;
};

// The object's share of a scene, as planned.
struct PlannedObject {
  PointCloud cloud_C;       // cleaned; what was guessed of it comes last
  std::size_t guessed = 0;  // points of it that no sensor saw (cloud/completion.h)
  double spacing_m = -1.0;
  BoxTree tree;
  std::vector<BoxShape> shapes;  // of the tree's nodes; empty: not told
  BoxShape shapeOf(std::size_t node) const { return node < shapes.size() ? shapes[node] : BoxShape{}; }
};

// What `explain` and `show` want to see, kept only on request.
struct FaceTrace {
  int object = -1;
  FaceDecision decision;
  FaceImage image;  // filled; empty for rejected faces
  std::vector<Contour> contours;
  std::vector<Region> regions;
  std::vector<Triplet> triplets;
  std::size_t configurations = 0, clear = 0;
};
struct PlanTrace {
  std::vector<FaceTrace> faces;
  PointCloud scene_C;  // all that the hand may meet, cleaned
  std::optional<Plane> table;
};

struct PlanResult {
  Outcome outcome = Outcome::bad_input;
  std::string
      message;  // one sentence; for no_grasp: the stage that removed the last candidate, the counts, the knob
  std::string model_version;
  std::string frame;             // of the answer, where it is not the cloud's: the name of the robot's
  Pose X_AC = Pose::Identity();  // the cloud in the frame of the answer; all poses here are in C
  Pose X_TP = Pose::Identity();  // the palm in the frame of the robot's tool
  std::vector<Grasp> grasps;     // best first
  std::vector<PlannedObject> objects;
  PlanReport report;
};

}  // namespace boxgrasp
