/* Mesh files to meshes. Assimp reads the file and cuts polygons into
 * triangles; the rest is done here, because its other steps can't be relied
 * on: its smooth normals are wrong wherever faces share vertices, and its
 * vertex joining merges everything closer than an absolute 1e-5. */
#include <assimp/cimport.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/version.h>
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "bridge/module.h"
#include "scene/faults.h"
#include "scene/fit.h"
#include "scene/import.h"
#include "scene/ply.h"
#include "scene/share.h"
#include "scene/vector.h"
#include "stylut/file.h"
#include "stylut/mesh.h"
#include "stylut/version.h"

#define ASSIMP_SYMBOLS(X)  \
  X(aiApplyPostProcessing) \
  X(aiAttachLogStream)     \
  X(aiDetachLogStream)     \
  X(aiGetErrorString)      \
  X(aiGetMaterialColor)    \
  X(aiGetMaterialString)   \
  X(aiGetMaterialTexture)  \
  X(aiGetVersionMajor)     \
  X(aiGetVersionMinor)     \
  X(aiGetVersionPatch)     \
  X(aiImportFile)          \
  X(aiReleaseImport)

static struct { ASSIMP_SYMBOLS(STY_MODULE_MEMBER) } assimp;
#define SYMBOL(name) STY_MODULE_SYMBOL(assimp, name),
static const StySymbol SYMBOLS[] = {ASSIMP_SYMBOLS(SYMBOL)};
static StyModule module = STY_MODULE("Assimp", "libstylut_assimp.so", 50e6, false, SYMBOLS);

enum { MAX_NODE_DEPTH = 256 };

/* A mesh of the file as one node shows it. */
typedef struct Part {
  const struct aiMesh *mesh;
  const struct aiVector3D *uvs; /* 1 per vertex; NULL: it has none */
  unsigned mesh_number;
  double matrix[3][4];    /* mesh to world */
  double cofactors[3][3]; /* for normals: proportional to the inverse transpose, same side */
  bool mirrored;
} Part;

/* Where a mesh's own coordinates were moved to: file = own / scale + centre. */
typedef struct Frame {
  double centre[3];
  double scale;
} Frame;

/* What importers only tell their log. */
typedef struct Log {
  bool bad_indices;     /* some drop faces with them, or bend them to other vertices */
  char *lost_materials; /* see StyMesh; owned */
} Log;

typedef struct Import {
  const char *path;
  const struct aiScene *file;
  Frame *frames; /* 1 per mesh of the file */
  Part *parts;
  size_t part_count, part_capacity;
  size_t triangle_count; /* of all parts, degenerate ones too */
  bool keep_normals;
  bool has_uvs; /* some part has */
  Log log;
} Import;

/* ---- reading ---- */

static const char *find_extension(const char *path) {
  const char *dot = strrchr(path, '.');
  return dot && !strchr(dot, '/') ? dot + 1 : "";
}

static bool has_extension(const char *path, const char *extension) {
  return strcasecmp(find_extension(path), extension) == 0;
}

static bool is_gltf(const char *path) { return has_extension(path, "gltf") || has_extension(path, "glb"); }

bool sty_is_mesh_file(const char *path) {
  static const char *const KNOWN[] = {"obj", "ply", "stl", "gltf", "glb", "fbx", "off"};
  for (size_t i = 0; i < sizeof KNOWN / sizeof *KNOWN; i++)
    if (has_extension(path, KNOWN[i])) return true;
  return false;
}

static StyStatus check_extension(const char *path, StyError *error) {
  if (sty_is_mesh_file(path)) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT,
                  "%s: found the file ending '%s', expected .obj, .ply, .stl, .gltf, .glb, .fbx or .off", path,
                  find_extension(path));
}

static StyStatus fail_library(const char *path, StyError *error) {
  char reason[256];
  snprintf(reason, sizeof reason, "%s", assimp.aiGetErrorString());
  reason[strcspn(reason, "\r\n")] = '\0';
  return sty_fail(error, STY_ERROR_INPUT, "%s: expected a mesh; the importer says: %s", path,
                  reason[0] ? reason : "nothing");
}

/* What the material calls its picture, and by which of the texture coordinates it is looked up: base colours of glTF
 * files, diffuse ones of others. */
