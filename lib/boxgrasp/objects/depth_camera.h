// A virtual depth camera: what a structured-light sensor like the first Kinect sees of an object.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/triangle_mesh.h"

namespace boxgrasp {

// The sensor's frame S: origin in the camera, x right, y down, z forward. A pixel (column u, row v) looks
// along ((u - (width - 1) / 2) / focal_px, (v - (height - 1) / 2) / focal_px, 1); depth is the z of S.
// Disparity d = focal_px baseline_m / z, in pixels.
struct DepthCameraOptions {
  int width_px = 640, height_px = 480;
  double focal_px = 575.8;    // the first Kinect's infrared camera
  double baseline_m = 0.075;  // the projector's distance from the camera, to the right
  // Standard deviation of the disparity. This value makes that of the depth 1.4 mm at 1 m, growing with z^2
  // (Khoshelham and Elberink 2012). 0: none.
  double disparity_noise_px = 0.0615;
  double disparity_step_px = 0.125;  // disparities are multiples of this: 2.9 mm at 1 m. 0: not quantised
  // Standard deviation of where a pixel really looks: it makes edges ragged. 0: none.
  double lateral_noise_px = 0.5;
  double max_incidence_rad = 1.4;  // no echo from surfaces seen at a more grazing angle: 80 degrees
  // How likely a pixel at an edge, where a neighbour's depth differs by edge_jump_m or there is none, is
  // lost.
  double edge_loss = 0.5;
  double edge_jump_m = 0.02;
  bool projector_shadow = true;  // nothing is measured where the projector's light does not reach
  double min_depth_m = 0.4, max_depth_m = 4.0;
  std::uint64_t seed = 1;
  void validate() const;

  // A perfect camera of the same geometry: exact depths, no losses but what is hidden from the camera.
  DepthCameraOptions withoutErrors() const;
};

// What stands before the camera, in the object's frame O.
struct DepthScene {
  TriangleMesh object_O;
  std::vector<TriangleMesh> others_O;  // they hide parts of the object, and are seen themselves
  bool table = false;                  // a square of 2 m in the plane of the object's lowest point, z up
};

enum class SeenThing : std::uint32_t { table, object, other };

struct DepthView {
  int width_px = 0, height_px = 0;
  Pose X_OS = Pose::Identity();  // of the sensor
  std::vector<float> depth_m;    // row by row; NaN where nothing was measured
  std::vector<SeenThing> thing;  // parallel to depth_m; says nothing where that is NaN

  // The measured points in O, row by row: of the object alone, or of everything.
  PointCloud objectCloud_O() const;
  PointCloud fullCloud_O() const;
  double focal_px = 0.0;
};

// Renders the scene. The same scene, pose, options and seed give the same bytes. Throws InputError for bad
// options, Stopped when told to stop. Pre: the meshes are not empty and their vertices finite.
DepthView seeFrom(const DepthScene& scene, const Pose& X_OS, const DepthCameraOptions& options = {},
                  const StopToken& stop = {});

struct NamedPose {
  std::string name;  // "view0", "view1", ...
  Pose X_OS = Pose::Identity();
};

struct ViewRingOptions {
  int views = 8;
  double elevation_rad = 0.6;  // of the camera above the object's centre: as a robot's head looks at a table
  double distance_m = 0.7;     // from the centre of the object's box
  void validate() const;
};

// Cameras evenly spread on a ring about the centre of the mesh's box, looking at it, z of O up in the
// picture; view0 is on the side of -y, the others follow counter-clockwise seen from above. Throws InputError
// for bad options.
std::vector<NamedPose> viewRing(const TriangleMesh& object_O, const ViewRingOptions& options = {});

}  // namespace boxgrasp
