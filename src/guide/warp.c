#include "stylut/warp.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "guide/pairs.h"

enum { BAND = 32 }; /* rows that are done at a time */

/* Moments' determinant over their squared trace, about one over their condition number, below which points count as
 * lying on a line: overall, a thousand times as long as it is wide, so that a slip of a pixel would move all. */
static const double thinnest_overall = 1e-6, thinnest_nearby = 1e-14;

/* ---- one place (section 2 of the paper) ----------------------------------------- */

/* Weighted sums over pairs of p^ = p - p* and q^ = q - q*. */
typedef struct Moments {
  double xx, xy, yy;    /* of p^ with p^ */
  double product[2][2]; /* of p^ with q^: [0][1] is p^.x times q^.y */
} Moments;

/* (v - p*) M of the best M. */
static void apply_similarity(const Moments *m, bool rigid, const double v[2], double out[2]) {
  /* Eqs. 6 to 8 as complex numbers: M is the sum of w conj(p^) q^, over that of w |p^|^2 or its own length. */
  const double real = m->product[0][0] + m->product[1][1], imaginary = m->product[0][1] - m->product[1][0];
  const double size = rigid ? sqrt(real * real + imaginary * imaginary) : m->xx + m->yy;
  const bool known = size > 0; /* a lone pair says nothing of rotation or scale */
  const double cosine = known ? real / size : 1, sine = known ? imaginary / size : 0;
  out[0] = v[0] * cosine - v[1] * sine;
  out[1] = v[0] * sine + v[1] * cosine;
}

static void apply_affine(const Moments *m, const double v[2], double out[2]) {
  const double determinant = m->xx * m->yy - m->xy * m->xy, trace = m->xx + m->yy;
  /* Beside a pair all but those on one line may have lost their weight. */
  if (!(determinant > thinnest_nearby * trace * trace)) {
    apply_similarity(m, false, v, out);
    return;
  }
  const double a = (v[0] * m->yy - v[1] * m->xy) / determinant, b = (v[1] * m->xx - v[0] * m->xy) / determinant;
  for (int k = 0; k < 2; k++) out[k] = a * m->product[0][k] + b * m->product[1][k]; /* eq. 5 */
}

/* Weights relative to the nearest pair's, whose number is returned; -1 - number where it is right here. */
static int weigh_pairs(const StyPairs *pairs, const double at[2], double *weights) {
  int nearest = 0;
  for (int i = 0; i < pairs->count; i++) {
    const double x = pairs->pairs[i].to[0] - at[0], y = pairs->pairs[i].to[1] - at[1];
    weights[i] = x * x + y * y;
    if (weights[i] < weights[nearest]) nearest = i;
  }
  const double least = weights[nearest];
  if (!(least > 0)) return -1 - nearest;
  for (int i = 0; i < pairs->count; i++) {
    const double ratio = least / weights[i];
    weights[i] = pairs->alpha == 1 ? ratio : pow(ratio, pairs->alpha);
  }
  return nearest;
}

static Moments sum_moments(const StyPairs *pairs, const double *weights, const StyPair *origin, const StyPair *centre) {
  Moments m = {.xx = 0};
  for (int i = 0; i < pairs->count; i++) {
    const StyPair *pair = &pairs->pairs[i];
    const double w = weights[i];
    const double p[2] = {pair->to[0] - origin->to[0] - centre->to[0], pair->to[1] - origin->to[1] - centre->to[1]};
    const double q[2] = {pair->from[0] - origin->from[0] - centre->from[0],
                         pair->from[1] - origin->from[1] - centre->from[1]};
    m.xx += w * p[0] * p[0];
    m.xy += w * p[0] * p[1];
    m.yy += w * p[1] * p[1];
    for (int r = 0; r < 2; r++)
      for (int c = 0; c < 2; c++) m.product[r][c] += w * p[r] * q[c];
  }
  return m;
}

/* f(at). All is taken relative to the nearest pair, so that nothing cancels where its weight outgrows all others'. */
static void solve(const StyPairs *pairs, const double at[2], double *weights, double out[2]) {
  const int nearest = weigh_pairs(pairs, at, weights);
  if (nearest < 0) {
    memcpy(out, pairs->pairs[-1 - nearest].from, sizeof pairs->pairs->from);
    return;
  }
  const StyPair *origin = &pairs->pairs[nearest];
  StyPair centre = {{0, 0}, {0, 0}}; /* p* and q* */
  double sum = 0, moved[2];
  for (int i = 0; i < pairs->count; i++) {
    sum += weights[i];
    for (int k = 0; k < 2; k++) {
      centre.to[k] += weights[i] * (pairs->pairs[i].to[k] - origin->to[k]);
      centre.from[k] += weights[i] * (pairs->pairs[i].from[k] - origin->from[k]);
    }
  }
  for (int k = 0; k < 2; k++) {
    centre.to[k] /= sum;
    centre.from[k] /= sum;
  }
  const Moments moments = sum_moments(pairs, weights, origin, &centre);
  const double v[2] = {at[0] - origin->to[0] - centre.to[0], at[1] - origin->to[1] - centre.to[1]};
  if (pairs->kind == STY_WARP_AFFINE)
    apply_affine(&moments, v, moved);
  else
    apply_similarity(&moments, pairs->kind == STY_WARP_RIGID, v, moved);
  for (int k = 0; k < 2; k++) out[k] = moved[k] + centre.from[k] + origin->from[k];
}

