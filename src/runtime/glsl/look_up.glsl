/* The lit sphere: LUT(guide at p) for every pixel; twin of look_up.c. Target: RGBA16UI, see make_match. */
layout(location = 0) out uvec4 match;

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  int style = get_style(p);
  match = style == 0 ? get_no_match() : fall_back(open_source(style), p);
}
