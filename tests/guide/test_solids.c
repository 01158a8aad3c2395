/* Solids of which every pixel is known, as meshes: a square, a box and a torus; where they are, how they are turned,
 * how they moved, and the shadows that they throw. Spheres are in test_scenes.c. */
#include "stage.h"

enum { SIDE = 160 };

static const StyTraceOptions SHAPE = {
    .width = SIDE, .height = SIDE, .groups = STY_GUIDE_NORMAL | STY_GUIDE_DEPTH | STY_GUIDE_POSITION | STY_GUIDE_UV};

/* ---- what a pixel looks along, and what it should see there ---- */

/* The stand's ray through a pixel, in the world. Perspective, its depth is its parameter. */
typedef struct Look {
  double from[3], along[3];
  double right[3], up[3], back[3];
} Look;

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double out[3]) {
  for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static void make_unit(double a[3]) {
  const double length = sqrt(dot(a, a));
  for (int k = 0; k < 3; k++) a[k] /= length;
}

static Look look_through(const StyStand *stand, double x, double y) {
  Look look;
  for (int k = 0; k < 3; k++) look.back[k] = stand->position[k] - stand->target[k];
  make_unit(look.back);
  cross(stand->up, look.back, look.right);
  make_unit(look.right);
  cross(look.back, look.right, look.up);
  const double half = stand->perspective ? tan(stand->fov * M_PI / 360) : stand->height / 2;
  const double s = (x / SIDE * 2 - 1) * half, t = (1 - y / SIDE * 2) * half;
  for (int k = 0; k < 3; k++) {
    const double film = s * look.right[k] + t * look.up[k];
    look.from[k] = stand->position[k] + (stand->perspective ? 0 : film);
    look.along[k] = (stand->perspective ? film : 0) - look.back[k];
  }
  return look;
}

/* Where a place of the world is in the picture, pixels. */
static void see(const StyStand *stand, const double at[3], double pixel[2]) {
  const Look look = look_through(stand, SIDE / 2.0, SIDE / 2.0);
  double from[3];
  for (int k = 0; k < 3; k++) from[k] = at[k] - stand->position[k];
  const double depth = stand->perspective ? -dot(from, look.back) : 1;
  const double half = stand->perspective ? tan(stand->fov * M_PI / 360) : stand->height / 2;
  pixel[0] = (dot(from, look.right) / depth / half + 1) / 2 * SIDE;
  pixel[1] = (1 - dot(from, look.up) / depth / half) / 2 * SIDE;
}

typedef struct Seen {
  double depth; /* along the ray, from its start; infinite: nothing there */
  double normal[3], uv[2];
} Seen;

/* Of the ray from `from` along `along`, in the solid's own frame. */
typedef Seen Solid(const double from[3], const double along[3]);

static Seen see_nothing(void) { return (Seen){.depth = INFINITY}; }

static Seen see_square(const double from[3], const double along[3]) {
  const double t = -from[2] / along[2], x = from[0] + t * along[0], y = from[1] + t * along[1];
  if (!(t > 0) || fabs(x) > 1 || fabs(y) > 1) return see_nothing();
  return (Seen){t, {0, 0, along[2] < 0 ? 1 : -1}, {(x + 1) / 2, (y + 1) / 2}};
}

static Seen see_box(const double from[3], const double along[3]) {
  double enter = -INFINITY, leave = INFINITY;
  int first = 0, last = 0;
  for (int k = 0; k < 3; k++) {
    const double a = (-1 - from[k]) / along[k], b = (1 - from[k]) / along[k];
    if (fmin(a, b) > enter) enter = fmin(a, b), first = k;
    if (fmax(a, b) < leave) leave = fmax(a, b), last = k;
  }
  if (enter > leave || leave < 0) return see_nothing();
  const bool inside = enter < 0;
  const int axis = inside ? last : first;
  Seen seen = {.depth = inside ? leave : enter};
  seen.normal[axis] = along[axis] < 0 ? 1 : -1; /* toward the viewer */
  for (int k = 0; k < 2; k++) seen.uv[k] = (from[(axis + 1 + k) % 3] + seen.depth * along[(axis + 1 + k) % 3] + 1) / 2;
  return seen;
}

static double measure_torus(const double at[3]) {
  return hypot(hypot(at[0], at[1]) - TORUS_MIDDLE, at[2]) - TORUS_TUBE;
}

/* By steps as long as the distance to it, which never overshoot; from inside, too. */
static Seen see_torus(const double from[3], const double along[3]) {
  const double length = sqrt(dot(along, along));
  double t = 0, at[3] = {0}, left = INFINITY;
  for (int step = 0; step < 4000 && left > 1e-12 && t * length < 20; step++) {
    for (int k = 0; k < 3; k++) at[k] = from[k] + t * along[k];
    left = fabs(measure_torus(at));
    t += left / length;
  }
  if (left > 1e-9) return see_nothing();
  const double ring = hypot(at[0], at[1]), beside = ring - TORUS_MIDDLE;
  Seen seen = {.depth = t, .normal = {at[0] / ring * beside, at[1] / ring * beside, at[2]}};
  make_unit(seen.normal);
  if (dot(seen.normal, along) > 0) /* from inside the tube */
    for (int k = 0; k < 3; k++) seen.normal[k] *= -1;
  seen.uv[0] = atan2(at[1], at[0]) / (2 * M_PI);
  seen.uv[1] = atan2(at[2], beside) / (2 * M_PI);
  for (int k = 0; k < 2; k++) seen.uv[k] -= floor(seen.uv[k]);
  return seen;
}

static StyMesh *make_fine_torus(void) { return make_surface(place_torus, 768, 384, true, true); }
static StyMesh *make_square(void) { return make_surface(place_square, 1, 1, false, false); }
static StyMesh *make_plain_box(void) { return make_box(1); }

/* Chords of the torus' circles lie at most 0.3 (pi/384)^2 / 2 = 1.0e-5 and (pi/768)^2 / 2 = 0.9e-5 below them, which
 * turns the normal by a third of a tube's radius more; floats of depth have 24 bits. */
static const struct {
  const char *name;
  StyMesh *(*make)(void);
  Solid *solid;
  double tolerance; /* of all values times the cosine between ray and normal, of a solid of size 1 */
} solids[] = {{"square", make_square, see_square, 3e-6},
              {"box", make_plain_box, see_box, 3e-6},
              {"torus", make_fine_torus, see_torus, 7e-5}};
enum { SOLIDS = sizeof solids / sizeof *solids };

/* Of 25600 pixels: where an edge runs through the pixel's centre, by less than the tolerance. */
enum { MOST_ODD = 3 };

/* ---- poses ---- */

/* A turn about a slanted axis, then enlarged, then moved. */
typedef struct Pose {
  double turn, size, to[3];
} Pose;

static void get_matrix(const Pose *pose, double out[3][4]) {
  static const double axis[3] = {2 / 7.0, 3 / 7.0, 6 / 7.0};
  const double c = cos(pose->turn), s = sin(pose->turn);
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    out[i][i] = pose->size * (c + (1 - c) * axis[i] * axis[i]);
    out[i][j] = pose->size * ((1 - c) * axis[i] * axis[j] - s * axis[k]);
    out[i][k] = pose->size * ((1 - c) * axis[i] * axis[k] + s * axis[j]);
    out[i][3] = pose->to[i];
  }
}

