/* Exemplars and guides at the bundle's size. */
#include <stdlib.h>
#include <string.h>

#include "inputs.h"
#include "inside.h"
#include "pack.h"
#include "stylut/image_io.h"
#include "stylut/scene_file.h"

char *find_file(const Packing *packing, const char *name, StyError *error) {
  char *path = sty_join_path(packing->manifest.folder, name);
  if (!path) sty_fail_memory(error, name, 0);
  return path;
}

static bool is_equal(Size a, Size b) { return a.width == b.width && a.height == b.height; }

/* ---- sizes ---- */

StyStatus measure_picture(const Packing *packing, const char *name, Size *out, StyError *error) {
  StyImageShape shape = {0};
  char *path = find_file(packing, name, error);
  if (!path) return STY_ERROR_LIBRARY;
  const StyStatus status = packing->records ? packing->records->measure(packing->records, path, out, error)
                                            : sty_read_image_shape(path, &shape, error);
  free(path);
  if (!packing->records) *out = (Size){shape.width, shape.height};
  return status;
}

static StyStatus measure_style(const Packing *packing, const StyManifestStyle *style, Size *out, StyError *error) {
  StyStatus status = measure_picture(packing, style->exemplars[0], out, error);
  if (!status && (out->width > STY_MAX_SOURCE_SIDE || out->height > STY_MAX_SOURCE_SIDE))
    status = sty_fail(error, STY_ERROR_INPUT, "style '%s': found exemplar %s of %dx%d pixels, expected sides up to %d",
                      style->name, style->exemplars[0], out->width, out->height, STY_MAX_SOURCE_SIDE);
  for (int i = 1; !status && i < style->parameters.layer_count; i++) {
    Size size;
    status = measure_picture(packing, style->exemplars[i], &size, error);
    if (!status && !is_equal(size, *out))
      status = sty_fail(error, STY_ERROR_INPUT,
                        "style '%s': found exemplars %s of %dx%d and %s of %dx%d pixels, expected one size in a style",
                        style->name, style->exemplars[0], out->width, out->height, style->exemplars[i], size.width,
                        size.height);
  }
  return status;
}

/* Filters of OpenImageIO take as long as pixels times the enlargement; and little is left of what was painted. */
enum { MOST_ENLARGEMENT = 16 };

static StyStatus check_enlargement(const Packing *packing, const StyManifestStyle *style, Size from, StyError *error) {
  const Size to = packing->size;
  if (packing->arguments->fit != FIT_RESIZE ||
      (to.width <= MOST_ENLARGEMENT * from.width && to.height <= MOST_ENLARGEMENT * from.height))
    return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT,
                  "style '%s': found exemplar %s of %dx%d pixels for a bundle of %dx%d, expected at most %d times each "
                  "side for --fit resize",
                  style->name, style->exemplars[0], from.width, from.height, to.width, to.height, MOST_ENLARGEMENT);
}

StyStatus measure_exemplars(Packing *packing, StyError *error) {
  const StyManifestStyle *styles = packing->manifest.styles;
  StyStatus status = STY_OK;
  for (int i = 0; !status && i < packing->manifest.style_count; i++) {
    Size *size = &packing->sizes[i];
    status = measure_style(packing, &styles[i], size, error);
    const Size first = packing->sizes[0];
    if (!status && packing->arguments->fit == FIT_NONE && !is_equal(*size, first))
      status = sty_fail(
          error, STY_ERROR_INPUT,
          "found exemplars %s of %dx%d and %s of %dx%d pixels, expected one size in a bundle, or --fit pad or resize",
          styles[0].exemplars[0], first.width, first.height, styles[i].exemplars[0], size->width, size->height);
    if (size->width > packing->size.width) packing->size.width = size->width;
    if (size->height > packing->size.height) packing->size.height = size->height;
  }
  for (int i = 0; !status && i < packing->manifest.style_count; i++)
    status = check_enlargement(packing, &styles[i], packing->sizes[i], error);
  return status;
}

