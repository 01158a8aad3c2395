#include "bridge/surface.h"

#include <cstdlib>

void sty_destroy_winding(StyWinding *winding) {
  std::free(winding->corners);
  std::free(winding->turned);
  std::free(winding->origins);
  *winding = StyWinding{};
}

#ifndef STY_WITH_CGAL

static StyStatus fail_unavailable(StyError *error) {
  return sty_fail(error, STY_ERROR_UNAVAILABLE, "repairing and simplifying meshes: stylut was built without CGAL");
}

StyStatus sty_wind_triangles(const StyTriangles *, StyWinding *, StyError *error) { return fail_unavailable(error); }
StyStatus sty_open_surface(const StyTriangles *, const StyWinding *, const StyCollapseRules *, StySurface **,
                           StyError *error) {
  return fail_unavailable(error);
}
StyStatus sty_copy_surface(const StySurface *, StySurface **, StyError *error) { return fail_unavailable(error); }
StyStatus sty_collapse_surface(StySurface *, size_t, StyError *error) { return fail_unavailable(error); }
void sty_close_surface(StySurface **) {}
size_t sty_count_surface(const StySurface *) { return 0; }
void sty_list_surface(const StySurface *, uint32_t *, uint32_t *) {}

#else

#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Edge_collapse_visitor_base.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <array>
#include <cmath>
#include <cstring>
#include <new>
#include <unordered_map>
#include <vector>

#include "bridge/guard.h"

namespace {

namespace simplification = CGAL::Surface_mesh_simplification;

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Vector = Kernel::Vector_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Vertex = Mesh::Vertex_index;
using Edge = Mesh::Halfedge_index;
using Face = Mesh::Face_index;

template <class Body>
StyStatus guard_surface(StyError *error, const Body &body) {
  return guard("a surface", 0.0, error, body);
}

Point get_point(const StyTriangles &triangles, std::size_t p) {
  const float *at = triangles.points + 3 * p;
  return Point(at[0], at[1], at[2]);
}

// ---- winding

using Polygon = std::array<std::size_t, 3>;

struct Watch : CGAL::Polygon_mesh_processing::Default_orientation_visitor {
  std::vector<unsigned char> *turned;
  std::vector<uint32_t> *origins;
  void polygon_orientation_reversed(std::size_t polygon) { (*turned)[polygon] ^= 1; }
  void duplicated_vertex(std::size_t from, std::size_t to) {
    if (origins->size() <= to) origins->resize(to + 1);
    (*origins)[to] = (*origins)[from];
  }
};

bool is_triangle(const StyTriangles &triangles, std::size_t t) {
  const uint32_t *c = triangles.corners + 3 * t;
  return c[0] < triangles.point_count && c[1] < triangles.point_count && c[2] < triangles.point_count && c[0] != c[1] &&
         c[1] != c[2] && c[2] != c[0];
}

template <class T>
T *copy_list(const std::vector<T> &list) {
  T *copy = static_cast<T *>(std::malloc(list.size() * sizeof(T)));
  if (copy == nullptr) throw std::bad_alloc();
  std::copy(list.begin(), list.end(), copy);
  return copy;
}

StyStatus wind(const StyTriangles &triangles, StyWinding *winding, StyError *error) {
  std::vector<Point> points;
  std::vector<Polygon> polygons;
  std::vector<unsigned char> turned(triangles.triangle_count);
  std::vector<uint32_t> origins, corners;
  for (std::size_t p = 0; p < triangles.point_count; p++) {
    points.push_back(get_point(triangles, p));
    origins.push_back(static_cast<uint32_t>(p));
  }
  for (std::size_t t = 0; t < triangles.triangle_count; t++) {
    const uint32_t *c = triangles.corners + 3 * t;
    if (!is_triangle(triangles, t))
      return sty_fail(error, STY_ERROR_INPUT, "triangle %zu joins the points %u, %u and %u, expected three of %zu",
                      t + 1, c[0], c[1], c[2], triangles.point_count);
    polygons.push_back({c[0], c[1], c[2]});
  }
  Watch watch;
  watch.turned = &turned;
  watch.origins = &origins;
  CGAL::Polygon_mesh_processing::orient_polygon_soup(points, polygons, CGAL::parameters::visitor(watch));
  for (const Polygon &polygon : polygons)
    for (const std::size_t p : polygon) corners.push_back(static_cast<uint32_t>(p));
  winding->point_count = points.size();
  winding->corners = copy_list(corners);
  winding->turned = copy_list(turned);
  winding->origins = copy_list(origins);
  return STY_OK;
}

}  // namespace