static bool name_texture(const struct aiMaterial *material, struct aiString *name, unsigned *uv_set) {
  static const enum aiTextureType TYPES[] = {aiTextureType_DIFFUSE, aiTextureType_BASE_COLOR};
  for (size_t t = 0; t < sizeof TYPES / sizeof *TYPES; t++)
    if (assimp.aiGetMaterialTexture(material, TYPES[t], 0, name, NULL, uv_set, NULL, NULL, NULL, NULL) ==
            aiReturn_SUCCESS &&
        name->length > 0)
      return true;
  return false;
}

/* The texture coordinates that a mesh's picture is looked up by, else the first; NULL: there are none. */
static const struct aiVector3D *find_uvs(const Import *import, const struct aiMesh *mesh) {
  struct aiString name;
  unsigned set = 0;
  const bool textured = mesh->mMaterialIndex < import->file->mNumMaterials &&
                        name_texture(import->file->mMaterials[mesh->mMaterialIndex], &name, &set);
  if (!textured || set >= AI_MAX_NUMBER_OF_TEXTURECOORDS || !mesh->mTextureCoords[set]) set = 0;
  return mesh->mNumUVComponents[set] >= 2 ? mesh->mTextureCoords[set] : NULL;
}

static StyStatus check_vertices(const Import *import, unsigned m, StyError *error) {
  const struct aiMesh *mesh = import->file->mMeshes[m];
  const struct aiVector3D *uvs = find_uvs(import, mesh);
  StyStatus status = STY_OK;
  for (unsigned v = 0; v < mesh->mNumVertices && !status; v++) {
    const float at[3] = {mesh->mVertices[v].x, mesh->mVertices[v].y, mesh->mVertices[v].z};
    float uv[2] = {0, 0};
    if (uvs) uv[0] = uvs[v].x, uv[1] = uvs[v].y;
    status = sty_check_vertex(import->path, v, m, at, uv, error);
  }
  return status;
}

static StyStatus check_faces(const Import *import, unsigned m, StyError *error) {
  const struct aiMesh *mesh = import->file->mMeshes[m];
  for (unsigned f = 0; f < mesh->mNumFaces; f++)
    for (unsigned k = 0; k < mesh->mFaces[f].mNumIndices; k++) {
      const unsigned index = mesh->mFaces[f].mIndices[k];
      if (index < mesh->mNumVertices) continue;
      return sty_fail_index(import->path, f, m, (int)index, mesh->mNumVertices, error);
    }
  return STY_OK;
}

static StyStatus check_meshes(const Import *import, StyError *error) {
  StyStatus status = STY_OK;
  for (unsigned m = 0; m < import->file->mNumMeshes && status == STY_OK; m++) {
    status = check_vertices(import, m, error);
    if (status == STY_OK) status = check_faces(import, m, error);
  }
  return status;
}

/* The cutting of polygons works in float and fails on tiny or far ones, so the
 * vertices of a mesh that has polygons are brought near [-1, 1]^3. */
static void move_polygons(struct aiMesh *mesh, Frame *frame) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (unsigned f = 0; f < mesh->mNumFaces; f++)
    for (unsigned i = 0; i < mesh->mFaces[f].mNumIndices; i++) {
      const struct aiVector3D p = mesh->mVertices[mesh->mFaces[f].mIndices[i]];
      const double at[3] = {p.x, p.y, p.z};
      for (int k = 0; k < 3; k++) low[k] = fmin(low[k], at[k]), high[k] = fmax(high[k], at[k]);
    }
  double extent = 0;
  for (int k = 0; k < 3; k++) {
    frame->centre[k] = (low[k] + high[k]) / 2;
    extent = fmax(extent, high[k] - low[k]);
  }
  if (extent > 0) frame->scale = 2 / extent;
  for (unsigned v = 0; v < mesh->mNumVertices; v++) {
    struct aiVector3D *p = &mesh->mVertices[v];
    p->x = (float)((p->x - frame->centre[0]) * frame->scale);
    p->y = (float)((p->y - frame->centre[1]) * frame->scale);
    p->z = (float)((p->z - frame->centre[2]) * frame->scale);
  }
}

/* Assimp marks a mesh with empty faces as one of polygons, and then aborts
 * when it finds none to cut. */
