// A small software renderer with a depth buffer: pictures without a display.
#pragma once

#include <array>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "boxgrasp/geometry/triangle_mesh.h"

namespace boxgrasp {

struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0;
};

// An orthographic camera: looks along `forward_C`; pixels are square.
struct Camera {
  Vector3d center_C = Vector3d::Zero();     // in the middle of the picture
  Vector3d forward_C = -Vector3d::UnitZ();  // unit
  Vector3d up_C = Vector3d::UnitY();        // need not be perpendicular to forward
  double height_m = 0.3;                    // that the picture's height shows
};

class Canvas {
 public:
  Canvas(int width_px, int height_px, const Camera& camera, Colour background = {255, 255, 255});

  // A square of size_px; nearer things hide farther ones.
  void point(const Vector3d& p_C, Colour colour, int size_px = 1);
  void segment(const Vector3d& a_C, const Vector3d& b_C, Colour colour, int width_px = 1);
  // Lit from the camera; both sides visible.
  void triangle(const std::array<Vector3d, 3>& corners_C, Colour colour);
  void mesh(const TriangleMesh& mesh_A, const Pose& X_CA, Colour colour);

  const cv::Mat3b& image() const { return image_; }
  Vector2d pixel(const Vector3d& p_C) const { return project(p_C).head<2>(); }  // column, row; any

 private:
  Vector3d project(const Vector3d& p_C) const;  // column, row, depth
  void plot(int column, int row, double depth, Colour colour);

  cv::Mat3b image_;
  cv::Mat1f depth_;
  Pose X_VC_;  // to view coordinates: x right, y down, z away
  double pixels_per_m_;
};

// Writes text on an image, black on a light ground.
void label(cv::Mat3b& image, const std::string& text, int column, int row, double scale = 0.45);

// The camera that shows all corners, from a direction.
Camera framing(const std::vector<Vector3d>& corners_C, const Vector3d& forward_C, const Vector3d& up_C,
               double aspect);

// Throws InputError when the file cannot be written.
void writePng(const cv::Mat3b& image, const std::filesystem::path& file);

}  // namespace boxgrasp
