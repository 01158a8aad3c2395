#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "guide/foreign.h"

const StyFieldInfo sty_fields[STY_FIELDS] = {
    [STY_FIELD_NORMAL] = {3, {"XYZ", "RGB"}, {"normal.X", "normal.Y", "normal.Z"}},
    [STY_FIELD_DEPTH] = {1, {NULL}, {"depth.Z"}},
    [STY_FIELD_DISTANCE] = {1, {NULL}, {"depth.Z"}},
    [STY_FIELD_POSITION] = {3, {"XYZ", "RGB"}, {"position.X", "position.Y", "position.Z"}},
    [STY_FIELD_UV] = {2, {"UV", "XY", "RG"}, {"uv.U", "uv.V"}},
    [STY_FIELD_ALBEDO] = {3, {"RGB"}, {"albedo.R", "albedo.G", "albedo.B"}},
    [STY_FIELD_PICTURE] = {3, {"RGB"}, {"luma.Y"}},
    [STY_FIELD_OBJECT] = {1, {NULL}, {"object.I"}},
    [STY_FIELD_STYLE] = {1, {NULL}, {"style.I"}},
    [STY_FIELD_MOTION] = {2, {"XY", "UV", "RG"}, {"motion.U", "motion.V"}},
    [STY_FIELD_ALPHA] = {1, {"A"}, {"A"}},
};

const StyProgram sty_programs[STY_PROGRAMS] = {
    {
        .name = "blender",
        .places = {[STY_FIELD_NORMAL] = {"Normal"},
                   [STY_FIELD_DEPTH] = {"Depth"},
                   [STY_FIELD_POSITION] = {"Position"},
                   [STY_FIELD_UV] = {"UV"},
                   [STY_FIELD_ALBEDO] = {"DiffCol", "Denoising Albedo"},
                   [STY_FIELD_PICTURE] = {"Combined"},
                   [STY_FIELD_OBJECT] = {"IndexOB"},
                   [STY_FIELD_STYLE] = {"IndexMA"},
                   [STY_FIELD_MOTION] = {"Vector"},
                   [STY_FIELD_ALPHA] = {"Combined"}},
        .mark = "Normal",
        .space = STY_SPACE_WORLD,
        .fixed_world = true,
        .toward_viewer = 1,
    },
    {
        .name = "arnold",
        .places = {[STY_FIELD_NORMAL] = {"N"},
                   [STY_FIELD_DEPTH] = {"Z"},
                   [STY_FIELD_POSITION] = {"P"},
                   [STY_FIELD_UV] = {"uv", "UV"},
                   [STY_FIELD_ALBEDO] = {"albedo", "diffuse_albedo"},
                   [STY_FIELD_PICTURE] = {"RGBA", ".RGB"},
                   [STY_FIELD_OBJECT] = {"ID", "id"},
                   [STY_FIELD_ALPHA] = {"RGBA", ".A"}},
        .mark = "Z",
        .space = STY_SPACE_WORLD,
        .fixed_world = true,
        .toward_viewer = 1,
        .is_unsure = true,
    },
    {
        .name = "pbrt",
        .places = {[STY_FIELD_NORMAL] = {"Ns"},
                   [STY_FIELD_POSITION] = {"P"},
                   [STY_FIELD_UV] = {".UV"},
                   [STY_FIELD_ALBEDO] = {"Albedo"},
                   [STY_FIELD_PICTURE] = {".RGB"}},
        .mark = "Ns",
        .space = STY_SPACE_VIEW,
        .toward_viewer = -1,
        .left_handed = true,
    },
    {
        .name = "houdini",
        .places = {[STY_FIELD_NORMAL] = {"N", "hitN"},
                   [STY_FIELD_DEPTH] = {"Pz", "hitPz"},
                   [STY_FIELD_DISTANCE] = {"hitdist"},
                   [STY_FIELD_POSITION] = {"P", "hitP"},
                   [STY_FIELD_UV] = {"uv", "hituv"},
                   [STY_FIELD_ALBEDO] = {"albedo", "basecolor"},
                   [STY_FIELD_PICTURE] = {"C", ".RGB"},
                   [STY_FIELD_OBJECT] = {"objectid"},
                   [STY_FIELD_ALPHA] = {"C", ".A"}},
        .mark = "Pz",
        .space = STY_SPACE_VIEW,
    },
    {
        .name = "unity",
        .places = {[STY_FIELD_NORMAL] = {".RGB"}, [STY_FIELD_ALPHA] = {".A"}},
        .space = STY_SPACE_WORLD,
        .toward_viewer = 1,
        .left_handed = true,
        .is_picture = true,
    },
    {
        .name = "png",
        .space = STY_SPACE_VIEW,
        .toward_viewer = 1,
        .is_picture = true,
    },
};

