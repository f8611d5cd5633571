#include "boxgrasp/viewer/plan_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/rendering/picture.h"
#include "boxgrasp/viewer/web_files.h"

namespace boxgrasp {
namespace {

using Json = nlohmann::ordered_json;
constexpr int kSchema = 1;

std::string base64(const void* data, std::size_t size) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto* bytes = static_cast<const unsigned char*>(data);
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t left = std::min<std::size_t>(3, size - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < left ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= left ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

template <typename T>
std::string base64(const std::vector<T>& values) {
  return base64(values.data(), values.size() * sizeof(T));
}

Json vectorJson(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json poseJson(const Pose& X_CA) {
  const Eigen::Quaterniond q(X_CA.linear());
  return {{"position_m", vectorJson(X_CA.translation())}, {"quaternion_wxyz", {q.w(), q.x(), q.y(), q.z()}}};
}

// Which leaf each point belongs to, counted through the leaves; 255: none.
std::vector<std::uint8_t> leafOfPoints(const PlannedObject& object) {
  std::vector<std::uint8_t> leaf_of(object.cloud_C.size(), 255);
  const std::vector<int> leaves = object.tree.leaves();
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    for (const auto point : object.tree.nodes[leaves[i]].points)
      leaf_of[point] = static_cast<std::uint8_t>(i % 255);
  }
  return leaf_of;
}

Json cloudJson(const PointCloud& cloud, const std::vector<std::uint8_t>& group, int max_points) {
  const std::size_t step = cloud.size() / static_cast<std::size_t>(max_points) + 1;
  std::vector<float> xyz;
  std::vector<std::uint8_t> groups;
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    xyz.insert(xyz.end(), {cloud.x[i], cloud.y[i], cloud.z[i]});
    if (!group.empty()) groups.push_back(group[i]);
  }
  return {{"points", cloud.size()},
          {"drawn", xyz.size() / 3},
          {"xyz_float32", base64(xyz)},
          {"leaf_uint8", base64(groups)}};
}

Json boxJson(const BoxNode& node, const BoxShape& shape) {
  Json json = poseJson(node.box.X_CB);
  json["extents_m"] = vectorJson(node.box.extents);
  json["parent"] = node.parent;
  json["level"] = node.depth;
  json["leaf"] = node.leaf();
  json["points"] = node.points.size();
  json["theta"] = node.theta;
  json["stop_reason"] = node.stop_reason;
  json["shape"] = describe(shape.kind);
  json["radius_m"] = shape.radius_m;
  return json;
}

Json objectJson(const PlannedObject& object, const ViewerOptions& options) {
  Json boxes = Json::array();
  const auto& nodes = object.tree.nodes;
  for (std::size_t i = 0; i < nodes.size(); ++i) boxes.push_back(boxJson(nodes[i], object.shapeOf(i)));
  return {{"cloud", cloudJson(object.cloud_C, leafOfPoints(object), options.max_points)},
          {"guessed", object.guessed},
          {"boxes", boxes}};
}

std::string pngOf(const FaceTrace& face, int side_px) {
  std::vector<std::uint8_t> png;
  cv::imencode(".png", drawFace(face, side_px), png);
  return base64(png);
}

Json faceJson(const FaceTrace& trace, const ViewerOptions& options) {
  const Face& face = trace.decision.face;
  Json json = poseJson(face.X_CF);
  json["object"] = trace.object;
  json["box"] = face.node;
  json["face"] = face.number;
  json["name"] = fmt::format("box {} face {}", face.node, faceName(face.number));
  json["size_m"] = {face.size.x(), face.size.y()};
  json["rejection"] = trace.decision.graspable() ? "" : std::string(describe(trace.decision.rejection));
  json["regions"] = trace.regions.size();
  json["triplets"] = trace.triplets.size();
  json["configurations"] = trace.configurations;
  json["clear"] = trace.clear;
  if (trace.image.width > 0) json["image_png"] = pngOf(trace, options.image_px);
  return json;
}

// The rejected faces without an image are all there; of the others those with the most grasps.
Json facesJson(const PlanTrace& trace, const ViewerOptions& options) {
  std::vector<const FaceTrace*> faces;
  for (const FaceTrace& face : trace.faces) faces.push_back(&face);
  std::stable_sort(faces.begin(), faces.end(), [](const FaceTrace* a, const FaceTrace* b) {
    return std::pair(a->clear, a->triplets.size()) > std::pair(b->clear, b->triplets.size());
  });
  Json json = Json::array();
  int images = 0;
  for (const FaceTrace* face : faces) {
    if (face->image.width > 0 && ++images > options.max_faces) continue;
    json.push_back(faceJson(*face, options));
  }
  return json;
}

HandJoints between(const HandJoints& from, const HandJoints& to, double share) {
  HandJoints joints = to;
  for (int f = 0; f < 3; ++f) joints.inner[f] = from.inner[f] + share * (to.inner[f] - from.inner[f]);
  return joints;
}

// The hand's links in P, from open to closed: for each step, for each link its two ends and its radius.
Json closingJson(const HandDescription& hand, const Grasp& grasp, int steps) {
  Json json = Json::array();
  for (int i = 0; i < steps; ++i) {
    Json links = Json::array();
    const HandJoints joints = between(grasp.pregrasp, grasp.joints, i / std::max(1.0, steps - 1.0));
    for (const Capsule& link : forwardKinematics(hand, joints).links)
      links.push_back({link.finger, vectorJson(link.a), vectorJson(link.b), link.radius});
    json.push_back(links);
  }
  return json;
}

Json contactJson(const SurfaceContact& contact) {
  return {{"position_m", vectorJson(contact.p_C)},
          {"normal", vectorJson(contact.normal_C)},
          {"seen", contact.seen}};
}

Json jointsJson(const HandJoints& joints) {
  return {
      {"spread", joints.spread}, {"f1", joints.inner[0]}, {"f2", joints.inner[1]}, {"f3", joints.inner[2]}};
}

Json graspJson(const HandDescription& hand, const Grasp& grasp, const ViewerOptions& options) {
  Json contacts = Json::array();
  for (const SurfaceContact& contact : grasp.contacts) contacts.push_back(contactJson(contact));
  return {{"score", grasp.score},
          {"palm_pose", poseJson(grasp.X_CP)},
          {"joints_rad", jointsJson(grasp.joints)},
          {"pregrasp_rad", jointsJson(grasp.pregrasp)},
          {"contacts", contacts},
          {"approach", vectorJson(grasp.approach_C)},
          {"quality", grasp.quality},
          {"object", grasp.object},
          {"box", grasp.box},
          {"face", grasp.face},
          {"closing", closingJson(hand, grasp, options.closing_steps)}};
}

Json graspsJson(const HandDescription& hand, const std::vector<Grasp>& grasps, const ViewerOptions& options) {
  Json json = Json::array();
  const auto most = std::min<std::size_t>(grasps.size(), static_cast<std::size_t>(options.max_grasps));
  for (std::size_t i = 0; i < most; ++i) json.push_back(graspJson(hand, grasps[i], options));
  return json;
}

Json reportJson(const PlanReport& report) {
  Json stages = Json::array();
  for (const Stage& stage : report.stages)
    stages.push_back({{"name", stage.name}, {"in", stage.in}, {"out", stage.out}, {"time_s", stage.time_s}});
  return {
      {"stages", stages}, {"rejected", report.rejected}, {"notes", report.notes}, {"time_s", report.time_s}};
}

// Text that stands in a script element must not end it.
std::string inScript(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', true, Json::error_handler_t::replace)) {
    if (c == '<')
      text += "\\u003c";
    else
      text += c;
  }
  return text;
}

// The template with each "{{name}}" replaced; what is put in is not looked at again.
std::string filledIn(std::string_view page, const std::map<std::string, std::string>& parts) {
  std::string text;
  for (std::size_t at = 0; at < page.size();) {
    const std::size_t begin = std::min(page.find("{{", at), page.size());
    text += page.substr(at, begin - at);
    if (begin == page.size()) break;
    const std::size_t end = page.find("}}", begin);
    text += parts.at(std::string(page.substr(begin + 2, end - begin - 2)));
    at = end + 2;
  }
  return text;
}

std::string page(const std::string& scene) {
  return filledIn(kViewerHtml, {{"css", kViewerCss},
                                {"three", kThreeJs},
                                {"orbit", kOrbitJs},
                                {"scene", scene},
                                {"viewer", kViewerJs}});
}

}  // namespace

