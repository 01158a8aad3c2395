/* A foreign file into a guide: what is taken, where a surface is, and what needs no camera. */
#include "guide/foreign.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stylut/guide.h"

/* Depths of misses: 1e10 and what 16-bit floats make of it, 1e30, infinity, or nothing at all. */
static const float far_depth = 1e9f, half_maximum = 65504;
static const double least_alpha = 1.0 / 256;
static const float exact_ids = 16777216; /* up to here float has all integers */

/* ---- what the parts share ---- */

void sty_add_note(StyNotes *notes, StyNoteKind kind, const char *format, ...) {
  if (notes->count == STY_MOST_NOTES) return;
  struct StyNote *line = &notes->list[notes->count++];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(line->text, sizeof line->text, format, arguments);
  va_end(arguments);
  sty_clean_text(line->text);
  line->kind = kind;
}

bool sty_has_field(const StyImport *import, StyField field) { return import->places[field].channels[0] >= 0; }

const float *sty_get_field(const StyImport *import, StyField field, int component) {
  const int channel = import->places[field].channels[component];
  return channel < 0 ? NULL : import->file->data + (size_t)channel * sty_count_pixels(import->file);
}

void sty_get_vector(const StyImport *import, StyField field, size_t pixel, double out[3]) {
  for (int k = 0; k < 3; k++) out[k] = (double)sty_get_field(import, field, k)[pixel];
}

static void drop_field(StyImport *import, StyField field) { import->places[field].channels[0] = -1; }

/* ---- coverage ---- */

static bool is_miss(float depth) { return depth == 0 || depth >= far_depth || depth == half_maximum; }

/* Whether a surface is seen; NaN counts, so that it is complained about. */
static bool is_covered(const StyImport *import, size_t pixel) {
  const float *alpha = sty_get_field(import, STY_FIELD_ALPHA, 0), *depth = sty_get_field(import, STY_FIELD_DEPTH, 0);
  double normal[3];
  if (!depth) depth = sty_get_field(import, STY_FIELD_DISTANCE, 0);
  sty_get_vector(import, STY_FIELD_NORMAL, pixel, normal);
  if (normal[0] == 0 && normal[1] == 0 && normal[2] == 0) return false;
  return !(alpha && alpha[pixel] <= 0) && !(depth && is_miss(depth[pixel]));
}

/* Normals within what every command takes, all else within what a scene may reach to. */
static StyStatus check_pixel(const StyImport *import, size_t pixel, StyError *error) {
  const size_t width = (size_t)import->file->width;
  for (int f = 0; f < STY_FIELDS; f++)
    for (int k = 0; k < sty_fields[f].count && sty_has_field(import, (StyField)f); k++) {
      const double value = (double)sty_get_field(import, (StyField)f, k)[pixel];
      const double most = f == STY_FIELD_NORMAL ? (double)STY_MAX_GUIDE_VALUE : STY_MAX_COORDINATE;
      if (!(fabs(value) <= most))
        return sty_fail(error, STY_ERROR_INPUT,
                        "%s: found %s = %g at pixel (%zu, %zu), expected a finite value within %g", import->name,
                        import->file->names[import->places[f].channels[k]], value, pixel % width, pixel / width, most);
    }
  return STY_OK;
}

static StyStatus fill_coverage(const StyImport *import, StyError *error) {
  float *coverage = sty_find_channel(import->guide, "A");
  const float *alpha = sty_get_field(import, STY_FIELD_ALPHA, 0);
  StyStatus status = STY_OK;
  for (size_t i = 0; !status && i < sty_count_pixels(import->guide); i++) {
    if (!is_covered(import, i)) continue;
    status = check_pixel(import, i, error);
    coverage[i] = alpha ? fminf(alpha[i], 1) : 1;
  }
  return status;
}

static void note_coverage(const StyImport *import) {
  const bool depth = sty_has_field(import, STY_FIELD_DEPTH) || sty_has_field(import, STY_FIELD_DISTANCE);
  sty_add_note(import->notes, STY_NOTE_ASSUMED, "a pixel is covered where its normal isn't 0%s%s",
               depth ? ", its depth isn't that of a miss" : "",
               sty_has_field(import, STY_FIELD_ALPHA) ? ", its alpha is above 0" : "");
}

/* ---- what is taken ---- */

