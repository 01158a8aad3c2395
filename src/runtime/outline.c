#include "picture.h"

/* ---- contours ---- */

enum { DIRECTIONS = 4 };
static const Point directions[DIRECTIONS] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};

/* Whether a place has a depth, and which. */
static bool find_depth(const StyFrame *frame, int x, int y, float *out) {
  if (!frame->depth || !contains_pixel(frame, x, y)) return false;
  const size_t index = get_pixel_index(frame, x, y);
  const float depth = frame->depth[index];
  *out = depth;
  return is_covered(frame, index) && depth >= -STY_MAX_DEPTH && depth <= STY_MAX_DEPTH;
}

static float measure_step(float a, float b) { return a > b ? a - b : b - a; }

/* By how much the neighbour in a direction lies behind what the surfaces' slopes let expect. One that goes on falling
 * away as it does before is still seen where another cuts through it. */
static bool find_gap(const StyFrame *frame, int x, int y, Point direction, float *gap) {
  float here, next, before, beyond;
  const int dx = direction.x, dy = direction.y;
  if (!find_depth(frame, x, y, &here) || !find_depth(frame, x + dx, y + dy, &next)) return false;
  const bool has_before = find_depth(frame, x - dx, y - dy, &before);
  const bool has_beyond = find_depth(frame, x + 2 * dx, y + 2 * dy, &beyond);
  if (!has_before && !has_beyond) return false;
  float slope = has_before ? measure_step(here, before) : measure_step(beyond, next);
  if (has_before && has_beyond && measure_step(beyond, next) < slope) slope = measure_step(beyond, next);
  slope *= 3;
  if (has_before && here - before > slope) slope = here - before;
  *gap = next - here - slope;
  return true;
}

static int grade_gap(const StyFrame *frame, const StyOutline *outline, int x, int y) {
  int most = 0;
  for (int d = 0; d < DIRECTIONS; d++) {
    float gap, limit = outline->depth_tolerance;
    int grade = 0;
    if (!find_gap(frame, x, y, directions[d], &gap)) continue;
    for (; grade < STY_MAX_GAP_GRADE && gap > limit; grade++) limit *= 2;
    if (grade > most) most = grade;
  }
  return most;
}

static bool is_behind(const StyFrame *frame, const StyOutline *outline, int x, int y, Point direction) {
  float gap;
  return find_gap(frame, x, y, direction, &gap) && gap > outline->depth_tolerance;
}

/* Which of two covered neighbours has the line between them. Gaps, not depths, tell what stands before what: where
 * surfaces cut through each other, depths differ this way and that from pixel to pixel. */
static bool owns_border(const StyFrame *frame, const StyOutline *outline, int x, int y, Point direction) {
  const int to_x = x + direction.x, to_y = y + direction.y;
  if (is_behind(frame, outline, x, y, direction)) return true;
  if (is_behind(frame, outline, to_x, to_y, (Point){-direction.x, -direction.y})) return false;
  const int own = get_object(frame, get_pixel_index(frame, x, y));
  const int other = get_object(frame, get_pixel_index(frame, to_x, to_y));
  return own != other ? own > other : direction.x + direction.y > 0;
}

static int weigh_border(const StyFrame *frame, const StyOutline *outline, int x, int y, Point direction) {
  const int to_x = x + direction.x, to_y = y + direction.y;
  if (!contains_pixel(frame, to_x, to_y)) return 0;
  const size_t here = get_pixel_index(frame, x, y), there = get_pixel_index(frame, to_x, to_y);
  if (!is_covered(frame, there)) return outline->silhouette_weight;
  if (!owns_border(frame, outline, x, y, direction)) return 0;
  const int bend = measure_difference(frame->guide + 4 * here, frame->guide + 4 * there) - outline->normal_tolerance;
  return (get_object(frame, here) != get_object(frame, there) ? outline->object_weight : 0) +
         (bend > 0 ? outline->normal_weight * bend : 0);
}