void ViewerOptions::validate() const {
  requireOption(max_points >= 1, "max_points", max_points, "at least 1");
  requireOption(max_grasps >= 0, "max_grasps", max_grasps, "at least 0");
  requireOption(max_faces >= 0, "max_faces", max_faces, "at least 0");
  requireOption(closing_steps >= 1 && closing_steps <= 100, "closing_steps", closing_steps, "in [1, 100]");
  requireOption(retreat_m >= 0 && retreat_m <= 1, "retreat_m", retreat_m, "in [0, 1]");
  requireOption(image_px >= 16 && image_px <= 2048, "image_px", image_px, "in [16, 2048]");
}

Json planScene(const PlanResult& result, const PlanTrace& trace, const HandDescription& hand,
               const ViewerOptions& options) {
  options.validate();
  Json objects = Json::array();
  for (const PlannedObject& object : result.objects) objects.push_back(objectJson(object, options));
  const HandGeometry open = forwardKinematics(hand, {});
  return {
      {"schema", kSchema},
      {"title", options.title},
      {"outcome", describe(result.outcome)},
      {"message", result.message},
      {"model_version", result.model_version},
      {"hand",
       {{"name", hand.name}, {"palm_radius_m", open.palm_radius}, {"palm_thickness_m", open.palm_thickness}}},
      {"retreat_m", options.retreat_m},
      {"up", vectorJson(trace.table ? trace.table->normal_C : Vector3d::UnitZ())},
      {"scene", cloudJson(trace.scene_C, {}, options.max_points)},
      {"objects", objects},
      {"faces", facesJson(trace, options)},
      {"num_grasps", result.grasps.size()},
      {"grasps", graspsJson(hand, result.grasps, options)},
      {"report", reportJson(result.report)}};
}

std::string planPage(const Json& scene) { return page(inScript(scene)); }

std::string livePage() { return page("null"); }

void writePlanPage(const Json& scene, const std::filesystem::path& html) {
  const std::filesystem::path unfinished = html.string() + ".part";
  std::ofstream stream(unfinished, std::ios::binary | std::ios::trunc);
  stream << planPage(scene);
  stream.close();
  std::error_code error;
  if (stream) std::filesystem::rename(unfinished, html, error);
  if (stream && !error) return;
  std::filesystem::remove(unfinished, error);
  throw InputError(fmt::format(
      "cannot write the page to '{}': check that the folder exists and has free space", html.string()));
}

}  // namespace boxgrasp