StyStatus sty_wind_triangles(const StyTriangles *triangles, StyWinding *out, StyError *error) {
  StyWinding winding{};
  const StyStatus status = guard_surface(error, [&] { return wind(*triangles, &winding, error); });
  if (status != STY_OK)
    sty_destroy_winding(&winding);
  else
    *out = winding;
  return status;
}

// ---- surfaces

struct StySurface {
  Mesh mesh;
  double angle, distance;
  std::vector<unsigned char> fixed;
  std::vector<Vector> normals;  // of points, but for those that have several:
  std::unordered_map<uint64_t, Vector> wedges;
  Mesh::Property_map<Vertex, uint32_t> origins;
  Mesh::Property_map<Vertex, double> spent;
  Mesh::Property_map<Face, uint32_t> numbers, groups;

  // Property maps belong to one mesh, so that a copy looks up its own.
  void find_properties() {
    origins = mesh.add_property_map<Vertex, uint32_t>("v:origin").first;
    spent = mesh.add_property_map<Vertex, double>("v:spent", 0.0).first;
    numbers = mesh.add_property_map<Face, uint32_t>("f:number").first;
    groups = mesh.add_property_map<Face, uint32_t>("f:group").first;
  }

  static uint64_t get_key(uint32_t point, uint32_t group) { return static_cast<uint64_t>(point) << 32 | group; }

  const Vector &get_normal(Vertex vertex, uint32_t group) const {
    const auto wedge = wedges.find(get_key(origins[vertex], group));
    return wedge == wedges.end() ? normals[origins[vertex]] : wedge->second;
  }
};

namespace {

bool is_seam(const StySurface &surface, Edge edge) {
  const Edge opposite = surface.mesh.opposite(edge);
  if (surface.mesh.is_border(edge) || surface.mesh.is_border(opposite)) return true;
  return surface.groups[surface.mesh.face(edge)] != surface.groups[surface.mesh.face(opposite)];
}

using Profile = simplification::Edge_collapse_visitor_base<Mesh>::Profile;
using Cost = boost::optional<double>;
using Placement = boost::optional<Point>;

// Among a point's triangles within one group, the one that takes its place, and by how much it misses.
struct Heir {
  uint32_t group;
  double area = 0.0;      // of the group's triangles around the point
  double inside = -1e30;  // least weight of the point's projection
  double miss = 0.0;
};

double square(double value) { return value * value; }

double get_area(const Point &a, const Point &b, const Point &c) {
  return std::sqrt(CGAL::cross_product(b - a, c - a).squared_length()) / 2.0;
}

// Weights of the corners at p's projection to their plane; false: no plane.
bool project(const std::array<Point, 3> &corners, const Point &p, std::array<double, 3> &weights) {
  const Vector ab = corners[1] - corners[0], ac = corners[2] - corners[0], ap = p - corners[0];
  const double bb = ab * ab, cc = ac * ac, bc = ab * ac, determinant = bb * cc - bc * bc;
  if (!(determinant > 0.0)) return false;
  weights[1] = (cc * (ab * ap) - bc * (ac * ap)) / determinant;
  weights[2] = (bb * (ac * ap) - bc * (ab * ap)) / determinant;
  weights[0] = 1.0 - weights[1] - weights[2];
  return true;
}

double get_squared_distance(const Point &p, const Point &a, const Point &b) {
  const Vector ab = b - a, ap = p - a;
  const double length = ab.squared_length(), t = length > 0.0 ? std::fmin(std::fmax(ap * ab / length, 0.0), 1.0) : 0.0;
  return (ap - t * ab).squared_length();
}

// Pulls the end of an edge that costs less to lose into the other.
class Pull {
 public:
  explicit Pull(const StySurface *surface) : surface_(surface), mesh_(surface->mesh) {}

  // As the placement: where both ends end up.
  Placement operator()(const Profile &profile) const {
    const Cost without_first = lose(profile, profile.v0(), profile.v1()),
               without_second = lose(profile, profile.v1(), profile.v0());
    if (!without_first && !without_second) return Placement();
    if (!without_second) return profile.p1();
    if (!without_first) return profile.p0();
    return *without_first < *without_second ? profile.p1() : profile.p0();
  }