const char *const sty_guide_programs[] = {"blender", "arnold", "pbrt", "houdini", "unity", "png", NULL};

/* ---- names ---- */

/* "ViewLayer.Normal.X": what stands before the layer, the layer, the component. */
typedef struct Parts {
  const char *name;
  size_t prefix; /* characters, with the dot behind it; 0: none */
  const char *layer;
  size_t layer_length;
  const char *component; /* "" where there is none */
} Parts;

/* Without a dot, all is the layer. */
static Parts split_name(const char *name) {
  const char *last = strrchr(name, '.'), *begin = name;
  const char *end = last ? last : name + strlen(name);
  for (const char *c = name; c < end; c++)
    if (*c == '.') begin = c + 1;
  return (Parts){name, (size_t)(begin - name), begin, (size_t)(end - begin), last ? last + 1 : ""};
}

/* A scalar's layer may be all of the name's end: "Z", "ViewLayer.Z". */
static Parts split_scalar(const char *name) {
  const char *last = strrchr(name, '.');
  const size_t prefix = last ? (size_t)(last - name) + 1 : 0;
  return (Parts){name, prefix, name + prefix, strlen(name) - prefix, ""};
}

static bool is_layer(const Parts *parts, const char *layer) {
  return strlen(layer) == parts->layer_length && memcmp(layer, parts->layer, parts->layer_length) == 0;
}

static bool is_letter(const char *component, char letter) {
  return toupper((unsigned char)component[0]) == letter && !component[1];
}

/* Whether the channel is this component of the layer; *prefix says where it begins. */
static bool is_component(const char *name, const char *layer, char letter, size_t *prefix) {
  Parts parts = split_name(name);
  if (letter) {
    *prefix = parts.prefix;
    if (layer[0] == '.') return !strchr(name, '.') && is_letter(name, letter);
    return is_layer(&parts, layer) && is_letter(parts.component, letter);
  }
  /* "Depth.Z", or "Pz.Pz" of a part that has its channel's name. */
  const bool with_component =
      is_layer(&parts, layer) && (strlen(parts.component) <= 1 || strcmp(parts.component, layer) == 0);
  if (!with_component) parts = split_scalar(name);
  *prefix = parts.prefix;
  return with_component || is_layer(&parts, layer);
}

static bool has_prefix(const char *name, size_t length, const char *wanted, size_t wanted_length) {
  return length == wanted_length && memcmp(name, wanted, length) == 0;
}

/* The component of the layer that has this prefix, or -1. */
static int find_component(const StyImage *image, const char *layer, char letter, const char *prefix, size_t length) {
  for (int c = 0; c < image->channel_count; c++) {
    size_t own;
    if (is_component(image->names[c], layer, letter, &own) && has_prefix(image->names[c], own, prefix, length))
      return c;
  }
  return -1;
}

/* All components, beginning with channel `first`. */
static bool find_all(const StyImage *image, const char *layer, const char *letters, int count, int first,
                     StyPlace *out) {
  size_t prefix;
  const char *name = image->names[first];
  if (!is_component(name, layer, letters ? letters[0] : '\0', &prefix)) return false;
  out->channels[0] = first;
  for (int k = 1; k < count; k++) {
    out->channels[k] = find_component(image, layer, letters[k], name, prefix);
    if (out->channels[k] < 0) return false;
  }
  return true;
}

/* ---- fields ---- */

/* The render layer that all is to be of: that of the normals. NULL: not known yet. */
typedef struct RenderLayer {
  const char *name;
  size_t length;
} RenderLayer;

static bool is_of(const StyImage *image, int channel, const char *layer, char letter, const RenderLayer *wanted) {
  size_t prefix = 0;
  is_component(image->names[channel], layer, letter, &prefix);
  return !wanted->name || prefix == 0 || has_prefix(image->names[channel], prefix, wanted->name, wanted->length);
}

