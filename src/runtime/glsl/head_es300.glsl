#version 300 es
/* Samplers that aren't named here have no precision or a low one, which loses bytes. */
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp isampler2D;
precision highp usampler2D;
precision highp sampler2DArray;
precision highp usampler2DArray;
