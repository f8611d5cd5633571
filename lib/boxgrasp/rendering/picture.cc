#include "boxgrasp/rendering/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/rendering/canvas.h"
#include "boxgrasp/rendering/hand_mesh.h"

namespace boxgrasp {
namespace {

constexpr std::array<Colour, 10> kBoxColours{{{31, 119, 180},
                                              {255, 127, 14},
                                              {44, 160, 44},
                                              {148, 103, 189},
                                              {140, 86, 75},
                                              {227, 119, 194},
                                              {188, 189, 34},
                                              {23, 190, 207},
                                              {214, 39, 40},
                                              {100, 100, 100}}};
constexpr Colour kSceneColour{205, 205, 205}, kContactColour{220, 0, 0}, kInk{20, 20, 20};
// Corners differ in one bit of their numbers along each edge.
constexpr std::array<std::array<int, 2>, 12> kBoxEdges{
    {{0, 1}, {0, 2}, {0, 4}, {1, 3}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 6}, {5, 7}, {6, 7}}};

Vector3d upOf(const PlanTrace& trace) { return trace.table ? trace.table->normal_C : Vector3d::UnitZ(); }

// Which way a viewer looks who stands in front, a little to the right and above.
Vector3d defaultView(const Vector3d& up_C) {
  const Vector3d side = up_C.unitOrthogonal();
  return (-0.55 * up_C - 0.75 * side - 0.45 * up_C.cross(side)).normalized();
}

// For what no sensor saw.
Colour pale(Colour colour) {
  const auto mixed = [](std::uint8_t value) { return static_cast<std::uint8_t>((value + 2 * 255) / 3); };
  return {mixed(colour.red), mixed(colour.green), mixed(colour.blue)};
}

void drawObject(Canvas& canvas, const PlannedObject& object) {
  const std::size_t seen = object.cloud_C.size() - object.guessed;
  const std::vector<int> leaves = object.tree.leaves();
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    for (const auto point : object.tree.nodes[leaves[i]].points)
      canvas.point(object.cloud_C.point(point), point < seen ? boxColour(i) : pale(boxColour(i)), 2);
  }
}

void drawScene(Canvas& canvas, const PlanTrace& trace) {
  for (std::size_t i = 0; i < trace.scene_C.size(); ++i)
    canvas.point(trace.scene_C.point(i), kSceneColour, 1);
}

std::vector<Vector3d> cornersOf(const PlanResult& result) {
  std::vector<Vector3d> corners;
  for (const PlannedObject& object : result.objects) {
    if (object.tree.nodes.empty()) continue;
    for (const Vector3d& corner : object.tree.nodes.front().box.corners()) corners.push_back(corner);
  }
  if (corners.empty()) corners.push_back(Vector3d::Zero());
  return corners;
}

cv::Mat3b boxesPanel(const PlanResult& result, const PlanTrace& trace, int side_px) {
  Canvas canvas(side_px, side_px, framing(cornersOf(result), defaultView(upOf(trace)), upOf(trace), 1.0));
  drawScene(canvas, trace);
  std::size_t boxes = 0;
  for (const PlannedObject& object : result.objects) {
    if (object.tree.nodes.empty()) continue;
    drawObject(canvas, object);
    const std::vector<int> leaves = object.tree.leaves();
    for (std::size_t i = 0; i < leaves.size(); ++i)
      drawBox(canvas, object.tree.nodes[leaves[i]].box, boxColour(i));
    boxes += leaves.size();
  }
  cv::Mat3b image = canvas.image().clone();
  label(image, fmt::format("{} boxes, {} objects", boxes, result.objects.size()), 10, 20);
  return image;
}

void drawHand(Canvas& canvas, const HandDescription& hand, const Grasp& grasp) {
  for (const DrawnPart& part : handMesh(hand, grasp.joints)) {
    canvas.mesh(part.mesh, grasp.X_CP, fingerColour(part.finger));
  }
}

void drawContacts(Canvas& canvas, const Grasp& grasp) {
  for (const SurfaceContact& contact : grasp.contacts) {
    canvas.segment(contact.p_C - 0.02 * contact.normal_C, contact.p_C, kContactColour, 3);
    canvas.point(contact.p_C, kContactColour, 7);
  }
}

