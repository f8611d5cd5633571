// A test as a client that speaks the wire itself.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "boxgrasp/messaging/channels.h"
#include "boxgrasp/messaging/lcm_bus.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "boxgrasp/objects/parametric.h"

namespace boxgrasp::test {

// A port of this process's own, so that test programs can run at the same time where they share a network.
inline const std::string& url() {
  static const std::string text = fmt::format("udpm://239.255.76.67:{}?ttl=0", 20000 + getpid() % 20000);
  return text;
}

inline PointCloud cup(std::size_t points = 20'000) {
  return sampleSurface(parametricObject("paper_cup"), points, 1);
}

class Wire {
 public:
  using Clock = std::chrono::steady_clock;

  Wire() : bus_({.url = url()}) {
    bus_.subscribe(channel::kPlanResponse, kMaxMessageBytes, [this](auto bytes) {
      answers.push_back(decoded<plan_response_t>(bytes));
      raw.emplace_back(bytes.begin(), bytes.end());
    });
    bus_.subscribe(channel::kStatus, kMaxMessageBytes,
                   [this](auto bytes) { status = decoded<status_t>(bytes); });
    bus_.subscribe(channel::kModelReply, kMaxMessageBytes,
                   [this](auto bytes) { publications.push_back(decoded<model_reply_t>(bytes)); });
  }

  plan_request_t request(const std::string& id, double deadline_s = 0.0, std::size_t points = 4000) const {
    PlanRequest plan;
    plan.cloud_C = cup(points);
    return toMessage(plan, {id, "camera", deadline_s, 1});
  }
  // Its plan takes some 20 s with slow.toml, and looks at its stop token all the time.
  plan_request_t slowRequest(const std::string& id, double deadline_s = 0.0) const {
    return request(id, deadline_s, 300'000);
  }
  template <typename Message>
  void send(const std::string& to, const Message& message) {
    bus_.publish(to, message);
  }
  // Looks at the condition after each message, and every wait_ms.
  bool until(const std::function<bool()>& condition, double timeout_s = 20.0, int wait_ms = 20) {
    const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);
    while (!condition() && Clock::now() < end) bus_.wait(wait_ms);
    return condition();
  }
  const plan_response_t* answer(const std::string& id) const {
    for (const plan_response_t& a : answers) {
      if (a.request_id == id) return &a;
    }
    return nullptr;
  }
  // The answer to a request sent now; a null pointer if none comes.
  const plan_response_t* ask(const plan_request_t& message) {
    send(channel::kPlanRequest, message);
    until([&] { return answer(message.request_id) != nullptr; });
    return answer(message.request_id);
  }
  // What the server says to a publication sent now; its message says so if it says nothing.
  model_reply_t publish(const publish_model_t& message) {
    send(channel::kPublishModel, message);
    model_reply_t reply{};
    reply.outcome = -1;
    reply.message = "no reply came";
    until([&] {
      for (const model_reply_t& one : publications) {
        if (one.request_id == message.request_id) reply = one;
      }
      return reply.outcome >= 0;
    });
    return reply;
  }
  bool active(const std::string& id) const {
    return std::find(status.active.begin(), status.active.end(), id) != status.active.end();
  }
  void freshStatus() {
    const auto before = status.utime;
    until([&] { return status.utime != before; });
  }

  std::vector<plan_response_t> answers;
  std::vector<std::vector<std::uint8_t>> raw;
  std::vector<model_reply_t> publications;
  status_t status{};

 private:
  LcmBus bus_;
};

}  // namespace boxgrasp::test
