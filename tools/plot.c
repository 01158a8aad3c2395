#include "plot.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include "spawn.h"

/* What is off an axis stands so far inside it. */
static const double edge = 1.1;

/* A logarithmic axis has no zero. */
static const double least_error = STY_LEAST_ERROR;

/* Colours that the colour-blind can tell apart (Okabe, Ito, "Color Universal
 * Design", 2008), by the place in the table of engines, and by map and metric. */
static const char *const engine_colours[] = {"#555555", "#cc79a7", "#0072b2", "#009e73",
                                             "#56b4e9", "#882255", "#d55e00"};
enum { ENGINE_COLOURS = sizeof engine_colours / sizeof *engine_colours };
static const char *const map_colours[2][2] = {{"#e69f00", "#d55e00"}, {"#56b4e9", "#0072b2"}};

/* gnuplot's point types, filled ones. */
enum { SQUARE = 5, CIRCLE = 7, TRIANGLE = 9, DIAMOND = 13 };
static const int parameter_marks[] = {CIRCLE, TRIANGLE, SQUARE, DIAMOND};
enum { PARAMETER_MARKS = sizeof parameter_marks / sizeof *parameter_marks };
static const struct {
  StyEncoding encoding;
  const char *name;
  int mark, dash;
} encodings[] = {{STY_ENCODE_RG8, "rg8", SQUARE, 3},
                 {STY_ENCODE_RG16, "rg16, rg8x2", CIRCLE, 1}, /* the same 16 bits, so the same points */
                 {STY_ENCODE_F32, "f32", TRIANGLE, 2}};
enum { ENCODINGS = sizeof encodings / sizeof *encodings };

/* ---- the child -------------------------------------------------------------------- */

/* Runs gnuplot without anybody's settings; its files are `in`, `out` and `said`.
 * Its exit status, or -1 where it ended otherwise. */
static StyStatus run_gnuplot(const char *const *arguments, FILE *in, FILE *out, FILE *said, int *ended,
                             StyError *error) {
  pid_t child;
  int state;
  const int cause = spawn_program(arguments, fileno(in), fileno(out), fileno(said), &child);
  if (cause)
    return sty_fail(
        error, STY_ERROR_UNAVAILABLE,
        "gnuplot: cannot run it: %s; expected the program in PATH (package gnuplot-nox); --csv goes without",
        strerror(cause));
  while (waitpid(child, &state, 0) < 0)
    if (errno != EINTR) return sty_fail(error, STY_ERROR_LIBRARY, "gnuplot: lost it: %s", strerror(errno));
  *ended = WIFEXITED(state) ? WEXITSTATUS(state) : -1;
  return STY_OK;
}

StyStatus find_gnuplot(StyError *error) {
  const char *const arguments[] = {"gnuplot", "--version", NULL};
  FILE *nothing = fopen("/dev/null", "r+");
  int ended = 0;
  if (!nothing) return sty_fail(error, STY_ERROR_LIBRARY, "/dev/null: cannot open: %s", strerror(errno));
  StyStatus status = run_gnuplot(arguments, nothing, nothing, nothing, &ended, error);
  fclose(nothing);
  if (!status && ended != 0)
    status = sty_fail(error, STY_ERROR_UNAVAILABLE, "gnuplot: found exit status %d of 'gnuplot --version', expected 0",
                      ended);
  return status;
}

/* The last line that isn't blank: there gnuplot says what is wrong. */
static void read_complaint(FILE *said, char complaint[256]) {
  char line[256];
  *complaint = 0;
  rewind(said);
  while (fgets(line, sizeof line, said)) {
    const char *text = line + strspn(line, " \t\n");
    if (*text) snprintf(complaint, 256, "%.*s", (int)strcspn(text, "\n"), text);
  }
}