static bool is_contour(const StyFrame *frame, const StyOutline *outline, int x, int y) {
  int border = 0, noise = 0;
  if (!is_covered(frame, get_pixel_index(frame, x, y))) return false;
  for (int d = 0; d < DIRECTIONS; d++) {
    const int weight = weigh_border(frame, outline, x, y, directions[d]);
    if (weight > border) border = weight;
  }
  const int depth = outline->depth_weight ? outline->depth_weight * grade_gap(frame, outline, x, y) : 0;
  if (outline->noise.texels) noise = outline->noise_weight * *get_texel(&outline->noise, x, y, 1);
  return 256 * ((int64_t)depth + border) - noise > 256 * (int64_t)outline->threshold;
}

static bool is_outline_valid(const StyOutline *outline) {
  const int most = STY_MAX_OUTLINE_WEIGHT;
  return outline && is_within(outline->silhouette_weight, 0, most) && is_within(outline->object_weight, 0, most) &&
         is_within(outline->normal_weight, 0, most) && is_within(outline->depth_weight, 0, most) &&
         is_within(outline->noise_weight, 0, most) && is_within(outline->threshold, 0, most) &&
         is_within(outline->normal_tolerance, 0, STY_MAX_THRESHOLD) && outline->depth_tolerance > 0 &&
         outline->depth_tolerance <= STY_MAX_DEPTH && is_pattern_valid(&outline->noise);
}

StyRuntimeStatus sty_find_contours(const StyFrame *frame, const StyOutline *outline, StyRect rect, uint8_t *contours) {
  if (!contours || !is_plain_frame_valid(frame, rect) || !is_outline_valid(outline)) return STY_RUNTIME_BAD_ARGUMENT;
  for (int y = rect.y0; y < rect.y1; y++)
    for (int x = rect.x0; x < rect.x1; x++)
      contours[get_pixel_index(frame, x, y)] = is_contour(frame, outline, x, y) ? 255 : 0;
  return STY_RUNTIME_OK;
}

/* ---- from contours to lines ---- */

static bool is_line_valid(const StyLine *line) {
  return line && is_within(line->width, STY_MIN_LINE_WIDTH, STY_MAX_LINE_WIDTH) && is_pattern_valid(&line->wobble) &&
         is_within(line->wobble_amount, 0, STY_MAX_WOBBLE);
}

int sty_get_line_reach(const StyLine *line) { return (line->width + 767) / 512 + 1; }

/* Down the column, then up: each pixel is one farther than the one before it, until a contour is met. */
static void measure_column(int width, const uint8_t *contours, int reach, StyRect rect, int x, int height,
                           int8_t *columns) {
  const size_t stride = (size_t)width;
  int distance = reach + 1;
  for (int y = rect.y0 > reach ? rect.y0 - reach : 0; y < rect.y1; y++) {
    const size_t index = (size_t)y * stride + (size_t)x;
    distance = contours[index] ? 0 : distance + (distance <= reach);
    if (y >= rect.y0) columns[index] = (int8_t)(distance <= reach ? -distance : STY_NO_CONTOUR);
  }
  distance = reach + 1;
  for (int y = (rect.y1 + reach < height ? rect.y1 + reach : height) - 1; y >= rect.y0; y--) {
    const size_t index = (size_t)y * stride + (size_t)x;
    distance = contours[index] ? 0 : distance + (distance <= reach);
    if (y < rect.y1 && distance <= reach && (columns[index] == STY_NO_CONTOUR || distance < -columns[index]))
      columns[index] = (int8_t)distance;
  }
}

StyRuntimeStatus sty_measure_columns(int width, int height, const uint8_t *contours, const StyLine *line, StyRect rect,
                                     int8_t *columns) {
  if (!contours || !columns || !is_line_valid(line) || !is_size_valid(width, height) ||
      !is_rect_inside(rect, width, height))
    return STY_RUNTIME_BAD_ARGUMENT;
  for (int x = rect.x0; x < rect.x1; x++)
    measure_column(width, contours, sty_get_line_reach(line), rect, x, height, columns);
  return STY_RUNTIME_OK;
}

/* Where a pixel looks for contours: a pixel, and the rest of the way in 256ths. */
typedef struct Aim {
  Point pixel, rest;
} Aim;

static int clamp_below(int value, int limit) { return value < 0 ? 0 : value < limit ? value : limit - 1; }

