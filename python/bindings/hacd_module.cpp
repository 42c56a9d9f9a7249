#include <cstddef>
#include <hacdHACD.h>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "interpreter_lock.h"

namespace {

namespace nb = nanobind;
using HullArray = nb::ndarray<nb::numpy, double, nb::shape<-1, 3>>;
using HullPoints = std::vector<HACD::Vec3<HACD::Real>>;

/// Weights and switches from Bullet's own demo of HACD (ConvexDecompositionDemo).
std::vector<HullPoints> run_hacd(HullPoints points, std::vector<HACD::Vec3<long>> triangles,
                                 std::size_t clusters, std::size_t vertices, double concavity) {
  HACD::HACD hacd;
  hacd.SetPoints(points.data());
  hacd.SetNPoints(points.size());
  hacd.SetTriangles(triangles.data());
  hacd.SetNTriangles(triangles.size());
  hacd.SetCompacityWeight(0.1);
  hacd.SetVolumeWeight(0.0);
  hacd.SetNClusters(clusters);
  hacd.SetNVerticesPerCH(vertices);
  hacd.SetConcavity(concavity);
  hacd.SetAddExtraDistPoints(false);
  hacd.SetAddNeighboursDistPoints(false);
  hacd.SetAddFacesPoints(false);
  if (!hacd.Compute()) return {};
  std::vector<HullPoints> hulls(hacd.GetNClusters());
  for (std::size_t i = 0; i < hulls.size(); ++i) {
    hulls[i].resize(hacd.GetNPointsCH(i));
    std::vector<HACD::Vec3<long>> faces(hacd.GetNTrianglesCH(i));
    hacd.GetCH(i, hulls[i].data(), faces.data());
  }
  return hulls;
}

std::vector<HullArray> decompose(const voxshell::python::PointsArray& vertices,
                                 const voxshell::python::FacesArray& faces, std::size_t clusters,
                                 std::size_t hull_vertices, double concavity) {
  HullPoints points;
  for (const voxshell::Vec3& p : voxshell::python::read_points(vertices)) {
    points.emplace_back(p.x, p.y, p.z);
  }
  std::vector<HACD::Vec3<long>> triangles;
  for (const voxshell::Triangle& t : voxshell::python::read_triangles(faces)) {
    triangles.emplace_back(long{t[0]}, long{t[1]}, long{t[2]});
  }
  std::vector<HullPoints> hulls;
  {
    const voxshell::python::ReleasedInterpreter released;
    hulls = run_hacd(std::move(points), std::move(triangles), clusters, hull_vertices, concavity);
  }
  std::vector<HullArray> arrays;
  for (const HullPoints& hull : hulls) {
    std::vector<double> rows;
    for (const auto& point : hull) rows.insert(rows.end(), {point.X(), point.Y(), point.Z()});
    arrays.push_back(
        voxshell::python::release<double, nb::shape<-1, 3>>(std::move(rows), {hull.size(), 3}));
  }
  return arrays;
}

}  // namespace

NB_MODULE(_hacd, module) {
  module.doc() = "HACD from Bullet's extras, a baseline for voxshell_studies.convex_parts.";
  module.def("decompose", &decompose, nb::arg("vertices"), nb::arg("faces"), nb::kw_only(),
             nb::arg("clusters"), nb::arg("hull_vertices"), nb::arg("concavity"),
             "Return the points of convex hulls that approximate a closed mesh.\n\n"
             "Args:\n"
             "    vertices: (n, 3) float64, any unit.\n"
             "    faces: (m, 3) uint32.\n"
             "    clusters: Smallest number of hulls.\n"
             "    hull_vertices: Largest number of vertices of a hull.\n"
             "    concavity: Largest remaining concavity, for a mesh of size 1000.");
}
