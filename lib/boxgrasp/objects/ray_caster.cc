#include "boxgrasp/objects/ray_caster.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <limits>

namespace boxgrasp {
namespace {

void copyMesh(RTCGeometry geometry, const TriangleMesh& mesh) {
  auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
  for (const Vector3d& p : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) *vertex++ = static_cast<float>(p[axis]);
  }
  auto* corner = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) corner = std::copy(triangle.begin(), triangle.end(), corner);
}

RTCRay rayFrom(const Vector3d& origin, const Vector3d& direction, double near, double far) {
  const Eigen::Vector3f o = origin.cast<float>(), d = direction.cast<float>();
  RTCRay ray{};
  ray.org_x = o.x(), ray.org_y = o.y(), ray.org_z = o.z();
  ray.dir_x = d.x(), ray.dir_y = d.y(), ray.dir_z = d.z();
  ray.tnear = static_cast<float>(near);
  ray.tfar = static_cast<float>(far);
  ray.mask = ~0u;
  return ray;
}

}  // namespace

RayCaster::RayCaster(std::vector<TriangleMesh> meshes) : meshes_(std::move(meshes)) {
  RTCDevice device = rtcNewDevice("threads=1");
  scene_.reset(rtcNewScene(device), rtcReleaseScene);
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
  for (const TriangleMesh& mesh : meshes_) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    copyMesh(geometry, mesh);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene_.get());
  rtcReleaseDevice(device);  // the scene keeps it
}

std::optional<RayHit> RayCaster::first(const Vector3d& origin, const Vector3d& direction) const {
  RTCRayHit query{rayFrom(origin, direction, 0.0, std::numeric_limits<double>::infinity()), {}};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const TriangleMesh& mesh = meshes_[query.hit.geomID];
  const auto [ia, ib, ic] = mesh.triangles[query.hit.primID];
  const Vector3d& a = mesh.vertices[ia];
  const Vector3d normal = (mesh.vertices[ib] - a).cross(mesh.vertices[ic] - a).normalized();
  return RayHit{normal.dot(a - origin) / normal.dot(direction), query.hit.geomID, normal};
}

bool RayCaster::blocked(const Vector3d& from, const Vector3d& to, double margin) const {
  const double distance = (to - from).norm();
  RTCRay ray = rayFrom(from, (to - from) / distance, margin, distance - margin);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_.get(), &context, &ray);
  return ray.tfar < 0.0f;
}

}  // namespace boxgrasp