static bool mark_polygons(struct aiMesh *mesh) {
  for (unsigned f = 0; f < mesh->mNumFaces; f++)
    if (mesh->mFaces[f].mNumIndices > 3) return true;
  mesh->mPrimitiveTypes &= ~(unsigned)aiPrimitiveType_POLYGON;
  return false;
}

static StyStatus cut_polygons(Import *import, StyError *error) {
  const unsigned count = import->file->mNumMeshes;
  import->frames = malloc((count + 1) * sizeof *import->frames);
  if (!import->frames) return sty_fail_memory(error, "mesh frames", (double)count * sizeof *import->frames);
  bool polygons = false;
  for (unsigned m = 0; m < count; m++) {
    import->frames[m] = (Frame){.scale = 1};
    if (!mark_polygons(import->file->mMeshes[m])) continue;
    move_polygons(import->file->mMeshes[m], &import->frames[m]);
    polygons = true;
  }
  if (!polygons) return STY_OK;
  import->file = assimp.aiApplyPostProcessing(import->file, aiProcess_Triangulate);
  return import->file ? STY_OK : fail_library(import->path, error);
}

/* What an OBJ file asks for in vain, as Assimp says it. */
static char *find_lost(const char *message) {
  static const struct {
    const char *said, *kind;
  } LOST[] = {{"Unable to locate material file ", "material file"}, {"failed to locate material ", "material"}};
  for (size_t l = 0; l < sizeof LOST / sizeof *LOST; l++) {
    const char *found = strstr(message, LOST[l].said);
    char *lost = NULL;
    if (!found) continue;
    found += strlen(LOST[l].said);
    return asprintf(&lost, "%s %.*s", LOST[l].kind, (int)strcspn(found, ",\r\n"), found) < 0 ? NULL : lost;
  }
  return NULL;
}

static void watch_log(const char *message, char *user) {
  Log *log = (Log *)(void *)user;
  if (strstr(message, "out of range") || strstr(message, "out-of-range")) log->bad_indices = true;
  if (!log->lost_materials) log->lost_materials = find_lost(message);
}

StyStatus sty_open_importer(StyError *error) { return sty_open_module(&module, error); }

static StyStatus load_file(Import *import, StyError *error) {
  StyStatus status = sty_open_importer(error);
  if (status) return status;
  struct aiLogStream stream = {watch_log, (char *)(void *)&import->log};
  assimp.aiAttachLogStream(&stream);
  import->file = assimp.aiImportFile(import->path, 0);
  assimp.aiDetachLogStream(&stream);
  if (!import->file) return fail_library(import->path, error);
  if (import->log.bad_indices)
    return sty_fail(error, STY_ERROR_INPUT, "%s: a face asks for a vertex that the file does not hold", import->path);
  /* What materials do to texture coordinates becomes part of them. */
  import->file = assimp.aiApplyPostProcessing(import->file, aiProcess_TransformUVCoords);
  if (!import->file) return fail_library(import->path, error);
  status = check_meshes(import, error);
  return status == STY_OK ? cut_polygons(import, error) : status;
}

static StyStatus read_file(Import *import, StyError *error) {
  StyStatus status = check_extension(import->path, error);
  if (status == STY_OK) status = sty_check_file(import->path, NULL, error);
  if (status == STY_OK && sty_is_ply(import->path)) status = sty_check_ply(import->path, error);
  if (status != STY_OK) return status;
  return load_file(import, error);
}

/* ---- the node tree ---- */

static void multiply_node(const double parent[3][4], const struct aiMatrix4x4 *own, double out[3][4]) {
  const double b[4][4] = {{own->a1, own->a2, own->a3, own->a4},
                          {own->b1, own->b2, own->b3, own->b4},
                          {own->c1, own->c2, own->c3, own->c4},
                          {0, 0, 0, 1}};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 4; j++) {
      out[i][j] = j == 3 ? parent[i][3] : 0;
      for (int k = 0; k < 3; k++) out[i][j] += parent[i][k] * b[k][j];
    }
}

static size_t count_triangles(const struct aiMesh *mesh) {
  size_t count = 0;
  for (unsigned f = 0; f < mesh->mNumFaces; f++) count += mesh->mFaces[f].mNumIndices == 3;
  return count;
}

