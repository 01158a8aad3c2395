/* Minimum cuts. Boykov, Kolmogorov, "An Experimental Comparison of Min-Cut/
 * Max-Flow Algorithms for Energy Minimization in Vision", 2004. */
#ifndef STYLUT_SRC_LUT_CUT_H
#define STYLUT_SRC_LUT_CUT_H

#include <stdbool.h>
#include <stdint.h>

/* A directed edge and, beside it, the one back. */
typedef struct StyCutArc {
  int head, next; /* node it leads to; the tail's next arc, -1: none */
  int32_t room;   /* what can still flow */
} StyCutArc;

typedef struct StyCutNode {
  int first;  /* arc, -1: none */
  int parent; /* arc toward the tree's root */
  int queued; /* next in the queue of active nodes; -1: last, -2: not queued */
  int stamp, distance;
  int32_t terminal; /* room from the source (above 0) or to the sink (below 0) */
  uint8_t side;     /* which tree it's in */
} StyCutNode;

typedef struct StyCut {
  StyCutNode *nodes;
  StyCutArc *arcs;
  int node_count, arc_count;
  int *orphans;
  int orphan_first, orphan_count, queue_first, queue_last, stamp;
} StyCut;

/* Room for so many nodes and (directed) edges. False: memory is short. */
bool sty_open_cut(int nodes, int edges, StyCut *out);
void sty_close_cut(StyCut *cut);

/* Empties it, for the next problem of `nodes` nodes. */
void sty_reset_cut(StyCut *cut, int nodes);

/* What it costs for a node to be on the source's side, or on the sink's. May be
 * called once per node. */
void sty_add_cut_costs(StyCut *cut, int node, int32_t source_side, int32_t sink_side);

/* What it costs for `tail` to be on the source's side and `head` on the sink's. */
void sty_add_cut_edge(StyCut *cut, int tail, int head, int32_t cost);

/* Finds the cheapest division. */
void sty_solve_cut(StyCut *cut);

/* After sty_solve_cut. Nodes that may be on either side count to the source's. */
bool sty_is_on_sink_side(const StyCut *cut, int node);

#endif
