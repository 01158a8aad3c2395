/* StyleBlit, parallel form; twin of transfer.c. Target: RGBA16UI, see make_match. */
layout(location = 0) out uvec4 match;

const int SCATTER_LEVEL = 3, FLAT_DIFFERENCE = 2;

bool looks_alike(ivec2 seed, ivec2 place) {
  if (!contains_pixel(place)) return true;
  if (has(HAS_ANCHORS) && get_object(seed) != get_object(place)) return false;
  ivec4 there = get_guide(place);
  return there.a > 0 && sum_differences(get_guide(seed), there) <= FLAT_DIFFERENCE;
}

bool is_flat(ivec2 seed, int level) {
  ivec2 across = ivec2(1 << (level - 1), 0), down = across.yx;
  return looks_alike(seed, seed - across) && looks_alike(seed, seed + across) && looks_alike(seed, seed - down) &&
         looks_alike(seed, seed + down);
}

/* On flat surfaces all seeds of a level would copy the same patch: each takes it from elsewhere, as if the surface faced
 * that way there. */
ivec2 scatter(Source source, ivec2 seed, ivec2 in_grid, int level, ivec2 found, out ivec4 tilt) {
  tilt = ivec4(0);
  if (source.scatter == 0 || level < SCATTER_LEVEL || !is_flat(seed, level)) return found;
  ivec2 moved = found + (2 * source.scatter + 1) * get_jitter(source.jitter_table, in_grid + 128) / 256 - source.scatter;
  ivec4 from = find_source_texel(source, found), to = find_source_texel(source, moved);
  if (from.a == 0 || to.a == 0) return found;
  tilt = to - from;
  return moved;
}

/* Whether a seed may propose to p. */
bool may_propose(ivec2 seed, ivec2 p) {
  return contains_pixel(seed) && get_guide(seed).a > 0 && (!has(HAS_ANCHORS) || get_object(seed) == get_object(p));
}

uvec4 match_pixel(Source source, ivec2 p) {
  ivec2 anchor = get_anchor(p);
  for (int level = source.top_level; level >= 0; level--) {
    ivec2 in_grid = find_seed(source.jitter_table, source.jitter_amount, p - anchor, level), seed = in_grid + anchor;
    if (!may_propose(seed, p)) continue;
    ivec4 tilt;
    ivec2 candidate = scatter(source, seed, in_grid, level, look_up(source, seed), tilt) + to_source(source, p - seed);
    int lighting = choose_lighting(source, seed);
    if (accepts(source, p, tilt, candidate, lighting)) return make_match(source, candidate, level, lighting);
  }
  return fall_back(source, p);
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  int style = get_style(p);
  match = style == 0 ? get_no_match() : match_pixel(open_source(style), p);
}