/* The node's matrix with the mesh's frame folded in. */
static Part make_part(const Import *import, unsigned m, const double node[3][4]) {
  const struct aiMesh *mesh = import->file->mMeshes[m];
  Part part = {.mesh = mesh, .uvs = find_uvs(import, mesh), .mesh_number = m};
  const Frame *frame = &import->frames[m];
  for (int i = 0; i < 3; i++) {
    part.matrix[i][3] = node[i][3];
    for (int j = 0; j < 3; j++) {
      part.matrix[i][j] = node[i][j] / frame->scale;
      part.matrix[i][3] += node[i][j] * frame->centre[j];
    }
  }
  for (int i = 0; i < 3; i++) cross_vectors(node[(i + 1) % 3], node[(i + 2) % 3], part.cofactors[i]);
  part.mirrored = dot_vectors(node[0], part.cofactors[0]) < 0;
  if (part.mirrored)
    for (int i = 0; i < 9; i++) part.cofactors[i / 3][i % 3] *= -1;
  return part;
}

static StyStatus add_part(Import *import, unsigned m, const double node[3][4], StyError *error) {
  const size_t triangles = count_triangles(import->file->mMeshes[m]);
  if (triangles == 0) return STY_OK;
  if (triangles > STY_MAX_TRIANGLES - import->triangle_count) return sty_fail_triangles(import->path, error);
  if (import->part_count == import->part_capacity) {
    const size_t capacity = import->part_capacity ? 2 * import->part_capacity : 16;
    Part *grown = realloc(import->parts, capacity * sizeof *grown);
    if (!grown) return sty_fail_memory(error, "mesh parts", (double)(capacity * sizeof *grown));
    import->parts = grown;
    import->part_capacity = capacity;
  }
  import->parts[import->part_count++] = make_part(import, m, node);
  import->has_uvs |= import->parts[import->part_count - 1].uvs != NULL;
  import->triangle_count += triangles;
  return STY_OK;
}

static StyStatus add_node(Import *import, const struct aiNode *node, const double parent[3][4], int depth,
                          StyError *error) {
  if (depth > MAX_NODE_DEPTH)
    return sty_fail(error, STY_ERROR_INPUT, "%s: nodes are nested more than %d deep", import->path, MAX_NODE_DEPTH);
  double matrix[3][4];
  multiply_node(parent, &node->mTransformation, matrix);
  StyStatus status = STY_OK;
  for (unsigned i = 0; i < node->mNumMeshes && status == STY_OK; i++)
    if (node->mMeshes[i] < import->file->mNumMeshes) status = add_part(import, node->mMeshes[i], matrix, error);
  for (unsigned i = 0; i < node->mNumChildren && status == STY_OK; i++)
    status = add_node(import, node->mChildren[i], matrix, depth + 1, error);
  return status;
}

/* The axis that the file says points up: 0 to 2; that of all formats but FBX is y. */
static int find_up_axis(const Import *import) {
  const struct aiMetadata *data = import->file->mMetaData;
  if (!has_extension(import->path, "fbx")) return 1;
  for (unsigned i = 0; data && i < data->mNumProperties; i++)
    if (strcmp(data->mKeys[i].data, "UpAxis") == 0 && data->mValues[i].mType == AI_INT32)
      return *(const int32_t *)data->mValues[i].mData;
  return 1;
}

static StyStatus list_parts(Import *import, StyError *error) {
  static const double UPRIGHT[3][3][4] = {{{0, -1, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 0}},
                                          {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
                                          {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}}};
  const int up = find_up_axis(import);
  const double(*upright)[4] = UPRIGHT[up >= 0 && up <= 2 ? up : 1];
  StyStatus status = STY_OK;
  if (import->file->mRootNode) status = add_node(import, import->file->mRootNode, upright, 0, error);
  /* Meshes that no node shows are shown as they are. */
  if (import->part_count == 0)
    for (unsigned m = 0; m < import->file->mNumMeshes && status == STY_OK; m++)
      status = add_part(import, m, upright, error);
  if (status == STY_OK && import->part_count == 0) return sty_fail_empty(import->path, error);
  return status;
}

/* ---- triangles ---- */

static void transform_vertex(const Part *part, unsigned v, double out[3]) {
  const struct aiVector3D p = part->mesh->mVertices[v];
  for (int i = 0; i < 3; i++)
    out[i] = part->matrix[i][0] * p.x + part->matrix[i][1] * p.y + part->matrix[i][2] * p.z + part->matrix[i][3];
}