/* ---- figures -------------------------------------------------------------------- */

/* The larger singular value of the matrix [a b; c d], from the lengths of its conformal and anticonformal parts. */
static double find_largest_stretch(double a, double b, double c, double d) {
  return sqrt((a + d) * (a + d) + (c - b) * (c - b)) / 2 + sqrt((a - d) * (a - d) + (c + b) * (c + b)) / 2;
}

static const StyWarpFigures no_figures = {
    .stretch = 1, .compression = 1, .stretch_at = {-1, -1}, .compression_at = {-1, -1}};

/* The place of pixel (x, y) in the source and those of its neighbours to the right and below. */
static void measure_cell(const double *here, const double *below, int x, int y, StyWarpFigures *figures) {
  const double *at = here + 2 * (ptrdiff_t)x, *right = at + 2, *down = below + 2 * (ptrdiff_t)x;
  const double a = right[0] - at[0], c = right[1] - at[1], b = down[0] - at[0], d = down[1] - at[1];
  const double determinant = a * d - b * c; /* the product of the singular values */
  figures->cells++;
  if (!(determinant > 0)) {
    figures->folded++;
    return;
  }
  const double most = find_largest_stretch(a, b, c, d), least = determinant / most;
  if (figures->stretch_at[0] < 0 || 1 / least > figures->stretch) {
    figures->stretch = 1 / least;
    figures->stretch_at[0] = x;
    figures->stretch_at[1] = y;
  }
  if (figures->compression_at[0] < 0 || most > figures->compression) {
    figures->compression = most;
    figures->compression_at[0] = x;
    figures->compression_at[1] = y;
  }
}

/* A band's figures after those of the bands above. */
static void add_figures(StyWarpFigures *sum, const StyWarpFigures *band) {
  const bool first = sum->cells == sum->folded;
  if (band->cells > band->folded && (first || band->stretch > sum->stretch)) {
    sum->stretch = band->stretch;
    memcpy(sum->stretch_at, band->stretch_at, sizeof sum->stretch_at);
  }
  if (band->cells > band->folded && (first || band->compression > sum->compression)) {
    sum->compression = band->compression;
    memcpy(sum->compression_at, band->compression_at, sizeof sum->compression_at);
  }
  sum->cells += band->cells;
  sum->folded += band->folded;
}

/* The field between its pixel centres; beyond the outermost, theirs. */
static void read_field(const StyImage *field, const double at[2], double out[2]) {
  const int sides[2] = {field->width, field->height};
  int first[2];
  double rest[2];
  for (int k = 0; k < 2; k++) {
    const double place = fmin(fmax(at[k] - 0.5, 0), sides[k] - 1);
    first[k] = place < sides[k] - 1 ? (int)place : sides[k] > 1 ? sides[k] - 2 : 0;
    rest[k] = place - first[k];
  }
  const size_t step[2] = {field->width > 1 ? 1 : 0, field->height > 1 ? (size_t)field->width : 0};
  const size_t pixel = (size_t)first[1] * (size_t)field->width + (size_t)first[0];
  for (int k = 0; k < 2; k++) {
    const float *plane = field->data + (size_t)k * sty_count_pixels(field) + pixel;
    const double upper = (double)plane[0] * (1 - rest[0]) + (double)plane[step[0]] * rest[0];
    const double lower = (double)plane[step[1]] * (1 - rest[0]) + (double)plane[step[0] + step[1]] * rest[0];
    out[k] = at[k] + upper * (1 - rest[1]) + lower * rest[1];
  }
}

static bool is_inside(const double at[2], const StyImage *field) {
  return at[0] >= 0 && at[0] <= field->width && at[1] >= 0 && at[1] <= field->height;
}