static StyStatus run_script(FILE *script, FILE *picture, FILE *said, StyError *error) {
  const char *const arguments[] = {"gnuplot", "--default-settings", NULL};
  struct stat info;
  int ended = 0;
  if (fflush(script) != 0 || fflush(picture) != 0)
    return sty_fail(error, STY_ERROR_FILE, "temporary file: cannot write: %s; expected room for the chart",
                    strerror(errno));
  rewind(script);
  const StyStatus status = run_gnuplot(arguments, script, picture, said, &ended, error);
  if (status) return status;
  if (ended == 0 && fstat(fileno(picture), &info) == 0 && info.st_size > 0) return STY_OK;
  char complaint[256];
  read_complaint(said, complaint);
  return sty_fail(error, STY_ERROR_LIBRARY, "gnuplot: found exit status %d%s%s, expected a chart", ended,
                  *complaint ? " and: " : "", complaint);
}

/* ---- the script: words -------------------------------------------------------------- */

/* A gnuplot string: nothing in single quotes means anything but the quote itself. */
static void write_string(FILE *script, const char *text) {
  fputc('\'', script);
  for (const char *c = text; *c; c++) {
    if (*c == '\'') fputc('\'', script);
    fputc((unsigned char)*c < 0x20 || *c == 0x7f ? '?' : *c, script);
  }
  fputc('\'', script);
}

/* ---- the script: a panel ------------------------------------------------------------ */

typedef struct Range {
  double low, high;
} Range;

typedef struct Panel {
  FILE *script;
  const Plot *plot;
  const StyChart *chart;
  StyChartPanel kind;
  Range x, y; /* of the axes */
} Panel;

static double get_x(const Panel *panel, const StyChartPoint *point) {
  return panel->kind == STY_PANEL_TIME ? fmax(point->milliseconds, 1e-3) : (double)point->bytes;
}

static double get_error(const StyChartPoint *point) { return fmax(point->lookup.p99, least_error); }

/* What is off the axis stands near its end, and its label says how much it is. */
static bool is_off(const Panel *panel, const StyChartPoint *point) { return get_error(point) > panel->y.high; }
static double get_y(const Panel *panel, const StyChartPoint *point) {
  return is_off(panel, point) ? panel->y.high / edge : get_error(point);
}

/* Each place once: rg8x2 stands where rg16 does. */
static bool is_drawn(const Panel *panel, const StyChartPoint *point) {
  return point->places[panel->kind] != STY_PLACE_NONE &&
         (panel->kind == STY_PANEL_TIME || point->encoding != STY_ENCODE_RG8X2);
}

/* Points that a line joins. */
static bool are_joined(const StyChartPoint *a, const StyChartPoint *b) {
  return a->engine == b->engine && a->parameters.trees == b->parameters.trees &&
         a->parameters.checks == b->parameters.checks && a->spec.map == b->spec.map &&
         a->spec.metric == b->spec.metric && a->encoding == b->encoding;
}

static void extend_range(Range *range, double value) {
  range->low = fmin(range->low, value);
  range->high = fmax(range->high, value);
}

/* With room for marks and labels. Errors are those of both panels, so that they can be compared, but only of
 * tables that lost nothing to their encoding: a bad one would leave no room for all others. */
static void find_ranges(Panel *panel) {
  panel->x = panel->y = (Range){INFINITY, 0};
  for (int p = 0; p < panel->chart->count; p++) {
    const StyChartPoint *point = &panel->chart->points[p];
    if (point->encoding == STY_ENCODE_F32) extend_range(&panel->y, get_error(point));
    if (is_drawn(panel, point)) extend_range(&panel->x, get_x(panel, point));
  }
  panel->x = (Range){panel->x.low / 3, panel->x.high * 1.7};
  panel->y = (Range){panel->y.low / 1.25, panel->y.high * 1.35};
}

/* As many digits of each decade as there is room for. */
static void write_tics(FILE *script, char axis, Range range) {
  const double span = range.high / range.low;
  const char *digits = span > 1e3 ? "1" : span > 10 ? "125" : "123456789", *separator = "";
  fprintf(script, "set %crange [%.9g:%.9g]\nset %ctics (", axis, range.low, range.high, axis);
  for (int decade = (int)floor(log10(range.low)); decade <= (int)ceil(log10(range.high)); decade++)
    for (const char *digit = digits; *digit; digit++) {
      const double at = (*digit - '0') * pow(10, decade);
      if (at < range.low || at > range.high) continue;
      fprintf(script, "%s'%g' %.9g", separator, at, at);
      separator = ", ";
    }
  fprintf(script, ")\n");
}

