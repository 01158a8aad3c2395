/* The zoo in small: every engine on every guide of up to 65,536 pixels. Raw
 * libraries, which crash, and guides of a million pixels are for zoo.c (`make zoo`). */
#include "../scratch.h"
#include "cases.h"
#include "judge.h"

/* flann-auto looks at all points for each of a sample: `make zoo` has the time for more. */
static bool is_left_out(const StyEngine *engine, const StySites *sites) {
  return strcmp(engine->name, "flann-auto") == 0 && sites->count > 5000;
}

static void expect_kept(const ZooCase *zoo, bool noisy, const ZooVerdict *verdict) {
  if (is_claim_broken(verdict)) fail_msg("%s%s: %s", zoo->name, noisy ? ", noisy" : "", verdict->note);
}

static StyLut *build_reference(const StySites *sites, int look, int size) {
  const StyLutSpec spec = describe_zoo_look(look, size);
  StyLut *lut = NULL;
  assert_int_equal(sty_build_lut(sites, &sty_engines[0], NULL, &spec, NULL, &lut, NULL), STY_OK);
  return lut;
}

static void expect_claims(const ZooCase *zoo, bool noisy, const StyImage *guide, const StySites *sites) {
  enum { SIZE = 16 };
  for (int look = 0; look < ZOO_LOOKS; look += CASES(1, 3)) {
    StyLut *reference = build_reference(sites, look, SIZE);
    for (const StyEngine *engine = sty_engines; engine->name; engine++) {
      if (is_left_out(engine, sites)) continue;
      ZooVerdict verdict = {0};
      judge_engine(guide, sites, engine, reference, &verdict);
      expect_kept(zoo, noisy, &verdict);
    }
    ZooVerdict verdict = {0};
    judge_resolve(guide, sites, reference, &verdict);
    judge_audit(guide, reference, (StyWeights)(look % 3), &verdict);
    expect_kept(zoo, noisy, &verdict);
    sty_destroy_lut(&reference);
  }
}

static void expect_refused_questions(const ZooCase *zoo, const StySites *sites) {
  for (const StyEngine *engine = sty_engines; engine->name; engine++) {
    ZooVerdict verdict = {0};
    judge_question(sites, engine, zoo->asked, zoo->refusal, &verdict);
    expect_kept(zoo, false, &verdict);
  }
}

static void expect_case(const ZooCase *zoo, bool noisy) {
  StyImage *guide = make_zoo_guide(zoo, noisy);
  assert_non_null(guide);
  if (is_zoo_refused(zoo, noisy) && !zoo->asked) {
    ZooVerdict verdict = {0};
    judge_refusal(guide, zoo->refusal, &verdict);
    expect_kept(zoo, noisy, &verdict);
  } else {
    StySites *sites = NULL;
    assert_int_equal(sty_collect_sites(zoo->name, guide, &sites, NULL), STY_OK);
    if (zoo->asked)
      expect_refused_questions(zoo, sites);
    else
      expect_claims(zoo, noisy, guide, sites);
    sty_destroy_sites(&sites);
  }
  sty_destroy_image(&guide);
}

static void test_guides(void **state) {
  (void)state;
  for (const ZooCase *zoo = zoo_cases; zoo->name; zoo++)
    if (!is_zoo_case_large(zoo)) expect_case(zoo, false);
}

static void test_guides_with_noise(void **state) {
  (void)state;
  for (const ZooCase *zoo = zoo_cases; zoo->name; zoo++)
    if (!is_zoo_case_large(zoo)) expect_case(zoo, true);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_guides), cmocka_unit_test(test_guides_with_noise)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
