/* Names and versions of the libraries in use, for --version and bug reports.
 * Static strings. */
#ifndef STYLUT_VERSION_H
#define STYLUT_VERSION_H

#ifdef __cplusplus
extern "C" {
#endif

const char *sty_get_image_library_version(void);    /* OpenImageIO */
const char *sty_get_mesh_library_version(void);     /* Assimp */
const char *sty_get_ray_library_version(void);      /* Embree */
const char *sty_get_search_library_version(void);   /* FLANN */
const char *sty_get_geometry_library_version(void); /* CGAL; NULL when built without it */

#ifdef __cplusplus
}
#endif
#endif
