/* What the passes share; twin of view.h, matching.h and seeds.c. Names, formats and meaning of textures and uniforms:
 * README.md. Texels are fetched, never filtered, and all decisions are made in integers. */

/* ---- the bundle: its files as they are ---- */

uniform sampler2DArray bundle_exemplars; /* RGBA8, not SRGB8_ALPHA8: stored bytes are averaged */
uniform sampler2DArray bundle_guides;    /* RGBA8 */
uniform usampler2DArray bundle_luts;     /* RG16UI */
uniform sampler2DArray bundle_params;    /* RGBA32F */
uniform sampler2DArray bundle_jitter;    /* RG8 */

/* ---- the frame: StyFrame ---- */

uniform ivec2 frame_size;
uniform int frame_stride; /* texels of the frame's textures from pixel to pixel: 2 for the half of a frame, else 1 */
uniform int frame_resolution;
uniform int frame_number;
uniform int frame_style;  /* where there are no styles */
uniform int frame_inputs; /* sum of HAS_*: which of the textures below are there */
const int HAS_FINE = 1, HAS_DEPTH = 2, HAS_STYLES = 4, HAS_OBJECTS = 8, HAS_LUMA = 16, HAS_ALBEDO = 32,
          HAS_ANCHORS = 64;

uniform sampler2D frame_guide;    /* RGBA8 */
uniform sampler2D frame_fine;     /* RG32F */
uniform sampler2D frame_depth;    /* R32F */
uniform usampler2D frame_styles;  /* R8UI */
uniform usampler2D frame_objects; /* R16UI */
uniform sampler2D frame_luma;     /* R8 */
uniform sampler2D frame_albedo;   /* RGBA8 */
uniform isampler2D frame_anchors; /* RG32I, ANCHOR_COLUMNS wide: object 256*row + column */
const int ANCHOR_COLUMNS = 256;

bool has(int input_bit) { return (frame_inputs & input_bit) != 0; }

ivec4 to_bytes(vec4 fractions) { return ivec4(fractions * 255.0 + 0.5); }

/* Of a repeated pattern; what % does to negative numbers isn't defined. */
ivec2 wrap(ivec2 p, ivec2 size) {
  ivec2 below = size - 1 - (-1 - min(p, -1)) % size, above = max(p, 0) % size;
  return ivec2(p.x < 0 ? below.x : above.x, p.y < 0 ? below.y : above.y);
}

ivec4 get_texel(sampler2D pattern, ivec2 p) {
  return to_bytes(texelFetch(pattern, wrap(p, textureSize(pattern, 0)), 0));
}

/* The root, rounded down, of what is below 2^31; how well sqrt rounds is up to the processor. */
int find_root(int square) {
  int root = int(sqrt(float(square)));
  while (root * root > square) root--;
  while (uint(root + 1) * uint(root + 1) <= uint(square)) root++;
  return root;
}

int sum_differences(ivec4 a, ivec4 b) {
  ivec3 differences = abs(a.xyz - b.xyz);
  return differences.x + differences.y + differences.z;
}

/* By bits: compilers may take it that no number is NaN. */
bool is_nan(float value) { return (floatBitsToInt(value) & 0x7FFFFFFF) > 0x7F800000; }

/* ---- a frame's pixel ---- */

bool contains_pixel(ivec2 p) { return all(greaterThanEqual(p, ivec2(0))) && all(lessThan(p, frame_size)); }

ivec4 get_guide(ivec2 p) { return to_bytes(texelFetch(frame_guide, p * frame_stride, 0)); }

int get_luma(ivec2 p) { return to_bytes(texelFetch(frame_luma, p * frame_stride, 0)).r; }

int get_object(ivec2 p) { return has(HAS_OBJECTS) ? int(texelFetch(frame_objects, p * frame_stride, 0).r) : 0; }

/* The style that a pixel is drawn in; 0 where nothing is stylized. */
int get_style(ivec2 p) {
  if (get_guide(p).a == 0) return 0;
  int style = has(HAS_STYLES) ? int(texelFetch(frame_styles, p * frame_stride, 0).r) : frame_style;
  return style <= textureSize(bundle_params, 0).x ? style : 0;
}

/* Where the seed grid of a pixel begins. */
ivec2 get_anchor(ivec2 p) {
  int object = get_object(p);
  ivec2 place = ivec2(object % ANCHOR_COLUMNS, object / ANCHOR_COLUMNS);
  if (!has(HAS_ANCHORS) || place.y >= textureSize(frame_anchors, 0).y) return ivec2(0);
  return texelFetch(frame_anchors, place, 0).xy;
}

/* ---- a style ---- */

const int UNORM8 = 1, OBJECTS = 2, BASE = 4; /* flags */
const int JITTER_SIZE = 256, MAX_LIGHTINGS = 4;
const int LEVEL_FALLBACK = 254, LEVEL_NONE = 255, NO_SOURCE = 65535;

struct Source {
  int number; /* the style's less 1 */
  ivec2 size;
  int threshold, luma_weight, colour_weight; /* 256ths */
  int top_level, radius, scatter, flags;
  float depth_tolerance;
  int layer, layer_count;
  ivec4 luma;                       /* bytes */
  int jitter_table, jitter_amount;  /* layer; 255ths */
  int spread;                       /* log2 of the frame's pixels per source pixel */
};

vec4 get_parameters(int style, int row) { return texelFetch(bundle_params, ivec3(style - 1, row, 0), 0); }

