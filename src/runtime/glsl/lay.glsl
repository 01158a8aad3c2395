/* Lines in a colour on a picture; twin of sty_lay_lines in outline.c for 8 bits. Target: RGBA8, not SRGB8_ALPHA8;
 * blending and dithering off. */
uniform sampler2D below;     /* RGBA8: the picture */
uniform sampler2D lines;     /* R8 */
uniform ivec4 lay_colour;    /* bytes */
uniform int lay_beyond;      /* 1: where the picture shows nothing, too */
layout(location = 0) out vec4 picture;

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  const uint whole = 255u * 255u;
  uvec4 under = uvec4(to_bytes(texelFetch(below, p, 0))), colour = uvec4(lay_colour);
  uint line = uint(to_bytes(texelFetch(lines, p, 0)).r) * colour.a;
  uint over = lay_beyond != 0 ? line * 255u : line, rest = (lay_beyond != 0 ? under.a : 1u) * (whole - line);
  uint sum = over + rest;
  uvec3 mixed = sum > 0u ? (colour.rgb * over + under.rgb * rest + sum / 2u) / sum : uvec3(0u);
  picture = vec4(mixed, lay_beyond != 0 ? (sum + whole / 2u) / whole : under.a) / 255.0;
}