static void turn_out(const Pose *pose, const double own[3], double out[3]) {
  double m[3][4];
  get_matrix(pose, m);
  for (int k = 0; k < 3; k++) out[k] = dot(m[k], own);
}

static void turn_in(const Pose *pose, const double world[3], double out[3]) {
  double m[3][4];
  get_matrix(pose, m);
  for (int k = 0; k < 3; k++)
    out[k] = (m[0][k] * world[0] + m[1][k] * world[1] + m[2][k] * world[2]) / pose->size / pose->size;
}

/* `at` is where it was seen, in the solid's own frame. */
static Seen see_posed(Solid *solid, const Pose *pose, const double from[3], const double along[3], double at[3]) {
  double moved[3], own_from[3], own_along[3];
  for (int k = 0; k < 3; k++) moved[k] = from[k] - pose->to[k];
  turn_in(pose, moved, own_from);
  turn_in(pose, along, own_along);
  const Seen seen = solid(own_from, own_along);
  for (int k = 0; k < 3; k++) at[k] = own_from[k] + seen.depth * own_along[k];
  return seen;
}

static StyScene *build(int solid, const Pose *pose) {
  StyScene *scene = open_stage();
  double m[3][4];
  get_matrix(pose, m);
  add_shape(scene, solids[solid].make(), m);
  return scene;
}

static void finish(StyScene *scene) { assert_int_equal(sty_finish_scene(scene, NULL), STY_OK); }