Source open_source(int style) {
  vec4 voting = get_parameters(style, 0), light = get_parameters(style, 1), seeds = get_parameters(style, 3);
  int period = int(seeds.y);
  Source source;
  source.number = style - 1;
  source.size = textureSize(bundle_guides, 0).xy;
  source.threshold = 256 * int(voting.x);
  source.top_level = int(voting.y);
  source.radius = int(voting.z);
  source.depth_tolerance = voting.w;
  source.luma_weight = int(light.x * 256.0 + 0.5);
  source.colour_weight = int(light.y * 256.0 + 0.5);
  source.layer = int(light.z);
  source.layer_count = int(light.w);
  source.luma = to_bytes(get_parameters(style, 2));
  source.jitter_table = period == 0 ? 0 : frame_number / period % textureSize(bundle_jitter, 0).z;
  source.jitter_amount = int(seeds.x * 255.0 + 0.5);
  source.spread = frame_resolution + (seeds.z == 2.0 ? 1 : 0) - (seeds.z == 0.5 ? 1 : 0);
  source.flags = int(seeds.w);
  source.scatter = int(get_parameters(style, 4).x);
  return source;
}

bool has_flag(Source source, int flag) { return (source.flags & flag) != 0; }

/* The guide texel at a source pixel; alpha is 0 outside the source or its mask. */
ivec4 find_source_texel(Source source, ivec2 p) {
  if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, source.size))) return ivec4(0);
  return to_bytes(texelFetch(bundle_guides, ivec3(p, source.number), 0));
}

/* A distance in the frame, in source pixels, rounded down. */
ivec2 to_source(Source source, ivec2 distance) {
  return source.spread > 0 ? distance >> source.spread : distance * (1 << -source.spread);
}

/* ---- seeds ---- */

/* A table is a layer of bundle_jitter. */
ivec2 get_jitter(int table, ivec2 cell) {
  return to_bytes(texelFetch(bundle_jitter, ivec3(cell & (JITTER_SIZE - 1), table), 0)).xy;
}

/* The seed nearest to p, both in the grid's coordinates. The order of the loops and the strict comparison decide
 * between seeds that are equally near. */
ivec2 find_seed(int table, int amount, ivec2 p, int level) {
  ivec2 nearest = ivec2(0);
  int least = 0x7FFFFFFF, reach = amount << level;
  for (int dx = -1; dx <= 1; dx++)
    for (int dy = -1; dy <= 1; dy++) {
      ivec2 cell = (p >> level) + ivec2(dx, dy);
      ivec2 seed = cell * (1 << level) + reach * get_jitter(table, cell) / (255 * 255);
      ivec2 way = seed - p;
      int distance = way.x * way.x + way.y * way.y;
      if (distance < least) {
        least = distance;
        nearest = seed;
      }
    }
  return nearest;
}

/* ---- matching a pixel ---- */

/* Where a coordinate g in -1..1 falls along a LUT's side; for the row, -g.y. Each step is one rounded operation, so
 * that no processor can fuse two. */
int address_fine(float g, int side, bool unorm8) {
  float unit = (is_nan(g) ? 0.0 : clamp(g, -1.0, 1.0)) * 0.5 + 0.5;
  int cell = unorm8 ? (int(unit * float(2 * (side - 1))) + 1) / 2 : int(unit * float(side));
  return min(cell, side - 1);
}

/* The same for a byte that stands for g = (2b-255)/255; 255 - b stands for -g. */
int address_byte(int b, int side, bool unorm8) {
  return min(unorm8 ? (2 * b * (side - 1) + 255) / 510 : b * side / 255, side - 1);
}

/* LUT(guide at a frame's pixel). */
ivec2 look_up(Source source, ivec2 p) {
  int side = textureSize(bundle_luts, 0).x;
  bool unorm8 = has_flag(source, UNORM8);
  ivec2 address;
  if (has(HAS_FINE)) {
    vec2 fine = texelFetch(frame_fine, p * frame_stride, 0).xy;
    address = ivec2(address_fine(fine.x, side, unorm8), address_fine(-fine.y, side, unorm8));
  } else {
    ivec4 guide = get_guide(p);
    address = ivec2(address_byte(guide.x, side, unorm8), address_byte(255 - guide.y, side, unorm8));
  }
  uvec2 place = texelFetch(bundle_luts, ivec3(address, source.number), 0).xy;
  return min(ivec2(place * uvec2(source.size) / 65535u), source.size - 1);
}

int choose_lighting(Source source, ivec2 p) {
  if (!has(HAS_LUMA)) return 0;
  int luma = get_luma(p), chosen = 0;
  for (int i = 1; i < source.layer_count; i++)
    if (abs(luma - source.luma[i]) < abs(luma - source.luma[chosen])) chosen = i;
  return chosen;
}

/* Whether a pixel, tilted by so many bytes, takes a source pixel in this lighting. */
bool accepts(Source source, ivec2 p, ivec4 tilt, ivec2 candidate, int lighting) {
  ivec4 there = find_source_texel(source, candidate);
  if (there.a == 0) return false;
  int error = 256 * sum_differences(get_guide(p) + tilt, there);
  if (has(HAS_LUMA)) error += source.luma_weight * abs(get_luma(p) - source.luma[lighting]);
  return error < source.threshold;
}

/* A match as targets hold it: x, y, level + 256 * lighting, style less 1. */
uvec4 make_match(Source source, ivec2 place, int level, int lighting) {
  return uvec4(place, level + 256 * lighting, source.number);
}

uvec4 get_no_match() { return uvec4(NO_SOURCE, NO_SOURCE, LEVEL_NONE, 0); }

int get_level(uvec4 match) { return int(match.z & 255u); }

int get_lighting(uvec4 match) { return int(match.z >> 8u); }

/* LUT(guide at p) in the lighting nearest to p. */
uvec4 fall_back(Source source, ivec2 p) {
  return make_match(source, look_up(source, p), LEVEL_FALLBACK, choose_lighting(source, p));
}
