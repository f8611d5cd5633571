#include "boxgrasp/wrench/general_hull.h"

#include <libqhull_r/qhull_ra.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>

namespace boxgrasp {
namespace {

// What qhull does about more than six points near one facet's plane. It either merges the facets, and gives
// up when a merged one is no longer flat; or it moves every point a little, at random but always alike, and
// farther where that does not help. Moving the points by r moves the inradius by at most r. Merging pays off
// with many points.
enum class Precision { merge, joggle };

constexpr std::size_t kFewPoints = 50;
constexpr double kMaxJoggle = 1e-9;  // of the largest coordinate

// Takes what qhull would print, for the message of an exception.
class Log {
 public:
  Log() : stream_(open_memstream(&text_, &size_)) {
    if (!stream_) throw std::bad_alloc();
  }
  ~Log() {
    std::fclose(stream_);
    std::free(text_);
  }
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  std::FILE* stream() { return stream_; }
  std::string text() { return std::fflush(stream_) == 0 ? std::string(text_, size_) : std::string(); }

 private:
  char* text_ = nullptr;
  std::size_t size_ = 0;
  std::FILE* stream_;
};

// One run of qhull with its memory. Its errors come back as an exit code, never as a jump out of run().
class Qhull {
 public:
  Qhull() { qh_zero(&state_, log_.stream()); }
  ~Qhull() {
    qh_freeqhull(&state_, !qh_ALL);
    int blocks = 0, bytes = 0;
    qh_memfreeshort(&state_, &blocks, &bytes);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  // Keeps a reference to the points. Did it end within rounding of their hull?
  bool run(std::vector<Wrench>& points, Precision precision) {
    char merge[] = "qhull Qx FA Pp", joggle[] = "qhull QJ FA Pp";
    const bool merges = precision == Precision::merge;
    const int code = qh_new_qhull(&state_, 6, static_cast<int>(points.size()), points.front().data(), false,
                                  merges ? merge : joggle, nullptr, log_.stream());
    return code == qh_ERRnone && (merges || state_.JOGGLEmax <= kMaxJoggle * state_.MAXabs_coord);
  }

  double inradius() const {
    double result = std::numeric_limits<double>::infinity();
    for (const facetT* facet = state_.facet_list; facet && facet->next; facet = facet->next) {
      result = std::min(result, -facet->offset);
    }
    return result;
  }
  double volume() const { return state_.totvol; }
  std::string log() { return log_.text(); }

 private:
  Log log_;
  qhT state_;
};

}  // namespace

WrenchHull generalHull(std::vector<Wrench> points) {
  const bool few = points.size() <= kFewPoints;
  std::string log;
  for (const Precision precision :
       {few ? Precision::joggle : Precision::merge, few ? Precision::merge : Precision::joggle}) {
    Qhull hull;
    if (hull.run(points, precision)) return {hull.inradius(), hull.volume()};
    log += hull.log();
  }
  throw std::runtime_error("qhull cannot tell the facets of a grasp wrench space: " + log);
}

}  // namespace boxgrasp