static void measure_residuals(const StyPairs *pairs, const StyImage *field, StyWarpFigures *figures) {
  double sum = 0;
  for (int i = 0; i < pairs->count; i++) {
    const StyPair *pair = &pairs->pairs[i];
    if (!is_inside(pair->to, field)) continue;
    double found[2];
    read_field(field, pair->to, found);
    const double x = found[0] - pair->from[0], y = found[1] - pair->from[1], residual = sqrt(x * x + y * y);
    sum += residual;
    figures->residual_max = fmax(figures->residual_max, residual);
  }
  figures->residual_mean = sum / figures->measured;
}

/* ---- the field ------------------------------------------------------------------ */

typedef struct Warping {
  const StyPairs *pairs; /* in pixels */
  StyImage *field;       /* planes U, V, A */
  StyWarpFigures *bands;
} Warping;

static void store_place(StyImage *field, int x, int y, const double place[2], StyWarpFigures *figures) {
  const size_t pixels = sty_count_pixels(field), pixel = (size_t)y * (size_t)field->width + (size_t)x;
  const bool inside = place[0] >= 0 && place[0] < field->width && place[1] >= 0 && place[1] < field->height;
  field->data[pixel] = (float)(place[0] - (x + 0.5));
  field->data[pixels + pixel] = (float)(place[1] - (y + 0.5));
  field->data[2 * pixels + pixel] = inside;
  figures->inside += inside;
}

/* A band solves the first row of the next as well, for the cells between them. */
static void warp_band(const Warping *warping, int first, int last, double *rows[2], double *weights,
                      StyWarpFigures *figures) {
  StyImage *field = warping->field;
  for (int y = first; y <= last && y < field->height; y++) {
    double *row = rows[y % 2], *above = rows[(y + 1) % 2];
    for (int x = 0; x < field->width; x++) {
      double *place = row + 2 * (ptrdiff_t)x;
      solve(warping->pairs, (const double[2]){x + 0.5, y + 0.5}, weights, place);
      if (y < last) store_place(field, x, y, place, figures);
    }
    for (int x = 0; x + 1 < field->width && y > first; x++) measure_cell(above, row, x, y - 1, figures);
  }
}

static StyStatus run_band(void *context, long i, StyError *error) {
  const Warping *warping = context;
  const size_t row = 2 * (size_t)warping->field->width, count = 2 * row + (size_t)warping->pairs->count;
  double *memory = malloc(count * sizeof *memory);
  if (!memory) return sty_fail_memory(error, "displacement field", (double)count * sizeof *memory);
  const int first = (int)i * BAND, last = first + BAND < warping->field->height ? first + BAND : warping->field->height;
  warp_band(warping, first, last, (double *[2]){memory, memory + row}, memory + 2 * row, &warping->bands[i]);
  free(memory);
  return STY_OK;
}

static void clear_misses(StyImage *field) {
  const size_t pixels = sty_count_pixels(field);
  for (size_t i = 0; i < pixels; i++)
    if (!(field->data[2 * pixels + i] > 0)) field->data[i] = field->data[pixels + i] = 0;
}

static StyStatus fill_field(const StyPairs *pairs, StyImage *field, const StyRun *run, StyWarpFigures *figures,
                            StyError *error) {
  const long count = (field->height + BAND - 1) / BAND;
  StyWarpFigures *bands = malloc((size_t)count * sizeof *bands);
  if (!bands) return sty_fail_memory(error, "displacement field", (double)count * sizeof *bands);
  for (long b = 0; b < count; b++) bands[b] = no_figures;
  Warping warping = {pairs, field, bands};
  const StyStatus status = sty_parallel_for(run, count, run_band, &warping, error);
  for (long b = 0; b < count; b++) {
    figures->inside += bands[b].inside;
    add_figures(figures, &bands[b]);
  }
  free(bands);
  measure_residuals(pairs, field, figures);
  clear_misses(field);
  return status;
}

/* ---- pairs that can be solved --------------------------------------------------- */

static StyStatus check_points(const char *name, const StyPairs *pairs, StyError *error) {
  const double most = pairs->normalized ? STY_MAX_PAIR_COORDINATE / 1e3 : STY_MAX_PAIR_COORDINATE;
  for (int i = 0; i < pairs->count; i++)
    for (int k = 0; k < 4; k++) {
      const double value = k < 2 ? pairs->pairs[i].from[k] : pairs->pairs[i].to[k - 2];
      if (!(fabs(value) <= most))
        return sty_fail(error, STY_ERROR_INPUT, "%s: found a coordinate %g in pair %d, expected one within %g", name,
                        value, i, most);
    }
  int earlier = 0;
  bool is_to = false;
  const int later = sty_find_repeated_point(pairs->pairs, pairs->count, &earlier, &is_to);
  if (later < 0) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT, "%s: found the same point '%s' in pairs %d and %d, expected each once", name,
                  is_to ? "to" : "from", earlier, later);
}

