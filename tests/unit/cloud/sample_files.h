// Small valid files of every format, built in memory.
#pragma once

#include <liblzf/lzf.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp::sample_files {

struct SampleFile {
  std::string name, format, bytes;
  bool mesh = false;
};

// Nine points of a slanted plane; every coordinate is exact in decimal and in binary.
inline PointCloud points() {
  PointCloud cloud;
  for (int i = 0; i < 9; ++i) cloud.push({0.25 * (i % 3), 0.5 * (i / 3), 0.125 * i - 0.5});
  return cloud;
}

template <typename T>
std::string raw(T value, bool swap = false) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (swap) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

inline std::string row(const PointCloud& cloud, std::size_t i, const std::string& separator = " ") {
  return std::to_string(cloud.x[i]) + separator + std::to_string(cloud.y[i]) + separator +
         std::to_string(cloud.z[i]);
}

inline std::string pcdHeader(const std::string& data, const std::string& points = "9",
                             const std::string& width = "3", const std::string& height = "3") {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z label\nSIZE 4 4 4 4\nTYPE F "
         "F F U\n"
         "COUNT 1 1 1 1\nWIDTH " +
         width + "\nHEIGHT " + height + "\nVIEWPOINT 0.5 0 -1 1 0 0 0\nPOINTS " + points + "\nDATA " + data +
         "\n";
}

inline std::string pcdAscii() {
  std::string bytes = pcdHeader("ascii");
  for (std::size_t i = 0; i < 9; ++i) bytes += row(points(), i) + " " + std::to_string(7 + i) + "\n";
  return bytes;
}

inline std::string pcdBinary() {
  const PointCloud cloud = points();
  std::string bytes = pcdHeader("binary");
  for (std::size_t i = 0; i < 9; ++i) {
    bytes += raw(cloud.x[i]) + raw(cloud.y[i]) + raw(cloud.z[i]) + raw(static_cast<std::uint32_t>(7 + i));
  }
  return bytes;
}

inline std::string pcdCompressed() {
  const PointCloud cloud = points();
  std::string plain;
  for (const auto* axis : {&cloud.x, &cloud.y, &cloud.z}) {
    for (const float value : *axis) plain += raw(value);
  }
  for (std::uint32_t i = 0; i < 9; ++i) plain += raw(7 + i);
  std::string packed(2 * plain.size(), '\0');
  packed.resize(lzf_compress(plain.data(), static_cast<unsigned>(plain.size()), packed.data(),
                                 static_cast<unsigned>(packed.size())));
  return pcdHeader("binary_compressed") + raw(static_cast<std::uint32_t>(packed.size())) +
         raw(static_cast<std::uint32_t>(plain.size())) + packed;
}

inline std::string plyHeader(const std::string& format, bool faces) {
  return "ply\nformat " + format +
         " 1.0\ncomment made here\nelement vertex 9\nproperty float x\nproperty double y\n"
         "property uchar red\nproperty float z\n" +
         (faces ? std::string("element face 2\nproperty list uchar int vertex_indices\nproperty short part\n")
                : std::string()) +
         "end_header\n";
}

inline std::string plyAscii(bool faces) {
  const PointCloud cloud = points();
  std::string bytes = plyHeader("ascii", faces);
  for (std::size_t i = 0; i < 9; ++i) {
    bytes += std::to_string(cloud.x[i]) + " " + std::to_string(cloud.y[i]) + " 200 " +
             std::to_string(cloud.z[i]) + "\n";
  }
  return bytes + (faces ? "4 0 1 4 3 9\n3 4 5 8 9\n" : "");
}

inline std::string plyBinary(bool swap, bool faces) {
  const PointCloud cloud = points();
  std::string bytes = plyHeader(swap ? "binary_big_endian" : "binary_little_endian", faces);
  for (std::size_t i = 0; i < 9; ++i) {
    bytes += raw(cloud.x[i], swap) + raw(static_cast<double>(cloud.y[i]), swap) + raw(std::uint8_t{200}) +
             raw(cloud.z[i], swap);
  }
  for (const std::vector<int>& polygon : {std::vector<int>{0, 1, 4, 3}, std::vector<int>{4, 5, 8}}) {
    if (!faces) break;
    bytes += raw(static_cast<std::uint8_t>(polygon.size()));
    for (const int corner : polygon) bytes += raw(corner, swap);
    bytes += raw(std::int16_t{9}, swap);
  }
  return bytes;
}

inline std::string xyz(const std::string& separator, const std::string& header) {
  std::string bytes = header;
  for (std::size_t i = 0; i < 9; ++i) bytes += row(points(), i, separator) + separator + "255\n";
  return bytes;
}

// The tetrahedron with corners at the origin and one along each axis.
inline std::string off() {
  return "OFF # a tetrahedron\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3 255 0 0\n3 0 3 2\n3 1 2 "
         "3\n";
}

inline std::string obj() {
  return "# a tetrahedron\no t\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nf 1//1 3//1 2//1\nf 1 2 4\nf 1 "
         "4 3\n"
         "f -3/2 -2/1 -1/1\n";
}

inline constexpr int kTetrahedron[4][3][3] = {{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}},
                                              {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}},
                                              {{0, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                              {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

inline std::string stlAscii() {
  std::string bytes = "solid t\n";
  for (const auto& triangle : kTetrahedron) {
    bytes += "facet normal 0 0 0\n outer loop\n";
    for (const auto& v : triangle) {
      bytes +=
          "  vertex " + std::to_string(v[0]) + " " + std::to_string(v[1]) + " " + std::to_string(v[2]) + "\n";
    }
    bytes += " endloop\nendfacet\n";
  }
  return bytes + "endsolid t\n";
}

inline std::string stlBinary() {
  std::string bytes(80, 's');
  bytes += raw(std::uint32_t{4});
  for (const auto& triangle : kTetrahedron) {
    bytes += std::string(12, '\0');
    for (const auto& v : triangle) {
      for (const int value : v) bytes += raw(static_cast<float>(value));
    }
    bytes += std::string(2, '\0');
  }
  return bytes;
}

inline std::vector<SampleFile> clouds() {
  return {{"a.pcd", "pcd ascii", pcdAscii()},
          {"b.pcd", "pcd binary", pcdBinary()},
          {"c.pcd", "pcd binary_compressed", pcdCompressed()},
          {"d.ply", "ply", plyAscii(false)},
          {"e.ply", "ply", plyBinary(false, false)},
          {"f.ply", "ply", plyBinary(true, false)},
          {"g.xyz", "xyz", xyz(" ", "# comment\n\n")},
          {"h.csv", "xyz", xyz(";", "x;y;z;grey\n")},
          {"i.txt", "xyz", xyz(", ", "")}};
}

inline std::vector<SampleFile> meshes() {
  return {{"a.off", "off", off(), true},
          {"b.obj", "obj", obj(), true},
          {"c.stl", "stl", stlAscii(), true},
          {"d.stl", "stl", stlBinary(), true},
          {"e.ply", "ply", plyAscii(true), true},
          {"f.ply", "ply", plyBinary(false, true), true},
          {"g.ply", "ply", plyBinary(true, true), true}};
}

inline std::vector<SampleFile> all() {
  auto files = clouds();
  for (auto& mesh : meshes()) files.push_back(std::move(mesh));
  return files;
}

}  // namespace boxgrasp::sample_files
