#include "boxgrasp/wrench/grasp_wrench_space.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/tolerances.h"
#include "boxgrasp/wrench/hull.h"
#include "boxgrasp/wrench/positive_span.h"
#include "boxgrasp/wrench/three_cone_hull.h"

namespace boxgrasp {
namespace {

constexpr std::size_t kMaxSumPoints = 10000;  // four contacts of eight edges; a hull of some seconds
constexpr std::size_t kMaxUnionPoints = 128;  // a hull of half a second; twice as many take up to four
constexpr double kAlongX = 1.0 - 1e-9;        // a normal's |x| above which the x axis gives no tangent

double frictionOf(const Contact& contact, const WrenchOptions& options) {
  return contact.friction < 0.0 ? options.friction : contact.friction;
}

void requireContact(std::size_t index, const Contact& contact) {
  const Vector3d &p = contact.p_C, &n = contact.normal_C;
  if (!p.allFinite()) {
    throw InputError(fmt::format("contact {}: its position is ({}, {}, {}), but must be finite", index, p.x(),
                                 p.y(), p.z()));
  }
  if (!(std::abs(n.norm() - 1.0) <= tolerance::kUnitVector)) {
    throw InputError(
        fmt::format("contact {}: its normal ({}, {}, {}) has the length {}, but must be a unit vector: "
                    "divide it by its length",
                    index, n.x(), n.y(), n.z(), n.norm()));
  }
  if (std::isnan(contact.friction) || std::isinf(contact.friction)) {
    throw InputError(
        fmt::format("contact {}: its friction is {}, but must be finite, or negative for the "
                    "options' coefficient",
                    index, contact.friction));
  }
}

// The tangential directions of a cone's edges.
std::vector<Vector2d> edgeDirections(int edges) {
  std::vector<Vector2d> directions;
  for (int j = 0; j < edges; ++j) {
    const double angle = 2.0 * std::numbers::pi * j / edges;
    directions.emplace_back(std::cos(angle), std::sin(angle));
  }
  return directions;
}

ForceCone coneOf(const Contact& contact, const std::vector<Vector2d>& directions,
                 const WrenchOptions& options) {
  const Vector3d& n = contact.normal_C;
  const Vector3d tx = n.cross(std::abs(n.x()) > kAlongX ? Vector3d::UnitZ() : Vector3d::UnitX()).normalized();
  const Vector3d ty = n.cross(tx).normalized();
  const double friction = frictionOf(contact, options);
  ForceCone cone{(contact.p_C - options.p_CG) / options.torque_scale_m, n, {}};
  cone.edges.resize(friction > 0.0 ? directions.size() : 1);
  for (std::size_t j = 0; j < cone.edges.size(); ++j)
    cone.edges[j] = n + friction * (directions[j].x() * tx + directions[j].y() * ty);
  return cone;
}

std::vector<Wrench> edgeWrenches(const ForceCone& cone) {
  std::vector<Wrench> result(cone.edges.size());
  for (std::size_t j = 0; j < result.size(); ++j) result[j] << cone.edges[j], cone.arm.cross(cone.edges[j]);
  return result;
}

std::vector<ForceCone> conesOf(const std::vector<Contact>& contacts, const WrenchOptions& options) {
  options.validate();
  const std::vector<Vector2d> directions = edgeDirections(options.cone_edges);
  std::vector<ForceCone> result;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    requireContact(i, contacts[i]);
    result.push_back(coneOf(contacts[i], directions, options));
  }
  return result;
}

std::vector<std::vector<Wrench>> edgesOf(const std::vector<ForceCone>& cones) {
  std::vector<std::vector<Wrench>> result;
  for (const ForceCone& cone : cones) result.push_back(edgeWrenches(cone));
  return result;
}

std::vector<Wrench> unionOf(const std::vector<std::vector<Wrench>>& edges) {
  std::vector<Wrench> result;
  for (const auto& of_contact : edges) result.insert(result.end(), of_contact.begin(), of_contact.end());
  return result;
}

void requireSumFits(const std::vector<std::vector<Wrench>>& edges) {
  double points = 1.0;
  for (const auto& of_contact : edges) points *= 1.0 + of_contact.size();
  if (points > kMaxSumPoints) {
    throw InputError(
        fmt::format("the Minkowski sum of {} contacts has {:.0f} points, more than {}: take fewer "
                    "contacts or cone edges, or the norm l1",
                    edges.size(), points, kMaxSumPoints));
  }
}

// Every contact gives one of its edges, or nothing.
std::vector<Wrench> sumOf(const std::vector<std::vector<Wrench>>& edges) {
  requireSumFits(edges);
  std::vector<Wrench> result{Wrench::Zero()};
  for (const auto& of_contact : edges) {
    const std::size_t without = result.size();
    for (const Wrench& edge : of_contact) {
      for (std::size_t i = 0; i < without; ++i) result.push_back(result[i] + edge);
    }
  }
  return result;
}

void requireUnionFits(std::size_t contacts, std::size_t points) {
  if (points > kMaxUnionPoints) {
    throw InputError(fmt::format(
        "the cones of {} contacts have {} edges, more than {} where they are not three in general "
        "position: take fewer contacts or cone edges",
        contacts, points, kMaxUnionPoints));
  }
}

WrenchHull unionHull(const std::vector<ForceCone>& cones, const std::vector<Wrench>& points) {
  const bool three = cones.size() == 3 &&
                     std::ranges::all_of(cones, [](const ForceCone& cone) { return cone.edges.size() > 1; });
  if (three) {
    if (const auto hull = threeConeHull({cones[0], cones[1], cones[2]})) return *hull;
  }
  requireUnionFits(cones.size(), points.size());
  return wrenchHull(points);
}

double largest(const std::vector<Wrench>& wrenches) {
  double result = 0.0;
  for (const Wrench& wrench : wrenches) result = std::max(result, wrench.norm());
  return result;
}

}  // namespace

void WrenchOptions::validate() const {
  requireOption(friction >= 0.0 && std::isfinite(friction), "friction", friction, "finite and at least 0");
  requireOption(cone_edges >= 3 && cone_edges <= 64, "cone_edges", cone_edges, "from 3 to 64");
  if (!p_CG.allFinite())
    throw InputError(
        fmt::format("option 'p_CG' is ({}, {}, {}), but must be finite", p_CG.x(), p_CG.y(), p_CG.z()));
  requireOption(torque_scale_m > 0.0 && std::isfinite(torque_scale_m), "torque_scale_m", torque_scale_m,
                "finite and above 0");
}

std::vector<Wrench> edgeWrenches(const Contact& contact, const WrenchOptions& options) {
  return edgeWrenches(coneOf(contact, edgeDirections(options.cone_edges), options));
}

GraspQuality graspQuality(const std::vector<Contact>& contacts, const WrenchOptions& options) {
  const std::vector<ForceCone> cones = conesOf(contacts, options);
  const auto edges = edgesOf(cones);
  const std::vector<Wrench> points = options.norm == WrenchNorm::l1 ? unionOf(edges) : sumOf(edges);
  const WrenchHull hull = options.norm == WrenchNorm::l1 ? unionHull(cones, points) : wrenchHull(points);
  const bool closed = hull.inradius > tolerance::kWrenchMargin * largest(points);
  return {closed ? hull.inradius : -1.0, hull.volume, closed};
}

bool forceClosure(const std::vector<Contact>& contacts, const WrenchOptions& options) {
  return positivelySpan(unionOf(edgesOf(conesOf(contacts, options))));
}

}  // namespace boxgrasp
