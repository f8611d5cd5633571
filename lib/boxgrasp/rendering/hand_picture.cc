#include "boxgrasp/rendering/hand_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "boxgrasp/base/durable_file.h"
#include "boxgrasp/base/error.h"
#include "boxgrasp/rendering/hand_mesh.h"

namespace boxgrasp {
namespace {

constexpr double kAxis_m = 0.04, kScale_m = 0.05, kMargin = 1.15;
constexpr std::array<Colour, 3> kAxisColours{{{200, 0, 0}, {0, 140, 0}, {0, 0, 220}}};
constexpr int kTextRow_px = 18;

struct State {
  const char* name;
  HandJoints joints;
};

std::array<State, 3> statesOf(const HandDescription& hand) {
  const Reach reach = fingerReach(hand);
  const auto at = [&](double share) {
    const double inner = std::lerp(reach.inner_min, reach.inner_max, share);
    return HandJoints{hand.spread_min, {inner, inner, inner}};
  };
  return {{{"open", at(0.0)}, {"half closed", at(0.5)}, {"closed", at(1.0)}}};
}

struct View {
  const char* name;
  Vector3d forward_P, up_P;
  Vector3d right_P() const { return forward_P.cross(up_P); }
};

const std::array<View, 2>& views() {
  static const std::array<View, 2> both{{{"from the side", -Vector3d::UnitX(), Vector3d::UnitZ()},
                                         {"from before the palm", -Vector3d::UnitZ(), Vector3d::UnitY()}}};
  return both;
}

// Everything that any state reaches.
Eigen::AlignedBox3d extentOf(const HandDescription& hand) {
  Eigen::AlignedBox3d extent;
  for (const State& state : statesOf(hand)) {
    for (const DrawnPart& part : handMesh(hand, state.joints)) {
      for (const Vector3d& vertex : part.mesh.vertices) extent.extend(vertex);
    }
  }
  return extent;
}

// All panels at one scale.
Camera cameraOf(const Eigen::AlignedBox3d& extent, const View& view) {
  return {extent.center(), view.forward_P, view.up_P, kMargin * extent.sizes().maxCoeff()};
}

std::string titleOf(const State& state, const View& view) {
  return fmt::format("{}, {}", state.name, view.name);
}

cv::Mat3b panelOf(const HandDescription& hand, const State& state, const View& view,
                  const Eigen::AlignedBox3d& extent, int side_px) {
  const Camera camera = cameraOf(extent, view);
  Canvas canvas(side_px, side_px, camera);
  for (const DrawnPart& part : handMesh(hand, state.joints))
    canvas.mesh(part.mesh, Pose::Identity(), fingerColour(part.finger));
  // Before the hand, so that nothing hides them.
  const Vector3d before_P = -camera.height_m * view.forward_P;
  for (int axis = 0; axis < 3; ++axis)
    canvas.segment(before_P, before_P + kAxis_m * Vector3d::Unit(axis), kAxisColours[axis], 2);
  const Vector3d corner_P =
      before_P + camera.center_C - camera.height_m * (0.45 * view.right_P() + 0.45 * view.up_P);
  canvas.segment(corner_P, corner_P + kScale_m * view.right_P(), {0, 0, 0}, 2);
  cv::Mat3b image = canvas.image();
  label(image, titleOf(state, view), 8, kTextRow_px);
  const Vector2d scale_px = canvas.pixel(corner_P + kScale_m * view.right_P());
  label(image, "50 mm", static_cast<int>(scale_px.x()) + 6, static_cast<int>(scale_px.y()) + 4);
  return image;
}

// SVG: orthographic, a capsule is a thick line with round ends, the palm a polygon or a disc; the nearest
// last.
class SvgPanel {
 public:
  SvgPanel(const View& view, const Camera& camera, int side_px)
      : view_(view), camera_(camera), side_px_(side_px), px_per_m_(side_px / camera.height_m) {}

