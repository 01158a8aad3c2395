/* What a bundle's files hold, for those who write them and those who read
 * them. Plain constants; needs nothing.
 *
 * A bundle is a folder with bundle.json and five KTX2 files. Every file is a
 * 2D array texture (layerCount at least 1), one level, no supercompression,
 * orientation "rd" (row 0 is the top). */
#ifndef STYLUT_RUNTIME_FORMAT_H
#define STYLUT_RUNTIME_FORMAT_H

/* Vulkan's numbers for the formats in use (VkFormat). */
#define STY_VK_R8G8_UNORM 16u
#define STY_VK_R8G8B8A8_UNORM 37u
#define STY_VK_R8G8B8A8_SRGB 43u
#define STY_VK_R16G16_UNORM 77u
#define STY_VK_R32G32B32A32_SFLOAT 109u

/* The files, in the order in which they are handed to the runtime. */
enum {
  STY_BUNDLE_EXEMPLARS, /* R8G8B8A8_SRGB, a layer per exemplar (of a style with bases: its exemplars, then their
                           bases); all of one size */
  STY_BUNDLE_GUIDES,    /* R8G8B8A8_UNORM, a layer per style: bytes of n/2+1/2, A = mask; size as exemplars */
  STY_BUNDLE_LUTS,      /* R16G16_UNORM, a layer per style, square; see below */
  STY_BUNDLE_PARAMS,    /* R32G32B32A32_SFLOAT, width = styles, height = STY_PARAM_ROWS, 1 layer */
  STY_BUNDLE_JITTER,    /* R8G8_UNORM, STY_JITTER_SIZE squared, a layer per jitter frame */
  STY_BUNDLE_FILES
};

/* A LUT texel holds the source pixel (x, y) as R = round((x+1/2)/W*65535),
 * G = round((y+1/2)/H*65535), little-endian; x = R*W/65535, rounded down, at most W-1. */

#define STY_JITTER_SIZE 256
#define STY_MAX_STYLES 256
#define STY_MAX_LEVEL 12      /* top level: seed spacing up to 4096 pixels */
#define STY_MAX_RADIUS 8      /* blend radius, pixels */
#define STY_MAX_THRESHOLD 766 /* above every possible error (3 * 255) */
#define STY_MAX_LIGHTINGS 4   /* exemplars of one style */
#define STY_MAX_LUMA_WEIGHT 16
#define STY_MAX_PERIOD 65535 /* frames that one jitter table lasts */
#define STY_MAX_SCATTER 64   /* source pixels */
#define STY_MAX_SOURCE_SIDE 32768
#define STY_MAX_LUT_SIDE 8192

/* Parameters: texel (style-1, row), components R G B A. What they mean: StyStyle in runtime.h.
 * row 0: threshold, top level, blend radius, depth tolerance (scene units; 0 = off)
 * row 1: luminance weight, colour weight, first layer, layer count
 * row 2: luminance of layers 0..3
 * row 3: jitter amount, jitter period in frames, exemplar scale, flags
 * row 4: scatter, 0, 0, 0 */
#define STY_PARAM_ROWS 5

/* Flags, an integer held in float. */
#define STY_FLAG_UNORM8 1u  /* LUT texel i answers for byte value i; else texel centres */
#define STY_FLAG_OBJECTS 2u /* votes of other objects are dropped */
#define STY_FLAG_BASE 4u    /* low frequencies by lit sphere: the layers behind the exemplars are their bases */
#define STY_KNOWN_FLAGS (STY_FLAG_UNORM8 | STY_FLAG_OBJECTS | STY_FLAG_BASE)

#endif
