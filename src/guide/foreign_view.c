/* Spaces: what a foreign file's camera makes of its normals, positions and depths. */
#include <math.h>

#include "guide/foreign.h"
#include "scene/vector.h"

static const double unit_tolerance = 0.1;

/* sty_place_camera takes the world for right-handed; in a left-handed one, right is on the other side. */
StyStatus sty_place_foreign_camera(StyImport *import, StyError *error) {
  const StyScene world = {.scale = 1};
  StyError cause = {STY_OK, ""};
  if (!import->options->camera) return STY_OK;
  const StyStatus status = sty_place_camera(&world, import->options->camera, import->file->width, import->file->height,
                                            &import->camera, &cause);
  if (status) return sty_fail(error, status, "%s: %s", import->name, cause.text);
  for (int k = 0; import->program->left_handed && k < 3; k++) import->camera.right[k] *= -1;
  import->has_camera = true;
  return STY_OK;
}

static void rotate_to_view(const StyCamera *camera, const double world[3], double out[3]) {
  const double x = dot_vectors(world, camera->right), y = dot_vectors(world, camera->up),
               z = dot_vectors(world, camera->back);
  out[0] = x, out[1] = y, out[2] = z;
}

static void place_in_world(const StyCamera *camera, const double view[3], double out[3]) {
  for (int k = 0; k < 3; k++)
    out[k] = camera->eye[k] + view[0] * camera->right[k] + view[1] * camera->up[k] + view[2] * camera->back[k];
}

/* A normal of the file in our view space, of the length it has. */
static void turn_normal(const StyImport *import, double normal[3]) {
  if (import->options->flip_y) normal[1] = -normal[1];
  if (import->is_world)
    rotate_to_view(&import->camera, normal, normal);
  else
    normal[2] *= import->toward;
}

/* Where the file says nothing else, most surfaces that are seen face the viewer. */
double sty_find_toward(const StyImport *import) {
  const float *z = sty_get_field(import, STY_FIELD_NORMAL, 2), *covered = sty_find_channel(import->guide, "A");
  size_t toward = 0, away = 0;
  if (import->program->toward_viewer) return import->program->toward_viewer;
  for (size_t i = 0; i < sty_count_pixels(import->file); i++) {
    toward += covered[i] > 0 && z[i] > 0;
    away += covered[i] > 0 && z[i] < 0;
  }
  const bool is_firm = 10 * (toward < away ? toward : away) <= toward + away;
  if (!import->is_world)
    sty_add_note(import->notes, is_firm ? STY_NOTE_ASSUMED : STY_NOTE_WARNING,
                 "camera space has Z %s the viewer, as %.1f %% of the normals face it so",
                 away > toward ? "away from" : "toward",
                 100.0 * (double)(away > toward ? away : toward) / (double)(toward + away > 0 ? toward + away : 1));
  return away > toward ? -1 : 1;
}

bool sty_has_world_positions(const StyImport *import) { return import->program->fixed_world || import->is_world; }

/* A position of the file in view space, from the eye; of a world it takes the camera. */
static void get_view_position(const StyImport *import, size_t pixel, double out[3]) {
  sty_get_vector(import, STY_FIELD_POSITION, pixel, out);
  if (!sty_has_world_positions(import)) {
    out[2] *= import->toward;
    return;
  }
  subtract_vectors(out, import->camera.eye, out);
  rotate_to_view(&import->camera, out, out);
}

/* ---- normals ---- */

static void find_normals(const StyImport *import, float *out[3]) {
  for (int k = 0; k < 3; k++) out[k] = sty_find_channel(import->guide, sty_fields[STY_FIELD_NORMAL].channels[k]);
}

static bool is_unit(const double normal[3]) { return fabs(sqrt(dot_vectors(normal, normal)) - 1) < unit_tolerance; }

void sty_fill_normals(StyImport *import, bool make_unit) {
  const float *covered = sty_find_channel(import->guide, "A");
  float *planes[3];
  find_normals(import, planes);
  for (size_t i = 0; i < sty_count_pixels(import->guide); i++) {
    if (!(covered[i] > 0)) continue;
    double n[3];
    sty_get_vector(import, STY_FIELD_NORMAL, i, n);
    turn_normal(import, n);
    const double length = make_unit && is_unit(n) ? sqrt(dot_vectors(n, n)) : 1;
    for (int k = 0; k < 3; k++) planes[k][i] = (float)(n[k] / length);
  }
}

/* Surfaces that are seen face the viewer, but for roundings and smooth normals at silhouettes; a map in the world's
 * axes, seen along one that lies, has half its normals beyond. */
static const double FACING_AWAY = -0.1, MOST_AWAY = 0.1;

void sty_check_normals(const StyImport *import) {
  const float *covered = sty_find_channel(import->guide, "A");
  float *planes[3];
  size_t count = 0, odd = 0, away = 0;
  find_normals(import, planes);
  for (size_t i = 0; i < sty_count_pixels(import->guide); i++) {
    if (!(covered[i] > 0)) continue;
    const double n[3] = {(double)planes[0][i], (double)planes[1][i], (double)planes[2][i]};
    count++, odd += !is_unit(n), away += n[2] < FACING_AWAY;
  }
  if (odd)
    sty_add_note(
        import->notes, STY_NOTE_WARNING,
        "found normals more than 10 %% off length 1 in %.2f %% of the covered pixels, left as they are; "
        "expected %s",
        100.0 * (double)odd / (double)count,
        2 * odd > count ? "a map of unit normals: is it another picture?" : "unit normals, without anti-aliasing");
  if ((double)away > MOST_AWAY * (double)count)
    sty_add_note(
        import->notes, STY_NOTE_WARNING,
        "found normals facing away from the viewer in %.0f %% of the covered pixels, expected z toward it: is it "
        "another space, camera or program?",
        100.0 * (double)away / (double)count);
}

