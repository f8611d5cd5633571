#include "boxgrasp/wrench/hull.h"

#include <libqhull_r/qhull_ra.h>

#include <Eigen/QR>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>

#include "boxgrasp/base/tolerances.h"

namespace boxgrasp {
namespace {

std::vector<Wrench> distinct(std::vector<Wrench> points) {
  std::sort(points.begin(), points.end(), [](const Wrench& a, const Wrench& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

bool spansSpace(const std::vector<Wrench>& points) {
  if (points.size() < 7) return false;
  Eigen::Matrix<double, 6, Eigen::Dynamic> edges(6, points.size() - 1);
  for (std::size_t i = 1; i < points.size(); ++i) edges.col(i - 1) = points[i] - points[0];
  Eigen::ColPivHouseholderQR<decltype(edges)> qr(edges);
  return qr.setThreshold(tolerance::kWrenchRank).rank() == 6;
}

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

  // Keeps a reference to the points.
  int run(std::vector<Wrench>& points) {
    char command[] = "qhull QJ FA Pp";
    return qh_new_qhull(&state_, 6, static_cast<int>(points.size()), points.front().data(), false, command,
                        nullptr, log_.stream());
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

WrenchHull wrenchHull(std::vector<Wrench> points) {
  points = distinct(std::move(points));
  if (!spansSpace(points)) return {};
  Qhull hull;
  const int code = hull.run(points);
  if (code == qh_ERRsingular) return {};
  if (code != qh_ERRnone) throw std::runtime_error("qhull failed on a grasp wrench space: " + hull.log());
  return {hull.inradius(), hull.volume()};
}

}  // namespace boxgrasp
