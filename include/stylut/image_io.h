/* Image files in and out, through OpenImageIO, which is loaded with the first
 * file. All functions may also fail with STY_ERROR_UNAVAILABLE, when the module
 * libstylut_oiio.so isn't found. */
#ifndef STYLUT_IMAGE_IO_H
#define STYLUT_IMAGE_IO_H

#include "stylut/file.h"
#include "stylut/image.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads EXR (all parts), PNG, TIFF, JPEG, TGA or HDR. Alpha stays
 * unassociated, values stay as stored. Channels of an EXR part that is named
 * and not the only one are called part.channel unless they carry a dot
 * already. A data window smaller than the display window is placed in it.
 * The header is checked against the limits of image.h and against the size of
 * the file before any pixel is allocated.
 * Errors: STY_ERROR_FILE (missing, a folder, unreadable), STY_ERROR_INPUT (not
 * a picture, truncated, absurd size), STY_ERROR_LIBRARY (memory). */
StyStatus sty_read_image(const char *path, StyImage **out, StyError *error);

typedef struct StyImageShape {
  int width, height, channels; /* within the limits of image.h */
} StyImageShape;

/* What a file's header says of the picture in it, of which no pixel is read. Errors: those of sty_read_image that show
 * in a header. Thread-safe. */
StyStatus sty_read_image_shape(const char *path, StyImageShape *out, StyError *error);

/* All channels at another size, by the filter that OpenImageIO takes where none is named: Blackman-Harris to enlarge,
 * Lanczos of 3 to reduce. Values may leave the range they had. `name` is for messages; the caller owns *out. */
StyStatus sty_resize_image(const char *name, const StyImage *image, int width, int height, StyImage **out,
                           StyError *error);

typedef enum StyImageFormat { STY_IMAGE_EXR, STY_IMAGE_PNG } StyImageFormat;

/* What an output will be, by its name's ending in either case. STY_ERROR_USAGE
 * for any but .exr and .png. */
StyStatus sty_get_image_format(const char *path, StyImageFormat *out, StyError *error);

/* Writes by the name's ending: .exr holds all channels as float with lossless
 * compression; .png holds 1 (grey), 2 (grey, alpha), 3 or 4 channels in their
 * given order with image->bits of 8 or 16, values clamped to 0..1. The
 * image's attributes are kept as metadata. The file appears whole or not at
 * all, and holds the same bytes whenever it is written. STY_ERROR_USAGE: another
 * ending, or what a PNG can't hold. */
StyStatus sty_write_image(const char *path, const StyImage *image, StyError *error);

/* All of sty_write_image but the last step, for pictures that should appear
 * together: sty_commit_output makes this one appear, sty_discard_output doesn't. */
StyStatus sty_prepare_image(const char *path, const StyImage *image, StyOutput *out, StyError *error);

/* A picture that is written as it comes, row by row from the top. */
typedef struct StyImageWriter StyImageWriter;

/* Begins the picture `path` of `height` rows; width, channels, bits and attributes are those of `like`, whose own
 * height and values don't matter. The caller closes or discards it. Errors: those of sty_write_image. */
StyStatus sty_open_image_writer(const char *path, const StyImage *like, int height, StyImageWriter **out,
                                StyError *error);

/* Memory that OpenImageIO takes once it is there, as measured. */
double sty_get_image_library_bytes(void);

/* Memory that a writer takes beside the rows that it is handed, `rows` at a time, as measured: OpenImageIO itself and
 * what it holds on the way into the file. */
double sty_estimate_writer_bytes(int width, int channels, int rows);

/* Appends all rows of `rows`, which has the writer's width and channels. From one thread at a time. */
StyStatus sty_write_rows(StyImageWriter *writer, const StyImage *rows, StyError *error);

/* Makes the picture appear; STY_ERROR_USAGE unless all its rows were written. Either way *writer is spent. */
StyStatus sty_close_image_writer(StyImageWriter **writer, StyError *error);

/* Leaves nothing behind; does nothing for NULL. */
void sty_discard_image_writer(StyImageWriter **writer);

#ifdef __cplusplus
}
#endif
#endif