/* ---- exemplars ---- */

StyStatus read_bytes(const char *path, uint8_t **bytes, Size *size, StyError *error) {
  StyImage *image = NULL;
  StyStatus status = sty_read_image(path, &image, error);
  uint8_t *out = status ? NULL : malloc(4 * sty_count_pixels(image));
  if (!status && !out) status = sty_fail_memory(error, path, 4.0 * (double)sty_count_pixels(image));
  if (!status) status = sty_convert_to_rgba8(path, image, out, error);
  if (status) {
    free(out);
  } else {
    *bytes = out;
    *size = (Size){image->width, image->height};
  }
  sty_destroy_image(&image);
  return status;
}

static void pad_bytes(const uint8_t *bytes, Size from, Size to, uint8_t *out) {
  memset(out, 0, 4 * (size_t)to.width * (size_t)to.height);
  for (int y = 0; y < from.height; y++)
    memcpy(out + 4 * (size_t)y * (size_t)to.width, bytes + 4 * (size_t)y * (size_t)from.width, 4 * (size_t)from.width);
}

/* Filters have lobes below 0: values are clamped after. */
static uint8_t to_byte(float value) { return (uint8_t)(value <= 0 ? 0 : value >= 1 ? 255 : value * 255 + 0.5f); }

/* Colours weigh by alpha, so that what isn't painted doesn't bleed in. */
static StyStatus resize_bytes(const uint8_t *bytes, Size from, Size to, uint8_t *out, StyError *error) {
  static const char *const names[] = {"R", "G", "B", "A"};
  StyImage *image = NULL, *larger = NULL;
  StyStatus status = sty_create_image(from.width, from.height, 4, names, 32, &image, error);
  if (status) return status;
  const size_t pixels = sty_count_pixels(image);
  for (size_t i = 0; i < pixels; i++)
    for (size_t c = 0; c < 4; c++)
      image->data[c * pixels + i] = (float)bytes[4 * i + c] / 255 * (c < 3 ? (float)bytes[4 * i + 3] / 255 : 1);
  status = sty_resize_image("exemplar", image, to.width, to.height, &larger, error);
  sty_destroy_image(&image);
  if (status) return status;
  const size_t count = sty_count_pixels(larger);
  for (size_t i = 0; i < count; i++) {
    const float alpha = larger->data[3 * count + i];
    for (size_t c = 0; c < 3; c++) out[4 * i + c] = alpha > 0 ? to_byte(larger->data[c * count + i] / alpha) : 0;
    out[4 * i + 3] = to_byte(alpha);
  }
  sty_destroy_image(&larger);
  return STY_OK;
}

/* Replaces the bytes by those of the bundle's size. */
static StyStatus fit_bytes(const Packing *packing, Size from, uint8_t **bytes, StyError *error) {
  const Size to = packing->size;
  if (is_equal(from, to)) return STY_OK;
  const size_t size = 4 * (size_t)to.width * (size_t)to.height;
  uint8_t *out = malloc(size);
  if (!out) return sty_fail_memory(error, "exemplar", (double)size);
  StyStatus status = STY_OK;
  if (packing->arguments->fit == FIT_PAD)
    pad_bytes(*bytes, from, to, out);
  else
    status = resize_bytes(*bytes, from, to, out, error);
  free(*bytes);
  *bytes = out;
  return status;
}

static StyStatus read_exemplar(const Packing *packing, int style, int lighting, uint8_t **out, StyError *error) {
  char *path = find_file(packing, packing->manifest.styles[style].exemplars[lighting], error);
  if (!path) return STY_ERROR_LIBRARY;
  Size size;
  StyStatus status = read_bytes(path, out, &size, error);
  free(path);
  return status ? status : fit_bytes(packing, packing->sizes[style], out, error);
}

/* ---- guides ---- */

