/* What commands say about meshes: how they were found, repaired and simplified. */
#ifndef STYLUT_TOOLS_MESHES_H
#define STYLUT_TOOLS_MESHES_H

#include <jansson.h>

#include "options.h"
#include "stylut/repair.h"
#include "stylut/simplify.h"

/* As JSON, or as lines on stdout that begin with two blanks. */
json_t *pack_survey(const StyMeshSurvey *survey);
void print_survey(const StyMeshSurvey *survey);
json_t *pack_repair(const StyRepair *repair);
void print_repair(const StyRepair *repair);

/* The budgets are named where nothing met them. */
json_t *pack_simplification(const StySimplification *done);
void print_simplification(const StySimplification *done, const StySimplifyOptions *options);

/* Where far more triangles stay than were asked for. */
void warn_of_remains(const Options *options, const StySimplification *done, const StySimplifyOptions *asked);

/* Warns of what is most likely a mistake in a scene: sty_review_scene. */
void warn_of_scene(const Options *options, const StyScene *scene);

#endif