/* Whether all `to`, or all `from`, lie on a line, or near enough for a matrix to make no sense of them. */
static bool are_collinear(const StyPairs *pairs, bool is_to) {
  double centre[2] = {0, 0}, xx = 0, xy = 0, yy = 0;
  const double *first = is_to ? pairs->pairs[0].to : pairs->pairs[0].from;
  for (int i = 0; i < pairs->count; i++) {
    const double *at = is_to ? pairs->pairs[i].to : pairs->pairs[i].from;
    for (int k = 0; k < 2; k++) centre[k] += (at[k] - first[k]) / pairs->count;
  }
  for (int i = 0; i < pairs->count; i++) {
    const double *at = is_to ? pairs->pairs[i].to : pairs->pairs[i].from;
    const double x = at[0] - first[0] - centre[0], y = at[1] - first[1] - centre[1];
    xx += x * x, xy += x * y, yy += y * y;
  }
  return !(xx * yy - xy * xy > thinnest_overall * (xx + yy) * (xx + yy));
}

static StyStatus check_affine(const char *name, const StyPairs *pairs, StyError *error) {
  for (int is_to = 1; is_to >= 0 && pairs->kind == STY_WARP_AFFINE; is_to--)
    if (are_collinear(pairs, is_to))
      return sty_fail(error, STY_ERROR_INPUT,
                      "%s: found %d point%s '%s' on one line, to a thousandth of its length, for kind affine, expected "
                      "three that aren't, or kind similarity or rigid",
                      name, pairs->count, pairs->count == 1 ? "" : "s", is_to ? "to" : "from");
  return STY_OK;
}

static StyStatus check_pairs(const char *name, const StyPairs *pairs, StyError *error) {
  if (!(pairs->alpha >= STY_MIN_WARP_ALPHA && pairs->alpha <= STY_MAX_WARP_ALPHA))
    return sty_fail(error, STY_ERROR_USAGE, "%s: found alpha = %g, expected a number from %g to %g", name, pairs->alpha,
                    STY_MIN_WARP_ALPHA, STY_MAX_WARP_ALPHA);
  const StyStatus status = check_points(name, pairs, error);
  return status ? status : check_affine(name, pairs, error);
}

/* A field that no pair lies in would be made up all over. */
static StyStatus count_outside(const char *name, const StyPairs *pairs, const StyImage *field, StyWarpFigures *figures,
                               StyError *error) {
  for (int i = 0; i < pairs->count; i++) {
    const StyPair *pair = &pairs->pairs[i];
    figures->measured += is_inside(pair->to, field);
    if (is_inside(pair->to, field) && is_inside(pair->from, field)) continue;
    if (!figures->outside++) figures->first_outside = i;
  }
  if (figures->measured) return STY_OK;
  const double *to = pairs->pairs[0].to;
  return sty_fail(error, STY_ERROR_INPUT,
                  "%s: found none of %d pairs inside the picture, the first 'to' at (%g, %g) of %dx%d pixels, expected "
                  "pairs in pixels of this size, or units \"normalized\"",
                  name, pairs->count, to[0], to[1], field->width, field->height);
}

StyStatus sty_make_warp_guide(const char *name, const StyPairs *pairs, int width, int height, const StyRun *run,
                              StyWarpFigures *figures, StyImage **out, StyError *error) {
  static const char *const names[] = {"motion.U", "motion.V", "A"};
  if (pairs->count < 1 || pairs->count > STY_MAX_PAIRS)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found %d pairs, expected 1 to %d", name, pairs->count, STY_MAX_PAIRS);
  const size_t count = (size_t)pairs->count;
  StyPairs scaled = *pairs;
  scaled.pairs = malloc(count * sizeof *scaled.pairs);
  StyStatus status = scaled.pairs ? check_pairs(name, pairs, error)
                                  : sty_fail_memory(error, name, (double)count * sizeof *scaled.pairs);
  const double sides[2] = {pairs->normalized ? width : 1, pairs->normalized ? height : 1};
  for (size_t i = 0; !status && i < count; i++)
    for (int k = 0; k < 2; k++) {
      scaled.pairs[i].from[k] = pairs->pairs[i].from[k] * sides[k];
      scaled.pairs[i].to[k] = pairs->pairs[i].to[k] * sides[k];
    }
  StyImage *field = NULL;
  StyWarpFigures found = no_figures;
  if (!status) status = sty_create_image(width, height, 3, names, 32, &field, error);
  if (!status) status = count_outside(name, &scaled, field, &found, error);
  if (!status) status = fill_field(&scaled, field, run, &found, error);
  if (!status && figures) *figures = found;
  if (status)
    sty_destroy_image(&field);
  else
    *out = field;
  free(scaled.pairs);
  return status;
}
