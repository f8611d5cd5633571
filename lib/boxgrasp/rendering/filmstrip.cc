#include "boxgrasp/rendering/filmstrip.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/rendering/canvas.h"
#include "boxgrasp/rendering/hand_mesh.h"

namespace boxgrasp {
namespace {

constexpr int kFiner = 2;  // pictures are drawn this much larger and then shrunk, which smooths edges
constexpr int kHeading_px = 52, kCaption_px = 36;
constexpr Colour kObjectColour{222, 206, 170};
constexpr int kAzimuths = 24;
constexpr std::array<double, 3> kElevations_rad{0.25, 0.60, 0.95};

// Directions from all around, looking down a little.
std::vector<Vector3d> candidateViews(const Vector3d& up_W) {
  const Vector3d east = up_W.unitOrthogonal(), north = up_W.cross(east);
  std::vector<Vector3d> views;
  for (const double elevation : kElevations_rad) {
    for (int i = 0; i < kAzimuths; ++i) {
      const double azimuth = 2 * std::numbers::pi * i / kAzimuths;
      const Vector3d level = std::cos(azimuth) * east + std::sin(azimuth) * north;
      views.push_back(std::cos(elevation) * level - std::sin(elevation) * up_W);
    }
  }
  return views;
}

template <typename Score>
Vector3d best(const std::vector<Vector3d>& views, const Score& score) {
  return *std::max_element(views.begin(), views.end(),
                           [&](const Vector3d& a, const Vector3d& b) { return score(a) < score(b); });
}

// What the first view frames: the object, and the hand around it with some of its way in.
std::vector<Vector3d> cornersOf(const Film& film, const HandDescription& hand) {
  const FilmFrame& frame = film.frames[film.grasped];
  Eigen::AlignedBox3d bounds_O;
  for (const Vector3d& p_O : film.object_O.vertices) bounds_O.extend(p_O);
  std::vector<Vector3d> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(frame.X_WO * bounds_O.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  for (const Capsule& link : frame.links_W) corners.insert(corners.end(), {link.a, link.b});
  for (const double side : {-1.0, 1.0})
    corners.push_back(frame.X_WP * Vector3d(side * hand.palm_radius, 0, -hand.palm_thickness));
  return corners;
}

void drawForces(cv::Mat3b& image, const Canvas& canvas, const FilmFrame& frame, double newton_m) {
  const auto at = [&](const Vector3d& p_W) {
    const Vector2d pixel = canvas.pixel(p_W);
    return cv::Point(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  };
  for (const FilmForce& force : frame.forces) {
    const cv::Point tip = at(force.p_W), tail = at(force.p_W - newton_m * force.force_W);
    cv::line(image, tail, tip, cv::Scalar(255, 255, 255), 4 * kFiner, cv::LINE_AA);
    cv::arrowedLine(image, tail, tip, cv::Scalar(30, 20, 200), 2 * kFiner, cv::LINE_AA, 0, 0.3);
    cv::circle(image, tip, 2 * kFiner, cv::Scalar(30, 20, 200), -1, cv::LINE_AA);
  }
}

cv::Mat3b drawFrame(const Film& film, const FilmFrame& frame, const HandDescription& hand,
                    const Camera& camera, const FilmOptions& options) {
  const int side = kFiner * options.panel_px;
  Canvas canvas(side, side, camera, {250, 250, 252});
  canvas.mesh(film.object_O, frame.X_WO, kObjectColour);
  canvas.mesh(palmMesh(hand).mesh, frame.X_WP, fingerColour(-1));
  for (const Capsule& link : frame.links_W)
    canvas.mesh(linkMesh(link).mesh, Pose::Identity(), fingerColour(link.finger));
  cv::Mat3b fine = canvas.image().clone(), image;
  drawForces(fine, canvas, frame, options.newton_m);
  cv::resize(fine, image, cv::Size(options.panel_px, options.panel_px), 0, 0, cv::INTER_AREA);
  return image;
}

// The film's cameras in the frame in which the object is grasped.
std::vector<Camera> camerasOf(const Film& film, const HandDescription& hand) {
  std::vector<Camera> cameras;
  double height_m = 0.0;
  for (const Vector3d& view : filmViews(film.frames[film.grasped].X_WP, film.up_W)) {
    cameras.push_back(framing(cornersOf(film, hand), view, film.up_W, 1.0));
    height_m = std::max(height_m, 1.1 * cameras.back().height_m);
  }
  for (Camera& camera : cameras) camera.height_m = height_m;
  return cameras;
}

Camera following(Camera camera, const Film& film, std::size_t i) {
  if (i > film.grasped)
    camera.center_C += film.frames[i].X_WP.translation() - film.frames[film.grasped].X_WP.translation();
  return camera;
}

// One frame with its views, one below the other.
cv::Mat3b drawColumn(const Film& film, std::size_t i, const HandDescription& hand,
                     const std::vector<Camera>& cameras, const FilmOptions& options) {
  const int side = options.panel_px;
  cv::Mat3b column(kCaption_px + static_cast<int>(cameras.size()) * side, side, cv::Vec3b(255, 255, 255));
  label(column, film.frames[i].caption, 6, 14, 0.42);
  label(column, film.frames[i].remark, 6, 30, 0.36);
  for (std::size_t view = 0; view < cameras.size(); ++view) {
    const cv::Rect place(0, kCaption_px + static_cast<int>(view) * side, side, side);
    drawFrame(film, film.frames[i], hand, following(cameras[view], film, i), options).copyTo(column(place));
  }
  cv::rectangle(column, cv::Rect(0, 0, column.cols, column.rows), cv::Scalar(215, 215, 215), 1);
  return column;
}

}  // namespace

void FilmOptions::validate() const {
  requireOption(panel_px >= 64 && panel_px <= 2048, "panel_px", panel_px, "in [64, 2048]");
  requireOption(columns >= 1 && columns <= 100, "columns", columns, "in [1, 100]");
  requireOption(newton_m >= 0 && newton_m <= 1, "newton_m", newton_m, "in [0, 1]");
}

std::array<Vector3d, 2> filmViews(const Pose& X_WP, const Vector3d& up_W) {
  const std::vector<Vector3d> views = candidateViews(up_W);
  const Matrix3d R_WP = X_WP.linear();
  // Across the thumb's plane; from behind the palm, or against it, the hand hides what it holds.
  const Vector3d first = best(views, [&](const Vector3d& view) {
    return std::abs(view.dot(R_WP.col(0))) - 0.4 * std::abs(view.dot(R_WP.col(2)));
  });
  const Vector3d second = best(views, [&](const Vector3d& view) {
    return -std::abs(view.dot(first)) - 0.4 * std::abs(view.dot(R_WP.col(2)));
  });
  return {first, second};
}

cv::Mat3b drawFilm(const Film& film, const HandDescription& hand, const FilmOptions& options) {
  options.validate();
  assert(film.grasped < film.frames.size());
  const std::vector<Camera> cameras = camerasOf(film, hand);
  const int frames = static_cast<int>(film.frames.size()), columns = std::min(options.columns, frames);
  const int rows = (frames + columns - 1) / columns;
  const int row_px = kCaption_px + static_cast<int>(cameras.size()) * options.panel_px;
  cv::Mat3b sheet(kHeading_px + rows * row_px, columns * options.panel_px, cv::Vec3b(255, 255, 255));
  label(sheet, film.title, 8, 20, 0.6);
  label(sheet, film.subtitle, 8, 42, 0.48);
  for (int i = 0; i < frames; ++i) {
    const cv::Rect place(i % columns * options.panel_px, kHeading_px + i / columns * row_px, options.panel_px,
                         row_px);
    drawColumn(film, static_cast<std::size_t>(i), hand, cameras, options).copyTo(sheet(place));
  }
  return sheet;
}

}  // namespace boxgrasp
