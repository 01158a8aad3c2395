/* Rays through the scene's trees, and where they meet what they meet. */
#include "guide/rays.h"

#include <math.h>
#include <string.h>

#include "guide/tracer.h"
#include "scene/points.h"
#include "scene/vector.h"

/* ---- triangles ---- */

/* Not fmin and fmax, which are calls. */
static double clamp(double value, double low, double high) { return value < low ? low : value > high ? high : value; }

static void load_corner(const StyMesh *mesh, size_t vertex, unsigned parts, int corner, int i,
                        StyTriangles *triangles) {
  for (size_t k = 0; k < 3; k++) triangles->corners[corner][k][i] = mesh->positions[3 * vertex + k];
  if (parts & STY_HIT_SHADING)
    for (size_t k = 0; k < 3; k++) triangles->normals[corner][k][i] = mesh->normals[3 * vertex + k];
  if (parts & STY_HIT_UV)
    for (size_t k = 0; k < 2; k++) triangles->uvs[corner][k][i] = mesh->uvs ? mesh->uvs[2 * vertex + k] : 0;
}

static void load_transform(const StyPlaced *placed, int i, StyTriangles *triangles) {
  for (int k = 0; k < 3; k++) {
    for (int l = 0; l < 4; l++) triangles->matrix[k][l][i] = placed->matrix[k][l];
    for (int l = 0; l < 3; l++) triangles->cofactors[k][l][i] = placed->cofactors[k][l];
  }
}

/* Who triangle hit i lies on. */
static void name_owner(const StyPlaced *placed, int i, StyHits *hits) {
  const StyMesh *mesh = placed->mesh;
  const StyObject *object = placed->object;
  const int part = sty_get_part(mesh, hits->triangle[i]) - 1;
  hits->material[i] = &object->material;
  hits->paint[i] = sty_get_paint(object, mesh, part);
  hits->style[i] = object->style;
  hits->object[i] = object->first_id + part;
}

/* All of a block that met triangles, together; other lanes take the first one's triangle, to no end. */
static void hit_triangles(const StyTracer *tracer, const StyRays *rays, const struct RTCRayHit8 *packet, unsigned parts,
                          const bool *is_triangle, StyHits *hits) {
  StyTriangles triangles; /* only what the parts take is set */
  triangles.is_moved = false;
  const StyPlaced *placed[STY_RAYS];
  int first = 0;
  while (!is_triangle[first]) first++;
  for (int i = 0; i < STY_RAYS; i++) {
    const int j = is_triangle[i] ? i : first;
    placed[i] = &tracer->placed[hits->thing[j]];
    const StyMesh *mesh = placed[i]->mesh;
    const uint32_t *indices = &mesh->indices[3 * (size_t)hits->triangle[j]];
    for (int c = 0; c < 3; c++) load_corner(mesh, indices[c], parts, c, i, &triangles);
    for (int k = 0; k < 2; k++) triangles.found[k][i] = k ? packet->hit.v[j] : packet->hit.u[j];
    triangles.is_moved |= !placed[i]->is_unmoved;
    if (parts & STY_HIT_OWNER && is_triangle[i]) name_owner(placed[i], i, hits);
  }
  for (int i = 0; i < STY_RAYS && triangles.is_moved; i++) load_transform(placed[i], i, &triangles);
  tracer->kernels->meet_triangles(rays, &triangles, parts, hits);
  for (int i = 0; i < STY_RAYS && parts & STY_HIT_LEAVE; i++)
    hits->off[i] = STY_FLOAT_SLACK * (hits->off[i] + placed[i]->shift);
}

/* ---- spheres ---- */

void sty_get_sphere_uv(const double out[3], double radius, double uv[2]) {
  uv[0] = 0.5 + atan2(out[0], out[2]) / (2 * M_PI);
  uv[1] = 0.5 + asin(clamp(out[1] / radius, -1, 1)) / M_PI;
}

/* From the sphere's centre to where the ray meets it; from inside, the far wall. A ray that only Embree takes for a hit
 * touches. */
