#include <math.h>
#include <stdio.h>
#include <string.h>

#include "lut/engine.h"
#include "stylut/parse.h"

const char *const sty_foreign_names[] = {"stylut", "unity", "rg8", "rg16", "rg8x2", NULL};
const char *const sty_encoding_names[] = {"f32", "rg16", "rg8x2", "rg8", NULL};

static const uint32_t max16 = 65535, max8 = 255;

float sty_get_coordinate(uint32_t pixel, uint32_t side) { return (float)(2 * pixel + 1) / (float)(2 * side); }

/* The four byte- or short-sized values of a texel under an integer encoding. */
static void pack_texel(StyEncoding encoding, uint32_t x, uint32_t y, uint32_t width, uint32_t height, uint32_t v[4]) {
  const uint32_t maximum = encoding == STY_ENCODE_RG8 ? max8 : max16;
  const uint32_t u16 = sty_encode_coordinate(x, width, maximum), v16 = sty_encode_coordinate(y, height, maximum);
  if (encoding == STY_ENCODE_RG8X2) {
    v[0] = u16 >> 8, v[1] = u16 & 255, v[2] = v16 >> 8, v[3] = v16 & 255;
  } else {
    v[0] = u16, v[1] = v16, v[2] = v[3] = 0;
  }
}

static StyStatus describe_cube(const StyLut *lut, StyImage *image, StyError *error) {
  char depth[32], channels[STY_FEATURES_SIZE];
  snprintf(depth, sizeof depth, "%d", lut->depth);
  sty_write_features(lut->axes, 3, channels);
  const StyStatus status = sty_set_attribute(image, "stylut:depth", depth, error);
  return status ? status : sty_set_attribute(image, "stylut:channels", channels, error);
}

static StyStatus describe_lut(const StyLut *lut, StyEncoding encoding, StyImage *image, StyError *error) {
  char source[32];
  snprintf(source, sizeof source, "%dx%d", lut->source_width, lut->source_height);
  const char *const pairs[][2] = {
      {"stylut:kind", "lut"},
      {"stylut:encoding", sty_encoding_names[encoding]},
      {"stylut:source", source},
      {"stylut:sampling", sty_sampling_names[lut->spec.sampling]},
      {"stylut:map", sty_map_names[lut->spec.map]},
      {"stylut:metric", sty_metric_names[lut->spec.metric]},
  };
  StyStatus status = STY_OK;
  for (size_t i = 0; !status && i < sizeof pairs / sizeof *pairs; i++)
    status = sty_set_attribute(image, pairs[i][0], pairs[i][1], error);
  char slack[32];
  snprintf(slack, sizeof slack, "%.9g", lut->slack);
  if (!status && lut->slack > 0) status = sty_set_attribute(image, "stylut:slack", slack, error);
  return status || !lut->depth ? status : describe_cube(lut, image, error);
}

StyStatus sty_encode_lut(const StyLut *lut, StyEncoding encoding, StyImage **out, StyError *error) {
  static const char *const float_names[] = {"u", "v", "error"}, *const integer_names[] = {"R", "G", "B", "A"};
  const bool is_float = encoding == STY_ENCODE_F32;
  const int bits = is_float ? 32 : encoding == STY_ENCODE_RG16 ? 16 : 8;
  StyImage *image = NULL;
  StyStatus status = sty_create_image(lut->spec.width, lut->spec.height, encoding == STY_ENCODE_RG8X2 ? 4 : 3,
                                      is_float ? float_names : integer_names, bits, &image, error);
  if (!status) status = describe_lut(lut, encoding, image, error);
  if (status) {
    sty_destroy_image(&image);
    return status;
  }
  const size_t texels = sty_count_pixels(image);
  const uint32_t width = (uint32_t)lut->source_width, height = (uint32_t)lut->source_height;
  for (size_t t = 0; t < texels; t++) {
    const uint32_t x = lut->pixels[t] % width, y = lut->pixels[t] / width;
    if (is_float) {
      image->data[t] = sty_get_coordinate(x, width);
      image->data[texels + t] = sty_get_coordinate(y, height);
      image->data[2 * texels + t] = lut->errors[t];
    } else {
      uint32_t v[4];
      pack_texel(encoding, x, y, width, height, v);
      for (int c = 0; c < image->channel_count; c++)
        image->data[(size_t)c * texels + t] = (float)v[c] / (bits == 8 ? 255.0f : 65535.0f);
    }
  }
  *out = image;
  return STY_OK;
}

