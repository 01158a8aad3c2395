/* What other programs call our channels, and how they hold them: one table, and the search in a file's names. */
#ifndef STYLUT_SRC_GUIDE_FOREIGN_H
#define STYLUT_SRC_GUIDE_FOREIGN_H

#include "stylut/foreign.h"

/* What may be found in a file. Positions and distances may stand in for a depth. */
typedef enum StyField {
  STY_FIELD_NORMAL,
  STY_FIELD_DEPTH,    /* along the view axis */
  STY_FIELD_DISTANCE, /* along the ray */
  STY_FIELD_POSITION,
  STY_FIELD_UV,
  STY_FIELD_ALBEDO,
  STY_FIELD_PICTURE, /* lit, scene-linear */
  STY_FIELD_OBJECT,
  STY_FIELD_STYLE,
  STY_FIELD_MOTION,
  STY_FIELD_ALPHA,
  STY_FIELDS
} StyField;

enum { STY_FIELD_COMPONENTS = 3, STY_FIELD_PLACES = 3 };

typedef struct StyFieldInfo {
  int count;                 /* components */
  const char *components[3]; /* the letters they go by, in either case; none: any one, or none */
  const char *channels[4];   /* ours that it becomes; NULL-terminated */
} StyFieldInfo;

extern const StyFieldInfo sty_fields[STY_FIELDS];

typedef struct StyProgram {
  const char *name;
  /* Layers to look for, the first that is there; ".RGB": channels of these names without a layer. */
  const char *places[STY_FIELDS][STY_FIELD_PLACES];
  const char *mark;  /* a layer that shows the program; NULL: none does */
  StySpace space;    /* of normals */
  bool fixed_world;  /* positions are world space whatever the normals are */
  int toward_viewer; /* sign of view space's Z toward the viewer; 0: as most normals have it */
  bool left_handed;  /* the world */
  bool is_unsure;    /* whether its depth is along the axis */
  bool is_picture;   /* 8 and 16 bit hold n/2+1/2 */
} StyProgram;

enum { STY_PROGRAMS = 6 };
extern const StyProgram sty_programs[STY_PROGRAMS];

/* Where a field stands in an image: indices of its channels; none where channels[0] < 0. */
typedef struct StyPlace {
  int channels[STY_FIELD_COMPONENTS];
  int others; /* further layers that would have done */
} StyPlace;

/* Looks for all fields of a program; all come from the render layer that the normals are of, or from none. */
void sty_find_fields(const StyProgram *program, const StyImage *image, StyPlace out[STY_FIELDS]);

/* The program whose own layers, or kind of picture, a file shows; NULL: none that could be told. */
const StyProgram *sty_find_shown_program(const StyImage *image);

/* STY_ERROR_INPUT where the file lacks the program's normals or shows another program's mark. */
StyStatus sty_check_program(const char *name, const StyProgram *program, const StyImage *image,
                            const StyPlace places[STY_FIELDS], StyError *error);

/* ---- an import under way ---- */

typedef struct StyImport {
  const char *name;
  const StyProgram *program;
  const StyForeignOptions *options;
  StyNotes *notes;
  const StyImage *file; /* as read */
  StyImage *guide;      /* to be filled */
  StyPlace places[STY_FIELDS];
  bool has_camera;
  StyCamera camera;  /* world units, axes in the file's world */
  bool is_world;     /* normals */
  double toward;     /* sign of the file's view Z toward the viewer */
  StyField depth_of; /* what the depth is taken from; STY_FIELDS: nothing */
  bool along_ray;    /* STY_FIELD_DEPTH turned out to be that */
} StyImport;

void sty_add_note(StyNotes *notes, StyNoteKind kind, const char *format, ...) __attribute__((format(printf, 3, 4)));
bool sty_has_field(const StyImport *import, StyField field);

/* A component's plane in the file, NULL where the field isn't there; three components of a pixel. */
const float *sty_get_field(const StyImport *import, StyField field, int component);
void sty_get_vector(const StyImport *import, StyField field, size_t pixel, double out[3]);

StyStatus sty_place_foreign_camera(StyImport *import, StyError *error);

/* From here on the guide's coverage is there. The sign of Z toward the viewer, by the table or the normals. */
double sty_find_toward(const StyImport *import);

void sty_note_normals(const StyImport *import);

/* make_unit: those that are nearly so become unit vectors. */
void sty_fill_normals(StyImport *import, bool make_unit);

/* Warns where the guide's normals have other lengths than 1, or face away. */
void sty_check_normals(const StyImport *import);

bool sty_has_world_positions(const StyImport *import);
void sty_fill_positions(StyImport *import);

/* Warns where the camera can't be the file's. Needs positions and the camera. */
void sty_check_foreign_camera(const StyImport *import);

/* Sets along_ray where the program leaves that open. */
void sty_settle_depth(StyImport *import);
void sty_fill_depth(StyImport *import);

#endif
