#include "boxgrasp/live/plan_history.h"

#include <algorithm>
#include <iterator>

namespace boxgrasp {
namespace {

template <typename T>
std::size_t bytesOf(const std::vector<T>& values) {
  return values.capacity() * sizeof(T);
}

std::size_t bytesOf(const PointCloud& cloud) {
  return bytesOf(cloud.x) + bytesOf(cloud.y) + bytesOf(cloud.z);
}

std::size_t bytesOf(const PlannedObject& object) {
  std::size_t bytes = bytesOf(object.cloud_C) + bytesOf(object.tree.nodes);
  for (const BoxNode& node : object.tree.nodes) bytes += bytesOf(node.points);
  return bytes;
}

std::size_t bytesOf(const FaceTrace& face) {
  std::size_t bytes = bytesOf(face.image.gray) + bytesOf(face.image.farthest) + bytesOf(face.regions) +
                      bytesOf(face.triplets);
  for (const Contour& contour : face.contours) bytes += sizeof contour + bytesOf(contour.points_F);
  return bytes;
}

}  // namespace

std::size_t MadePlan::bytes() const {
  std::size_t bytes = sizeof *this + bytesOf(trace.scene_C) + bytesOf(trace.faces) + bytesOf(result.grasps);
  for (const PlannedObject& object : result.objects) bytes += bytesOf(object);
  for (const FaceTrace& face : trace.faces) bytes += bytesOf(face);
  return bytes;
}

void PlanHistory::add(const plan_response_t& answer, MadePlanPtr plan) {
  const std::size_t bytes = answer.request_id.size() + answer.message.size() + (plan ? plan->bytes() : 0);
  std::list<Entry> removed;  // freed when others no longer wait for the lock
  const std::lock_guard lock(mutex_);
  entries_.push_front({{++last_id_, answer.request_id, answer.utime, answer.outcome, answer.message,
                        answer.model_version, answer.num_grasps, answer.time_s, std::move(plan)},
                       bytes});
  removed = takeSurplus();
}

std::list<PlanHistory::Entry> PlanHistory::takeSurplus() {
  const auto surplus = [&] {
    std::uint64_t bytes = 0;
    for (const Entry& entry : entries_) bytes += entry.bytes;
    return entries_.size() > max_count_ || bytes > max_bytes_;
  };
  std::list<Entry> removed;
  while (!entries_.empty() && surplus()) removed.splice(removed.end(), entries_, nextToGo());
  return removed;
}

std::list<PlanHistory::Entry>::iterator PlanHistory::nextToGo() {
  const auto unplanned = [](const Entry& entry) { return entry.request.plan == nullptr; };
  const auto count = static_cast<std::uint64_t>(std::count_if(entries_.begin(), entries_.end(), unplanned));
  if (2 * count <= max_count_) return std::prev(entries_.end());
  return std::prev(std::find_if(entries_.rbegin(), entries_.rend(), unplanned).base());
}

std::vector<AnsweredRequest> PlanHistory::newestFirst() const {
  const std::lock_guard lock(mutex_);
  std::vector<AnsweredRequest> requests;
  for (const Entry& entry : entries_) requests.push_back(entry.request);
  return requests;
}

std::optional<AnsweredRequest> PlanHistory::find(std::int64_t id) const {
  const std::lock_guard lock(mutex_);
  for (const Entry& entry : entries_) {
    if (entry.request.id == id) return entry.request;
  }
  return std::nullopt;
}

}  // namespace boxgrasp
