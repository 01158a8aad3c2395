/* Scene files: the fuzzer's bytes are the file, beside a mesh and a texture that it may name. What is read is traced.
 */
#include <math.h>

#include "fuzz.h"
#include "stylut/guide.h"
#include "stylut/scene_file.h"

enum { WIDTH = 6, HEIGHT = 4 };

static const unsigned GROUPS = STY_GUIDE_NORMAL | STY_GUIDE_DEPTH | STY_GUIDE_POSITION | STY_GUIDE_OBJECT |
                               STY_GUIDE_STYLE | STY_GUIDE_ALBEDO | STY_GUIDE_LUMA | STY_GUIDE_UV |
                               STY_GUIDE_CURVATURE | STY_GUIDE_CONTOUR | STY_GUIDE_MOTION;

static const char MESH[] =
    "OFF\n5 5 0\n-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n0 0 1\n4 0 3 2 1\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n";
static const char TEXTURE[] = "P6 1 2 255 abcdef";

static void put_neighbours(void) {
  static bool done;
  if (done) return;
  put_file("m.off", (const uint8_t *)MESH, sizeof MESH - 1);
  put_file("t.ppm", (const uint8_t *)TEXTURE, sizeof TEXTURE - 1);
  done = true;
}

static void check_material(const StyScene *scene, const StyMaterial *material, int style) {
  require(style >= 0 && style <= STY_MOST_STYLE);
  require(material->paint.texture >= -1 && material->paint.texture < scene->texture_count);
  require(material->specular >= 0 && material->specular <= 1 && material->shininess >= 1);
  for (int k = 0; k < 3; k++) require(material->paint.colour[k] >= 0 && material->paint.colour[k] <= 1);
}

static void check_scene(const StyScene *scene) {
  require(scene->object_count + scene->sphere_count >= 1 && scene->light_count <= STY_MOST_LIGHTS);
  require(isfinite(scene->scale) && scene->scale > 0 && scene->ambient >= 0);
  for (int k = 0; k < 3; k++) {
    require(scene->minimum[k] <= scene->maximum[k]);
    require(scene->minimum[k] >= -STY_MAX_COORDINATE && scene->maximum[k] <= STY_MAX_COORDINATE);
  }
  for (int o = 0; o < scene->object_count; o++) {
    require(scene->objects[o].mesh >= 0 && scene->objects[o].mesh < scene->mesh_count);
    check_material(scene, &scene->objects[o].material, scene->objects[o].style);
  }
  for (int s = 0; s < scene->sphere_count; s++) {
    require(scene->spheres[s].radius > 0 && scene->spheres[s].id > scene->object_count);
    check_material(scene, &scene->spheres[s].material, scene->spheres[s].style);
  }
}

static double at(const StyImage *guide, const char *channel, size_t pixel) {
  const float *plane = sty_find_channel(guide, channel);
  require(plane);
  return (double)plane[pixel];
}

/* Every covered pixel holds numbers, and a normal of unit length. Light as strong as 1e30 may well be infinite. */
static void check_guide(const StyImage *guide) {
  for (size_t i = 0; i < sty_count_pixels(guide); i++) {
    if (at(guide, "A", i) == 0) continue;
    const double x = at(guide, "normal.X", i), y = at(guide, "normal.Y", i), z = at(guide, "normal.Z", i);
    require(fabs(x * x + y * y + z * z - 1) < 1e-5);
    require(at(guide, "object.I", i) >= 1);
    for (int c = 0; c < guide->channel_count; c++) {
      const double value = at(guide, guide->names[c], i);
      require(strcmp(guide->names[c], "luma.Y") == 0 ? !isnan(value) : isfinite(value));
    }
  }
}

static void trace_scene(const StyScene *scene, const StyViewpoint *viewpoint) {
  StyCamera camera;
  StyImage *guide = NULL;
  StyError error;
  StyStatus status = sty_set_camera(scene, viewpoint, WIDTH, HEIGHT, &camera, &error);
  const StyTraceOptions options = {
      .width = WIDTH, .height = HEIGHT, .groups = GROUPS, .contour = {1, 1}, .previous = {scene, &camera}};
  if (!status) status = sty_trace_guide(scene, &camera, &options, &(StyRun){.threads = 1}, NULL, &guide, &error);
  if (status)
    require_message(status, &error);
  else
    check_guide(guide);
  sty_destroy_image(&guide);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  put_neighbours();
  const char *path = put_file("scene.json", data, size);
  StyScene *scene = NULL;
  StyViewpoint viewpoint;
  StyStand stand;
  StyError error;
  const StyMeshOptions options = {-1};
  StyStatus status = sty_read_stand(path, &stand, &error);
  if (status) require_message(status, &error);
  status = sty_read_scene(path, &options, &scene, &viewpoint, &error);
  if (status) {
    require(!scene);
    require_message(status, &error);
    return 0;
  }
  check_scene(scene);
  trace_scene(scene, &viewpoint);
  sty_destroy_scene(&scene);
  return 0;
}