/* A table of a kind this version doesn't know must not be taken for another. */
static StyStatus check_kind(const char *name, const StyImage *image, StyError *error) {
  const char *text = sty_find_attribute(image, "stylut:kind");
  if (text && strcmp(text, "lut") != 0)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found stylut:kind = %s, expected lut", name, text);
  return STY_OK;
}

/* The attribute's place among `names`; *out is left alone where the file doesn't say. */
static StyStatus read_choice(const char *name, const StyImage *image, const char *attribute, const char *const *names,
                             int *out, StyError *error) {
  const char *text = sty_find_attribute(image, attribute);
  if (!text || !sty_parse_choice(attribute, text, names, out, NULL)) return STY_OK;
  char known[64] = "";
  for (int i = 0; names[i]; i++)
    snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? " or " : "", names[i]);
  return sty_fail(error, STY_ERROR_INPUT, "%s: found %s = %s, expected %s", name, attribute, text, known);
}

static StyStatus choose_encoding(const char *name, const StyImage *image, StyForeign foreign, StyEncoding *out,
                                 StyError *error) {
  static const StyEncoding encodings[] = {[STY_FOREIGN_UNITY] = STY_ENCODE_RG8,
                                          [STY_FOREIGN_RG8] = STY_ENCODE_RG8,
                                          [STY_FOREIGN_RG16] = STY_ENCODE_RG16,
                                          [STY_FOREIGN_RG8X2] = STY_ENCODE_RG8X2};
  int choice = -1;
  if (foreign) {
    choice = (int)encodings[foreign];
  } else {
    const StyStatus status = read_choice(name, image, "stylut:encoding", sty_encoding_names, &choice, error);
    if (status) return status;
  }
  if (choice < 0 && image->bits == 8)
    return sty_fail(error, STY_ERROR_INPUT,
                    "%s: found an 8-bit picture without a stylut:encoding attribute, expected a LUT that says whether "
                    "it is rg8x2 or rg8",
                    name);
  *out = choice >= 0 ? (StyEncoding)choice : image->bits == 32 ? STY_ENCODE_F32 : STY_ENCODE_RG16;
  return STY_OK;
}

static StyStatus find_sampling(const char *name, const StyImage *image, StyLutHints *facts, StyError *error) {
  if (facts->foreign == STY_FOREIGN_UNITY) {
    facts->sampling = STY_SAMPLE_CORNER;
    return STY_OK;
  }
  int choice = -1;
  const StyStatus status = read_choice(name, image, "stylut:sampling", sty_sampling_names, &choice, error);
  if (status) return status;
  if (choice >= 0 && facts->sampling >= 0 && facts->sampling != choice)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found a LUT of sampling %s, expected %s", name,
                    sty_sampling_names[choice], sty_sampling_names[facts->sampling]);
  if (choice >= 0) facts->sampling = choice;
  if (facts->sampling < 0) facts->sampling = STY_SAMPLE_CENTRE;
  return STY_OK;
}

static StyStatus find_source_size(const char *name, const StyImage *image, StyLutHints *facts, StyError *error) {
  const char *text = sty_find_attribute(image, "stylut:source");
  if (text) {
    int width, height;
    if (sty_parse_size("stylut:source", text, STY_MAX_SIDE, &width, &height, NULL))
      return sty_fail(error, STY_ERROR_INPUT, "%s: found source size '%s', expected WIDTHxHEIGHT", name, text);
    if (facts->source_width && (width != facts->source_width || height != facts->source_height))
      return sty_fail(error, STY_ERROR_INPUT, "%s: found a LUT for a source of %dx%d pixels, expected one for %dx%d",
                      name, width, height, facts->source_width, facts->source_height);
    facts->source_width = width;
    facts->source_height = height;
  }
  if (!facts->source_width)
    return sty_fail(error, STY_ERROR_INPUT,
                    "%s: found no stylut:source attribute, expected to know the size of the LUT's source", name);
  return STY_OK;
}