/* The file's vertex indices of a triangle, counter-clockwise in the world. */
static void order_triangle(const Part *part, const struct aiFace *face, unsigned out[3]) {
  out[0] = face->mIndices[0];
  out[1] = face->mIndices[part->mirrored ? 2 : 1];
  out[2] = face->mIndices[part->mirrored ? 1 : 2];
}

static StyStatus measure_part(const Import *import, const Part *part, StyMesh *mesh, StyError *error) {
  for (unsigned f = 0; f < part->mesh->mNumFaces; f++) {
    if (part->mesh->mFaces[f].mNumIndices != 3) continue;
    unsigned vertices[3];
    double world[3][3];
    order_triangle(part, &part->mesh->mFaces[f], vertices);
    for (int k = 0; k < 3; k++) {
      transform_vertex(part, vertices[k], world[k]);
      StyStatus status = sty_check_world(import->path, vertices[k], part->mesh_number, world[k], error);
      if (status != STY_OK) return status;
    }
    if (!sty_has_area(world[0], world[1], world[2])) continue;
    for (int i = 0; i < 9; i++) {
      const double at = world[i / 3][i % 3];
      mesh->minimum[i % 3] = fmin(mesh->minimum[i % 3], at);
      mesh->maximum[i % 3] = fmax(mesh->maximum[i % 3], at);
    }
  }
  return STY_OK;
}

static StyStatus measure_mesh(const Import *import, StyMesh *mesh, StyError *error) {
  for (int k = 0; k < 3; k++) mesh->minimum[k] = INFINITY, mesh->maximum[k] = -INFINITY;
  for (size_t p = 0; p < import->part_count; p++) {
    StyStatus status = measure_part(import, &import->parts[p], mesh, error);
    if (status != STY_OK) return status;
  }
  return sty_set_mesh_space(mesh) ? STY_OK : sty_fail_flat(import->path, import->triangle_count, error);
}

/* Leaves the normal unknown where the file has none that can be used. */
static void fill_file_normal(const Part *part, unsigned v, float out[3]) {
  const struct aiVector3D n = part->mesh->mNormals[v];
  double world[3];
  for (int i = 0; i < 3; i++)
    world[i] = part->cofactors[i][0] * n.x + part->cofactors[i][1] * n.y + part->cofactors[i][2] * n.z;
  if (!normalize_vector(world)) return;
  for (int k = 0; k < 3; k++) out[k] = (float)world[k] + 0.0f;
}

static void fill_corner(const Import *import, const StyMesh *mesh, const Part *part, unsigned v, StyCorner *out) {
  double world[3];
  transform_vertex(part, v, world);
  *out = (StyCorner){0};
  /* Adding zero turns negative zero into zero: corners compare by their bytes. */
  for (int k = 0; k < 3; k++) out->position[k] = (float)((world[k] - mesh->centre[k]) * mesh->scale) + 0.0f;
  if (import->keep_normals && part->mesh->mNormals) fill_file_normal(part, v, out->normal);
  if (!part->uvs) return;
  out->uv[0] = part->uvs[v].x + 0.0f;
  out->uv[1] = part->uvs[v].y + 0.0f;
}

static void fill_part(const Import *import, const Part *part, StyMesh *mesh, StyCorner *corners) {
  for (unsigned f = 0; f < part->mesh->mNumFaces; f++) {
    if (part->mesh->mFaces[f].mNumIndices != 3) continue;
    unsigned vertices[3];
    StyCorner *own = &corners[3 * mesh->triangle_count];
    order_triangle(part, &part->mesh->mFaces[f], vertices);
    for (int k = 0; k < 3; k++) fill_corner(import, mesh, part, vertices[k], &own[k]);
    /* Rounding to trace space may flatten a triangle that had an area. */
    if (sty_keeps_triangle(mesh, (const float *const[]){own[0].position, own[1].position, own[2].position}))
      mesh->part_ids[mesh->triangle_count++] = (uint32_t)mesh->part_count;
  }
  mesh->vertices_read += part->mesh->mNumVertices;
}

