#include "boxgrasp/planning/object_grasps.h"

#include <iterator>
#include <utility>

#include "boxgrasp/base/parallel.h"
#include "boxgrasp/planning/face_grasps.h"

namespace boxgrasp {
namespace {

constexpr double kObjectCell_m = 0.006;  // of the grid over an object: about the search radius of contacts

// One way to look for grasps.
struct Attempt {
  PlannerOptions options;
  Surroundings surroundings;
  std::string note;
};

// Each allows what the one before did, and more; the next is tried where one finds nothing.
std::vector<Attempt> attemptsOn(const ObjectWork& work, const PlannedObject& object) {
  Attempt next{work.options, work.surroundings, ""};
  EdgeUse& edges = next.options.faces.edges;
  if (edges == EdgeUse::partial && !work.surroundings.viewpoints_C.empty()) edges = EdgeUse::always;
  std::vector<Attempt> attempts{next};
  if (edges == EdgeUse::last || edges == EdgeUse::partial) {
    edges = EdgeUse::always;
    next.note = "no grasp comes over a face; these come over edges";
    attempts.push_back(next);
  }
  if (work.options.guessed_faces && object.guessed > 0) {
    next.surroundings.viewpoints_C.clear();
    next.note = "no grasp on the side that was seen; these come to the one that was guessed";
    attempts.push_back(next);
  }
  if (work.options.force_closure == ForceClosureUse::prefer) {
    next.options.force_closure = ForceClosureUse::ignore;
    next.note = "no grasp's contacts are in force closure; these are without";
    attempts.push_back(next);
  }
  return attempts;
}

class ObjectSearch {
 public:
  ObjectSearch(const ObjectWork& work, const PlannedObject& object, int index, bool traced)
      : work_(work),
        object_(object),
        index_(index),
        traced_(traced),
        grid_C_(object.cloud_C, kObjectCell_m) {}

  ObjectGrasps search(const Attempt& attempt) const {
    ObjectGrasps found;
    found.note = attempt.note;
    std::vector<FaceDecision> decisions = decide(attempt, found.tally);
    keepAllowedApproaches(decisions, found.tally);
    searchFaces(attempt, decisions, found);
    return found;
  }

 private:
  std::vector<FaceDecision> decide(const Attempt& attempt, Tally& tally) const {
    const StageTimer timer(tally, StageId::faces);
    std::vector<FaceDecision> decisions =
        graspableFaces(object_.tree, object_.cloud_C, work_.scene_grid_C, attempt.surroundings,
                       attempt.options.faces, work_.stop);
    std::size_t graspable = 0;
    for (const FaceDecision& decision : decisions) {
      graspable += decision.graspable();
      if (!decision.graspable()) tally.reject(describe(decision.rejection));
    }
    tally.count(StageId::faces, decisions.size(), graspable);
    return decisions;
  }

  // A hand comes along the z of the face that it grasps at.
  void keepAllowedApproaches(std::vector<FaceDecision>& decisions, Tally& tally) const {
    if (!work_.robot.restrictsApproach()) return;
    const StageTimer timer(tally, StageId::approach);
    std::size_t graspable = 0, allowed = 0;
    for (FaceDecision& decision : decisions) {
      if (!decision.graspable()) continue;
      ++graspable;
      if (work_.robot.mayComeAlong(decision.face.X_CF.linear().col(2))) {
        ++allowed;
      } else {
        decision.rejection = FaceRejection::not_allowed;
        tally.reject(describe(decision.rejection));
      }
    }
    tally.count(StageId::approach, graspable, allowed);
  }

  void searchFaces(const Attempt& attempt, const std::vector<FaceDecision>& decisions,
                   ObjectGrasps& found) const {
    const FaceWork work{work_.hand,
                        attempt.options,
                        object_,
                        index_,
                        grid_C_,
                        work_.scene_grid_C,
                        work_.surroundings.viewpoints_C,
                        work_.robot,
                        work_.surroundings.gravity_C,
                        work_.stop};
    std::vector<std::vector<Grasp>> grasps(decisions.size());
    std::vector<Tally> tallies(decisions.size());
    found.traces.resize(decisions.size());
    parallelFor(decisions.size(), attempt.options.threads, [&](std::size_t i) {
      FaceTrace& trace = found.traces[i];
      trace.object = index_;
      trace.decision = decisions[i];
      if (decisions[i].graspable())
        grasps[i] = graspsOnFace(work, decisions[i].face, tallies[i], traced_ ? &trace : nullptr);
    });
    for (const Tally& tally : tallies) found.tally.add(tally);
    for (auto& on_face : grasps) std::move(on_face.begin(), on_face.end(), std::back_inserter(found.grasps));
  }

  const ObjectWork& work_;
  const PlannedObject& object_;
  int index_;
  bool traced_;
  PointGrid grid_C_;
};

}  // namespace

ObjectGrasps graspsOnObject(const ObjectWork& work, const PlannedObject& object, int index, bool traced) {
  const ObjectSearch search(work, object, index, traced);
  const std::vector<Attempt> attempts = attemptsOn(work, object);
  ObjectGrasps first = search.search(attempts.front());
  if (!first.grasps.empty()) return first;
  for (std::size_t i = 1; i < attempts.size(); ++i) {
    ObjectGrasps other = search.search(attempts[i]);
    if (!other.grasps.empty()) return other;
  }
  return first;
}

}  // namespace boxgrasp