/* The stand that sees the pose as this one sees the solid itself, but for its turn. */
static StyStand follow(const StyStand *stand, const Pose *pose) {
  StyStand out = *stand;
  out.height *= pose->size;
  for (int k = 0; k < 3; k++) {
    out.position[k] = stand->position[k] * pose->size + pose->to[k];
    out.target[k] = stand->target[k] * pose->size + pose->to[k];
  }
  return out;
}

/* ---- where they are --------------------------------------------------------------- */

static double get_turn(double a, double b) { return fmin(fabs(a - b), 1 - fabs(a - b)); }

/* The largest difference of a pixel from what should be there, times the cosine between ray and normal. */
static double measure_pixel(const StyImage *guide, int x, int y, const Seen *seen, const Pose *pose, const Look *look) {
  double normal[3];
  turn_out(pose, seen->normal, normal);
  make_unit(normal);
  double worst = fabs(look_up(guide, "depth.Z", x, y) - seen->depth) / pose->size;
  worst = fmax(worst, fabs(look_up(guide, "normal.X", x, y) - dot(normal, look->right)));
  worst = fmax(worst, fabs(look_up(guide, "normal.Y", x, y) - dot(normal, look->up)));
  worst = fmax(worst, fabs(look_up(guide, "normal.Z", x, y) - dot(normal, look->back)));
  worst = fmax(worst, get_turn(look_up(guide, "uv.U", x, y), seen->uv[0]));
  worst = fmax(worst, get_turn(look_up(guide, "uv.V", x, y), seen->uv[1]));
  return worst * fabs(dot(normal, look->along)) / sqrt(dot(look->along, look->along));
}

static void check_place(int solid, const Pose *pose, const StyStand *near, int least_covered) {
  const StyStand stand = follow(near, pose);
  StyScene *scene = build(solid, pose);
  finish(scene);
  StyImage *guide = trace_from(scene, &stand, SHAPE);
  int odd = 0, covered = 0;
  double at[3];
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      const Look look = look_through(&stand, x + 0.5, y + 0.5);
      const Seen seen = see_posed(solids[solid].solid, pose, look.from, look.along, at);
      covered += isfinite(seen.depth);
      if (isfinite(seen.depth) != (look_up(guide, "A", x, y) > 0))
        odd++;
      else if (isfinite(seen.depth))
        odd += !(measure_pixel(guide, x, y, &seen, pose, &look) < solids[solid].tolerance);
    }
  if (odd > MOST_ODD || covered < least_covered)
    fail_msg("%s of size %g at %g: %d of %d pixels are wrong", solids[solid].name, pose->size, pose->to[0], odd,
             covered);
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

static const StyStand STANDS[] = {
    {.position = {3, 2, 4}, .up = {0, 1, 0}, .height = 3.4},
    {.perspective = true, .position = {-1, 2.5, 3}, .target = {0.1, 0, 0}, .up = {0, 1, 0}, .fov = 45}};

/* Wherever in the world, and of whatever size. */
static void test_places(void **state) {
  (void)state;
  static const Pose poses[] = {{0, 1, {0, 0, 0}},
                               {0.7, 1, {1e8, -1e8, 5e7}},
                               {0.7, 1e-30, {0, 0, 0}},
                               {0.7, 1e-9, {1e-3, 0, 0}},
                               {0.7, 2e29, {0, 0, 0}}};
  for (int solid = 0; solid < SOLIDS; solid++)
    for (int p = 0; p < CASES(5, 2); p++)
      for (int s = 0; s < 2; s++) check_place(solid, &poses[p], &STANDS[s], SIDE * SIDE / 8);
}

/* From inside a closed mesh its walls are seen, as far away as they are, and face the viewer. */
static void test_from_inside(void **state) {
  (void)state;
  static const Pose pose = {0.4, 3, {5, -2, 1}};
  static const StyStand in_box = {
      .perspective = true, .position = {0.2, -0.3, 0.1}, .target = {1, 0.5, 0.3}, .up = {0, 1, 0}, .fov = 100};
  static const Pose upright = {0, 3, {5, -2, 1}};
  static const StyStand in_tube = {
      .perspective = true, .position = {0.7, 0.05, -0.1}, .target = {0.6, 1, 0}, .up = {0, 0, 1}, .fov = 100};
  check_place(1, &pose, &in_box, SIDE * SIDE);
  check_place(2, &upright, &in_tube, SIDE * SIDE);
}

/* ---- how they moved --------------------------------------------------------------- */

