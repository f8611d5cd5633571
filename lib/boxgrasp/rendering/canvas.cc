#include "boxgrasp/rendering/canvas.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

constexpr double kAmbient = 0.35;  // the share of light that does not depend on the angle

Matrix3d viewAxes(const Camera& camera) {
  Vector3d right = camera.forward_C.cross(camera.up_C);
  if (right.norm() < 1e-6) right = camera.forward_C.unitOrthogonal();
  right.normalize();
  Matrix3d rows;
  rows << right.transpose(), camera.forward_C.cross(right).transpose(), camera.forward_C.transpose();
  return rows;
}

cv::Vec3b bgr(Colour c, double light = 1.0) {
  const auto lit = [&](std::uint8_t v) {
    return static_cast<std::uint8_t>(std::clamp(v * light, 0.0, 255.0));
  };
  return {lit(c.blue), lit(c.green), lit(c.red)};
}

double edge(const Vector3d& a, const Vector3d& b, double x, double y) {
  return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
}

}  // namespace

Canvas::Canvas(int width_px, int height_px, const Camera& camera, Colour background)
    : image_(height_px, width_px, bgr(background)),
      depth_(height_px, width_px, std::numeric_limits<float>::infinity()),
      pixels_per_m_(height_px / camera.height_m) {
  const Matrix3d axes = viewAxes(camera);
  X_VC_ = makePose(axes, -axes * camera.center_C);
}

Vector3d Canvas::project(const Vector3d& p_C) const {
  const Vector3d p_V = X_VC_ * p_C;
  return {image_.cols / 2.0 + pixels_per_m_ * p_V.x(), image_.rows / 2.0 + pixels_per_m_ * p_V.y(), p_V.z()};
}

void Canvas::plot(int column, int row, double depth, Colour colour) {
  if (column < 0 || row < 0 || column >= image_.cols || row >= image_.rows || depth >= depth_(row, column))
    return;
  depth_(row, column) = static_cast<float>(depth);
  image_(row, column) = bgr(colour);
}

void Canvas::point(const Vector3d& p_C, Colour colour, int size_px) {
  const Vector3d p = project(p_C);
  const int left = static_cast<int>(std::floor(p.x() - size_px / 2.0 + 0.5));
  const int top = static_cast<int>(std::floor(p.y() - size_px / 2.0 + 0.5));
  for (int row = top; row < top + size_px; ++row) {
    for (int column = left; column < left + size_px; ++column) plot(column, row, p.z(), colour);
  }
}

void Canvas::segment(const Vector3d& a_C, const Vector3d& b_C, Colour colour, int width_px) {
  const Vector3d a = project(a_C), b = project(b_C);
  const int steps = std::clamp(static_cast<int>(2 * (b - a).head<2>().norm()) + 1, 1, 10000);
  for (int i = 0; i <= steps; ++i)
    point(a_C + (b_C - a_C) * (static_cast<double>(i) / steps), colour, width_px);
}

void Canvas::triangle(const std::array<Vector3d, 3>& corners_C, Colour colour) {
  const Vector3d a = project(corners_C[0]), b = project(corners_C[1]), c = project(corners_C[2]);
  const double area = edge(a, b, c.x(), c.y());
  if (std::abs(area) < 1e-9) return;
  const Vector3d normal = (corners_C[1] - corners_C[0]).cross(corners_C[2] - corners_C[0]).normalized();
  const double light = kAmbient + (1 - kAmbient) * std::abs((X_VC_.linear() * normal).z());
  const cv::Vec3b lit = bgr(colour, light);
  const Colour shaded{lit[2], lit[1], lit[0]};
  const int left = std::max(0, static_cast<int>(std::floor(std::min({a.x(), b.x(), c.x()}))));
  const int right = std::min(image_.cols - 1, static_cast<int>(std::ceil(std::max({a.x(), b.x(), c.x()}))));
  const int top = std::max(0, static_cast<int>(std::floor(std::min({a.y(), b.y(), c.y()}))));
  const int bottom = std::min(image_.rows - 1, static_cast<int>(std::ceil(std::max({a.y(), b.y(), c.y()}))));
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) {
      const double u = edge(b, c, column, row) / area, v = edge(c, a, column, row) / area;
      if (u >= 0 && v >= 0 && u + v <= 1)
        plot(column, row, u * a.z() + v * b.z() + (1 - u - v) * c.z(), shaded);
    }
  }
}

void Canvas::mesh(const TriangleMesh& mesh_A, const Pose& X_CA, Colour colour) {
  for (const auto& [i, j, k] : mesh_A.triangles) {
    triangle({X_CA * mesh_A.vertices[i], X_CA * mesh_A.vertices[j], X_CA * mesh_A.vertices[k]}, colour);
  }
}

void label(cv::Mat3b& image, const std::string& text, int column, int row, double scale) {
  const cv::Point at(column, row);
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(255, 255, 255), 3, cv::LINE_AA);
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(20, 20, 20), 1, cv::LINE_AA);
}

Camera framing(const std::vector<Vector3d>& corners_C, const Vector3d& forward_C, const Vector3d& up_C,
               double aspect) {
  Camera camera;
  camera.forward_C = forward_C.normalized();
  camera.up_C = up_C;
  const Matrix3d axes = viewAxes(camera);
  Eigen::AlignedBox3d box_V;
  for (const Vector3d& p_C : corners_C) box_V.extend(axes * p_C);
  camera.center_C = axes.transpose() * box_V.center();
  camera.height_m = 1.08 * std::max({box_V.sizes().y(), box_V.sizes().x() / aspect, 1e-3});
  return camera;
}

void writePng(const cv::Mat3b& image, const std::filesystem::path& file) {
  std::vector<unsigned char> bytes;
  cv::imencode(".png", image, bytes);
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream)
    throw InputError(
        fmt::format("cannot write the picture to '{}': check the folder and the free space", file.string()));
}

}  // namespace boxgrasp
