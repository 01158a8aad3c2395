#include "lut/cut.h"

#include <stdlib.h>

enum { FREE, SOURCE, SINK };
enum { NO_PARENT = -1, TERMINAL = -2, ORPHAN = -3 };
enum { LAST = -1, NOT_QUEUED = -2 };

bool sty_open_cut(int nodes, int edges, StyCut *out) {
  *out = (StyCut){.nodes = malloc((size_t)nodes * sizeof *out->nodes),
                  .arcs = malloc(2 * (size_t)edges * sizeof *out->arcs),
                  .orphans = malloc((size_t)nodes * sizeof *out->orphans)};
  if (out->nodes && out->arcs && out->orphans) return true;
  sty_close_cut(out);
  return false;
}

void sty_close_cut(StyCut *cut) {
  free(cut->nodes);
  free(cut->arcs);
  free(cut->orphans);
  *cut = (StyCut){0};
}

void sty_reset_cut(StyCut *cut, int nodes) {
  cut->node_count = nodes;
  cut->arc_count = 0;
  for (int n = 0; n < nodes; n++)
    cut->nodes[n] = (StyCutNode){.first = -1, .parent = NO_PARENT, .queued = NOT_QUEUED, .side = FREE};
}

void sty_add_cut_costs(StyCut *cut, int node, int32_t source_side, int32_t sink_side) {
  /* Cutting the edge from the source puts a node on the sink's side. */
  cut->nodes[node].terminal += sink_side - source_side;
}

static void add_arc(StyCut *cut, int tail, int head, int32_t room) {
  cut->arcs[cut->arc_count] = (StyCutArc){head, cut->nodes[tail].first, room};
  cut->nodes[tail].first = cut->arc_count++;
}

void sty_add_cut_edge(StyCut *cut, int tail, int head, int32_t cost) {
  add_arc(cut, tail, head, cost);
  add_arc(cut, head, tail, 0);
}

/* ---- the queue of active nodes ------------------------------------------------ */

static void activate(StyCut *cut, int node) {
  if (cut->nodes[node].queued != NOT_QUEUED) return;
  cut->nodes[node].queued = LAST;
  if (cut->queue_last >= 0)
    cut->nodes[cut->queue_last].queued = node;
  else
    cut->queue_first = node;
  cut->queue_last = node;
}

/* The first node that is still in a tree, or -1. It stays queued. */
static int get_active(StyCut *cut) {
  while (cut->queue_first >= 0 && cut->nodes[cut->queue_first].parent == NO_PARENT) {
    const int node = cut->queue_first;
    cut->queue_first = cut->nodes[node].queued;
    cut->nodes[node].queued = NOT_QUEUED;
    if (cut->queue_first < 0) cut->queue_last = -1;
  }
  return cut->queue_first;
}

static void retire(StyCut *cut, int node) {
  cut->queue_first = cut->nodes[node].queued;
  cut->nodes[node].queued = NOT_QUEUED;
  if (cut->queue_first < 0) cut->queue_last = -1;
}

/* ---- growing ------------------------------------------------------------------ */

/* What can flow along an arc as seen from a tree: away from the source, or toward the sink. */
static int32_t get_room(const StyCut *cut, int arc, int side) { return cut->arcs[side == SOURCE ? arc : arc ^ 1].room; }

/* Grows a tree by a node's neighbours; the arc from the source's tree to the
 * sink's where they meet, or -1. */
static int grow(StyCut *cut, int node) {
  StyCutNode *nodes = cut->nodes;
  const int side = nodes[node].side;
  for (int a = nodes[node].first; a >= 0; a = cut->arcs[a].next) {
    if (get_room(cut, a, side) <= 0) continue;
    StyCutNode *other = &nodes[cut->arcs[a].head];
    if (other->side == FREE || other->parent == NO_PARENT) {
      other->side = (uint8_t)side;
      other->parent = a ^ 1;
      other->stamp = nodes[node].stamp;
      other->distance = nodes[node].distance + 1;
      activate(cut, cut->arcs[a].head);
    } else if (other->side != side) {
      return side == SOURCE ? a : a ^ 1;
    } else if (other->stamp <= nodes[node].stamp && other->distance > nodes[node].distance + 1) {
      /* A shorter way to the root. */
      other->parent = a ^ 1;
      other->stamp = nodes[node].stamp;
      other->distance = nodes[node].distance + 1;
    }
  }
  return -1;
}

/* ---- augmenting --------------------------------------------------------------- */

static int32_t least(int32_t a, int32_t b) { return a < b ? a : b; }

/* The narrowest place between a node and its tree's root. */
static int32_t find_bottleneck(const StyCut *cut, int node, int side, int32_t room) {
  for (int parent; (parent = cut->nodes[node].parent) != TERMINAL; node = cut->arcs[parent].head)
    room = least(room, cut->arcs[side == SOURCE ? parent ^ 1 : parent].room);
  return least(room, side == SOURCE ? cut->nodes[node].terminal : -cut->nodes[node].terminal);
}

/* Orphans wait in a ring; none is in it twice. */
static void make_orphan(StyCut *cut, int node) {
  cut->nodes[node].parent = ORPHAN;
  cut->orphans[(cut->orphan_first + cut->orphan_count++) % cut->node_count] = node;
}

