/* A real frame through every pass: shaders beside the C path, in both dialects. Writes what another reader of the
 * bundle needs to do the same: the frame's inputs and patterns as raw texels, what toon shading and outlines are given,
 * and the C path's matches, picture, toon, lines, and lines laid on the toon.
 * Usage: draw_frame BUNDLE GUIDE.exr FOLDER */
#include "drawings.h"
#include "stylut/guide.h"
#include "stylut/image_io.h"
#include "stylut/pack.h"
#include "twins.h"

enum { OBJECTS = 2, NUMBER = 3 };

static void require_done(StyStatus status, const StyError *error) {
  if (status) give_up("%s", error->text);
}

static const float *get_channel(const StyImage *image, const char *name) {
  const float *values = sty_find_channel(image, name);
  if (!values) give_up("the guide has no channel %s", name);
  return values;
}

static uint8_t round_byte(float value) { return (uint8_t)(value * 255 + 0.5f); }

static const uint8_t *encode_guide(const StyImage *image) {
  StyImage *encoded = NULL;
  StyError error;
  uint8_t *guide = allocate(sty_count_pixels(image), 4);
  require_done(sty_encode_normals(image, 8, &encoded, &error), &error);
  require_done(sty_convert_to_rgba8("guide", encoded, guide, &error), &error);
  sty_destroy_image(&encoded);
  return guide;
}

/* Bands of 16 columns take turns at the styles; objects with anchors; albedo in whatever encoding, since bytes are
 * bytes here. */
static StyFrame make_frame(const StyImage *image, int style_count) {
  static const int32_t anchors[2 * OBJECTS] = {0, 0, 37, -12};
  static const char *const colours[] = {"albedo.R", "albedo.G", "albedo.B"};
  const size_t pixels = sty_count_pixels(image);
  const float *x = get_channel(image, "normal.X"), *y = get_channel(image, "normal.Y"),
              *light = get_channel(image, "luma.Y"), *ids = get_channel(image, "object.I");
  float *fine = allocate(pixels, 2 * sizeof *fine);
  uint8_t *styles = allocate(pixels, 1), *luma = allocate(pixels, 1), *albedo = allocate(pixels, 4);
  uint16_t *objects = allocate(pixels, sizeof *objects);
  for (size_t i = 0; i < pixels; i++) {
    fine[2 * i] = x[i], fine[2 * i + 1] = y[i];
    styles[i] = (uint8_t)(1 + i % (size_t)image->width / 16 % (size_t)style_count);
    luma[i] = round_byte(light[i]);
    objects[i] = (uint16_t)ids[i];
    for (size_t c = 0; c < 3; c++) albedo[4 * i + c] = round_byte(get_channel(image, colours[c])[i]);
  }
  return (StyFrame){.width = image->width,
                    .height = image->height,
                    .guide = encode_guide(image),
                    .fine = fine,
                    .depth = get_channel(image, "depth.Z"),
                    .styles = styles,
                    .objects = objects,
                    .luma = luma,
                    .albedo = albedo,
                    .anchors = anchors,
                    .anchor_count = OBJECTS,
                    .number = NUMBER};
}

static void destroy_frame(const StyFrame *frame) {
  free((void *)frame->guide);
  free((void *)frame->fine);
  free((void *)frame->styles);
  free((void *)frame->objects);
  free((void *)frame->luma);
  free((void *)frame->albedo);
}

static FILE *create(const char *folder, const char *name) {
  char path[PATH_MAX];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "wb");
  if (!file) give_up("%s cannot be written", path);
  return file;
}

static void write_raw(const char *folder, const char *name, const void *texels, size_t size) {
  FILE *file = create(folder, name);
  if (fwrite(texels, 1, size, file) != size || fclose(file)) give_up("%s cannot be written", name);
}

