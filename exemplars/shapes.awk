# More models, as OBJ: torus and bust for exemplars/coherence.sh, round forms that
# show the same direction in many places, and the urn of exemplars/lit, which has
# texture coordinates. Each is a grid of quads bent around the Y axis.
# Usage: awk -v shape=torus|bust|urn -f shapes.awk >FILE.obj

# A ring standing upright.
function set_torus(i, j,   s, t) {
  s = 2 * PI * i / COLUMNS
  t = 2 * PI * j / ROWS
  x = (1 + 0.4 * cos(t)) * cos(s)
  y = (1 + 0.4 * cos(t)) * sin(s)
  z = 0.4 * sin(t)
}

# One of the bust's outlines by height, smoothly through its knots (Catmull-Rom).
function follow(knots, k, f,   a, b, c, d) {
  a = knots[k > 1 ? k - 1 : 1]
  b = knots[k]
  c = knots[k + 1]
  d = knots[k + 2 <= KNOTS ? k + 2 : KNOTS]
  return b + f / 2 * (c - a + f * (2 * a - 5 * b + 4 * c - d + f * (3 * (b - c) + d - a)))
}

# What stands out of (or, below 0, is pressed into) the bust around a place
# (at, y): width and height of the mark, and how far.
function bump(from, at, at_y, wide_by, high_by, far,   u, v) {
  u = (from - at) / wide_by
  v = (y - at_y) / high_by
  return far * exp(-(u * u + v * v))
}

function face(   sum) {
  sum = bump(x, 0, 1.40, 0.09, 0.13, 0.12) + bump(x, 0, 1.31, 0.10, 0.06, 0.08)           # nose: bridge, tip
  sum += bump(x, -0.19, 1.51, 0.16, 0.06, 0.05) + bump(x, 0.19, 1.51, 0.16, 0.06, 0.05)   # brows
  sum += bump(x, -0.19, 1.42, 0.10, 0.06, -0.06) + bump(x, 0.19, 1.42, 0.10, 0.06, -0.06) # eyes
  sum += bump(x, 0, 1.18, 0.13, 0.03, 0.05) + bump(x, 0, 1.11, 0.11, 0.03, 0.05)          # lips
  return sum + bump(x, 0, 0.98, 0.13, 0.09, 0.08)                                         # chin
}

# The knot before row j of an outline.
function find_knot(j,   f) {
  f = (KNOTS - 1) * j / ROWS
  return int(f) < KNOTS - 1 ? int(f) + 1 : KNOTS - 1
}

# Stacked ellipses with face and ears on them.
function set_bust(i, j,   s, k, f, ear) {
  s = 2 * PI * i / COLUMNS
  k = find_knot(j)
  f = (KNOTS - 1) * j / ROWS - (k - 1)
  y = follow(high, k, f)
  x = follow(wide, k, f) * sin(s)
  z = follow(fore, k, f) + follow(deep, k, f) * cos(s)
  ear = bump(z, -0.02, 1.38, 0.09, 0.13, 0.10) * sin(s) * sin(s) * sin(s)
  if (cos(s) > 0) z += face() * cos(s)
  x += ear
}

# Turned on a wheel: outside up to the lip, and down again within.
function set_urn(i, j,   s, k, f, r) {
  s = 2 * PI * i / COLUMNS
  k = find_knot(j)
  f = (KNOTS - 1) * j / ROWS - (k - 1)
  y = follow(high, k, f)
  r = follow(wide, k, f)
  x = r * sin(s)
  z = r * cos(s)
}

# Its picture comes four times around and once along its outline, by length, so that nothing is drawn out.
function print_places(   i, j, along, before_y, before_z, lengths) {
  for (j = 0; j <= ROWS; j++) {
    set_urn(0, j)
    if (j > 0) along += sqrt((y - before_y) ^ 2 + (z - before_z) ^ 2)
    lengths[j] = along
    before_y = y
    before_z = z
  }
  for (j = 0; j <= ROWS; j++)
    for (i = 0; i <= COLUMNS; i++) printf "vt %.4f %.4f\n", 4 * i / COLUMNS, lengths[j] / along
}

function print_quad(i, j,   a, b, at) {
  a = j * COLUMNS + i + 1
  b = j * COLUMNS + (i + 1) % COLUMNS + 1
  if (shape != "urn") {
    print "f", a, b, b + COLUMNS, a + COLUMNS
    return
  }
  at = j * (COLUMNS + 1) + i + 1
  printf "f %d/%d %d/%d %d/%d %d/%d\n", a, at, b, at + 1, b + COLUMNS, at + COLUMNS + 2, a + COLUMNS, at + COLUMNS + 1
}

function set_bust_outline() {
  # From the plinth to the crown: height, half width, half depth, how far forward.
  KNOTS = split("-0.60 -0.58 -0.45 -0.20 0.05 0.24 0.36 0.46 0.60 0.76 0.90 1.05 1.20 1.40 1.60 1.78 1.92 2.00 2.03", high, " ")
  split("0.01 0.45 0.62 0.88 1.02 0.95 0.68 0.40 0.29 0.28 0.33 0.40 0.44 0.47 0.48 0.44 0.32 0.16 0.01", wide, " ")
  split("0.01 0.28 0.36 0.42 0.42 0.38 0.32 0.28 0.26 0.27 0.35 0.43 0.47 0.50 0.53 0.49 0.37 0.19 0.01", deep, " ")
  split("0.00 0.00 0.00 0.02 0.00 -0.03 -0.05 -0.05 -0.03 0.00 0.03 0.05 0.05 0.03 0.01 0.00 0.00 0.00 0.00", fore, " ")
}

function set_urn_outline() {
  KNOTS = split("0 0 0.04 0.09 0.30 0.58 0.80 0.93 1.02 1.13 1.16 1.13 1.02 0.93 0.80 0.58 0.30 0.10 0.10", high, " ")
  split("0.01 0.22 0.25 0.21 0.34 0.44 0.40 0.25 0.20 0.27 0.29 0.25 0.17 0.22 0.37 0.41 0.31 0.18 0.01", wide, " ")
}

BEGIN {
  PI = atan2(0, -1)
  if (shape == "torus") { COLUMNS = 320; ROWS = 160 }
  else if (shape == "bust") { COLUMNS = 240; ROWS = 360; set_bust_outline() }
  else if (shape == "urn") { COLUMNS = 72; ROWS = 54; set_urn_outline() }
  else { print "shapes.awk: found shape '" shape "', expected torus, bust or urn" >"/dev/stderr"; exit 1 }

  for (j = 0; j <= ROWS; j++)
    for (i = 0; i < COLUMNS; i++) {
      if (shape == "torus") set_torus(i, j)
      else if (shape == "bust") set_bust(i, j)
      else set_urn(i, j)
      printf "v %.6f %.6f %.6f\n", x, y, z
    }
  if (shape == "urn") print_places()
  for (j = 0; j < ROWS; j++)
    for (i = 0; i < COLUMNS; i++) print_quad(i, j)
}