/* The end of a channel's name: its component, or all of it. */
static const char *get_end(const char *name) {
  const char *dot = strrchr(name, '.');
  return dot ? dot : name;
}

static void note_taken(const StyImport *import, StyField field) {
  const StyFieldInfo *info = &sty_fields[field];
  char ours[64], theirs[STY_NOTE_SIZE - 80];
  snprintf(ours, sizeof ours, "%s", info->channels[0]);
  for (int k = 1; info->channels[k]; k++)
    snprintf(ours + strlen(ours), sizeof ours - strlen(ours), " %s", get_end(info->channels[k]));
  snprintf(theirs, sizeof theirs, "%s", import->file->names[import->places[field].channels[0]]);
  for (int k = 1; k < info->count; k++)
    snprintf(theirs + strlen(theirs), sizeof theirs - strlen(theirs), " %s",
             get_end(import->file->names[import->places[field].channels[k]]));
  sty_add_note(import->notes, STY_NOTE_TAKEN, "%s from %s", ours, theirs);
}

static void note_left_out(const StyImport *import) {
  for (int c = 0; c < import->file->channel_count; c++) {
    bool is_taken = false;
    for (int f = 0; f < STY_FIELDS; f++)
      for (int k = 0; k < sty_fields[f].count && sty_has_field(import, (StyField)f); k++)
        is_taken = is_taken || import->places[f].channels[k] == c;
    if (!is_taken) sty_add_note(import->notes, STY_NOTE_LEFT_OUT, "%s", import->file->names[c]);
  }
}

/* Ids that the file's filter has mixed, or that a float can't tell apart. */
static void check_objects(const StyImport *import) {
  const float *ids = sty_get_field(import, STY_FIELD_OBJECT, 0);
  size_t mixed = 0, large = 0;
  for (size_t i = 0; ids && i < sty_count_pixels(import->file); i++) {
    if (!is_covered(import, i)) continue;
    mixed += ids[i] != floorf(ids[i]);
    large += fabsf(ids[i]) > exact_ids;
  }
  if (mixed)
    sty_add_note(import->notes, STY_NOTE_WARNING,
                 "found object ids that aren't whole at %zu pixels, expected ids without anti-aliasing", mixed);
  if (large)
    sty_add_note(import->notes, STY_NOTE_WARNING, "found object ids beyond 16777216 at %zu pixels, where some coincide",
                 large);
}

/* Ids that aren't styles leave no style. */
static void check_styles(StyImport *import) {
  const float *ids = sty_get_field(import, STY_FIELD_STYLE, 0);
  for (size_t i = 0; ids && i < sty_count_pixels(import->file); i++) {
    const bool is_style = ids[i] >= 0 && ids[i] <= STY_MOST_STYLE && ids[i] == floorf(ids[i]);
    if (is_style || !isfinite(ids[i]) || !is_covered(import, i)) continue;
    sty_add_note(import->notes, STY_NOTE_WARNING, "style.I left out: found %s = %g, expected whole numbers up to 255",
                 import->file->names[import->places[STY_FIELD_STYLE].channels[0]], (double)ids[i]);
    drop_field(import, STY_FIELD_STYLE);
    return;
  }
}

/* Positions of camera space need the camera to become the world's, but are a depth all the same. */
static bool writes_positions(const StyImport *import) {
  return sty_has_field(import, STY_FIELD_POSITION) && (import->has_camera || sty_has_world_positions(import));
}

static void choose_depth(StyImport *import) {
  const bool distance = sty_has_field(import, STY_FIELD_DISTANCE), position = sty_has_field(import, STY_FIELD_POSITION);
  import->depth_of = STY_FIELDS;
  if (sty_has_field(import, STY_FIELD_DEPTH))
    import->depth_of = STY_FIELD_DEPTH;
  else if (distance && import->has_camera)
    import->depth_of = STY_FIELD_DISTANCE;
  else if (position && (import->has_camera || !sty_has_world_positions(import)))
    import->depth_of = STY_FIELD_POSITION;
  if (distance && import->depth_of == STY_FIELDS)
    sty_add_note(import->notes, STY_NOTE_WARNING,
                 "depth.Z left out: %s is the distance along the ray, which needs --camera",
                 import->file->names[import->places[STY_FIELD_DISTANCE].channels[0]]);
  if (position && !writes_positions(import))
    sty_add_note(import->notes, STY_NOTE_WARNING, "position left out: it is in camera space, which needs --camera");
  if (import->depth_of == STY_FIELD_POSITION)
    sty_add_note(import->notes, STY_NOTE_ASSUMED, "depth.Z is the positions' distance along the view axis");
  else if (position && !writes_positions(import))
    drop_field(import, STY_FIELD_POSITION);
  if (import->depth_of != STY_FIELD_DISTANCE && import->depth_of != STY_FIELDS) drop_field(import, STY_FIELD_DISTANCE);
}