bool is_sphere(const StyManifestStyle *style) { return strcmp(style->guide, "sphere") == 0; }

/* A name as the manifest would have it. */
static const char *strip_folder(const Packing *packing, const char *path) {
  const size_t length = strlen(packing->manifest.folder);
  const bool inside = strncmp(path, packing->manifest.folder, length) == 0 && path[length] == '/';
  return inside ? path + length + 1 : path;
}

static StyStatus record_scene(const Packing *packing, const StyScene *scene, StyError *error) {
  StyStatus status = STY_OK;
  for (int m = 0; !status && m < scene->mesh_count; m++)
    status = record_input(packing, strip_folder(packing, scene->meshes[m]->path), error);
  return status;
}

/* Before any of them is read. What else is wrong with the scene, its reader says. */
static StyStatus check_meshes(const Packing *packing, const char *path, StyError *error) {
  StyDocument scene;
  char *folder = sty_get_folder(path);
  const json_t *object;
  size_t i;
  StyStatus status = folder ? STY_OK : sty_fail_memory(error, path, 0);
  if (status || sty_read_document(path, &scene, NULL) != STY_OK) {
    free(folder);
    return status;
  }
  json_array_foreach(json_object_get(scene.root, "objects"), i, object) {
    const char *name = json_string_value(json_object_get(object, "mesh"));
    char *mesh = name && !status ? sty_join_path(folder, name) : NULL;
    if (mesh) status = check_inside(packing, path, mesh, error);
    free(mesh);
  }
  sty_close_document(&scene);
  free(folder);
  return status;
}

static StyStatus trace_scene(const Packing *packing, const char *path, Size size, StyImage **out, StyError *error) {
  const StyMeshOptions mesh_options = {.crease_angle = -1};
  const StyRun run = {.threads = packing->arguments->options.threads};
  const StyTraceOptions options = {.width = size.width, .height = size.height, .groups = STY_GUIDE_NORMAL};
  StyScene *scene = NULL;
  StyViewpoint viewpoint;
  StyCamera camera;
  StyStatus status = check_meshes(packing, path, error);
  if (!status) status = sty_read_scene(path, &mesh_options, &scene, &viewpoint, error);
  if (status) return status;
  status = sty_set_camera(scene, &viewpoint, size.width, size.height, &camera, error);
  if (status) sty_fail(error, status, "%s: %s", path, error->text);
  if (!status) status = record_scene(packing, scene, error);
  if (!status) status = sty_trace_guide(scene, &camera, &options, &run, NULL, out, error);
  sty_destroy_scene(&scene);
  return status;
}

/* Styles may share a guide, which is warned of once. */
static StyStatus read_guide_file(const Packing *packing, const char *name, const char *path, StyImage **out,
                                 StyError *error) {
  Options options = packing->arguments->options;
  options.quiet = options.quiet || json_object_get(packing->guides, name);
  json_object_set_new(packing->guides, name, json_true());
  return read_guide(&options, path, out, error);
}

StyStatus check_guide_fits(const StyManifestStyle *style, Size exemplar, Size guide, StyError *error) {
  if (is_equal(guide, exemplar)) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT,
                  "style '%s': found exemplar %s of %dx%d and guide %s of %dx%d pixels, expected one size", style->name,
                  style->exemplars[0], exemplar.width, exemplar.height, style->guide, guide.width, guide.height);
}

/* The guide as it is, of the size asked for; files have that of their exemplar. */
static StyStatus make_guide(const Packing *packing, const StyManifestStyle *style, Size size, StyImage **out,
                            StyError *error) {
  if (is_sphere(style)) return sty_make_sphere_guide(size.width, size.height, STY_GUIDE_NORMAL, out, error);
  char *path = find_file(packing, style->guide, error);
  if (!path) return STY_ERROR_LIBRARY;
  const bool is_scene = sty_is_scene_file(path);
  StyStatus status = is_scene ? trace_scene(packing, path, size, out, error)
                              : read_guide_file(packing, style->guide, path, out, error);
  if (!status) {
    status = check_guide_fits(style, size, (Size){(*out)->width, (*out)->height}, error);
    if (status) sty_destroy_image(out);
  }
  free(path);
  return status;
}