static int take_orphan(StyCut *cut) {
  const int node = cut->orphans[cut->orphan_first];
  cut->orphan_first = (cut->orphan_first + 1) % cut->node_count;
  cut->orphan_count--;
  return node;
}

static void push_to_root(StyCut *cut, int node, int side, int32_t flow) {
  for (int parent; (parent = cut->nodes[node].parent) != TERMINAL;) {
    const int down = side == SOURCE ? parent ^ 1 : parent;
    const int up = cut->arcs[parent].head;
    cut->arcs[down].room -= flow;
    cut->arcs[down ^ 1].room += flow;
    if (cut->arcs[down].room == 0) make_orphan(cut, node);
    node = up;
  }
  cut->nodes[node].terminal -= side == SOURCE ? flow : -flow;
  if (cut->nodes[node].terminal == 0) make_orphan(cut, node);
}

/* Sends what the path through `arc` can carry; it leaves orphans. */
static void augment(StyCut *cut, int arc) {
  const int tail = cut->arcs[arc ^ 1].head, head = cut->arcs[arc].head;
  int32_t flow = find_bottleneck(cut, tail, SOURCE, cut->arcs[arc].room);
  flow = find_bottleneck(cut, head, SINK, flow);
  cut->arcs[arc].room -= flow;
  cut->arcs[arc ^ 1].room += flow;
  push_to_root(cut, tail, SOURCE, flow);
  push_to_root(cut, head, SINK, flow);
}

/* ---- adopting ----------------------------------------------------------------- */

enum { FAR = INT32_MAX / 2 };

/* How far the root is, or FAR where the way ends at an orphan. Nodes on the way
 * are stamped, so that they need not be followed again. */
static int measure_origin(StyCut *cut, int node) {
  int distance = 0, at = node;
  for (;;) {
    if (cut->nodes[at].stamp == cut->stamp) {
      distance += cut->nodes[at].distance;
      break;
    }
    const int parent = cut->nodes[at].parent;
    distance++;
    if (parent == TERMINAL) {
      cut->nodes[at].stamp = cut->stamp;
      cut->nodes[at].distance = 1;
      break;
    }
    if (parent == ORPHAN || parent == NO_PARENT) return FAR;
    at = cut->arcs[parent].head;
  }
  for (int walk = node, left = distance; cut->nodes[walk].stamp != cut->stamp;
       walk = cut->arcs[cut->nodes[walk].parent].head) {
    cut->nodes[walk].stamp = cut->stamp;
    cut->nodes[walk].distance = left--;
  }
  return distance;
}

/* The arc from `node` to the nearest node of its tree that has a way to the root, or NO_PARENT. */
static int find_parent(StyCut *cut, int node) {
  const int side = cut->nodes[node].side;
  int best = NO_PARENT, nearest = FAR;
  for (int a = cut->nodes[node].first; a >= 0; a = cut->arcs[a].next) {
    const int other = cut->arcs[a].head;
    if (cut->arcs[side == SOURCE ? a ^ 1 : a].room <= 0) continue;
    if (cut->nodes[other].side != side || cut->nodes[other].parent == NO_PARENT) continue;
    const int distance = measure_origin(cut, other);
    if (distance >= nearest) continue;
    best = a;
    nearest = distance;
  }
  if (best != NO_PARENT) {
    cut->nodes[node].stamp = cut->stamp;
    cut->nodes[node].distance = nearest + 1;
  }
  return best;
}

/* Sets a node free; its children become orphans, its neighbours may grow toward it. */
static void abandon(StyCut *cut, int node) {
  const int side = cut->nodes[node].side;
  for (int a = cut->nodes[node].first; a >= 0; a = cut->arcs[a].next) {
    const int other = cut->arcs[a].head;
    if (cut->nodes[other].side != side || cut->nodes[other].parent == NO_PARENT) continue;
    if (cut->arcs[side == SOURCE ? a ^ 1 : a].room > 0) activate(cut, other);
    const int parent = cut->nodes[other].parent;
    if (parent >= 0 && cut->arcs[parent].head == node) make_orphan(cut, other);
  }
  cut->nodes[node].parent = NO_PARENT;
  cut->nodes[node].side = FREE;
}

static void adopt_orphans(StyCut *cut) {
  cut->stamp++;
  while (cut->orphan_count) {
    const int node = take_orphan(cut);
    const int parent = find_parent(cut, node);
    if (parent != NO_PARENT)
      cut->nodes[node].parent = parent;
    else
      abandon(cut, node);
  }
}

/* ---- the whole ---------------------------------------------------------------- */

void sty_solve_cut(StyCut *cut) {
  cut->queue_first = cut->queue_last = -1;
  cut->orphan_first = cut->orphan_count = 0;
  cut->stamp = 1;
  for (int n = 0; n < cut->node_count; n++) {
    StyCutNode *node = &cut->nodes[n];
    if (node->terminal == 0) continue;
    node->side = node->terminal > 0 ? SOURCE : SINK;
    node->parent = TERMINAL;
    node->distance = 1;
    activate(cut, n);
  }
  for (int node; (node = get_active(cut)) >= 0;) {
    const int arc = grow(cut, node);
    if (arc < 0) {
      retire(cut, node);
      continue;
    }
    augment(cut, arc);
    adopt_orphans(cut);
  }
}

bool sty_is_on_sink_side(const StyCut *cut, int node) { return cut->nodes[node].side == SINK; }