void sty_note_normals(const StyImport *import) {
  const char *const flipped = import->options->flip_y ? ", Y flipped" : "";
  if (import->is_world)
    sty_add_note(import->notes, STY_NOTE_ASSUMED, "normals are %s world space%s; the camera turned them",
                 import->program->left_handed ? "left-handed" : "right-handed", flipped);
  else
    sty_add_note(import->notes, STY_NOTE_ASSUMED, "normals are view space, +X right, +Y up, +Z %s the viewer%s",
                 import->toward > 0 ? "toward" : "away from", flipped);
}

/* ---- positions and depth ---- */

void sty_fill_positions(StyImport *import) {
  const float *covered = sty_find_channel(import->guide, "A");
  float *planes[3];
  for (int k = 0; k < 3; k++) planes[k] = sty_find_channel(import->guide, sty_fields[STY_FIELD_POSITION].channels[k]);
  for (size_t i = 0; planes[0] && i < sty_count_pixels(import->guide); i++) {
    if (!(covered[i] > 0)) continue;
    double at[3], view[3];
    sty_get_vector(import, STY_FIELD_POSITION, i, at);
    if (!sty_has_world_positions(import)) {
      get_view_position(import, i, view);
      place_in_world(&import->camera, view, at);
    }
    for (int k = 0; k < 3; k++) planes[k][i] = (float)at[k];
  }
}

/* The film's coordinates of a pixel centre, as in scene.h. */
static void get_film(const StyCamera *camera, const StyImage *image, size_t pixel, double film[2]) {
  const double x = (double)(pixel % (size_t)image->width), y = (double)(pixel / (size_t)image->width);
  film[0] = ((x + 0.5) / image->width * 2 - 1) * camera->half_width;
  film[1] = (1 - (y + 0.5) / image->height * 2) * camera->half_height;
}

/* What a distance along the pixel's ray is along the axis. */
static double get_cosine(const StyImport *import, size_t pixel) {
  double film[2];
  if (!import->camera.perspective) return 1;
  get_film(&import->camera, import->file, pixel, film);
  return 1 / sqrt(1 + film[0] * film[0] + film[1] * film[1]);
}

/* Whether the camera sees the positions where the file has them. */
void sty_check_foreign_camera(const StyImport *import) {
  const StyCamera *camera = &import->camera;
  const float *covered = sty_find_channel(import->guide, "A");
  size_t count = 0, elsewhere = 0;
  for (size_t i = 0; i < sty_count_pixels(import->file); i++) {
    if (!(covered[i] > 0)) continue;
    double at[3], film[2];
    get_view_position(import, i, at);
    get_film(camera, import->file, i, film);
    const double scale = camera->perspective ? -1 / at[2] : 1, pixel = 2 * camera->half_height / import->file->height;
    count++;
    elsewhere += !(fabs(at[0] * scale - film[0]) <= 2 * pixel && fabs(at[1] * scale - film[1]) <= 2 * pixel);
  }
  if (2 * elsewhere > count)
    sty_add_note(
        import->notes, STY_NOTE_WARNING,
        "found that the camera sees %.0f %% of the positions elsewhere than at their pixels, expected the file's "
        "own camera and space",
        100.0 * (double)elsewhere / (double)count);
}

/* Positions tell what a depth is that may be either. */
void sty_settle_depth(StyImport *import) {
  const float *depth = sty_get_field(import, STY_FIELD_DEPTH, 0), *covered = sty_find_channel(import->guide, "A");
  size_t axis = 0, ray = 0;
  if (!depth || !import->program->is_unsure) return;
  if (!import->has_camera || !sty_has_field(import, STY_FIELD_POSITION)) {
    sty_add_note(import->notes, STY_NOTE_WARNING,
                 "%s is taken for the distance along the view axis; P and a camera would tell",
                 import->file->names[import->places[STY_FIELD_DEPTH].channels[0]]);
    return;
  }
  for (size_t i = 0; i < sty_count_pixels(import->file); i++) {
    if (!(covered[i] > 0)) continue;
    double at[3];
    get_view_position(import, i, at);
    const double found = (double)depth[i];
    const bool is_ray = fabs(found * get_cosine(import, i) + at[2]) < fabs(found + at[2]);
    ray += is_ray;
    axis += !is_ray;
  }
  import->along_ray = ray > axis;
  sty_add_note(import->notes, STY_NOTE_ASSUMED, "depth is the distance along the %s, as positions tell",
               import->along_ray ? "ray" : "view axis");
}

static double get_depth(const StyImport *import, size_t pixel) {
  double at[3];
  if (import->depth_of == STY_FIELD_POSITION) {
    get_view_position(import, pixel, at);
    return -at[2];
  }
  const double found = (double)sty_get_field(import, import->depth_of, 0)[pixel];
  const bool along_ray = import->along_ray || import->depth_of == STY_FIELD_DISTANCE;
  return along_ray ? found * get_cosine(import, pixel) : found;
}

void sty_fill_depth(StyImport *import) {
  const float *covered = sty_find_channel(import->guide, "A");
  float *depth = sty_find_channel(import->guide, "depth.Z");
  for (size_t i = 0; depth && i < sty_count_pixels(import->guide); i++)
    depth[i] = covered[i] > 0 ? (float)get_depth(import, i) : INFINITY;
}