/* A guide of another size: by nearest pixels, as normals in between two surfaces would be of neither; or as it is, with
 * nothing right of it and below. */
static StyStatus fit_guide(const Packing *packing, StyImage **guide, StyError *error) {
  static const char *const names[] = {"A", "normal.X", "normal.Y", "normal.Z"};
  const StyImage *from = *guide;
  const Size to = packing->size;
  StyImage *out = NULL;
  const StyStatus status = sty_create_image(to.width, to.height, 4, names, from->bits, &out, error);
  if (status) return status;
  const bool pads = packing->arguments->fit == FIT_PAD;
  for (int c = 0; c < 4; c++) {
    const float *source = sty_find_channel(from, names[c]);
    float *target = sty_find_channel(out, names[c]);
    for (int y = 0; source && y < to.height; y++)
      for (int x = 0; x < to.width; x++) {
        const long long i = pads ? x : (2LL * x + 1) * from->width / (2 * to.width);
        const long long j = pads ? y : (2LL * y + 1) * from->height / (2 * to.height);
        if (i < from->width && j < from->height)
          target[(size_t)y * (size_t)to.width + (size_t)x] = source[j * from->width + i];
      }
  }
  sty_destroy_image(guide);
  *guide = out;
  return STY_OK;
}

/* Spheres become ellipses with their exemplars; scenes are seen anew where the proportions stay. */
StyStatus get_guide(const Packing *packing, int number, StyImage **out, StyError *error) {
  const StyManifestStyle *style = &packing->manifest.styles[number];
  const Size from = packing->sizes[number], to = packing->size;
  const bool stays = (long long)from.width * to.height == (long long)to.width * from.height;
  const bool anew =
      packing->arguments->fit == FIT_RESIZE && (is_sphere(style) || (sty_is_scene_file(style->guide) && stays));
  const Size size = anew ? to : from;
  const StyStatus status = make_guide(packing, style, size, out, error);
  return status || is_equal(size, to) ? status : fit_guide(packing, out, error);
}

StyStatus read_exemplars(const Packing *packing, int number, uint8_t *layers[STY_MAX_LIGHTINGS], StyError *error) {
  StyStatus status = STY_OK;
  for (int i = 0; !status && i < packing->manifest.styles[number].parameters.layer_count; i++)
    status = read_exemplar(packing, number, i, &layers[i], error);
  return status;
}

/* Less than half opaque is a hole that no surface should be given. */
StyStatus find_painted(const Packing *packing, int number, uint8_t *const *layers, uint8_t *painted, StyError *error) {
  const StyManifestStyle *style = &packing->manifest.styles[number];
  const int lightings = style->parameters.layer_count;
  const size_t pixels = (size_t)packing->size.width * (size_t)packing->size.height;
  bool any = false;
  for (size_t i = 0; i < pixels; i++) {
    painted[i] = 255;
    for (int k = 0; k < lightings; k++)
      if (layers[k][4 * i + 3] < 128) painted[i] = 0;
    any = any || painted[i];
  }
  if (any) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT,
                  "style '%s': found no paint in exemplar %s, expected pixels that are at least "
                  "half opaque%s",
                  style->name, style->exemplars[0], lightings > 1 ? " in all its exemplars" : "");
}

Overlap uncover_unpainted(StyImage *guide, const uint8_t *painted) {
  Overlap overlap = {0, 0};
  float *covered = sty_find_channel(guide, "A");
  for (size_t i = 0; i < sty_count_pixels(guide); i++) {
    overlap.guided += covered[i] > 0;
    overlap.painted += covered[i] > 0 && painted[i];
    if (!painted[i]) covered[i] = 0;
  }
  return overlap;
}