static void write_frame(const char *folder, const StyFrame *frame, const StyMatch *matches, const uint8_t *picture) {
  const size_t pixels = (size_t)frame->width * (size_t)frame->height;
  int32_t anchors[2 * ANCHOR_COLUMNS] = {0};
  memcpy(anchors, frame->anchors, 2 * (size_t)frame->anchor_count * sizeof *anchors);
  write_raw(folder, "frame_guide", frame->guide, 4 * pixels);
  write_raw(folder, "frame_fine", frame->fine, 8 * pixels);
  write_raw(folder, "frame_depth", frame->depth, 4 * pixels);
  write_raw(folder, "frame_styles", frame->styles, pixels);
  write_raw(folder, "frame_objects", frame->objects, 2 * pixels);
  write_raw(folder, "frame_luma", frame->luma, pixels);
  write_raw(folder, "frame_albedo", frame->albedo, 4 * pixels);
  write_raw(folder, "frame_anchors", anchors, sizeof anchors);
  write_raw(folder, "matches", matches, pixels * sizeof *matches);
  write_raw(folder, "picture", picture, 4 * pixels);
  FILE *file = create(folder, "frame.json");
  fprintf(file, "{\"width\": %d, \"height\": %d, \"number\": %d, \"inputs\": %d}\n", frame->width, frame->height,
          frame->number, list_inputs(frame));
  fclose(file);
}

/* ---- steps of light, hatched in cells, with lines that waver ---- */

enum { SIDE = 64 };
static const uint8_t line_colour[4] = {200, 30, 20, 230};

typedef struct Drawings {
  StyToon toon;
  StyOutline outline;
  StyLine line;
  uint8_t *shaded, *lines, *laid; /* what C makes of the frame */
} Drawings;

static StyPattern draw_hatch(void) {
  static uint8_t hatch[SIDE * SIDE];
  for (int i = 0; i < SIDE * SIDE; i++) hatch[i] = (uint8_t)(i / SIDE % 8 * 32);
  return (StyPattern){hatch, SIDE, SIDE};
}

static StyPattern draw_wave(void) {
  static uint8_t wave[2 * SIDE * SIDE];
  for (int i = 0; i < SIDE * SIDE; i++)
    wave[2 * i] = (uint8_t)(abs(i / SIDE - 32) * 7 + 10), wave[2 * i + 1] = (uint8_t)(abs(i % SIDE - 32) * 7 + 10);
  return (StyPattern){wave, SIDE, SIDE};
}

static Drawings make_drawings(const StyBundle *bundle, size_t pixels) {
  return (Drawings){.toon = {.band_count = 3,
                             .thresholds = {38, 128},
                             .colours = {{60, 50, 90, 255}, {170, 140, 120, 255}, {250, 240, 220, 255}},
                             .colour_weight = 128,
                             .pattern = draw_hatch(),
                             .pattern_weight = 128,
                             .cell_level = 4,
                             .jitter = bundle->textures[STY_BUNDLE_JITTER].texels,
                             .jitter_amount = 255},
                    .outline = {.silhouette_weight = 256,
                                .object_weight = 256,
                                .normal_weight = 2,
                                .depth_weight = 128,
                                .normal_tolerance = 60,
                                .depth_tolerance = 0.02f,
                                .threshold = 128},
                    .line = {.width = 700, .wobble = draw_wave(), .wobble_amount = 512},
                    .shaded = allocate(pixels, 4),
                    .lines = allocate(pixels, 1),
                    .laid = allocate(pixels, 4)};
}

static void destroy_drawings(Drawings *drawings) {
  free(drawings->shaded);
  free(drawings->lines);
  free(drawings->laid);
}

static void check_drawings(const Gpu *gpu, const StyBundle *bundle, const StyFrame *frame, const Drawings *drawings) {
  const size_t pixels = (size_t)frame->width * (size_t)frame->height;
  Twins twins = open_twins(gpu, bundle, frame);
  check_toon(&twins, frame, 1, &drawings->toon, drawings->shaded);
  memcpy(drawings->laid, drawings->shaded, 4 * pixels);
  check_outline(&twins, frame, 1, &drawings->outline, &drawings->line, line_colour, 1, drawings->laid, drawings->lines);
  size_t drawn = 0, dark = 0, light = 0;
  for (size_t i = 0; i < pixels; i++) {
    drawn += drawings->lines[i] > 0;
    dark += frame->guide[4 * i + 3] > 0 && frame->luma[i] < drawings->toon.thresholds[0];
    light += frame->guide[4 * i + 3] > 0 && frame->luma[i] >= drawings->toon.thresholds[1];
  }
  if (drawn < pixels / 100 || dark < pixels / 100 || light < pixels / 100)
    give_up("only %zu pixels of the frame have lines, %zu are dark, %zu are light", drawn, dark, light);
  close_twins(&twins);
}

