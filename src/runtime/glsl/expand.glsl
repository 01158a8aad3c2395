/* From matches of half a frame to those of the whole; twin of sty_expand_matches in resolution.c. Target: RGBA16UI,
 * see make_match. */
uniform usampler2D half_matches; /* RGBA16UI, (frame_size + 1) / 2 */
layout(location = 0) out uvec4 match;

/* Where pieces are moved, so is the half's match. */
ivec4 find_tilt(Source source, ivec2 p, uvec4 parent) {
  ivec4 there = find_source_texel(source, ivec2(parent.xy));
  return source.scatter != 0 && there.a > 0 ? there - get_guide(p - p % 2) : ivec4(0);
}

uvec4 expand(Source source, ivec2 p) {
  uvec4 parent = texelFetch(half_matches, p / 2, 0);
  int level = get_level(parent), lighting = get_lighting(parent);
  ivec2 candidate = ivec2(parent.xy) + to_source(source, p % 2);
  if (level != LEVEL_NONE && int(parent.w) == source.number && lighting < source.layer_count &&
      accepts(source, p, find_tilt(source, p, parent), candidate, lighting))
    return make_match(source, candidate, level, lighting);
  return fall_back(source, p);
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  int style = get_style(p);
  match = style == 0 ? get_no_match() : expand(open_source(style), p);
}