// The direction from which a hand is seen best: from its side, a little from behind the palm.
Vector3d sideView(const Grasp& grasp) {
  const Matrix3d R_CP = grasp.X_CP.linear();
  return (-0.85 * R_CP.col(0) - 0.30 * R_CP.col(1) + 0.42 * R_CP.col(2)).normalized();
}

std::string jointsText(const HandDescription& hand, const HandJoints& joints) {
  if (hand.prismatic()) {
    return fmt::format("pads {:.0f} mm apart",
                       2e3 * (hand.base_radius - hand.slide_per_rad * joints.inner[kF1]));
  }
  constexpr double kDegrees = 180 / std::numbers::pi;
  return fmt::format("spread {:.0f} deg, fingers {:.0f} {:.0f} {:.0f} deg", joints.spread * kDegrees,
                     joints.inner[kF1] * kDegrees, joints.inner[kF2] * kDegrees,
                     joints.inner[kThumb] * kDegrees);
}

cv::Mat3b graspPanel(const PlanResult& result, const PlanTrace& trace, const HandDescription& hand,
                     std::size_t rank, int side_px) {
  const Grasp& grasp = result.grasps[rank];
  std::vector<Vector3d> corners;
  for (const Vector3d& corner : result.objects[grasp.object].tree.nodes.front().box.corners())
    corners.push_back(corner);
  for (const Capsule& link : forwardKinematics(hand, grasp.joints).links) {
    corners.push_back(grasp.X_CP * link.a);
    corners.push_back(grasp.X_CP * link.b);
  }
  corners.push_back(grasp.X_CP * Vector3d(0, 0, -hand.palm_thickness));
  Canvas canvas(side_px, side_px, framing(corners, sideView(grasp), -grasp.approach_C, 1.0));
  drawScene(canvas, trace);
  drawObject(canvas, result.objects[grasp.object]);
  drawHand(canvas, hand, grasp);
  drawContacts(canvas, grasp);
  cv::Mat3b image = canvas.image().clone();
  label(image, fmt::format("#{} score {:.3f}", rank + 1, grasp.score), 10, 20);
  label(image, jointsText(hand, grasp.joints), 10, 40, 0.4);
  return image;
}

// The faces with the most clear grasps first, then those with the most triplets.
std::vector<const FaceTrace*> busiestFaces(const PlanTrace& trace, std::size_t most) {
  std::vector<const FaceTrace*> faces;
  for (const FaceTrace& face : trace.faces) {
    if (face.image.width > 0) faces.push_back(&face);
  }
  std::stable_sort(faces.begin(), faces.end(), [](const FaceTrace* a, const FaceTrace* b) {
    return std::pair(a->clear, a->triplets.size()) > std::pair(b->clear, b->triplets.size());
  });
  faces.resize(std::min(faces.size(), most));
  return faces;
}

// Puts panels of one size in rows.
cv::Mat3b tiled(const std::vector<cv::Mat3b>& panels, int columns, int side_px) {
  const int rows = (static_cast<int>(panels.size()) + columns - 1) / columns;
  cv::Mat3b sheet(rows * side_px, columns * side_px, cv::Vec3b(255, 255, 255));
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const cv::Rect place(static_cast<int>(i) % columns * side_px, static_cast<int>(i) / columns * side_px,
                         side_px, side_px);
    panels[i].copyTo(sheet(place));
    cv::rectangle(sheet, place, cv::Scalar(225, 225, 225), 1);
  }
  return sheet;
}

// From the plane of a face to the pixels of its drawing.
struct FaceView {
  const FaceImage& image;
  double zoom;
  cv::Point at(const Vector2d& p_F) const {
    const Vector2d pixel = (image.toPixel(p_F) + Vector2d(0.5, 0.5)) * zoom;
    return {static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))};
  }
};

void drawRegions(cv::Mat3b& drawing, const FaceView& view, const std::vector<Region>& regions) {
  for (const Region& region : regions) {
    const Vector2d middle = (region.a_F + region.b_F) / 2;
    cv::line(drawing, view.at(region.a_F), view.at(region.b_F), cv::Scalar(60, 200, 60), 2, cv::LINE_AA);
    cv::line(drawing, view.at(middle), view.at(middle + 0.006 * region.normal_F), cv::Scalar(60, 200, 60), 1,
             cv::LINE_AA);
  }
}

