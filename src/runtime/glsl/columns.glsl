/* Rows to the nearest contour of each pixel's column; twin of sty_measure_columns in outline.c. Target: R8I. */
uniform sampler2D contours; /* R8 */
uniform int line_width;     /* 256ths of a pixel */
layout(location = 0) out int column;

const int NO_CONTOUR = 127;

bool is_contour(ivec2 p) { return contains_pixel(p) && texelFetch(contours, p, 0).r > 0.5; }

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  int reach = (line_width + 767) / 512 + 1;
  column = NO_CONTOUR;
  for (int i = 0; i <= reach && column == NO_CONTOUR; i++) {
    if (is_contour(p + ivec2(0, i))) column = i;
    if (is_contour(p - ivec2(0, i))) column = -i;
  }
}
