/* stylut guide import FILE --as PROGRAM */
#include <stdio.h>
#include <stdlib.h>

#include "commands.h"
#include "options.h"
#include "stylut/foreign.h"
#include "stylut/guide.h"
#include "stylut/image_io.h"
#include "stylut/parse.h"
#include "stylut/scene_file.h"

typedef struct Arguments {
  Options options;
  const char *file, *camera;
  StyForeignOptions foreign;
  StyStand stand;
  int bits;
  StyImageFormat format;
} Arguments;

enum { KEY_AS = 0x200, KEY_CAMERA, KEY_FLIP_Y, KEY_SPACE, KEY_BITS };

static const struct argp_option options_table[] = {
    {"as", KEY_AS, "PROGRAM", 0, "whose file it is: blender, arnold, pbrt, houdini, unity, or png", 0},
    {"camera", KEY_CAMERA, "FILE.json", 0,
     "the camera that the file was rendered with: a scene file, of which only the camera is read (perspective or "
     "orthographic), in the program's own world",
     0},
    {"space", KEY_SPACE, "view|world", 0,
     "what the normals are relative to, where it isn't what the program does by itself", 0},
    {"flip-y", KEY_FLIP_Y, NULL, 0, "the file's normals have Y down (DirectX)", 0},
    {"bits", KEY_BITS, "8|16", 0, "precision of a PNG (default: the file's own, at most 16)", 0},
    {0},
};