/* What kind of table an image holds. */
typedef struct Kind {
  StyEncoding encoding;
  int depth; /* as in StyLut, and so are the axes */
  StyFeature axes[3];
  int map, metric;
} Kind;

static StyStatus find_depth(const char *name, const StyImage *image, Kind *kind, StyError *error) {
  const char *text = sty_find_attribute(image, "stylut:depth");
  const char *channels = sty_find_attribute(image, "stylut:channels");
  StyFeature features[STY_MOST_DIMS];
  long long depth;
  int count = 0;
  if (!text) return STY_OK;
  if (sty_parse_integer("stylut:depth", text, 1, STY_MAX_CUBE, &depth, NULL) || image->width != depth ||
      image->height != depth * depth)
    return sty_fail(error, STY_ERROR_INPUT,
                    "%s: found %dx%d pixels and stylut:depth = %s, expected slices as many as they are wide", name,
                    image->width, image->height, text);
  if (!channels || sty_parse_features("stylut:channels", channels, features, &count, NULL) || count != 3)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found stylut:channels = %s, expected three channels", name,
                    channels ? channels : "nothing");
  memcpy(kind->axes, features, sizeof kind->axes);
  kind->depth = (int)depth;
  return STY_OK;
}

/* From its attributes, else from its shape. `facts` holds what the caller knew
 * and receives what the file says. */
static StyStatus recognize_lut(const char *name, const StyImage *image, Kind *kind, StyLutHints *facts,
                               StyError *error) {
  StyStatus status = facts->foreign ? STY_OK : find_depth(name, image, kind, error);
  const bool square = image->width == image->height || facts->foreign == STY_FOREIGN_UNITY;
  const bool fits = square && image->width <= STY_MAX_LUT_SIZE && image->height <= STY_MAX_LUT_SIZE;
  if (!status && !kind->depth && !fits)
    return sty_fail(error, STY_ERROR_INPUT,
                    "%s: found %dx%d pixels, expected a square LUT of at most %d (StyleBlitUnity's: --as unity)", name,
                    image->width, image->height, STY_MAX_LUT_SIZE);
  if (!status) status = choose_encoding(name, image, facts->foreign, &kind->encoding, error);
  if (!status) status = find_sampling(name, image, facts, error);
  if (!status) status = find_source_size(name, image, facts, error);
  return status;
}

/* The table that the image is to fill. */
static StyStatus create_lut(const char *name, const StyImage *image, const Kind *kind, const StyLutHints *facts,
                            StyLut **out, StyError *error) {
  const StyLutSpec spec = {image->width, image->height, (StySampling)facts->sampling, (StyMap)kind->map,
                           (StyMetric)kind->metric};
  const bool plain = spec.sampling == STY_SAMPLE_CENTRE && spec.map == STY_MAP_XY && spec.metric == STY_METRIC_XY;
  if (kind->depth && !plain)
    return sty_fail(error, STY_ERROR_INPUT,
                    "%s: found three dimensions with sampling %s, map %s and metric %s, expected centre, xy and xy",
                    name, sty_sampling_names[spec.sampling], sty_map_names[spec.map], sty_metric_names[spec.metric]);
  const StyStatus status =
      kind->depth ? sty_create_cube(kind->depth, kind->axes, facts->source_width, facts->source_height, out, error)
                  : sty_create_lut(&spec, facts->source_width, facts->source_height, out, error);
  /* What nobody may ask for is the file's fault here. */
  if (status == STY_ERROR_USAGE) return sty_fail(error, STY_ERROR_INPUT, "%s: %s", name, error ? error->text : "");
  return status;
}

static StyStatus read_slack(const char *name, const StyImage *image, double *out, StyError *error) {
  const char *text = sty_find_attribute(image, "stylut:slack");
  if (!text || !sty_parse_number("stylut:slack", text, 0, STY_MAX_GUIDE_VALUE, out, NULL)) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT, "%s: found stylut:slack = %s, expected a number of 0 to %g", name, text,
                  (double)STY_MAX_GUIDE_VALUE);
}

/* The source coordinate of a float texel, or -1. */
static long unpack_float(float u, int side) {
  if (!(u >= 0 && u <= 1)) return -1;
  const long x = (long)(u * (float)side);
  return x < side ? x : side - 1;
}