static void meet_sphere(const StyBall *ball, const double origin[3], const double direction[3], double out[3]) {
  double from[3], nearest[3];
  subtract_vectors(origin, ball->centre, from);
  const double a = dot_vectors(direction, direction), b = dot_vectors(from, direction);
  /* The distance of ray and centre, squared, without the cancellation of b*b - a*c. */
  for (int k = 0; k < 3; k++) nearest[k] = from[k] - b / a * direction[k];
  const double half = sqrt(fmax(0, ball->radius * ball->radius - dot_vectors(nearest, nearest)) / a);
  const double t = -b / a - half >= 0 ? -b / a - half : -b / a + half;
  for (int k = 0; k < 3; k++) out[k] = nearest[k] + (t + b / a) * direction[k];
}

static void hit_sphere(const StyBall *ball, const StyRays *rays, int i, StyHits *hits) {
  double origin[3], direction[3], out[3], shading[3], uv[2];
  sty_get_lane(rays->origin, i, origin);
  sty_get_lane(rays->direction, i, direction);
  meet_sphere(ball, origin, direction, out);
  const double side = dot_vectors(out, direction) > 0 ? -1 : 1;
  for (int k = 0; k < 3; k++) shading[k] = side * out[k];
  normalize_vector(shading);
  sty_get_sphere_uv(out, ball->radius, uv);
  for (int k = 0; k < 3; k++) {
    hits->at[k][i] = ball->centre[k] + out[k];
    hits->facet[k][i] = side * out[k];
    hits->shading[k][i] = shading[k];
  }
  for (int k = 0; k < 2; k++) hits->uv[k][i] = uv[k];
  hits->curvature[i] = side / ball->radius;
  hits->off[i] = STY_FLOAT_SLACK * ball->reach;
  hits->material[i] = &ball->sphere->material;
  hits->paint[i] = &ball->sphere->material.paint;
  hits->style[i] = ball->sphere->style;
  hits->object[i] = ball->sphere->id;
}

/* ---- rays ---- */

static void find_hits(const StyTracer *tracer, const StyRays *rays, const struct RTCRayHit8 *packet, unsigned parts,
                      const int *valid, StyHits *hits) {
  const unsigned objects = (unsigned)tracer->model->object_count;
  bool is_triangle[STY_RAYS], any = false;
  for (int i = 0; i < STY_RAYS; i++) {
    is_triangle[i] = false;
    if (!valid[i]) continue;
    const unsigned instance = packet->hit.instID[0][i], primitive = packet->hit.primID[i];
    hits->thing[i] = instance == RTC_INVALID_GEOMETRY_ID ? packet->hit.geomID[i] : instance;
    hits->triangle[i] = primitive;
    is_triangle[i] = hits->thing[i] != objects;
    any |= is_triangle[i];
  }
  if (any) hit_triangles(tracer, rays, packet, parts, is_triangle, hits);
  for (int i = 0; i < STY_RAYS; i++) {
    if (!valid[i] || is_triangle[i]) continue;
    const unsigned sphere = hits->triangle[i];
    hits->thing[i] = objects + sphere;
    hit_sphere(&tracer->balls[sphere], rays, i, hits);
  }
}

static void set_rays(struct RTCRay8 *packet, const StyRays *rays) {
  float *const origin[] = {packet->org_x, packet->org_y, packet->org_z};
  float *const direction[] = {packet->dir_x, packet->dir_y, packet->dir_z};
  for (int k = 0; k < 3; k++) {
    EACH_LANE origin[k][i] = (float)rays->origin[k][i];
    EACH_LANE direction[k][i] = (float)rays->direction[k][i];
  }
  EACH_LANE {
    packet->tnear[i] = 0;
    packet->tfar[i] = INFINITY;
    packet->time[i] = 0;
    packet->mask[i] = ~0u;
    packet->id[i] = 0;
    packet->flags[i] = 0;
  }
}

bool sty_trace_rays(const StyTracer *tracer, const StyRays *rays, bool coherent, unsigned parts, int *valid,
                    StyHits *hits) {
  struct RTCIntersectContext context;
  _Alignas(32) struct RTCRayHit8 packet;
  rtcInitIntersectContext(&context);
  if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  set_rays(&packet.ray, rays);
  EACH_LANE packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  EACH_LANE packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  sty_embree.rtcIntersect8(valid, tracer->scene, &context, &packet);
  int any = 0;
  EACH_LANE {
    valid[i] = packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? 0 : valid[i];
    any |= valid[i];
  }
  if (any) find_hits(tracer, rays, &packet, parts, valid, hits);
  return any;
}