/* Each point was where its own place on the solid was before, seen by the camera before. */
static void check_motion(int solid, const StyStand *now, const StyStand *then) {
  static const Pose here = {0.5, 1, {0.1, 0, 0}}, there = {0.4, 1.1, {-0.1, 0.2, 0.1}};
  StyScene *scene = build(solid, &here), *before = build(solid, &there);
  finish(scene);
  finish(before);
  StyCamera camera;
  assert_int_equal(sty_place_camera(before, then, SIDE, SIDE, &camera, NULL), STY_OK);
  StyImage *guide = trace_from(
      scene, now,
      (StyTraceOptions){.width = SIDE, .height = SIDE, .groups = STY_GUIDE_MOTION, .previous = {before, &camera}});
  int odd = 0, covered = 0;
  double at[3], was[3], pixel[2];
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      const Look look = look_through(now, x + 0.5, y + 0.5);
      const Seen seen = see_posed(solids[solid].solid, &here, look.from, look.along, at);
      if (!isfinite(seen.depth) || look_up(guide, "A", x, y) == 0) continue;
      turn_out(&there, at, was);
      for (int k = 0; k < 3; k++) was[k] += there.to[k];
      see(then, was, pixel);
      odd += fabs(look_up(guide, "motion.U", x, y) - (pixel[0] - x - 0.5)) > 0.01 ||
             fabs(look_up(guide, "motion.V", x, y) - (pixel[1] - y - 0.5)) > 0.01;
      covered++;
    }
  if (odd > MOST_ODD || covered < SIDE * SIDE / 8)
    fail_msg("motion of the %s: %d of %d pixels are wrong", solids[solid].name, odd, covered);
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
  sty_destroy_scene(&before);
}

static void test_motion(void **state) {
  (void)state;
  static const StyStand other = {
      .perspective = true, .position = {-1.2, 2.4, 3.3}, .target = {0.1, 0.1, 0}, .up = {0.1, 1, 0}, .fov = 50};
  for (int solid = 0; solid < SOLIDS; solid++) {
    check_motion(solid, &STANDS[0], &STANDS[0]);
    check_motion(solid, &STANDS[1], &other);
  }
}

/* ---- their shadows ---------------------------------------------------------------- */

/* On a plate below: dark where the way to the sun meets the solid, else lit by the cosine. */
static void check_shadow(int solid, const double sun[3]) {
  static const Pose pose = {0.6, 1, {0.2, 0.1, 0}};
  static const double plate[3][4] = {{5, 0, 0, 0}, {0, 5, 0, 0}, {0, 0, 5, -2}};
  static const StyStand above = {.position = {0.5, -1, 6}, .target = {0.5, -1, 0}, .up = {0, 1, 0}, .height = 7};
  StyScene *scene = build(solid, &pose);
  add_shape(scene, make_square(), plate);
  add_sun(scene, sun);
  finish(scene);
  StyImage *guide =
      trace_from(scene, &above,
                 (StyTraceOptions){
                     .width = SIDE, .height = SIDE, .groups = STY_GUIDE_LUMA | STY_GUIDE_OBJECT | STY_GUIDE_POSITION});
  const double to_sun[3] = {-sun[0], -sun[1], -sun[2]}, lit = to_sun[2] / sqrt(dot(sun, sun));
  int odd = 0, dark = 0;
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      if (look_up(guide, "object.I", x, y) != 2) continue;
      const Look look = look_through(&above, x + 0.5, y + 0.5);
      const double from[3] = {look.from[0], look.from[1], -2};
      double at[3];
      const bool hidden = isfinite(see_posed(solids[solid].solid, &pose, from, to_sun, at).depth);
      odd += !(fabs(look_up(guide, "luma.Y", x, y) - (hidden ? 0 : lit)) < 1e-6);
      dark += hidden;
    }
  if (odd > MOST_ODD || dark < SIDE)
    fail_msg("shadow of the %s: %d of %d pixels are wrong", solids[solid].name, odd, dark);
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

static void test_shadows(void **state) {
  (void)state;
  static const double low[3] = {0.8, -0.9, -1}, steep[3] = {0.9, 0.1, -2};
  for (int solid = 0; solid < SOLIDS; solid++) {
    check_shadow(solid, low);
    check_shadow(solid, steep);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_places),
      cmocka_unit_test(test_from_inside),
      cmocka_unit_test(test_motion),
      cmocka_unit_test(test_shadows),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