static void find_in_layer(const StyImage *image, const StyFieldInfo *field, const char *layer,
                          const RenderLayer *wanted, StyPlace *out) {
  for (int f = 0; f < 3 && (f == 0 || field->components[f]); f++) {
    const char *letters = layer[0] == '.' ? layer + 1 : field->components[f];
    for (int c = 0; c < image->channel_count; c++) {
      StyPlace place = {{-1, -1, -1}, 0};
      if (!find_all(image, layer, letters, field->count, c, &place)) continue;
      if (!is_of(image, c, layer, letters ? letters[0] : '\0', wanted)) continue;
      if (out->channels[0] < 0)
        *out = place;
      else
        out->others++;
    }
    if (out->channels[0] >= 0 || layer[0] == '.') return;
  }
}

static StyPlace find_field(const StyProgram *program, const StyImage *image, StyField field,
                           const RenderLayer *wanted) {
  StyPlace place = {{-1, -1, -1}, 0};
  for (int p = 0; p < STY_FIELD_PLACES && program->places[field][p] && place.channels[0] < 0; p++)
    find_in_layer(image, &sty_fields[field], program->places[field][p], wanted, &place);
  return place;
}

void sty_find_fields(const StyProgram *program, const StyImage *image, StyPlace out[STY_FIELDS]) {
  RenderLayer layer = {NULL, 0};
  for (int f = 0; f < STY_FIELDS; f++) { /* normals are the first */
    out[f] = find_field(program, image, (StyField)f, &layer);
    if (f > 0 || out[f].channels[0] < 0) continue;
    layer.name = image->names[out[f].channels[0]];
    layer.length = split_name(layer.name).prefix;
  }
}

/* ---- the wrong program ---- */

/* Of no render layer, lest N.Z pass for a Z. */
static const char *find_mark(const StyProgram *program, const StyImage *image) {
  for (int c = 0; program->mark && c < image->channel_count; c++) {
    const Parts parts = split_name(image->names[c]);
    if (is_layer(&parts, program->mark)) return image->names[c];
  }
  return NULL;
}

/* Integers of R, G and B are a picture; layers are whose mark and normals are there. */
const StyProgram *sty_find_shown_program(const StyImage *image) {
  const bool is_picture =
      image->bits < 32 && sty_find_channel(image, "R") && sty_find_channel(image, "G") && sty_find_channel(image, "B");
  StyPlace places[STY_FIELDS];
  for (int p = 0; p < STY_PROGRAMS; p++) {
    const StyProgram *program = &sty_programs[p];
    if (is_picture && program->is_picture && program->space == STY_SPACE_VIEW) return program;
    if (!find_mark(program, image)) continue;
    sty_find_fields(program, image, places);
    if (places[STY_FIELD_NORMAL].channels[0] >= 0) return program;
  }
  return NULL;
}

static void list_channels(const StyImage *image, char *out, size_t size) {
  out[0] = '\0';
  for (int c = 0; c < image->channel_count && strlen(out) < size - STY_MAX_NAME - 2; c++)
    snprintf(out + strlen(out), size - strlen(out), "%s%s", c ? ", " : "", image->names[c]);
}

static StyStatus fail_normals(const char *name, const StyProgram *program, const StyImage *image, StyError *error) {
  const StyProgram *shown = sty_find_shown_program(image);
  const char *place = program->places[STY_FIELD_NORMAL][0];
  char found[384], expected[64] = "R, G and B of 8 or 16 bit", hint[32] = "";
  list_channels(image, found, sizeof found);
  if (place && place[0] != '.') snprintf(expected, sizeof expected, "%s.X, %s.Y and %s.Z", place, place, place);
  if (shown) snprintf(hint, sizeof hint, ", or --as %s", shown->name);
  return sty_fail(error, STY_ERROR_INPUT, "%s: found no normals of %s among %d channel%s (%s), expected %s%s", name,
                  program->name, image->channel_count, image->channel_count == 1 ? "" : "s", found, expected, hint);
}

StyStatus sty_check_program(const char *name, const StyProgram *program, const StyImage *image,
                            const StyPlace places[STY_FIELDS], StyError *error) {
  if (places[STY_FIELD_NORMAL].channels[0] < 0) return fail_normals(name, program, image, error);
  for (int p = 0; p < STY_PROGRAMS && !find_mark(program, image); p++) {
    const char *mark = find_mark(&sty_programs[p], image);
    if (mark)
      return sty_fail(error, STY_ERROR_INPUT,
                      "%s: found channel %s, which is of %s, expected channels of %s, or --as %s", name, mark,
                      sty_programs[p].name, program->name, sty_programs[p].name);
  }
  return STY_OK;
}