void drawTriplets(cv::Mat3b& drawing, const FaceView& view, const std::vector<Triplet>& triplets) {
  for (const Triplet& triplet : triplets) {
    cv::drawMarker(drawing, view.at(triplet.focus_F), cv::Scalar(255, 90, 30), cv::MARKER_CROSS, 5, 1);
    for (const Vector2d& p_F : triplet.points_F)
      cv::drawMarker(drawing, view.at(p_F), cv::Scalar(40, 40, 230), cv::MARKER_DIAMOND, 7, 1);
  }
}

}  // namespace

Colour boxColour(std::size_t i) { return kBoxColours[i % kBoxColours.size()]; }

void drawBox(Canvas& canvas, const OrientedBox& box, Colour colour) {
  const auto corners = box.corners();
  for (const auto& [a, b] : kBoxEdges) canvas.segment(corners[a], corners[b], colour, 2);
}

void PictureOptions::validate() const {
  requireOption(panel_px >= 64 && panel_px <= 4096, "panel_px", panel_px, "in [64, 4096]");
  requireOption(grasps >= 0 && grasps <= 100, "grasps", grasps, "in [0, 100]");
  requireOption(face_images >= 0 && face_images <= 100, "face_images", face_images, "in [0, 100]");
}

cv::Mat3b drawFace(const FaceTrace& face, int side_px) {
  const FaceImage& image = face.image;
  const cv::Mat1b gray(image.height, image.width, const_cast<std::uint8_t*>(image.gray.data()));
  const double zoom = static_cast<double>(side_px) / std::max(image.width, image.height);
  cv::Mat enlarged;
  cv::resize(gray, enlarged, {}, zoom, zoom, cv::INTER_NEAREST);
  cv::Mat3b drawing(side_px, side_px, cv::Vec3b(0, 0, 0));
  cv::Mat3b part =
      drawing(cv::Rect(0, 0, std::min(side_px, enlarged.cols), std::min(side_px, enlarged.rows)));
  cv::cvtColor(enlarged(cv::Rect(0, 0, part.cols, part.rows)), part, cv::COLOR_GRAY2BGR);
  const FaceView view{image, zoom};
  for (const Contour& contour : face.contours) {
    for (const Vector2d& p_F : contour.points_F)
      cv::circle(drawing, view.at(p_F), 1, cv::Scalar(200, 160, 0), -1);
  }
  drawRegions(drawing, view, face.regions);
  drawTriplets(drawing, view, face.triplets);
  label(
      drawing,
      fmt::format("box {} face {}: {} regions, {} triplets, {} clear", face.decision.face.node,
                  faceName(face.decision.face.number), face.regions.size(), face.triplets.size(), face.clear),
      8, side_px - 10, 0.4);
  return drawing;
}

cv::Mat3b drawPlan(const PlanResult& result, const PlanTrace& trace, const HandDescription& hand,
                   const PictureOptions& options) {
  options.validate();
  std::vector<cv::Mat3b> panels{boxesPanel(result, trace, options.panel_px)};
  if (!options.title.empty()) label(panels.front(), options.title, 10, 40);
  label(panels.front(), result.message, 10, options.panel_px - 10, 0.35);
  for (std::size_t i = 0; i < std::min<std::size_t>(options.grasps, result.grasps.size()); ++i) {
    panels.push_back(graspPanel(result, trace, hand, i, options.panel_px));
  }
  for (const FaceTrace* face : busiestFaces(trace, options.face_images))
    panels.push_back(drawFace(*face, options.panel_px));
  return tiled(panels, std::min<int>(3, static_cast<int>(panels.size())), options.panel_px);
}

void writePlanPicture(const PlanResult& result, const PlanTrace& trace, const HandDescription& hand,
                      const std::filesystem::path& png, const PictureOptions& options) {
  writePng(drawPlan(result, trace, hand, options), png);
}

}  // namespace boxgrasp