static bool is_written(const StyImport *import, StyField field) {
  if (field == STY_FIELD_POSITION) return writes_positions(import);
  if (field == STY_FIELD_DEPTH || field == STY_FIELD_DISTANCE) return import->depth_of == field;
  return field != STY_FIELD_ALPHA && sty_has_field(import, field);
}

static StyStatus create_guide(StyImport *import, StyError *error) {
  const char *names[STY_FIELDS * STY_FIELD_COMPONENTS + 2] = {"A"};
  int count = 1;
  for (int f = 0; f < STY_FIELDS; f++) {
    for (int k = 0; sty_fields[f].channels[k] && is_written(import, (StyField)f); k++)
      names[count++] = sty_fields[f].channels[k];
    if (is_written(import, (StyField)f) || (f == STY_FIELD_ALPHA && sty_has_field(import, STY_FIELD_ALPHA)))
      note_taken(import, (StyField)f);
  }
  if (import->depth_of == STY_FIELD_POSITION) names[count++] = "depth.Z";
  StyStatus status =
      sty_create_image(import->file->width, import->file->height, count, names, 32, &import->guide, error);
  for (int a = 0; !status && a < import->file->attribute_count; a++)
    status =
        sty_set_attribute(import->guide, import->file->attributes[a].name, import->file->attributes[a].value, error);
  return status;
}

/* ---- plain values ---- */

static void copy_field(const StyImport *import, StyField field, const float sign[STY_FIELD_COMPONENTS]) {
  const float *covered = sty_find_channel(import->guide, "A");
  for (int k = 0; k < sty_fields[field].count && sty_has_field(import, field); k++) {
    const float *from = sty_get_field(import, field, k);
    float *to = sty_find_channel(import->guide, sty_fields[field].channels[k]);
    for (size_t i = 0; i < sty_count_pixels(import->guide); i++)
      if (covered[i] > 0) to[i] = sign[k] * from[i];
  }
}

/* Renderers multiply their pictures by alpha; where hardly any is left, nor is a colour. */
static void fill_luma(const StyImport *import) {
  static const double weights[3] = {0.2126, 0.7152, 0.0722};
  const float *covered = sty_find_channel(import->guide, "A");
  float *luma = sty_find_channel(import->guide, "luma.Y");
  for (size_t i = 0; luma && i < sty_count_pixels(import->guide); i++) {
    double colour[3], sum = 0;
    if (!(covered[i] > 0)) continue;
    sty_get_vector(import, STY_FIELD_PICTURE, i, colour);
    for (int k = 0; k < 3; k++) sum += weights[k] * colour[k];
    luma[i] = (float)(sum / fmax((double)covered[i], least_alpha));
  }
}

static void fill_plain(const StyImport *import) {
  static const float same[3] = {1, 1, 1}, down[3] = {1, -1, 1};
  copy_field(import, STY_FIELD_UV, same);
  copy_field(import, STY_FIELD_ALBEDO, same);
  copy_field(import, STY_FIELD_OBJECT, same);
  copy_field(import, STY_FIELD_STYLE, same);
  copy_field(import, STY_FIELD_MOTION, down);
  fill_luma(import);
  if (sty_has_field(import, STY_FIELD_PICTURE))
    sty_add_note(import->notes, STY_NOTE_ASSUMED,
                 "luma.Y is the picture's luminance: scene-linear Rec. 709, alpha divided out");
  if (sty_has_field(import, STY_FIELD_STYLE))
    sty_add_note(import->notes, STY_NOTE_ASSUMED, "a material's index is the number of its style");
  if (sty_has_field(import, STY_FIELD_MOTION))
    sty_add_note(import->notes, STY_NOTE_ASSUMED, "motion leads to the previous frame, its Y up in the file");
}

/* ---- the whole ---- */