static StyStatus check_arguments(Arguments *arguments) {
  Options *options = &arguments->options;
  const char *const inputs[] = {arguments->file, arguments->camera};
  StyStatus status = require_argument(options, arguments->file, "the file to import");
  if (!status && !is_given(options, "as"))
    status = sty_fail(&options->error, STY_ERROR_USAGE,
                      "option '--as': found none, expected blender, arnold, pbrt, houdini, unity or png");
  if (!status) status = require_output(options);
  if (!status) status = protect_inputs(options, options->output, inputs, 2);
  if (!status) status = sty_get_image_format(options->output, &arguments->format, &options->error);
  const OptionNeed needs[] = {{"bits", arguments->format == STY_IMAGE_PNG, "an output that ends in .png"}};
  return status ? status : check_needs(options, needs, 1);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  static const char *const spaces[] = {"view", "world", NULL};
  Arguments *arguments = state->input;
  StyError *error = &arguments->options.error;
  StyStatus status = STY_OK;
  int choice = 0;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_argument(&arguments->options, &arguments->file, text); break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case KEY_AS: status = sty_parse_choice("--as", text, sty_guide_programs, &arguments->foreign.program, error); break;
    case KEY_CAMERA: arguments->camera = text; break;
    case KEY_FLIP_Y: arguments->foreign.flip_y = true; break;
    case KEY_SPACE:
      status = sty_parse_choice("--space", text, spaces, &choice, error);
      arguments->foreign.space = choice ? STY_SPACE_WORLD : STY_SPACE_VIEW;
      break;
    case KEY_BITS: status = parse_bits(&arguments->options, text, &arguments->bits); break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

static const struct argp_child children[] = {{&output_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "FILE",
    .doc =
        "Turns another program's render passes into a guide, and says what it assumed.\v"
        "blender: multi-layer EXR; Normal, Position (world), Depth, UV, Vector, IndexOB, IndexMA (the style), DiffCol, "
        "Combined. arnold: N, P (world), Z, albedo, id. pbrt: the gbuffer film's Ns, P, u, v, Albedo (its camera "
        "space). houdini: N, P (camera space), Pz or hitdist, uv. unity: n/2+1/2 in R, G, B (world). png: n/2+1/2 in "
        "R, G, B, Y up.\n\n"
        "World-space normals want --camera, as do distances along the ray and positions of camera space, which are "
        "else "
        "left out; --space tells where a file differs. A camera is a JSON file {\"schema\": \"stylut-scene/1\", "
        "\"camera\": {\"type\": \"perspective\", \"position\": [x, y, z], \"target\": [x, y, z], \"up\": [0, 0, 1], "
        "\"fov\": DEGREES}}, in the axes of the program (Z is up in Blender; Unity and pbrt are left-handed), its fov "
        "vertical. Render without anti-aliasing. Channels without a place in a guide are listed. FILE.exr holds all "
        "that was taken, FILE.png the normals.",
    .children = children,
};

/* ---- the work ---- */

static StyStatus read_file(Arguments *arguments, StyNotes *notes, StyImage **guide) {
  StyError *error = &arguments->options.error;
  StyStatus status = arguments->camera ? sty_read_stand(arguments->camera, &arguments->stand, error) : STY_OK;
  if (arguments->camera) arguments->foreign.camera = &arguments->stand;
  if (!status) status = sty_read_image(arguments->file, guide, error);
  if (!status) status = sty_import_foreign(arguments->file, &arguments->foreign, guide, notes, error);
  return status;
}

static StyStatus write_guide(Arguments *arguments, StyImage *guide) {
  Options *options = &arguments->options;
  const char *const inputs[] = {arguments->file, arguments->camera};
  const int own = guide->bits == 8 ? 8 : 16;
  StyImage *encoded = NULL;
  StyStatus status = STY_OK;
  if (arguments->format == STY_IMAGE_PNG)
    status = sty_encode_normals(guide, arguments->bits ? arguments->bits : own, &encoded, &options->error);
  StyImage *image = encoded ? encoded : guide;
  if (!status) status = add_history(options, "guide import", image, inputs, arguments->camera ? 2 : 1, &options->error);
  if (!status) status = sty_write_image(options->output, image, &options->error);
  sty_destroy_image(&encoded);
  return status;
}

static size_t count_covered(const StyImage *guide) {
  const float *coverage = sty_find_channel(guide, "A");
  size_t covered = 0;
  for (size_t i = 0; i < sty_count_pixels(guide); i++) covered += coverage[i] > 0;
  return covered;
}

static json_t *pack_notes(const StyNotes *notes, StyNoteKind kind) {
  json_t *list = json_array();
  for (int n = 0; n < notes->count; n++)
    if (notes->list[n].kind == kind) json_array_append_new(list, make_json_text(notes->list[n].text));
  return list;
}

/* One line each; what is left out in one. */
static void print_notes(const StyNotes *notes) {
  static const char *const heads[] = {[STY_NOTE_TAKEN] = "taken  ", [STY_NOTE_ASSUMED] = "assumed"};
  int left_out = 0;
  for (int n = 0; n < notes->count; n++)
    if (notes->list[n].kind == STY_NOTE_TAKEN || notes->list[n].kind == STY_NOTE_ASSUMED)
      printf("%s  %s\n", heads[notes->list[n].kind], notes->list[n].text);
  for (int n = 0; n < notes->count; n++)
    if (notes->list[n].kind == STY_NOTE_LEFT_OUT) printf("%s%s", left_out++ ? ", " : "left out ", notes->list[n].text);
  if (left_out) putchar('\n');
}

static StyStatus print_report(Arguments *arguments, const StyNotes *notes, const StyImage *guide) {
  const Options *options = &arguments->options;
  const size_t covered = count_covered(guide);
  const char *program = sty_guide_programs[arguments->foreign.program];
  for (int n = 0; n < notes->count; n++)
    if (notes->list[n].kind == STY_NOTE_WARNING)
      warn(options, "%s: %s", clean_text(arguments->file), notes->list[n].text);
  if (!covered)
    warn(options, "%s: found no covered pixel, expected normals and, where there is one, an alpha above 0",
         clean_text(arguments->file));
  if (options->dry_run)
    return report_dry_run(&arguments->options, "%dx%d pixels, %d channels, from %s", guide->width, guide->height,
                          guide->channel_count, program);
  if (options->json)
    return print_json(
        json_pack("{s:s, s:s, s:[ii], s:I, s:o, s:o, s:o, s:o}", "schema", "stylut-import/1", "as", program, "size",
                  guide->width, guide->height, "covered", (json_int_t)covered, "taken",
                  pack_notes(notes, STY_NOTE_TAKEN), "assumed", pack_notes(notes, STY_NOTE_ASSUMED), "warnings",
                  pack_notes(notes, STY_NOTE_WARNING), "left_out", pack_notes(notes, STY_NOTE_LEFT_OUT)),
        &arguments->options.error);
  if (options->quiet) return STY_OK;
  printf("%s: %dx%d, %.1f %% covered, from %s\n", clean_text(options->output), guide->width, guide->height,
         100.0 * (double)covered / (double)sty_count_pixels(guide), program);
  print_notes(notes);
  return STY_OK;
}

static StyStatus run(Arguments *arguments) {
  StyImage *guide = NULL;
  StyNotes *notes = calloc(1, sizeof *notes);
  if (!notes) return sty_fail_memory(&arguments->options.error, "notes", sizeof *notes);
  StyStatus status = read_file(arguments, notes, &guide);
  if (!status && !arguments->options.dry_run) status = write_guide(arguments, guide);
  if (!status) status = print_report(arguments, notes, guide);
  sty_destroy_image(&guide);
  free(notes);
  return status;
}

StyStatus run_guide_import(int argc, char **argv) {
  Arguments arguments = {.format = STY_IMAGE_EXR};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