static Aim find_aim(int width, int height, const StyLine *line, int x, int y) {
  if (!line->wobble.texels) return (Aim){{x, y}, {0, 0}};
  const uint8_t *texel = get_texel(&line->wobble, x, y, 2);
  const Point way = {shift_down(line->wobble_amount * (texel[0] - 128), 7),
                     shift_down(line->wobble_amount * (texel[1] - 128), 7)};
  const Point step = {shift_down(way.x + 128, 8), shift_down(way.y + 128, 8)};
  return (Aim){{clamp_below(x + step.x, width), clamp_below(y + step.y, height)},
               {way.x - 256 * step.x, way.y - 256 * step.y}};
}

static int square_distance(const Aim *aim, const int8_t *column, int i, int least) {
  if (*column == STY_NO_CONTOUR) return least;
  const int dx = 256 * i - aim->rest.x, dy = 256 * *column - aim->rest.y;
  return dx * dx + dy * dy < least ? dx * dx + dy * dy : least;
}

/* Columns from the nearest to the farthest, until none can be nearer: a place is less than a pixel off its middle. */
static int find_distance(int width, const int8_t *columns, const Aim *aim, int reach, int most) {
  const int x = aim->pixel.x;
  const int8_t *middle = columns + (size_t)aim->pixel.y * (size_t)width + (size_t)x;
  int least = (most + 1) * (most + 1);
  for (int i = 0; i <= reach && (i == 0 || 256 * 256 * (i - 1) * (i - 1) < least); i++) {
    if (x + i < width) least = square_distance(aim, middle + i, i, least);
    if (x >= i) least = square_distance(aim, middle - i, -i, least);
  }
  return find_root((uint32_t)least);
}

static uint8_t cover_pixel(int width, int height, const int8_t *columns, const StyLine *line, int x, int y) {
  const int half = (line->width + 256) / 2;
  const Aim aim = find_aim(width, height, line, x, y);
  int coverage = half - find_distance(width, columns, &aim, sty_get_line_reach(line), half);
  if (coverage > 256) coverage = 256;
  if (coverage > line->width) coverage = line->width;
  return (uint8_t)(coverage > 0 ? (coverage * 255 + 128) / 256 : 0);
}

StyRuntimeStatus sty_draw_lines(int width, int height, const int8_t *columns, const StyLine *line, StyRect rect,
                                uint8_t *lines) {
  if (!columns || !lines || !is_line_valid(line) || !is_size_valid(width, height) ||
      !is_rect_inside(rect, width, height))
    return STY_RUNTIME_BAD_ARGUMENT;
  for (int y = rect.y0; y < rect.y1; y++)
    for (int x = rect.x0; x < rect.x1; x++)
      lines[(size_t)y * (size_t)width + (size_t)x] = cover_pixel(width, height, columns, line, x, y);
  return STY_RUNTIME_OK;
}

/* ---- lines on a picture ---- */

static void lay_pixel(uint64_t line, const uint8_t colour[4], bool beyond, int bits, void *picture, size_t at) {
  const uint64_t whole = 255 * 255, most = bits == 8 ? 255 : 65535, alpha = read_component(picture, bits, at + 3);
  const uint64_t over = beyond ? line * most : line, under = beyond ? alpha * (whole - line) : whole - line;
  const uint64_t sum = over + under;
  for (size_t c = 0; c < 3; c++) {
    const uint64_t mixed = colour[c] * (most / 255) * over + read_component(picture, bits, at + c) * under;
    write_component(picture, bits, at + c, sum ? (mixed + sum / 2) / sum : 0);
  }
  if (beyond) write_component(picture, bits, at + 3, (sum + whole / 2) / whole);
}

StyRuntimeStatus sty_lay_lines(int width, int height, const uint8_t *lines, const uint8_t colour[4], int beyond,
                               StyRect rect, int bits, void *picture) {
  if (!lines || !colour || !picture || (bits != 8 && bits != 16) || !is_size_valid(width, height) ||
      !is_rect_inside(rect, width, height))
    return STY_RUNTIME_BAD_ARGUMENT;
  for (int y = rect.y0; y < rect.y1; y++)
    for (int x = rect.x0; x < rect.x1; x++) {
      const size_t index = (size_t)y * (size_t)width + (size_t)x;
      lay_pixel((uint64_t)lines[index] * colour[3], colour, beyond, bits, picture, 4 * index);
    }
  return STY_RUNTIME_OK;
}