StyStatus encode_guide(const StyImage *guide, uint8_t **out, StyError *error) {
  StyImage *encoded = NULL;
  const size_t size = 4 * sty_count_pixels(guide);
  uint8_t *texels = malloc(size);
  if (!texels) return sty_fail_memory(error, "guide", (double)size);
  StyStatus status = sty_encode_normals(guide, 8, &encoded, error);
  if (!status) status = sty_convert_to_rgba8("guide", encoded, texels, error);
  sty_destroy_image(&encoded);
  if (status)
    free(texels);
  else
    *out = texels;
  return status;
}

Overlap leave_painted(const uint8_t *texels, const uint8_t *painted, size_t pixels, uint8_t *out) {
  Overlap overlap = {0, 0};
  for (size_t i = 0; i < pixels; i++) {
    const bool covered = texels[4 * i + 3] > 0, kept = covered && painted[i];
    overlap.guided += covered;
    overlap.painted += kept;
    for (size_t c = 0; c < 4; c++) out[4 * i + c] = kept ? texels[4 * i + c] : 0;
  }
  return overlap;
}

static StyStatus mask_guide(const Packing *packing, int number, const Guide *guide, Source *source, StyError *error) {
  const size_t pixels = sty_count_pixels(guide->image);
  uint8_t *painted = malloc(pixels);
  source->texels = malloc(4 * pixels);
  StyStatus status = painted && source->texels ? sty_copy_image(guide->image, &source->guide, error)
                                               : sty_fail_memory(error, "guide", 5.0 * (double)pixels);
  if (!status) status = find_painted(packing, number, source->layers, painted, error);
  if (!status) source->overlap = leave_painted(guide->texels, painted, pixels, source->texels);
  if (!status) uncover_unpainted(source->guide, painted);
  free(painted);
  return status;
}

StyStatus make_bases(const Packing *packing, int number, const StyImage *guide, uint8_t *layers[2 * STY_MAX_LIGHTINGS],
                     StyError *error) {
  const StyManifestStyle *style = &packing->manifest.styles[number];
  const int lightings = style->parameters.layer_count;
  const StyRun run = {.threads = packing->arguments->options.threads};
  StyStatus status = STY_OK;
  for (int i = 0; !status && style->base > 0 && i < lightings; i++)
    status = sty_make_base(layers[i], guide, style->base, &run, &layers[lightings + i], error);
  return status;
}

bool is_same_guide(const Packing *packing, int a, int b) {
  return strcmp(packing->manifest.styles[a].guide, packing->manifest.styles[b].guide) == 0 &&
         is_equal(packing->sizes[a], packing->sizes[b]);
}

StyStatus open_guide(const Packing *packing, int number, Guide *out, StyError *error) {
  Guide guide = {NULL, NULL};
  StyStatus status = get_guide(packing, number, &guide.image, error);
  if (!status) status = encode_guide(guide.image, &guide.texels, error);
  if (status) close_guide(&guide);
  *out = guide;
  return status;
}

void close_guide(Guide *guide) {
  sty_destroy_image(&guide->image);
  free(guide->texels);
  guide->texels = NULL;
}

StyStatus open_source(const Packing *packing, int number, const Guide *guide, Source *out, StyError *error) {
  Source source = {0};
  StyStatus status = read_exemplars(packing, number, source.layers, error);
  if (!status) status = mask_guide(packing, number, guide, &source, error);
  if (!status) status = make_bases(packing, number, source.guide, source.layers, error);
  if (status)
    close_source(&source);
  else
    *out = source;
  return status;
}

void close_source(Source *source) {
  for (int i = 0; i < 2 * STY_MAX_LIGHTINGS; i++) free(source->layers[i]);
  free(source->texels);
  sty_destroy_image(&source->guide);
  *source = (Source){.guide = NULL};
}