static StyStatus fill_corners(const Import *import, StyMesh *mesh, StyCorner **out, StyError *error) {
  const size_t count = import->triangle_count;
  StyCorner *corners = malloc(3 * count * sizeof *corners);
  mesh->part_ids = malloc(count * sizeof *mesh->part_ids);
  if (!corners || !mesh->part_ids) {
    free(corners);
    return sty_fail_memory(error, "mesh corners", (double)(3 * count * sizeof *corners));
  }
  for (size_t p = 0; p < import->part_count; p++) {
    mesh->part_count++;
    fill_part(import, &import->parts[p], mesh, corners);
  }
  if (mesh->part_count == 1) {
    free(mesh->part_ids);
    mesh->part_ids = NULL;
  }
  *out = corners;
  return mesh->triangle_count > 0 ? STY_OK : sty_fail_flat(import->path, import->triangle_count, error);
}

/* ---- materials ---- */

/* The number of the picture inside the file that is called "*0" and so on or, in FBX, by the name of the file that it
 * once was; their count: there is none. */
static unsigned find_inner_texture(const Import *import, const struct aiString *name) {
  const struct aiScene *file = import->file;
  if (name->data[0] == '*') {
    const unsigned long number = strtoul(name->data + 1, NULL, 10);
    return number < file->mNumTextures ? (unsigned)number : file->mNumTextures;
  }
  for (unsigned t = 0; t < file->mNumTextures; t++)
    if (file->mTextures[t]->mFilename.length && strcmp(file->mTextures[t]->mFilename.data, name->data) == 0) return t;
  return file->mNumTextures;
}

/* As it is packed there: no height means a picture's file of so many bytes. */
static StyPicture copy_inner_texture(const Import *import, unsigned number) {
  const struct aiTexture *inner = number < import->file->mNumTextures ? import->file->mTextures[number] : NULL;
  if (!inner || inner->mHeight > 0 || inner->mWidth == 0) return (StyPicture){0};
  StyPicture picture = {.bytes = malloc(inner->mWidth), .size = inner->mWidth};
  if (picture.bytes) memcpy(picture.bytes, inner->pcData, picture.size);
  if (!picture.bytes || asprintf(&picture.path, "%s: picture %u", import->path, number + 1) < 0) {
    free(picture.bytes);
    return (StyPicture){0};
  }
  return picture;
}

/* As URIs write them: %20 for a blank. */
static void decode_percent(char *text) {
  char *out = text;
  for (const char *c = text; *c; c++) {
    const bool coded = c[0] == '%' && isxdigit((unsigned char)c[1]) && isxdigit((unsigned char)c[2]);
    const char digits[3] = {c[1], coded ? c[2] : '\0', '\0'};
    *out++ = coded ? (char)strtoul(digits, NULL, 16) : *c;
    if (coded) c += 2;
  }
  *out = '\0';
}

/* One beside the file: where the name says or, where nothing is there, by the last part of the name, as FBX files tend
 * to hold paths of the computer that they were made on. */
static StyPicture find_outer_texture(const char *path, struct aiString *name) {
  for (char *c = name->data; *c; c++) *c = *c == '\\' ? '/' : *c; /* files written on Windows */
  if (is_gltf(path)) decode_percent(name->data);
  const char *slash = strrchr(name->data, '/');
  char *folder = sty_get_folder(path);
  char *named = folder ? sty_join_path(folder, name->data) : NULL;
  char *beside = folder && slash ? sty_join_path(folder, slash + 1) : NULL;
  const bool is_beside = named && beside && access(named, F_OK) != 0 && access(beside, F_OK) == 0;
  const StyPicture picture = {.path = is_beside ? beside : named, .named_by = strdup(path)};
  free(is_beside ? named : beside);
  free(folder);
  if (picture.path && picture.named_by) return picture;
  free(picture.path);
  free(picture.named_by);
  return (StyPicture){0};
}

/* The picture of a part's material; without a path: none. */
static StyPicture find_texture(const Import *import, const struct aiMaterial *material) {
  struct aiString name;
  unsigned uv_set;
  if (!name_texture(material, &name, &uv_set)) return (StyPicture){0};
  const unsigned inner = find_inner_texture(import, &name);
  const bool is_inner = inner < import->file->mNumTextures || name.data[0] == '*';
  return is_inner ? copy_inner_texture(import, inner) : find_outer_texture(import->path, &name);
}

/* The number of the mesh's texture that this is, which is taken over. */
static int number_texture(StyMesh *mesh, StyPicture *picture) {
  for (int t = 0; t < mesh->texture_count; t++)
    if (strcmp(mesh->textures[t].path, picture->path) == 0) {
      free(picture->path);
      free(picture->named_by);
      free(picture->bytes);
      return t;
    }
  mesh->textures[mesh->texture_count] = *picture;
  return mesh->texture_count++;
}

