#include "boxgrasp/cloud/sensor_view.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace boxgrasp {
namespace {

constexpr int kMaxSide_px = 256;     // coarser pixels rather than a larger object in the image
constexpr double kNearest_m = 1e-3;  // nothing nearer to the sensor is in front of it
constexpr float kOnePixel_m =
    0.02f;                       // surfaces of one pixel lie so near each other, unless one hides the other
constexpr int kMargin_px = 2;    // for the outline
constexpr double kAround = 0.5;  // of the object's size, on each side: what is there may hide parts of it

}  // namespace

SensorView::SensorView(const PointCloud& seen_C, const PointCloud& others_C, const Pose& X_CS, double pitch_m)
    : X_SC_(X_CS.inverse()) {
  Eigen::AlignedBox2d image;
  double sum_m = 0.0;
  for (std::size_t i = 0; i < seen_C.size(); ++i) {
    const Vector3d p_S = X_SC_ * seen_C.point(i);
    sum_m += p_S.z();
    if (p_S.z() > kNearest_m) image.extend(Vector2d(p_S.head<2>() / p_S.z()));
  }
  if (image.isEmpty()) image.extend(Vector2d::Zero().eval());
  const double mean_m = std::max(sum_m / static_cast<double>(seen_C.size()), kNearest_m);
  pixel_ = std::max(pitch_m / mean_m, image.sizes().maxCoeff() / kMaxSide_px);
  const Vector2d around = kAround * image.sizes() + Vector2d::Constant(kMargin_px * pixel_);
  image = {image.min() - around, image.max() + around};
  corner_ = image.min();
  width_ = static_cast<int>(image.sizes().x() / pixel_) + 1;
  height_ = static_cast<int>(image.sizes().y() / pixel_) + 1;
  pixels_.resize(static_cast<std::size_t>(width_) * height_);
  for (std::size_t i = 0; i < seen_C.size(); ++i) {
    const Ray ray = rayTo(seen_C.point(i));
    if (ray.column < 0) continue;
    Pixel& pixel = pixels_[indexOf(ray)];
    pixel.read = true;
    pixel.nearest = std::min(pixel.nearest, static_cast<float>(ray.depth_m));
  }
  for (std::size_t i = 0; i < seen_C.size(); ++i) {
    const Ray ray = rayTo(seen_C.point(i));
    if (ray.column < 0) continue;
    Pixel& pixel = pixels_[indexOf(ray)];
    const auto depth_m = static_cast<float>(ray.depth_m);
    if (depth_m < pixel.nearest + kOnePixel_m) pixel.farthest = std::max(pixel.farthest, depth_m);
  }
  for (std::size_t i = 0; i < others_C.size(); ++i) {
    const Ray ray = rayTo(others_C.point(i));
    if (ray.column >= 0)
      pixels_[indexOf(ray)].other = std::min(pixels_[indexOf(ray)].other, static_cast<float>(ray.depth_m));
  }
  spread();
}

SensorView::Ray SensorView::rayTo(const Vector3d& p_C) const {
  const Vector3d p_S = X_SC_ * p_C;
  if (p_S.z() <= kNearest_m) return {};
  const Vector2d at = (p_S.head<2>() / p_S.z() - corner_) / pixel_;
  if (!(at.x() >= 0 && at.y() >= 0 && at.x() < width_ && at.y() < height_)) return {};
  return {static_cast<int>(at.x()), static_cast<int>(at.y()), p_S.z()};
}

// Every pixel takes in its neighbours: readings lie a pixel apart, and the outline is no sharper.
void SensorView::spread() {
  const std::vector<Pixel> before = pixels_;
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column) {
      Pixel& pixel = pixels_[static_cast<std::size_t>(row) * width_ + column];
      for (int r = std::max(0, row - 1); r <= std::min(height_ - 1, row + 1); ++r) {
        for (int c = std::max(0, column - 1); c <= std::min(width_ - 1, column + 1); ++c) {
          const Pixel& near = before[static_cast<std::size_t>(r) * width_ + c];
          pixel.nearest = std::min(pixel.nearest, near.nearest);
          pixel.farthest = std::max(pixel.farthest, near.farthest);
          pixel.other = std::min(pixel.other, near.other);
        }
      }
    }
  }
}

double SensorView::behind(const Vector3d& p_C) const {
  const Ray ray = rayTo(p_C);
  return ray.column < 0 ? 0.0 : std::max(0.0, ray.depth_m - pixels_[indexOf(ray)].nearest);
}

SensorView::Judgement SensorView::judge(const Vector3d& p_C, double tolerance_m) const {
  const Ray ray = rayTo(p_C);
  if (ray.column < 0) return {};
  const Pixel& pixel = pixels_[indexOf(ray)];
  const double behind_m = ray.depth_m - pixel.nearest;
  if (std::isfinite(pixel.nearest) && behind_m >= -tolerance_m) {
    const double beyond_m = ray.depth_m - pixel.farthest;
    return {beyond_m <= tolerance_m ? Verdict::seen : Verdict::hidden, std::max(0.0, behind_m),
            std::max({0.0, -behind_m, beyond_m}), !pixel.read};
  }
  if (ray.depth_m > pixel.other + tolerance_m)
    return {Verdict::hidden, ray.depth_m - pixel.other, 0.0, false};
  return {};
}

SensorView::Judgement judge(const std::vector<SensorView>& views, const Vector3d& p_C, double tolerance_m) {
  using Verdict = SensorView::Verdict;
  // What is seen says more than what is hidden, and that more than a rim; where two of a kind differ, the
  // object is as thin as one of them allows.
  const auto tellsMore = [](const SensorView::Judgement& a, const SensorView::Judgement& b) {
    if (a.at_rim != b.at_rim) return b.at_rim;
    if (a.verdict != b.verdict) return a.verdict == Verdict::seen;
    return a.verdict == Verdict::seen ? a.off_m < b.off_m : a.behind_m < b.behind_m;
  };
  std::optional<SensorView::Judgement> best;
  for (const SensorView& view : views) {
    const SensorView::Judgement found = view.judge(p_C, tolerance_m);
    if (found.verdict == Verdict::contradicted) return found;
    if (!best || tellsMore(found, *best)) best = found;
  }
  return best.value_or(SensorView::Judgement{});
}

}  // namespace boxgrasp
