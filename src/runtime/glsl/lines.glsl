/* How much of each pixel is line; twin of sty_draw_lines in outline.c. Target: R8. */
uniform isampler2D columns;                  /* R8I */
uniform int line_width, line_wobble_amount;  /* 256ths of a pixel; amount 0: there is no wobble */
uniform sampler2D line_wobble;               /* RG8 */
layout(location = 0) out float line;

const int NO_CONTOUR = 127;

/* The square of the distance to the nearest contour of a column, at most `least`. */
int square_distance(ivec2 aim, ivec2 rest, int i, int least) {
  ivec2 place = aim + ivec2(i, 0);
  int column = contains_pixel(place) ? texelFetch(columns, place, 0).r : NO_CONTOUR;
  ivec2 way = 256 * ivec2(i, column) - rest;
  return column == NO_CONTOUR ? least : min(way.x * way.x + way.y * way.y, least);
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy), way = ivec2(0);
  if (line_wobble_amount > 0) way = (line_wobble_amount * (get_texel(line_wobble, p).xy - 128)) >> 7;
  ivec2 whole = (way + 128) >> 8, aim = clamp(p + whole, ivec2(0), frame_size - 1);
  int reach = (line_width + 767) / 512 + 1, most = (line_width + 256) / 2, least = (most + 1) * (most + 1);
  for (int i = -reach; i <= reach; i++) least = square_distance(aim, way - 256 * whole, i, least);
  int coverage = max(0, min(min(256, line_width), most - find_root(least)));
  line = float((coverage * 255 + 128) / 256) / 255.0;
}
