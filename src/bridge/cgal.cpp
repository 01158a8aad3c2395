#include "bridge/cgal.h"

#include <cstdlib>

#include "stylut/version.h"

void sty_destroy_field_mesh(StyFieldMesh *mesh) {
  std::free(mesh->vertices);
  std::free(mesh->triangles);
  *mesh = StyFieldMesh{};
}

#ifndef STY_WITH_CGAL

StyStatus sty_mesh_field(StyField *, void *, const StyFieldBounds *, StyFieldMesh *, StyError *error) {
  return sty_fail(error, STY_ERROR_UNAVAILABLE, "meshing: stylut was built without CGAL");
}

const char *sty_get_geometry_library_version(void) { return nullptr; }

#else

#include <CGAL/Complex_2_in_triangulation_3.h>
#include <CGAL/IO/facets_in_complex_2_to_triangle_mesh.h>
#include <CGAL/Implicit_surface_3.h>
#include <CGAL/Random.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_default_triangulation_3.h>
#include <CGAL/make_surface_mesh.h>
#include <CGAL/version.h>

#include <cmath>

#include "bridge/guard.h"

#define QUOTE_TOKEN(token) #token
#define QUOTE_VALUE(macro) QUOTE_TOKEN(macro)

namespace {

using Triangulation = CGAL::Surface_mesh_default_triangulation_3;
using Complex = CGAL::Complex_2_in_triangulation_3<Triangulation>;
using Kernel = Triangulation::Geom_traits;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

struct FieldFunction {
  using FT = Kernel::FT;
  using Point = Kernel::Point_3;
  StyField *field;
  void *context;
  FT operator()(const Point &p) const {
    const double point[3] = {p.x(), p.y(), p.z()};
    return field(context, point);
  }
};

bool is_positive(double value) { return std::isfinite(value) && value > 0.0; }

Mesh mesh_field(StyField *field, void *context, const StyFieldBounds &bounds) {
  const Point center(bounds.center[0], bounds.center[1], bounds.center[2]);
  const Kernel::Sphere_3 ball(center, bounds.radius * bounds.radius);
  const CGAL::Implicit_surface_3<Kernel, FieldFunction> surface(FieldFunction{field, context}, ball, 1e-6);
  const CGAL::Surface_mesh_default_criteria_3<Triangulation> criteria(bounds.angle, bounds.size, bounds.distance);
  CGAL::get_default_random() = CGAL::Random(0);
  Triangulation triangulation;
  Complex complex(triangulation);
  CGAL::make_surface_mesh(complex, surface, criteria, CGAL::Manifold_tag());
  Mesh mesh;
  CGAL::facets_in_complex_2_to_triangle_mesh(complex, mesh);
  return mesh;
}

StyStatus copy_mesh(const Mesh &mesh, StyFieldMesh *out, StyError *error) {
  StyFieldMesh copy{};
  copy.vertex_count = mesh.number_of_vertices();
  copy.triangle_count = mesh.number_of_faces();
  const std::size_t vertex_bytes = copy.vertex_count * sizeof *copy.vertices;
  const std::size_t triangle_bytes = copy.triangle_count * sizeof *copy.triangles;
  copy.vertices = static_cast<double(*)[3]>(std::malloc(vertex_bytes));
  copy.triangles = static_cast<uint32_t(*)[3]>(std::malloc(triangle_bytes));
  if (copy.vertices == nullptr || copy.triangles == nullptr) {
    sty_destroy_field_mesh(&copy);
    return sty_fail_memory(error, "a mesh", static_cast<double>(vertex_bytes + triangle_bytes));
  }
  for (const auto vertex : mesh.vertices()) {
    const Point &p = mesh.point(vertex);
    for (int axis = 0; axis < 3; axis++) {
      copy.vertices[vertex.idx()][axis] = p[axis];
    }
  }
  for (const auto face : mesh.faces()) {
    int corner = 0;
    for (const auto vertex : mesh.vertices_around_face(mesh.halfedge(face))) {
      copy.triangles[face.idx()][corner++] = vertex.idx();
    }
  }
  *out = copy;
  return STY_OK;
}

}  // namespace

StyStatus sty_mesh_field(StyField *field, void *context, const StyFieldBounds *bounds, StyFieldMesh *out,
                         StyError *error) {
  if (!is_positive(bounds->radius) || !is_positive(bounds->angle) || !is_positive(bounds->size) ||
      !is_positive(bounds->distance)) {
    return sty_fail(error, STY_ERROR_INPUT,
                    "meshing: radius %g, angle %g, size %g, distance %g: expected positive numbers", bounds->radius,
                    bounds->angle, bounds->size, bounds->distance);
  }
  if (!(field(context, bounds->center) < 0.0)) {
    return sty_fail(error, STY_ERROR_INPUT, "meshing: centre (%g, %g, %g) is not inside the surface", bounds->center[0],
                    bounds->center[1], bounds->center[2]);
  }
  return guard("a mesh", 0.0, error, [&] {
    const Mesh mesh = mesh_field(field, context, *bounds);
    if (mesh.number_of_faces() == 0) {
      return sty_fail(error, STY_ERROR_INPUT, "meshing: no surface within %g of the centre", bounds->radius);
    }
    return copy_mesh(mesh, out, error);
  });
}

const char *sty_get_geometry_library_version(void) { return "CGAL " QUOTE_VALUE(CGAL_VERSION); }

#endif
