// Counting and timing the stages of a plan.
#pragma once

#include <array>
#include <chrono>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace boxgrasp {

// The stages in order. Their names and what each counts are in tally.cc.
enum class StageId {
  scene,
  clean,
  completion,
  decomposition,
  faces,
  approach,
  images,
  regions,
  triplets,
  configurations,
  contacts,
  force_closure,
  clearance,
  reach,
  ranking,
  distinct,
};
inline constexpr std::size_t kStageCount = 16;

struct StageText {
  std::string_view name;
  std::string_view takes;  // what it counts going in
  std::string_view gives;  // ... and coming out
  std::string_view knob;   // what to turn when nothing comes out
};
const StageText& stageText(StageId id);

// What one thread counted; tallies of several threads are added up in a fixed order, so counts do not depend
// on threads.
class Tally {
 public:
  void count(StageId id, std::size_t in, std::size_t out);
  void spend(StageId id, double time_s) { at(id).time_s += time_s; }
  void reject(std::string_view reason, std::size_t n = 1);
  void add(const Tally& other);

  struct Entry {
    std::size_t in = 0, out = 0;
    double time_s = 0.0;
    bool reached = false;
  };
  const Entry& operator[](StageId id) const { return entries_[static_cast<std::size_t>(id)]; }
  const std::map<std::string, std::size_t>& rejected() const { return rejected_; }

 private:
  Entry& at(StageId id) { return entries_[static_cast<std::size_t>(id)]; }
  std::array<Entry, kStageCount> entries_;
  std::map<std::string, std::size_t> rejected_;
};

// Adds the wall time of its own life to one stage.
class StageTimer {
 public:
  StageTimer(Tally& tally, StageId id) : tally_(tally), id_(id) {}
  ~StageTimer() {
    tally_.spend(id_, std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  Tally& tally_;
  StageId id_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Why there is no grasp: the first stage that let nothing through, what it was given, the commonest reasons,
// the knob to turn.
std::string whyNoGrasp(const Tally& tally);

}  // namespace boxgrasp
