/* What rays are traced through: the scene's objects in its trace space, and Embree's trees of them. */
#ifndef STYLUT_GUIDE_TRACER_H
#define STYLUT_GUIDE_TRACER_H

#include <embree3/rtcore.h>
#include <stdatomic.h>

#include "bridge/module.h"
#include "guide/kernels.h"

#define STY_EMBREE_SYMBOLS(X)           \
  X(rtcAttachGeometryByID)              \
  X(rtcCommitGeometry)                  \
  X(rtcCommitScene)                     \
  X(rtcGetDeviceError)                  \
  X(rtcIntersect8)                      \
  X(rtcNewDevice)                       \
  X(rtcNewGeometry)                     \
  X(rtcNewScene)                        \
  X(rtcOccluded8)                       \
  X(rtcReleaseDevice)                   \
  X(rtcReleaseGeometry)                 \
  X(rtcReleaseScene)                    \
  X(rtcSetDeviceErrorFunction)          \
  X(rtcSetDeviceMemoryMonitorFunction)  \
  X(rtcSetGeometryInstancedScene)       \
  X(rtcSetGeometryTransform)            \
  X(rtcSetNewGeometryBuffer)            \
  X(rtcSetSceneFlags)                   \
  X(rtcSetSceneProgressMonitorFunction) \
  X(rtcSetSharedGeometryBuffer)

/* Embree, once a tracer was opened. */
extern struct StyEmbree { STY_EMBREE_SYMBOLS(STY_MODULE_MEMBER) } sty_embree;

/* How far from where it is Embree may see a surface, as a share of the numbers that place it: eight roundings of
 * floats. Random scenes needed two. */
#define STY_FLOAT_SLACK 0x1p-21

/* An object in the scene's trace space. */
typedef struct StyPlaced {
  const StyMesh *mesh;
  const StyObject *object;
  double matrix[3][4];    /* from the mesh's trace space */
  double cofactors[3][3]; /* for normals: proportional to the transform's inverse transpose */
  bool is_unmoved;        /* the matrix is the identity */
  double shift;           /* the largest part of the matrix' translation */
} StyPlaced;

/* A sphere in the scene's trace space. */
typedef struct StyBall {
  double centre[3], radius, reach; /* the last: how far from the origin it comes, along an axis */
  const StySphere *sphere;
} StyBall;

struct StyTracer {
  RTCDevice device;
  RTCScene scene;
  RTCScene *trees;   /* 1 per mesh; NULL where no object needs it */
  int *users;        /* objects of each mesh */
  StyPlaced *placed; /* 1 per object */
  StyBall *balls;    /* 1 per sphere */
  const StyScene *model;
  const StyKernels *kernels;
  const StyRun *run;                   /* while the trees are built */
  char message[256];                   /* what Embree complained about first */
  _Atomic long long bytes, most_bytes; /* Embree's own */
};

StyPlaced sty_place_object(const StyScene *scene, const StyObject *object);

#endif