static StyStatus require_camera(const StyImport *import, StyError *error) {
  if (!import->is_world || import->has_camera) return STY_OK;
  return sty_fail(error, STY_ERROR_USAGE,
                  "--camera: found none with %s, whose normals are world space, expected the camera that the file was "
                  "rendered with, or --space view where normals are the camera's",
                  import->name);
}

static void warn_of_unused_camera(const StyImport *import) {
  if (import->has_camera && !import->is_world && !sty_has_field(import, STY_FIELD_POSITION) &&
      !sty_has_field(import, STY_FIELD_DISTANCE))
    sty_add_note(import->notes, STY_NOTE_WARNING, "--camera: found, but nothing in the file needs it");
}

static StyStatus fill_guide(StyImport *import, StyError *error) {
  const StyStatus status = fill_coverage(import, error);
  if (status) return status;
  import->toward = sty_find_toward(import);
  sty_settle_depth(import);
  if (import->has_camera && sty_has_field(import, STY_FIELD_POSITION)) sty_check_foreign_camera(import);
  sty_note_normals(import);
  sty_fill_normals(import, true);
  sty_check_normals(import);
  sty_fill_positions(import);
  sty_fill_depth(import);
  fill_plain(import);
  note_coverage(import);
  return STY_OK;
}

static StyStatus import_layers(StyImport *import, StyError *error) {
  sty_find_fields(import->program, import->file, import->places);
  StyStatus status = sty_check_program(import->name, import->program, import->file, import->places, error);
  if (!status) status = require_camera(import, error);
  if (status) return status;
  const StyPlace *normal = &import->places[STY_FIELD_NORMAL];
  if (normal->others)
    sty_add_note(import->notes, STY_NOTE_WARNING,
                 "found normals of %d render layers, took %s and all that goes with it", normal->others + 1,
                 import->file->names[normal->channels[0]]);
  choose_depth(import);
  check_objects(import);
  check_styles(import);
  status = create_guide(import, error);
  if (!status) status = fill_guide(import, error);
  if (!status) note_left_out(import);
  return status;
}

/* Integers are read as every other command reads them; then only the space is left to see to. */
static StyStatus import_picture(StyImport *import, StyImage **image, StyError *error) {
  static const char *const names[] = {"normal.X", "normal.Y", "normal.Z"};
  StyStatus status = require_camera(import, error);
  const StyProgram *shown = sty_find_shown_program(*image);
  if (status) return status;
  status = sty_import_guide(import->name, image, error);
  if (status && error && shown && !shown->is_picture)
    sty_fail(error, status, "%s, or --as %s", error->text, shown->name);
  if (status) return status;
  import->file = import->guide = *image;
  for (int f = 0; f < STY_FIELDS; f++) drop_field(import, (StyField)f);
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < import->file->channel_count; c++)
      if (strcmp(import->file->names[c], names[k]) == 0) import->places[STY_FIELD_NORMAL].channels[k] = c;
  import->toward = 1;
  sty_add_note(import->notes, STY_NOTE_TAKEN, "normal.X .Y .Z and A as every command reads the file");
  sty_note_normals(import);
  if (import->is_world || import->options->flip_y) sty_fill_normals(import, import->is_world);
  sty_check_normals(import);
  if (import->is_world) import->guide->bits = 32; /* turned, they are no bytes any more */
  return STY_OK;
}

StyStatus sty_import_foreign(const char *name, const StyForeignOptions *options, StyImage **image, StyNotes *notes,
                             StyError *error) {
  const StyProgram *program = &sty_programs[options->program];
  StyNotes *lines = calloc(1, sizeof *lines);
  if (!lines) return sty_fail_memory(error, name, sizeof *lines);
  StyImport import = {.name = name, .program = program, .options = options, .notes = lines, .file = *image};
  import.is_world = (options->space == STY_SPACE_USUAL ? program->space : options->space) == STY_SPACE_WORLD;
  const bool is_picture = program->is_picture && ((*image)->bits < 32 || !program->places[STY_FIELD_NORMAL][0]);
  StyStatus status = sty_place_foreign_camera(&import, error);
  if (!status) status = is_picture ? import_picture(&import, image, error) : import_layers(&import, error);
  if (!status) warn_of_unused_camera(&import);
  if (!status && !is_picture) {
    sty_destroy_image(image);
    *image = import.guide;
  } else if (!is_picture) {
    sty_destroy_image(&import.guide);
  }
  if (!status) *notes = *lines;
  free(lines);
  return status;
}
