# Pictures that the things of exemplars/lit wear, as plain PPM: an urn's glaze, a floor's tiles.
# Usage: awk -v pattern=glaze|tiles -f patterns.awk >FILE.ppm

# 0 to 1, another for each pair of whole numbers.
function scatter(a, b,   n) {
  n = (a * 7919 + b * 104729 + 12345) % 65521
  n = (n * 30011 + 17) % 65521
  return n * 31 % 65521 / 65521
}

# x and y count from the lower left corner: along the urn's outline y goes up outside to the lip, and down within.
function is_drawn(x, y,   row) {
  if (y < 54 || y > 236) return 1                                  # foot, lip and all within
  if (y >= 96 && y < 124) {                                        # a meander around the belly
    row = int((123 - y) / 4) + 1
    return substr(meander[row], int(x / 4) % 8 + 1, 1) == "#"
  }
  if (y >= 88 && y < 91 || y >= 129 && y < 132) return 1           # its borders
  if (y < 84) return 2 * ((x + 8) % 16 - 8) ^ 2 < (84 - y) ^ 2 / 30        # rays from the foot
  if (y >= 150 && y < 190) return (x % 32 - 16) ^ 2 / 81 + (y - 170) ^ 2 / 289 < 1 # leaves on the shoulder
  return y >= 205 && y < 222 && int(x / 8) % 2 == int((y - 205) / 8.5) % 2 # checks around the neck
}

function put(r, g, b, light) { printf "%d %d %d\n", r * light, g * light, b * light }

function put_glaze(x, y,   light) {
  light = 0.93 + 0.07 * scatter(x, y)
  if (is_drawn(x, HEIGHT - 1 - y)) put(52, 40, 46, light)
  else put(214, 122, 66, light)
}

function put_tile(x, y,   light, column, row) {
  column = int(x / 64)
  row = int(y / 64)
  light = 0.85 + 0.15 * scatter(column, row)
  if (x % 64 < 3 || y % 64 < 3) put(110, 104, 98, 1)
  else if ((column + row) % 2) put(176, 190, 186, light - 0.02 * scatter(x, y))
  else put(238, 230, 214, light - 0.02 * scatter(x, y))
}

BEGIN {
  split("#######. #.....#. #.###.#. #.#...#. #.#####. #....... ########", meander, " ")
  if (pattern == "glaze") { WIDTH = 128; HEIGHT = 512 }
  else if (pattern == "tiles") { WIDTH = 256; HEIGHT = 256 }
  else { print "patterns.awk: found pattern '" pattern "', expected glaze or tiles" >"/dev/stderr"; exit 1 }
  printf "P3\n%d %d\n255\n", WIDTH, HEIGHT
  for (y = 0; y < HEIGHT; y++)
    for (x = 0; x < WIDTH; x++)
      if (pattern == "glaze") put_glaze(x, y)
      else put_tile(x, y)
}