static void write_byte_tics(FILE *script, Range range) {
  static const char *const units[] = {"B", "KiB", "MiB", "GiB"};
  const char *separator = "";
  fprintf(script, "set xrange [%.9g:%.9g]\nset xtics (", range.low, range.high);
  for (int power = 0; power < 40; power += 2) {
    const double at = ldexp(1, power);
    if (at < range.low || at > range.high) continue;
    fprintf(script, "%s'%d %s' %.9g", separator, 1 << power % 10, units[power / 10], at);
    separator = ", ";
  }
  fprintf(script, ")\n");
}

/* ---- the script: series ------------------------------------------------------------- */

static const char *get_colour(const Panel *panel, const StyChartPoint *point) {
  if (panel->kind == STY_PANEL_TIME) return engine_colours[(point->engine - sty_engines) % ENGINE_COLOURS];
  return map_colours[point->spec.map][point->spec.metric];
}

/* `nth` of its engine's series. */
static void write_style(const Panel *panel, const StyChartPoint *point, int nth) {
  int mark = parameter_marks[nth % PARAMETER_MARKS], dash = 1;
  for (int e = 0; panel->kind == STY_PANEL_BYTES && e < ENCODINGS; e++)
    if (encodings[e].encoding == point->encoding) {
      mark = encodings[e].mark;
      dash = encodings[e].dash;
    }
  fprintf(panel->script, "with linespoints lc rgb '%s' lw 1.3 dt %d pt %d ps 0.8", get_colour(panel, point), dash,
          mark);
}

/* A line with its marks; in the panel of bytes the key is one of colours and marks. */
static void write_series(const Panel *panel, const StyChartPoint *point, int nth) {
  char parameters[STY_PARAMETERS_SIZE];
  fprintf(panel->script, ", \\\n  '-' using 1:2 ");
  write_style(panel, point, nth);
  if (panel->kind == STY_PANEL_BYTES)
    fprintf(panel->script, " notitle");
  else
    fprintf(panel->script, " title '%s %s'", point->engine->name,
            sty_format_parameters(point->engine, &point->parameters, parameters));
}

static void write_all_series(const Panel *panel) {
  const StyChartPoint *before = NULL;
  int nth = 0;
  for (int p = 0; p < panel->chart->count; p++) {
    const StyChartPoint *point = &panel->chart->points[p];
    if (!is_drawn(panel, point) || (before && are_joined(before, point))) continue;
    nth = before && before->engine == point->engine ? nth + 1 : 0;
    write_series(panel, point, nth);
    before = point;
  }
}

/* "x y label" */
static void write_point(const Panel *panel, const StyChartPoint *point) {
  fprintf(panel->script, "%.9g %.9g ", get_x(panel, point), get_y(panel, point));
  if (is_off(panel, point))
    fprintf(panel->script, "\"%d: %.3g\302\260\"\n", point->spec.width, get_error(point));
  else
    fprintf(panel->script, "%d\n", point->spec.width);
}

/* What the '-' of all series stand for, in the same order. */
static void write_series_data(const Panel *panel) {
  const StyChartPoint *before = NULL;
  for (int p = 0; p < panel->chart->count; p++) {
    const StyChartPoint *point = &panel->chart->points[p];
    if (!is_drawn(panel, point)) continue;
    if (before && !are_joined(before, point)) fprintf(panel->script, "e\n");
    write_point(panel, point);
    before = point;
  }
  fprintf(panel->script, "e\n");
}

/* ---- the script: front and labels ----------------------------------------------------- */

static bool is_on_front(const Panel *panel, const StyChartPoint *point) {
  return is_drawn(panel, point) && point->places[panel->kind] == STY_PLACE_FRONT;
}

