/* The mean of neighbours' votes; twin of blend.c for 8 bits. Target: RGBA8, not SRGB8_ALPHA8; blending and dithering
 * off. */
uniform usampler2D matches; /* RGBA16UI, frame_size */
layout(location = 0) out vec4 picture;

/* The votes for one pixel. With bases a vote is a difference. */
struct Tally {
  ivec3 colour; /* times the exemplar's alpha */
  int alpha, votes;
};

ivec4 get_exemplar(Source source, int lighting, ivec2 place) {
  return to_bytes(texelFetch(bundle_exemplars, ivec3(place, source.layer + lighting), 0));
}

ivec3 get_base(Source source, int lighting, ivec2 place) {
  return has_flag(source, BASE) ? get_exemplar(source, source.layer_count + lighting, place).rgb : ivec3(0);
}

void add_vote(inout Tally tally, Source source, int lighting, ivec2 place) {
  ivec4 texel = get_exemplar(source, lighting, place);
  tally.colour += (texel.rgb - get_base(source, lighting, place)) * texel.a;
  tally.alpha += texel.a;
  tally.votes++;
}

bool is_infinite(float value) { return (floatBitsToInt(value) & 0x7FFFFFFF) == 0x7F800000; }

/* Equal depths agree even at infinity; NaN agrees with nothing but itself. */
bool is_depth_near(Source source, ivec2 a, ivec2 b) {
  if (!has(HAS_DEPTH) || source.depth_tolerance == 0.0 || a == b) return true;
  float depth_a = texelFetch(frame_depth, a * frame_stride, 0).r;
  float depth_b = texelFetch(frame_depth, b * frame_stride, 0).r;
  if (is_nan(depth_a) || is_nan(depth_b)) return false;
  if (is_infinite(depth_a) || is_infinite(depth_b)) return floatBitsToInt(depth_a) == floatBitsToInt(depth_b);
  return abs(depth_a - depth_b) <= source.depth_tolerance;
}

bool may_vote(Source source, ivec2 p, ivec2 neighbour, uvec4 match) {
  return get_style(neighbour) == source.number + 1 && get_lighting(match) < source.layer_count &&
         is_depth_near(source, p, neighbour) &&
         (!has_flag(source, OBJECTS) || get_object(p) == get_object(neighbour));
}

Tally count_votes(Source source, ivec2 p) {
  Tally tally = Tally(ivec3(0), 0, 0);
  ivec2 first = max(p - source.radius, 0), last = min(p + source.radius, frame_size - 1);
  for (int y = first.y; y <= last.y; y++)
    for (int x = first.x; x <= last.x; x++) {
      ivec2 neighbour = ivec2(x, y);
      uvec4 match = texelFetch(matches, neighbour, 0);
      if (!may_vote(source, p, neighbour, match)) continue;
      ivec2 place = ivec2(match.xy) - to_source(source, neighbour - p);
      if (find_source_texel(source, place).a > 0) add_vote(tally, source, get_lighting(match), place);
    }
  /* A fallback may rest on a masked source pixel; better its colour than a hole. */
  uvec4 own = texelFetch(matches, p, 0);
  if (tally.votes == 0 && all(lessThan(ivec2(own.xy), source.size)) && get_lighting(own) < source.layer_count)
    add_vote(tally, source, get_lighting(own), ivec2(own.xy));
  return tally;
}

/* colour / alpha * factor / (255 * 256), rounded half up; by long division, since the product has more than 32 bits. */
int weigh(int colour, int alpha, int factor) {
  int rest = colour % alpha;
  int high = rest * (factor / 256);
  int low = high % alpha * 256 + rest * (factor % 256);
  int product = colour / alpha * factor + high / alpha * 256 + low / alpha;
  return (product + 255 * 128) / (255 * 256);
}

vec4 resolve_votes(Source source, ivec2 p, Tally tally) {
  if (tally.alpha == 0) return vec4(0.0);
  ivec3 factor = ivec3(255 * 256), base = ivec3(0);
  if (has(HAS_ALBEDO))
    factor = 255 * (256 - source.colour_weight) +
             source.colour_weight * to_bytes(texelFetch(frame_albedo, p * frame_stride, 0)).rgb;
  if (has_flag(source, BASE)) base = get_base(source, choose_lighting(source, p), look_up(source, p));
  ivec3 colour = clamp(tally.colour + base * tally.alpha, 0, 255 * tally.alpha);
  ivec3 mean = ivec3(weigh(colour.r, tally.alpha, factor.r), weigh(colour.g, tally.alpha, factor.g),
                     weigh(colour.b, tally.alpha, factor.b));
  int whole = tally.votes * 255, alpha = (tally.alpha * get_guide(p).a + whole / 2) / whole;
  return vec4(mean, alpha) / 255.0;
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  int style = get_style(p);
  if (style == 0) {
    picture = vec4(0.0);
    return;
  }
  Source source = open_source(style);
  picture = resolve_votes(source, p, count_votes(source, p));
}
