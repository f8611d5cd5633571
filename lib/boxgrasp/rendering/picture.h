// Pictures of a plan: the boxes, the face images with their regions and finger points, the best grasps with
// the hand.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "boxgrasp/planning/plan.h"
#include "boxgrasp/rendering/canvas.h"

namespace boxgrasp {

// The colour of the i-th leaf box in all pictures, and the box's edges.
Colour boxColour(std::size_t i);
void drawBox(Canvas& canvas, const OrientedBox& box, Colour colour);

struct PictureOptions {
  int panel_px = 440;   // side of one panel
  int grasps = 5;       // best grasps that are drawn
  int face_images = 6;  // face images that are drawn: those with the most grasps first
  std::string title;    // e.g. the name of the file
  void validate() const;
};

cv::Mat3b drawPlan(const PlanResult& result, const PlanTrace& trace, const HandDescription& hand,
                   const PictureOptions& options = {});

// One face image with contours (grey), regions (green, with inward normals), and the triplets' finger points
// (red) and foci (blue).
cv::Mat3b drawFace(const FaceTrace& face, int side_px);

// Writes the picture as PNG. Throws InputError when the file cannot be written.
void writePlanPicture(const PlanResult& result, const PlanTrace& trace, const HandDescription& hand,
                      const std::filesystem::path& png, const PictureOptions& options = {});

}  // namespace boxgrasp
