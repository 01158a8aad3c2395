/* Names and versions of the libraries in use, for --version and bug reports.
 * Static strings. */
#ifndef STYLUT_VERSION_H
#define STYLUT_VERSION_H

#ifdef __cplusplus
extern "C" {
#endif

const char *sty_get_geometry_library_version(void); /* CGAL; NULL when built without it */

#ifdef __cplusplus
}
#endif
#endif
