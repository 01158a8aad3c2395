/* Luminance in steps; twin of toon.c for 8 bits. Target: RGBA8, not SRGB8_ALPHA8; blending and dithering off. */
uniform int toon_band_count, toon_thresholds[7]; /* bytes */
uniform ivec4 toon_colours[8];                   /* bytes */
uniform int toon_colour_weight;                  /* 256ths */
uniform int toon_style;
uniform int toon_pattern_weight; /* 256ths; 0: there is no pattern */
uniform int toon_cell_level, toon_jitter_table, toon_jitter_amount;
uniform sampler2D toon_pattern; /* R8 */
layout(location = 0) out vec4 picture;

/* The differences of normals between samples along x and y: sums, in 64ths of a byte, and pairs. */
struct Slopes {
  ivec2 sum, pairs;
};

/* The guide of the sample; alpha is 0 where it doesn't count. */
ivec4 find_sample(ivec2 seed, int object, ivec2 place) {
  ivec2 p = seed + (place - 2) * (1 << (toon_cell_level - 2));
  if (any(greaterThan(place, ivec2(4))) || !contains_pixel(p) || get_object(p) != object) return ivec4(0);
  return get_guide(p);
}

int measure_length(ivec4 a, ivec4 b) {
  ivec3 d = a.xyz - b.xyz;
  return find_root(4096 * (d.x * d.x + d.y * d.y + d.z * d.z));
}

Slopes measure_slopes(ivec2 seed, int object) {
  Slopes slopes = Slopes(ivec2(0), ivec2(0));
  for (int row = 0; row < 5; row++)
    for (int column = 0; column < 5; column++) {
      ivec2 place = ivec2(column, row);
      ivec4 sampled = find_sample(seed, object, place);
      if (sampled.a == 0) continue;
      ivec4 right = find_sample(seed, object, place + ivec2(1, 0));
      ivec4 below = find_sample(seed, object, place + ivec2(0, 1));
      if (right.a > 0) slopes.sum.x += measure_length(sampled, right), slopes.pairs.x++;
      if (below.a > 0) slopes.sum.y += measure_length(sampled, below), slopes.pairs.y++;
    }
  return slopes;
}

/* Cosine and sine of the cell around a seed, for one object, in 4096ths. */
ivec2 turn_cell(ivec2 seed, int object) {
  Slopes slopes = measure_slopes(seed, object);
  bvec2 has_pairs = greaterThan(slopes.pairs, ivec2(0)), slants = greaterThanEqual(slopes.sum, 32 * slopes.pairs);
  if (!(has_pairs.x && slants.x) && !(has_pairs.y && slants.y)) return ivec2(4096, 0);
  ivec2 way = slopes.sum * (all(has_pairs) ? slopes.pairs.yx : ivec2(1));
  while (way.x >= 2048 || way.y >= 2048) way /= 2;
  return 65536 * way / find_root(256 * (way.x * way.x + way.y * way.y));
}

/* Where in the pattern a pixel lies. */
ivec2 place_pixel(ivec2 p) {
  ivec2 anchor = get_anchor(p), in_grid = p - anchor;
  if (toon_cell_level == 0) return in_grid;
  ivec2 seed = find_seed(toon_jitter_table, toon_jitter_amount, in_grid, toon_cell_level);
  ivec2 turn = turn_cell(seed + anchor, get_object(p)), d = in_grid - seed;
  return seed + ((ivec2(d.x * turn.x + d.y * turn.y, d.y * turn.x - d.x * turn.y) + 2048) >> 12);
}

ivec4 choose_band(ivec2 p) {
  int luma = 256 * get_luma(p), band = 0;
  if (toon_pattern_weight > 0) luma += toon_pattern_weight * (get_texel(toon_pattern, place_pixel(p)).r - 128);
  for (int i = 0; i < toon_band_count - 1; i++)
    if (256 * toon_thresholds[i] <= luma) band++;
  return toon_colours[band];
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  int style = has(HAS_STYLES) ? int(texelFetch(frame_styles, p * frame_stride, 0).r) : frame_style;
  int coverage = get_guide(p).a;
  if (coverage == 0 || (toon_style != 0 && toon_style != style)) {
    picture = vec4(0.0);
    return;
  }
  const int whole = 255 * 256;
  ivec4 colour = choose_band(p);
  ivec3 factor = ivec3(whole);
  if (has(HAS_ALBEDO))
    factor = 255 * (256 - toon_colour_weight) +
             toon_colour_weight * to_bytes(texelFetch(frame_albedo, p * frame_stride, 0)).rgb;
  picture = vec4((colour.rgb * factor + whole / 2) / whole, (colour.a * coverage + 127) / 255) / 255.0;
}