/* Of one size, and so near each other that one label does for both. */
static bool share_label(const Panel *panel, const StyChartPoint *a, const StyChartPoint *b) {
  const double dx = log(get_x(panel, a) / get_x(panel, b)) / log(panel->x.high / panel->x.low);
  const double dy = log(get_y(panel, a) / get_y(panel, b)) / log(panel->y.high / panel->y.low);
  return a->spec.width == b->spec.width && fabs(dx) < 0.06 && fabs(dy) < 0.03;
}

/* Of several that share a label the first on the front has it, or else the first. */
static bool has_label(const Panel *panel, int p) {
  const StyChartPoint *points = panel->chart->points;
  const bool front = is_on_front(panel, &points[p]);
  for (int k = 0; k < panel->chart->count; k++) {
    const bool other = is_on_front(panel, &points[k]);
    if (is_drawn(panel, &points[k]) && (other > front || (other == front && k < p)) &&
        share_label(panel, &points[k], &points[p]))
      return false;
  }
  return is_drawn(panel, &points[p]);
}

/* A block of the points that are on the front, or not, with a label or all. */
static void write_block(const Panel *panel, const char *name, bool front, bool labels) {
  fprintf(panel->script, "$%s << EOD\n", name);
  for (int p = 0; p < panel->chart->count; p++)
    if (is_on_front(panel, &panel->chart->points[p]) == front && (!labels || has_label(panel, p)))
      write_point(panel, &panel->chart->points[p]);
  fprintf(panel->script, "EOD\n");
}

/* ---- the script: the whole -------------------------------------------------------------- */

/* What colours and marks of the panel of bytes mean. */
static void write_byte_key(FILE *script) {
  for (int e = 0; e < ENCODINGS; e++)
    fprintf(script, ", \\\n  NaN with linespoints lc rgb '#444444' dt %d pt %d ps 0.8 title '%s'", encodings[e].dash,
            encodings[e].mark, encodings[e].name);
  for (int map = 0; map < 2; map++)
    for (int metric = 0; metric < 2; metric++)
      fprintf(script, ", \\\n  NaN with lines lw 4 lc rgb '%s' title 'map %s, metric %s'", map_colours[map][metric],
              sty_map_names[map], sty_metric_names[metric]);
}

static void write_axes(const Panel *panel) {
  const int threads = panel->plot->threads;
  if (panel->kind == STY_PANEL_TIME) {
    fprintf(panel->script,
            "set title 'Time against error: engines'\nset xlabel 'time to build, ms, %d thread%s (left is faster)'\n",
            threads, threads == 1 ? "" : "s");
    write_tics(panel->script, 'x', panel->x);
  } else {
    fprintf(panel->script,
            "set title 'Bytes against error: maps, metrics, encodings'\n"
            "set xlabel 'size of the texture (left is smaller)'\n");
    write_byte_tics(panel->script, panel->x);
  }
  write_tics(panel->script, 'y', panel->y);
}

static void write_panel(FILE *script, const Plot *plot, StyChartPanel kind) {
  Panel panel = {.script = script, .plot = plot, .chart = plot->chart, .kind = kind};
  const double left = kind == STY_PANEL_TIME ? 0.06 : 0.56;
  find_ranges(&panel);
  write_axes(&panel);
  write_block(&panel, "front", true, false);
  write_block(&panel, "labels", true, true);
  write_block(&panel, "small_labels", false, true);
  fprintf(script, "set lmargin at screen %g\nset rmargin at screen %g\nset key at screen %g, 0.015\n", left,
          left + 0.425, left);
  fprintf(script, "plot $front using 1:2 smooth unique with lines lw 9 lc rgb '#dddddd' title 'Pareto front'");
  write_all_series(&panel);
  fprintf(script,
          ", \\\n  $front using 1:2 with points pt 6 ps 1.9 lw 1.6 lc rgb '#000000' notitle"
          ", \\\n  $small_labels using 1:2:3 with labels offset 0.6,0.6 left font ',%d' textcolor rgb '#888888' "
          "notitle, \\\n  $labels using 1:2:3 with labels offset -0.8,-0.8 right font ',%d' notitle",
          plot->format == PLOT_SVG ? 10 : 8, plot->format == PLOT_SVG ? 14 : 11);
  if (kind == STY_PANEL_BYTES) write_byte_key(script);
  fprintf(script, "\n");
  write_series_data(&panel);
}

