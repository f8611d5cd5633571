// Messages with something in every member, for tests of the wire.
#pragma once

#include <fmt/format.h>

#include "boxgrasp/base/random.h"
#include "boxgrasp/messaging/cloud_conversion.h"
#include "boxgrasp/messaging/codec.h"

namespace boxgrasp::test {

inline PointCloud randomCloud(std::mt19937_64& random, std::size_t n) {
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i)
    cloud.push({uniform(random, -1, 1), uniform(random, -1, 1), normal(random)});
  return cloud;
}

inline plan_request_t randomRequest(std::mt19937_64& random, std::size_t points = 20) {
  plan_request_t message{};
  message.utime = static_cast<std::int64_t>(random() >> 1);
  message.request_id = fmt::format("request {}", random());
  message.cloud = toMessage(randomCloud(random, points), "camera");
  message.cloud.filler = {1, 2, 3};
  message.cloud.filler_size = 3;
  message.top_k = 7;
  message.deadline_s = uniform(random);
  message.friction = uniform(random);
  message.object = -1;
  message.has_gravity = 1;
  message.gravity[2] = -1;
  message.forbidden.resize(2);
  message.viewpoints.resize(2);
  message.num_viewpoints = 2;
  for (viewpoint_t& viewpoint : message.viewpoints) viewpoint = {{uniform(random), 2, 3}};
  for (region_t& region : message.forbidden) region = {{-1, -1, -1}, {uniform(random), 1, 1}};
  message.num_forbidden = 2;
  return message;
}

inline plan_response_t randomResponse(std::mt19937_64& random) {
  plan_response_t message{};
  message.request_id = "an id";
  message.frame = "camera";
  message.message = "two grasps";
  message.grasps.resize(2);
  for (grasp_t& grasp : message.grasps) {
    grasp = {};
    grasp.score = normal(random);
  }
  message.num_grasps = 2;
  message.boxes.resize(3);
  for (box_t& box : message.boxes) box.stop_reason = "too small";
  message.num_boxes = 3;
  message.stages.resize(1);
  message.stages[0].name = "scene";
  message.num_stages = 1;
  message.rejected.resize(2);
  message.num_rejected = 2;
  message.notes = {"a note", ""};
  message.num_notes = 2;
  return message;
}

}  // namespace boxgrasp::test