static StyStatus decode_floats(const char *name, const float *u, const float *v, StyLut *lut, StyError *error) {
  const size_t texels = sty_count_texels(&lut->spec);
  for (size_t t = 0; t < texels; t++) {
    const long x = unpack_float(u[t], lut->source_width), y = unpack_float(v[t], lut->source_height);
    if (x < 0 || y < 0)
      return sty_fail(error, STY_ERROR_INPUT,
                      "%s: found (%g, %g) at texel (%zu, %zu), expected coordinates from 0 to 1", name, (double)u[t],
                      (double)v[t], t % (size_t)lut->spec.width, t / (size_t)lut->spec.width);
    lut->pixels[t] = (uint32_t)(y * lut->source_width + x);
  }
  return STY_OK;
}

static void decode_integers(const float *const planes[4], StyEncoding encoding, bool y_up, StyLut *lut) {
  const size_t texels = sty_count_texels(&lut->spec);
  const uint32_t width = (uint32_t)lut->source_width, height = (uint32_t)lut->source_height;
  const uint32_t maximum = encoding == STY_ENCODE_RG8 ? max8 : max16;
  const float scale = encoding == STY_ENCODE_RG16 ? 65535.0f : 255.0f;
  for (size_t t = 0; t < texels; t++) {
    uint32_t u = (uint32_t)lrintf(planes[0][t] * scale), v = (uint32_t)lrintf(planes[1][t] * scale);
    if (encoding == STY_ENCODE_RG8X2) {
      u = u << 8 | v;
      v = (uint32_t)lrintf(planes[2][t] * scale) << 8 | (uint32_t)lrintf(planes[3][t] * scale);
    }
    const uint32_t x = sty_decode_coordinate(u, width, maximum), y = sty_decode_coordinate(v, height, maximum);
    lut->pixels[t] = (y_up ? height - 1 - y : y) * width + x;
  }
}

StyStatus sty_decode_lut(const char *name, const StyImage *image, const StyLutHints *hints, StyLut **out,
                         StyError *error) {
  Kind kind = {.encoding = STY_ENCODE_F32, .map = STY_MAP_XY, .metric = STY_METRIC_XY};
  StyLutHints facts = *hints;
  StyStatus status = check_kind(name, image, error);
  if (!status) status = recognize_lut(name, image, &kind, &facts, error);
  if (status) return status;
  static const char *const float_names[4] = {"u", "v", "error"}, *const integer_names[4] = {"R", "G", "B", "A"};
  const bool is_float = kind.encoding == STY_ENCODE_F32;
  const int wanted = kind.encoding == STY_ENCODE_RG8X2 ? 4 : 2;
  const int bits = is_float ? 32 : kind.encoding == STY_ENCODE_RG16 ? 16 : 8;
  const float *planes[4] = {NULL};
  bool complete = image->bits == bits;
  for (int c = 0; c < wanted; c++) {
    planes[c] = sty_find_channel(image, is_float ? float_names[c] : integer_names[c]);
    complete = complete && planes[c];
  }
  if (!complete)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found %d-bit channels %s..., expected %s of an %s LUT", name,
                    image->bits, image->names[0],
                    is_float      ? "u and v"
                    : wanted == 2 ? "R and G"
                                  : "R, G, B and A",
                    sty_encoding_names[kind.encoding]);
  StyLut *lut = NULL;
  status = read_choice(name, image, "stylut:map", sty_map_names, &kind.map, error);
  if (!status) status = read_choice(name, image, "stylut:metric", sty_metric_names, &kind.metric, error);
  if (!status) status = create_lut(name, image, &kind, &facts, &lut, error);
  if (status) return status;
  const float *errors = is_float ? sty_find_channel(image, float_names[2]) : NULL;
  if (errors) memcpy(lut->errors, errors, sty_count_pixels(image) * sizeof *errors);
  status = read_slack(name, image, &lut->slack, error);
  if (!status && is_float)
    status = decode_floats(name, planes[0], planes[1], lut, error);
  else if (!status)
    decode_integers(planes, kind.encoding, facts.foreign == STY_FOREIGN_UNITY, lut);
  if (status)
    sty_destroy_lut(&lut);
  else
    *out = lut;
  return status;
}
