#include "step_due.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "step.h"

enum { MOST_DEPFILE = 1 << 24 };

/* "RECIPE.done"; the caller frees it. */
static char *name_note(const StyDocument *recipe) {
  char *name = NULL;
  return asprintf(&name, "%s.done", recipe->name) < 0 ? NULL : name;
}

static void note_files(json_t *note, const json_t *names) {
  const json_t *name;
  size_t i;
  json_array_foreach(names, i, name)
      json_object_set_new(note, json_string_value(name), identify_file(json_string_value(name)));
}

/* What the step found out that it was made of: words behind the depfile's colon. */
static void note_depfile(json_t *note, const StyDocument *recipe) {
  const char *file = json_string_value(json_object_get(recipe->root, "depfile"));
  unsigned char *text = NULL;
  size_t size = 0;
  if (!file || sty_read_file(file, MOST_DEPFILE, &text, &size, NULL) != STY_OK) return;
  char *rest = strchr((char *)text, ':'), *at = NULL;
  for (char *word = rest ? strtok_r(rest + 1, " \n", &at) : NULL; word; word = strtok_r(NULL, " \n", &at))
    json_object_set_new(note, word, identify_file(word));
  free(text);
}

json_t *note_inputs(const StyDocument *recipe) {
  json_t *note = json_object();
  json_object_set_new(note, "version", identify_file("version"));
  note_files(note, json_object_get(recipe->root, "takes"));
  return note;
}

/* All of them, by the names they have; the recipe by what it says. */
static json_t *complete_note(const StyDocument *recipe, json_t *note) {
  char hash[STY_HASH_SIZE];
  sty_hash_bytes(recipe->text, strlen(recipe->text), hash);
  json_object_set_new(note, "", json_string(hash));
  note_depfile(note, recipe);
  note_files(note, json_object_get(recipe->root, "makes"));
  return note;
}

static bool is_whole(const json_t *note) {
  const char *name;
  json_t *file;
  json_object_foreach((json_t *)(uintptr_t)note, name, file) if (json_is_null(file)) return false;
  return true;
}

bool is_step_due(const StyDocument *recipe) {
  StyDocument known = {NULL, NULL, NULL};
  char *name = name_note(recipe);
  json_t *note = complete_note(recipe, note_inputs(recipe));
  const bool is_done =
      name && sty_read_document(name, &known, NULL) == STY_OK && is_whole(note) && json_equal(known.root, note);
  sty_close_document(&known);
  json_decref(note);
  free(name);
  return !is_done;
}

StyStatus note_done(const StyDocument *recipe, json_t *inputs, StyError *error) {
  char *name = name_note(recipe);
  json_t *note = complete_note(recipe, inputs);
  const StyStatus status = name ? sty_write_json(name, note, error) : sty_fail_memory(error, recipe->name, 0);
  json_decref(note);
  free(name);
  return status;
}