  // As the cost of that.
  Cost operator()(const Profile &profile, const Placement &placement) const {
    if (!placement) return Cost();
    const bool is_first = *placement == profile.p1();
    return is_first ? lose(profile, profile.v0(), profile.v1()) : lose(profile, profile.v1(), profile.v0());
  }

 private:
  Cost lose(const Profile &profile, Vertex lost, Vertex kept) const {
    if (surface_->fixed[surface_->origins[lost]]) return Cost();
    const Point &from = mesh_.point(lost), &to = mesh_.point(kept);
    std::array<Heir, 2> heirs;
    std::size_t heir_count = 0, seams = 0;
    double seam_miss = 0.0, area = 0.0, cost = surface_->spent[lost];
    for (const Edge edge : mesh_.halfedges_around_target(mesh_.halfedge(lost))) {
      if (is_seam(*surface_, edge)) {
        if (++seams > 2) return Cost();
        const Vertex before = mesh_.source(edge);
        if (before != kept) seam_miss = get_squared_distance(from, mesh_.point(before), to);
      }
      if (mesh_.is_border(edge)) continue;
      const uint32_t group = surface_->groups[mesh_.face(edge)];
      std::size_t h = 0;
      while (h < heir_count && heirs[h].group != group) h++;
      if (h == heirs.size()) return Cost();
      if (h == heir_count) heirs[heir_count++].group = group;
      measure(edge, lost, kept, &heirs[h]);
    }
    if (seams == 1 || (seams == 2 && !is_seam(*surface_, profile.v0_v1()))) return Cost();
    for (std::size_t h = 0; h < heir_count; h++) {
      cost += heirs[h].area * heirs[h].miss;
      area += heirs[h].area;
    }
    // Where nothing is missed, as within a plane, short edges go first: else fans would grow there.
    const double short_first = 1e-6 * (to - from).squared_length();
    return cost + area * (seam_miss + short_first) / square(surface_->distance);
  }

  // The triangle before `edge`, which ends at the point that goes.
  void measure(Edge edge, Vertex lost, Vertex kept, Heir *heir) const {
    const Vertex a = mesh_.source(edge), b = mesh_.target(mesh_.next(edge));
    const Point &from = mesh_.point(lost);
    heir->area += get_area(from, mesh_.point(a), mesh_.point(b));
    if (a == kept || b == kept) return;
    const std::array<Point, 3> corners = {mesh_.point(kept), mesh_.point(b), mesh_.point(a)};
    std::array<double, 3> weights;
    if (!project(corners, from, weights)) return;
    const double inside = std::fmin(std::fmin(weights[0], weights[1]), weights[2]);
    if (inside <= heir->inside) return;
    heir->inside = inside;
    heir->miss = get_miss({kept, b, a}, corners, weights, lost, heir->group);
  }

  double get_miss(const std::array<Vertex, 3> &vertices, const std::array<Point, 3> &corners,
                  std::array<double, 3> weights, Vertex lost, uint32_t group) const {
    double sum = 0.0;
    for (double &weight : weights) sum += weight = std::fmax(weight, 0.0);
    Vector normal = CGAL::NULL_VECTOR, at = CGAL::NULL_VECTOR;
    for (std::size_t k = 0; k < 3; k++) {
      normal = normal + weights[k] / sum * surface_->get_normal(vertices[k], group);
      at = at + weights[k] / sum * (corners[k] - CGAL::ORIGIN);
    }
    const double length = std::sqrt(normal.squared_length());
    if (length > 0.0) normal = normal / length;
    const Vector turned = normal - surface_->get_normal(lost, group), moved = at - (mesh_.point(lost) - CGAL::ORIGIN);
    return turned.squared_length() / square(surface_->angle) + moved.squared_length() / square(surface_->distance);
  }

