/* Which pixels are contours; twin of sty_find_contours in outline.c. Target: R8. */
uniform int outline_silhouette_weight, outline_object_weight, outline_normal_weight, outline_depth_weight;
uniform int outline_normal_tolerance, outline_noise_weight, outline_threshold; /* noise weight 0: there is no noise */
uniform float outline_depth_tolerance;
uniform sampler2D outline_noise; /* R8 */
layout(location = 0) out float contour;

const int MAX_GAP_GRADE = 8;
const int MAX_DEPTH = 0x7149F2CA; /* the bits of 1e30; those of larger numbers and of NaN are more */

bool is_covered(ivec2 p) { return get_guide(p).a > 0; }

/* The number itself, by way of bits that a compiler cannot know: it is rounded here, whatever could be fused or put in
 * another order. frame_stride is 1 or 2. */
float pin(float value) { return intBitsToFloat(floatBitsToInt(value) | (frame_stride & 4)); }

float subtract(float a, float b) { return pin(a - b); }

/* Whether a place has a depth, and which. */
bool find_depth(ivec2 p, out float depth) {
  depth = 0.0;
  if (!has(HAS_DEPTH) || !contains_pixel(p)) return false;
  depth = texelFetch(frame_depth, p * frame_stride, 0).r;
  return is_covered(p) && (floatBitsToInt(depth) & 0x7FFFFFFF) <= MAX_DEPTH;
}

/* By how much the neighbour lies behind what the surfaces' slopes let expect; 0 or less where nothing is to be said. */
float find_gap(ivec2 p, ivec2 direction) {
  float here, next, before, beyond;
  if (!find_depth(p, here) || !find_depth(p + direction, next)) return 0.0;
  bool has_before = find_depth(p - direction, before), has_beyond = find_depth(p + 2 * direction, beyond);
  if (!has_before && !has_beyond) return 0.0;
  float slope = abs(has_before ? subtract(here, before) : subtract(beyond, next));
  if (has_beyond) slope = min(slope, abs(subtract(beyond, next)));
  slope = pin(3.0 * slope);
  if (has_before) slope = max(slope, subtract(here, before));
  return subtract(subtract(next, here), slope);
}

int grade_gap(ivec2 p, ivec2 direction) {
  float gap = find_gap(p, direction), limit = outline_depth_tolerance;
  int grade = 0;
  for (; grade < MAX_GAP_GRADE && gap > limit; grade++) limit *= 2.0;
  return grade;
}

/* Which of two covered neighbours has the line between them. */
bool owns_border(ivec2 p, ivec2 direction) {
  if (find_gap(p, direction) > outline_depth_tolerance) return true;
  if (find_gap(p + direction, -direction) > outline_depth_tolerance) return false;
  int own = get_object(p), other = get_object(p + direction);
  return own != other ? own > other : direction.x + direction.y > 0;
}

int weigh_border(ivec2 p, ivec2 direction) {
  ivec2 neighbour = p + direction;
  if (!contains_pixel(neighbour)) return 0;
  if (!is_covered(neighbour)) return outline_silhouette_weight;
  if (!owns_border(p, direction)) return 0;
  int bend = sum_differences(get_guide(p), get_guide(neighbour)) - outline_normal_tolerance;
  return (get_object(p) != get_object(neighbour) ? outline_object_weight : 0) + outline_normal_weight * max(bend, 0);
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  int border = 0, grade = 0, noise = 0;
  contour = 0.0;
  if (!is_covered(p)) return;
  for (int d = 0; d < 4; d++) {
    ivec2 direction = (d < 2 ? ivec2(1, 0) : ivec2(0, 1)) * (d % 2 == 0 ? -1 : 1);
    border = max(border, weigh_border(p, direction));
    if (outline_depth_weight > 0) grade = max(grade, grade_gap(p, direction));
  }
  if (outline_noise_weight > 0) noise = outline_noise_weight * get_texel(outline_noise, p).r;
  /* 256 * strength - noise > 256 * threshold, in 32 bits. */
  contour = outline_depth_weight * grade + border - outline_threshold > noise / 256 ? 1.0 : 0.0;
}