void sty_copy_hit(const StyHits *hits, int i, StyHits *out) {
  for (int k = 0; k < 3; k++) {
    out->at[k][i] = hits->at[k][i];
    out->facet[k][i] = hits->facet[k][i];
    out->shading[k][i] = hits->shading[k][i];
    out->weights[k][i] = hits->weights[k][i];
  }
  for (int k = 0; k < 2; k++) out->uv[k][i] = hits->uv[k][i];
  out->curvature[i] = hits->curvature[i];
  out->off[i] = hits->off[i];
  out->thing[i] = hits->thing[i];
  out->triangle[i] = hits->triangle[i];
  out->paint[i] = hits->paint[i];
  out->material[i] = hits->material[i];
  out->style[i] = hits->style[i];
  out->object[i] = hits->object[i];
}

void sty_leave_hit(const StyHits *hits, int i, const double to[3], StyRay *out) {
  double facet[3];
  sty_get_lane(hits->facet, i, facet);
  normalize_vector(facet);
  /* Where only the interpolated normal faces the light, the facet is seen from behind by it. */
  const double off = dot_vectors(facet, to) < 0 ? -hits->off[i] : hits->off[i];
  for (int k = 0; k < 3; k++) out->origin[k] = hits->at[k][i] + off * facet[k];
  memcpy(out->direction, to, sizeof out->direction);
}

/* What a lamp touches doesn't hide it: shadow rays end this share of their length before it. */
static const double LAMP_SLACK = 0x1p-18;

void sty_trace_shadows(const StyTracer *tracer, const StyHits *hits, const StyLane to[3], const StyLane distances,
                       int *asks) {
  struct RTCIntersectContext context;
  _Alignas(32) struct RTCRay8 packet;
  StyRays rays = {0};
  rtcInitIntersectContext(&context);
  for (int i = 0; i < STY_RAYS; i++) {
    if (!asks[i]) continue;
    double direction[3];
    StyRay ray;
    sty_get_lane(to, i, direction);
    sty_leave_hit(hits, i, direction, &ray);
    sty_set_ray(&rays, i, &ray);
  }
  set_rays(&packet, &rays);
  for (int i = 0; i < STY_RAYS; i++)
    if (asks[i]) packet.tfar[i] = (float)(distances[i] * (1 - LAMP_SLACK));
  sty_embree.rtcOccluded8(asks, tracer->scene, &context, &packet);
  for (int i = 0; i < STY_RAYS; i++)
    if (asks[i] && packet.tfar[i] < 0) asks[i] = 0;
}

/* ---- another scene ---- */

static void follow_sphere(const StyScene *scene, const StyHits *hits, int i, const StyScene *other, double at[3]) {
  const unsigned number = hits->thing[i] - (unsigned)scene->object_count;
  const StySphere *sphere = &scene->spheres[number], *then = &other->spheres[number];
  const double growth = then->radius * other->scale / (sphere->radius * scene->scale);
  double centre[3];
  sty_get_trace_point(scene, sphere->centre, centre);
  sty_get_trace_point(other, then->centre, at);
  for (int k = 0; k < 3; k++) at[k] += (hits->at[k][i] - centre[k]) * growth;
}

static void follow_triangle(const StyHits *hits, int i, const StyScene *other, double at[3]) {
  const StyPlaced placed = sty_place_object(other, &other->objects[hits->thing[i]]);
  const uint32_t *indices = &placed.mesh->indices[3 * (size_t)hits->triangle[i]];
  double own[3] = {0, 0, 0};
  for (int c = 0; c < 3; c++)
    for (size_t k = 0; k < 3; k++)
      own[k] += hits->weights[c][i] * (double)placed.mesh->positions[3 * (size_t)indices[c] + k];
  for (int k = 0; k < 3; k++) at[k] = dot_vectors(placed.matrix[k], own) + placed.matrix[k][3];
}

void sty_follow_hit(const StyScene *scene, const StyHits *hits, int i, const StyScene *other, double at[3]) {
  if (hits->thing[i] >= (unsigned)scene->object_count)
    follow_sphere(scene, hits, i, other, at);
  else
    follow_triangle(hits, i, other, at);
}