  const StySurface *surface_;
  const Mesh &mesh_;
};

struct Keep : simplification::Edge_collapse_visitor_base<Mesh> {
  StySurface *surface;
  uint32_t kept = 0;
  double spent = 0.0;
  void OnSelected(const Profile &, const Cost &cost, std::size_t, std::size_t) { spent = cost ? *cost : 0.0; }
  void OnCollapsing(const Profile &profile, const Placement &placement) {
    if (!placement) return;
    const Vertex vertex = *placement == profile.p1() ? profile.v1() : profile.v0();
    kept = surface->origins[vertex];
    spent += surface->spent[vertex];
  }
  void OnCollapsed(const Profile &, const Vertex &vertex) {
    surface->origins[vertex] = kept;
    surface->spent[vertex] = spent;
  }
};

struct Stop {
  const Mesh *mesh;
  std::size_t target;
  template <class F, class P>
  bool operator()(const F &, const P &, std::size_t, std::size_t) const {
    return mesh->number_of_faces() <= target;
  }
};

void fill_normals(const StyTriangles &triangles, const StyCollapseRules &rules, StySurface *surface) {
  surface->normals.assign(triangles.point_count, CGAL::NULL_VECTOR);
  std::vector<unsigned char> seen(triangles.point_count);
  for (std::size_t c = 0; c < 3 * triangles.triangle_count; c++) {
    const uint32_t point = triangles.corners[c];
    const Vector normal(rules.normals[3 * c], rules.normals[3 * c + 1], rules.normals[3 * c + 2]);
    if (!seen[point]) surface->normals[point] = normal;
    seen[point] = 1;
    if (normal != surface->normals[point])
      surface->wedges.emplace(StySurface::get_key(point, rules.groups[c / 3]), normal);
  }
}

StyStatus fill_surface(const StyTriangles &triangles, const StyWinding &winding, const StyCollapseRules &rules,
                       StySurface *surface, StyError *error) {
  surface->find_properties();
  surface->angle = rules.angle;
  surface->distance = rules.distance;
  surface->fixed.assign(rules.fixed, rules.fixed + triangles.point_count);
  fill_normals(triangles, rules, surface);
  for (std::size_t p = 0; p < winding.point_count; p++)
    surface->origins[surface->mesh.add_vertex(get_point(triangles, winding.origins[p]))] = winding.origins[p];
  for (std::size_t t = 0; t < triangles.triangle_count; t++) {
    const uint32_t *c = winding.corners + 3 * t;
    const Face face = surface->mesh.add_face(Vertex(c[0]), Vertex(c[1]), Vertex(c[2]));
    if (face == Mesh::null_face())
      return sty_fail(error, STY_ERROR_INPUT, "triangle %zu does not fit its neighbours, expected a surface", t + 1);
    surface->numbers[face] = static_cast<uint32_t>(t);
    surface->groups[face] = rules.groups[t];
  }
  return STY_OK;
}

}  // namespace

StyStatus sty_open_surface(const StyTriangles *triangles, const StyWinding *winding, const StyCollapseRules *rules,
                           StySurface **out, StyError *error) {
  StySurface *surface = nullptr;
  const StyStatus status = guard_surface(error, [&] {
    surface = new StySurface;
    return fill_surface(*triangles, *winding, *rules, surface, error);
  });
  if (status != STY_OK)
    sty_close_surface(&surface);
  else
    *out = surface;
  return status;
}

StyStatus sty_copy_surface(const StySurface *surface, StySurface **out, StyError *error) {
  return guard_surface(error, [&] {
    StySurface *copy = new StySurface(*surface);
    copy->find_properties();
    *out = copy;
    return STY_OK;
  });
}

void sty_close_surface(StySurface **surface) {
  delete *surface;
  *surface = nullptr;
}

StyStatus sty_collapse_surface(StySurface *surface, size_t target, StyError *error) {
  return guard_surface(error, [&] {
    const Pull pull(surface);
    Keep keep;
    keep.surface = surface;
    simplification::edge_collapse(surface->mesh, Stop{&surface->mesh, target},
                                  CGAL::parameters::get_cost(pull)
                                      .get_placement(pull)
                                      .filter(simplification::Bounded_normal_change_filter<>())
                                      .visitor(keep));
    surface->mesh.collect_garbage();
    return STY_OK;
  });
}

size_t sty_count_surface(const StySurface *surface) { return surface->mesh.number_of_faces(); }

void sty_list_surface(const StySurface *surface, uint32_t *corners, uint32_t *numbers) {
  for (const Face face : surface->mesh.faces()) {
    *numbers++ = surface->numbers[face];
    for (const Vertex vertex : surface->mesh.vertices_around_face(surface->mesh.halfedge(face)))
      *corners++ = surface->origins[vertex];
  }
}

#endif
