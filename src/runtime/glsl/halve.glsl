/* Double resolution, last step: the mean of four pixels; twin of sty_halve_picture in resolution.c for 8 bits.
 * Target: RGBA8, not SRGB8_ALPHA8; blending and dithering off. */
uniform sampler2D double_picture; /* RGBA8, twice the target's size */
layout(location = 0) out vec4 picture;

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  ivec3 colour = ivec3(0);
  int alpha = 0;
  for (int i = 0; i < 4; i++) {
    ivec4 texel = to_bytes(texelFetch(double_picture, 2 * p + ivec2(i % 2, i / 2), 0));
    colour += texel.a * texel.rgb;
    alpha += texel.a;
  }
  if (alpha > 0) colour = (colour + alpha / 2) / alpha;
  picture = vec4(colour, (alpha + 2) / 4) / 255.0;
}
