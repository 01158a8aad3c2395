/* The commands, one file each. argv[0] is "stylut NAME" for messages. */
#ifndef STYLUT_TOOLS_COMMANDS_H
#define STYLUT_TOOLS_COMMANDS_H

#include "stylut/status.h"

StyStatus run_guide(int argc, char **argv);
StyStatus run_guide_sphere(int argc, char **argv);
StyStatus run_guide_scene(int argc, char **argv);
StyStatus run_guide_import(int argc, char **argv);
StyStatus run_guide_strokes(int argc, char **argv);
StyStatus run_guide_warp(int argc, char **argv);
StyStatus run_guide_flow(int argc, char **argv);
StyStatus run_lut(int argc, char **argv);
StyStatus run_check(int argc, char **argv);
StyStatus run_report(int argc, char **argv);
StyStatus run_pack(int argc, char **argv);
StyStatus run_params(int argc, char **argv);
StyStatus run_batch(int argc, char **argv);
StyStatus run_step(int argc, char **argv);
StyStatus run_unpack(int argc, char **argv);
StyStatus run_stylize(int argc, char **argv);
StyStatus run_toon(int argc, char **argv);
StyStatus run_outline(int argc, char **argv);
StyStatus run_match(int argc, char **argv);
StyStatus run_info(int argc, char **argv);
StyStatus run_validate(int argc, char **argv);
StyStatus run_compare(int argc, char **argv);
StyStatus run_probe(int argc, char **argv);
StyStatus run_chart(int argc, char **argv);
StyStatus run_doctor(int argc, char **argv);
StyStatus run_init(int argc, char **argv);
StyStatus run_bench(int argc, char **argv);

#endif