/* Of the formats that have materials; of others the importer makes grey ones up. */
static bool has_materials(const char *path) {
  return has_extension(path, "obj") || has_extension(path, "fbx") || is_gltf(path);
}

/* White for what the file says nothing of, where the importer would say grey. */
static StyPaint read_paint(const Import *import, const Part *part, StyMesh *mesh) {
  StyPaint paint = {{1, 1, 1}, -1};
  struct aiString name;
  struct aiColor4D colour;
  if (!has_materials(import->path) || part->mesh->mMaterialIndex >= import->file->mNumMaterials) return paint;
  const struct aiMaterial *material = import->file->mMaterials[part->mesh->mMaterialIndex];
  if (assimp.aiGetMaterialString(material, AI_MATKEY_NAME, &name) == aiReturn_SUCCESS &&
      strcmp(name.data, AI_DEFAULT_MATERIAL_NAME) == 0)
    return paint;
  if (assimp.aiGetMaterialColor(material, AI_MATKEY_COLOR_DIFFUSE, &colour) == aiReturn_SUCCESS) {
    const double found[3] = {(double)colour.r, (double)colour.g, (double)colour.b};
    for (int k = 0; k < 3; k++) paint.colour[k] = found[k] >= 0 && found[k] <= 1 ? found[k] : 1;
  }
  StyPicture texture = find_texture(import, material);
  if (texture.path) paint.texture = number_texture(mesh, &texture);
  return paint;
}

static StyStatus read_paints(const Import *import, StyMesh *mesh, StyError *error) {
  mesh->paints = malloc(import->part_count * sizeof *mesh->paints);
  mesh->textures = malloc(import->part_count * sizeof *mesh->textures);
  if (!mesh->paints || !mesh->textures)
    return sty_fail_memory(error, "mesh parts", (double)(import->part_count * sizeof *mesh->paints));
  for (size_t p = 0; p < import->part_count; p++) mesh->paints[p] = read_paint(import, &import->parts[p], mesh);
  return STY_OK;
}

/* ---- the mesh ---- */

/* Lets go of the importer's copy, which nothing needs once corners are filled. */
static void release_import(Import *import) {
  if (import->file) assimp.aiReleaseImport(import->file);
  free(import->frames);
  free(import->parts);
  import->file = NULL;
  import->frames = NULL;
  import->parts = NULL;
}

static StyStatus build_mesh(Import *import, StyMesh *mesh, StyError *error) {
  StyCorner *corners = NULL;
  StyStatus status = measure_mesh(import, mesh, error);
  if (status == STY_OK) status = fill_corners(import, mesh, &corners, error);
  if (status == STY_OK) status = read_paints(import, mesh, error);
  release_import(import);
  if (status == STY_OK) status = sty_share_vertices(mesh, corners, import->has_uvs, error);
  free(corners);
  return status;
}

StyStatus sty_import_mesh(const char *path, bool keep_normals, StyMesh **out, StyError *error) {
  /* STL can only store facets, so its normals tell nothing. */
  Import import = {.path = path, .keep_normals = keep_normals && !has_extension(path, "stl")};
  StyMesh *mesh = calloc(1, sizeof *mesh);
  if (!mesh) return sty_fail_memory(error, "mesh", sizeof *mesh);
  mesh->path = strdup(path);
  StyStatus status = mesh->path ? read_file(&import, error) : sty_fail_memory(error, path, (double)strlen(path));
  if (status == STY_OK) status = list_parts(&import, error);
  if (status == STY_OK) status = build_mesh(&import, mesh, error);
  mesh->lost_materials = import.log.lost_materials;
  release_import(&import);
  if (status == STY_OK)
    *out = mesh;
  else
    sty_destroy_mesh(&mesh);
  return status;
}

const char *sty_get_mesh_library_version(void) {
  static _Thread_local char text[48];
  if (sty_open_importer(NULL)) return "Assimp, which can't be opened";
  snprintf(text, sizeof text, "Assimp %u.%u.%u", assimp.aiGetVersionMajor(), assimp.aiGetVersionMinor(),
           assimp.aiGetVersionPatch());
  return text;
}
