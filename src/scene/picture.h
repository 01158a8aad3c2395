/* Pictures that meshes and scenes own. */
#ifndef STYLUT_SCENE_PICTURE_H
#define STYLUT_SCENE_PICTURE_H

#include "stylut/mesh.h"

/* Frees a list and what is in it. */
void sty_destroy_pictures(StyPicture *pictures, int count);

#endif