  void line(const Vector3d& a, const Vector3d& b, double width_m, Colour colour) {
    shapes_.emplace_back(
        depth(a, b),
        fmt::format("<line {} stroke=\"{}\" stroke-width=\"{:.2f}\" stroke-linecap=\"round\"/>\n", ends(a, b),
                    text(colour), width_m * px_per_m_));
  }
  void palm(const HandGeometry& hand) {
    const Vector3d back(0, 0, -hand.palm_thickness), front = Vector3d::Zero();
    const bool from_front = std::abs(view_.forward_P.z()) > 0.5;
    const Vector2d c = pixel(front), r = Vector2d::Constant(hand.palm_radius * px_per_m_);
    const Vector2d size(2 * r.x(), hand.palm_thickness * px_per_m_);
    shapes_.emplace_back(
        depth(back, front),
        from_front ? fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" fill=\"{}\"/>\n", c.x(),
                                 c.y(), r.x(), text(fingerColour(-1)))
                   : fmt::format(
                         "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\"/>\n",
                         c.x() - r.x(), c.y(), size.x(), size.y(), text(fingerColour(-1))));
  }
  std::string svg(const std::string& title) {
    std::ranges::stable_sort(shapes_, std::greater{}, &std::pair<double, std::string>::first);
    std::string all;
    for (const auto& [depth, shape] : shapes_) all += shape;
    for (int axis = 0; axis < 3; ++axis)
      all += fmt::format("<line {} stroke=\"{}\" stroke-width=\"2\"/>\n",
                         ends(Vector3d::Zero(), kAxis_m * Vector3d::Unit(axis)), text(kAxisColours[axis]));
    const double end_px = 10 + kScale_m * px_per_m_;
    all += fmt::format("<path d=\"M10,{0} H{1:.2f}\" stroke=\"black\" stroke-width=\"2\"/>\n", side_px_ - 10,
                       end_px);
    return all + fmt::format("<text x=\"8\" y=\"{}\">{}</text>\n<text x=\"{:.2f}\" y=\"{}\">50 mm</text>\n",
                             kTextRow_px, title, end_px + 6, side_px_ - 6);
  }

 private:
  Vector2d pixel(const Vector3d& p) const {
    const Vector3d from = p - camera_.center_C;
    return Vector2d::Constant(side_px_ / 2.0) +
           px_per_m_ * Vector2d(from.dot(view_.right_P()), -from.dot(view_.up_P));
  }
  double depth(const Vector3d& a, const Vector3d& b) const { return (a + b).dot(view_.forward_P) / 2; }
  std::string ends(const Vector3d& a, const Vector3d& b) const {
    const Vector2d p = pixel(a), q = pixel(b);
    return fmt::format("x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"", p.x(), p.y(), q.x(), q.y());
  }
  static std::string text(Colour c) { return fmt::format("#{:02x}{:02x}{:02x}", c.red, c.green, c.blue); }

  const View& view_;
  const Camera camera_;
  const int side_px_;
  const double px_per_m_;
  std::vector<std::pair<double, std::string>> shapes_;
};

}  // namespace

void HandPictureOptions::validate() const {
  requireOption(panel_px >= 50 && panel_px <= 4000, "panel_px", panel_px, "in [50, 4000]");
}

cv::Mat3b drawHand(const HandDescription& hand, const HandPictureOptions& options) {
  options.validate();
  const Eigen::AlignedBox3d extent = extentOf(hand);
  std::vector<cv::Mat> rows;
  for (const View& view : views()) {
    std::vector<cv::Mat> panels;
    for (const State& state : statesOf(hand))
      panels.push_back(panelOf(hand, state, view, extent, options.panel_px));
    cv::hconcat(panels, rows.emplace_back());
  }
  cv::Mat all;
  cv::vconcat(rows, all);
  return all;
}

std::string handSvg(const HandDescription& hand, const HandPictureOptions& options) {
  options.validate();
  const int side = options.panel_px;
  const Eigen::AlignedBox3d extent = extentOf(hand);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      3 * side, 2 * side);
  for (std::size_t row = 0; row < views().size(); ++row) {
    int column = 0;
    for (const State& state : statesOf(hand)) {
      const View& view = views()[row];
      SvgPanel panel(view, cameraOf(extent, view), side);
      const HandGeometry geometry = forwardKinematics(hand, state.joints);
      panel.palm(geometry);
      for (const Capsule& link : geometry.links)
        panel.line(link.a, link.b, 2 * link.radius, fingerColour(link.finger));
      svg += fmt::format("<g transform=\"translate({},{})\">\n{}</g>\n", side * column++,
                         side * static_cast<int>(row), panel.svg(titleOf(state, view)));
    }
  }
  return svg + "</svg>\n";
}

void writeHandPicture(const HandDescription& hand, const std::filesystem::path& file,
                      const HandPictureOptions& options) {
  if (file.extension() == ".png") return writePng(drawHand(hand, options), file);
  if (file.extension() == ".svg") return writeDurably(file, handSvg(hand, options));
  throw InputError(fmt::format("cannot draw into '{}': name it .png or .svg", file.string()));
}

}  // namespace boxgrasp