static void write_bytes(FILE *file, const char *name, int count, const uint8_t *bytes) {
  fprintf(file, "\"%s\": [", name);
  for (int i = 0; i < count; i++) fprintf(file, i ? ", %d" : "%d", bytes[i]);
  fprintf(file, "],\n");
}

/* Uniforms by their names; those that aren't there are 0. */
static void write_uniforms(const char *folder, const Drawings *drawings) {
  const StyToon *toon = &drawings->toon;
  const StyOutline *outline = &drawings->outline;
  FILE *file = create(folder, "uniforms.json");
  fprintf(file, "{\"toon_band_count\": %d, \"toon_colour_weight\": %d, \"toon_pattern_weight\": %d,\n",
          toon->band_count, toon->colour_weight, toon->pattern_weight);
  fprintf(file, "\"toon_cell_level\": %d, \"toon_jitter_amount\": %d,\n", toon->cell_level, toon->jitter_amount);
  write_bytes(file, "toon_thresholds", STY_MAX_BANDS - 1, toon->thresholds);
  write_bytes(file, "toon_colours", 4 * STY_MAX_BANDS, toon->colours[0]);
  fprintf(file, "\"outline_silhouette_weight\": %d, \"outline_object_weight\": %d, \"outline_normal_weight\": %d,\n",
          outline->silhouette_weight, outline->object_weight, outline->normal_weight);
  fprintf(file, "\"outline_depth_weight\": %d, \"outline_normal_tolerance\": %d, \"outline_depth_tolerance\": %.9g,\n",
          outline->depth_weight, outline->normal_tolerance, (double)outline->depth_tolerance);
  write_bytes(file, "lay_colour", 4, line_colour);
  fprintf(file, "\"outline_threshold\": %d, \"line_width\": %d, \"line_wobble_amount\": %d, \"lay_beyond\": 1}\n",
          outline->threshold, drawings->line.width, drawings->line.wobble_amount);
  fclose(file);
}

static void write_drawings(const char *folder, const Drawings *drawings, size_t pixels) {
  write_raw(folder, "toon_pattern", drawings->toon.pattern.texels, SIDE * SIDE);
  write_raw(folder, "line_wobble", drawings->line.wobble.texels, 2 * SIDE * SIDE);
  write_raw(folder, "toon", drawings->shaded, 4 * pixels);
  write_raw(folder, "lines", drawings->lines, pixels);
  write_raw(folder, "laid", drawings->laid, 4 * pixels);
  write_uniforms(folder, drawings);
}

/* ---- all of it ---- */

static void check_dialect(const char *dialect, const StyBundle *bundle, const StyFrame *frame, StyMatch *matches,
                          uint8_t *picture, const Drawings *drawings) {
  Gpu gpu = open_gpu(dialect);
  check_passes(&gpu, bundle, frame, matches, picture);
  check_drawings(&gpu, bundle, frame, drawings);
  printf("%s: every pass equals its twin\n", dialect);
  close_gpu(&gpu);
}

int main(int argc, char **argv) {
  if (argc != 4) give_up("found %d arguments, expected BUNDLE GUIDE.exr FOLDER", argc - 1);
  StyLoadedBundle loaded;
  StyImage *image = NULL;
  StyError error;
  require_done(sty_load_bundle(argv[1], NULL, NULL, &loaded, &error), &error);
  require_done(sty_read_image(argv[2], &image, &error), &error);
  const StyFrame frame = make_frame(image, (int)loaded.bundle.textures[STY_BUNDLE_PARAMS].width);
  StyMatch *matches = allocate(sty_count_pixels(image), sizeof *matches);
  uint8_t *picture = allocate(sty_count_pixels(image), 4);
  Drawings drawings = make_drawings(&loaded.bundle, sty_count_pixels(image));
  check_dialect("330", &loaded.bundle, &frame, matches, picture, &drawings);
  check_dialect("es300", &loaded.bundle, &frame, matches, picture, &drawings);
  write_frame(argv[3], &frame, matches, picture);
  write_drawings(argv[3], &drawings, sty_count_pixels(image));
  destroy_drawings(&drawings);
  free(matches);
  free(picture);
  destroy_frame(&frame);
  sty_destroy_image(&image);
  sty_unload_bundle(&loaded);
  return 0;
}
