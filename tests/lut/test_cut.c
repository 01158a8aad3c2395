#include "lut/cut.h"

#include "../scratch.h"

enum { MOST_NODES = 9, MOST_EDGES = 40 };

typedef struct Problem {
  int nodes, edges;
  int32_t costs[MOST_NODES][2]; /* on the source's side, on the sink's */
  int tails[MOST_EDGES], heads[MOST_EDGES];
  int32_t edge_costs[MOST_EDGES];
} Problem;

/* `sides`: one bit a node, set on the sink's side. */
static int64_t get_cost(const Problem *p, unsigned sides) {
  int64_t sum = 0;
  for (int n = 0; n < p->nodes; n++) sum += p->costs[n][sides >> n & 1];
  for (int e = 0; e < p->edges; e++)
    if (!(sides >> p->tails[e] & 1) && (sides >> p->heads[e] & 1)) sum += p->edge_costs[e];
  return sum;
}

static Problem draw_problem(uint64_t *random) {
  Problem p = {.nodes = 1 + draw_below(random, MOST_NODES)};
  const int largest = draw_below(random, 2) ? 3 : 1000; /* small costs make ties */
  for (int n = 0; n < p.nodes; n++)
    for (int side = 0; side < 2; side++) p.costs[n][side] = draw_below(random, 3) ? draw_below(random, largest) : 0;
  p.edges = p.nodes > 1 ? draw_below(random, MOST_EDGES + 1) : 0;
  for (int e = 0; e < p.edges; e++) {
    p.tails[e] = draw_below(random, p.nodes);
    p.heads[e] = (p.tails[e] + 1 + draw_below(random, p.nodes - 1)) % p.nodes;
    p.edge_costs[e] = draw_below(random, largest);
  }
  return p;
}

static unsigned solve(StyCut *cut, const Problem *p) {
  sty_reset_cut(cut, p->nodes);
  for (int n = 0; n < p->nodes; n++) sty_add_cut_costs(cut, n, p->costs[n][0], p->costs[n][1]);
  for (int e = 0; e < p->edges; e++) sty_add_cut_edge(cut, p->tails[e], p->heads[e], p->edge_costs[e]);
  sty_solve_cut(cut);
  unsigned sides = 0;
  for (int n = 0; n < p->nodes; n++) sides |= (unsigned)sty_is_on_sink_side(cut, n) << n;
  return sides;
}

/* Against every division there is; one cut serves all problems, as it does in use. */
static void test_small_graphs(void **state) {
  (void)state;
  StyCut cut;
  uint64_t random = 1;
  assert_true(sty_open_cut(MOST_NODES, MOST_EDGES, &cut));
  for (int trial = 0; trial < 20000; trial++) {
    const Problem p = draw_problem(&random);
    int64_t least = INT64_MAX;
    for (unsigned sides = 0; sides < 1u << p.nodes; sides++) {
      const int64_t cost = get_cost(&p, sides);
      least = cost < least ? cost : least;
    }
    const int64_t found = get_cost(&p, solve(&cut, &p));
    if (found != least) fail_msg("trial %d: cost %lld instead of %lld", trial, (long long)found, (long long)least);
  }
  sty_close_cut(&cut);
}

/* A long chain and a wide grid: deep trees, many orphans. The answer is known:
 * one end wants the source, the other the sink, and the cheapest edge is cut. */
static void test_chain(void **state) {
  (void)state;
  enum { LENGTH = 20000, WEAKEST = 12345 };
  StyCut cut;
  assert_true(sty_open_cut(LENGTH, LENGTH, &cut));
  sty_reset_cut(&cut, LENGTH);
  sty_add_cut_costs(&cut, 0, 0, 1000000);
  sty_add_cut_costs(&cut, LENGTH - 1, 1000000, 0);
  for (int n = 0; n + 1 < LENGTH; n++) sty_add_cut_edge(&cut, n, n + 1, n == WEAKEST ? 3 : 5 + n % 7);
  sty_solve_cut(&cut);
  for (int n = 0; n < LENGTH; n++) assert_int_equal(sty_is_on_sink_side(&cut, n), n > WEAKEST);
  sty_close_cut(&cut);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_small_graphs), cmocka_unit_test(test_chain)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