static void write_script(FILE *script, const Plot *plot) {
  fprintf(script, "set encoding utf8\nset terminal %s noenhanced background rgb '#ffffff'\n",
          plot->format == PLOT_SVG ? "svg size 1160,600 font 'sans-serif,12'"
                                   : "pngcairo size 1160,600 font 'DejaVu Sans,9'");
  fprintf(script, "set multiplot title ");
  write_string(script, plot->title);
  fprintf(script,
          "\nset logscale xy\nset grid lc rgb '#eeeeee' lt 1\nset border lc rgb '#666666'\nset tics nomirror\n"
          "set size 1, 1\nset tmargin at screen 0.89\nset bmargin at screen 0.28\n"
          "set key left bottom Left reverse maxrows 5 samplen 2.5\nset ylabel 'lookup error, p99, degrees (lower is "
          "better)'\n");
  for (int panel = 0; panel < STY_PANELS; panel++) write_panel(script, plot, (StyChartPanel)panel);
  fprintf(script, "unset multiplot\n");
}

/* ---- what the file says of its making ---------------------------------------------------- */

/* Behind the picture, where XML allows instructions. */
static void append_svg_text(FILE *picture, const char *text) {
  fseek(picture, 0, SEEK_END);
  fputs("<?stylut ", picture);
  for (const char *c = text; *c; c++) fputc(c[0] == '?' && c[1] == '>' ? '_' : *c, picture);
  fputs("?>\n", picture);
}

static void put_big_endian(unsigned char out[4], uint32_t number) {
  for (int b = 0; b < 4; b++) out[b] = (unsigned char)(number >> (24 - 8 * b));
}

/* A text chunk behind the first one, which is of 25 bytes after a mark of 8 (PNG
 * specification, 4.2.3). False: no memory. */
static bool insert_png_text(FILE *picture, const char *text) {
  enum { HEAD = 8 + 25 };
  static const char key[] = "tEXtstylut:command";
  const size_t size = sizeof key + strlen(text); /* with the zero that ends the keyword */
  fseek(picture, 0, SEEK_END);
  const long end = ftell(picture), rest = end - HEAD;
  if (rest < 0) return true; /* no picture at all: not for here to say */
  unsigned char *chunk = malloc(4 + size + 4 + (size_t)rest);
  if (!chunk) return false;
  put_big_endian(chunk, (uint32_t)size - 4);
  memcpy(chunk + 4, key, sizeof key);
  memcpy(chunk + 4 + sizeof key, text, size - sizeof key);
  put_big_endian(chunk + 4 + size, (uint32_t)crc32(0, chunk + 4, (uInt)size));
  fseek(picture, HEAD, SEEK_SET);
  const size_t there = fread(chunk + 4 + size + 4, 1, (size_t)rest, picture);
  fseek(picture, HEAD, SEEK_SET);
  fwrite(chunk, 1, 4 + size + 4 + there, picture);
  free(chunk);
  return true;
}

StyStatus draw_plot(const Plot *plot, FILE *picture, StyError *error) {
  FILE *script = tmpfile(), *said = tmpfile();
  StyStatus status = STY_OK;
  if (!script || !said)
    status =
        sty_fail(error, STY_ERROR_FILE, "temporary file: cannot create: %s; expected a folder for it", strerror(errno));
  if (!status) write_script(script, plot);
  if (!status) status = run_script(script, picture, said, error);
  if (!status && plot->making && plot->format == PLOT_SVG) append_svg_text(picture, plot->making);
  if (!status && plot->making && plot->format == PLOT_PNG && !insert_png_text(picture, plot->making))
    status = sty_fail_memory(error, "chart", (double)strlen(plot->making));
  if (script) fclose(script);
  if (said) fclose(said);
  return status;
}
