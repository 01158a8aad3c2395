/* A bundle's index: the fuzzer's bytes are bundle.json, beside textures that
 * are there but nothing more. (Textures have a target of their own.) */
#include "fuzz.h"
#include "stylut/pack.h"

static void take_finding(void *context, const StyFinding *finding) {
  int *errors = context;
  require(finding->number >= STY_FINDING_INDEX && finding->number <= STY_FINDING_BACKGROUND);
  require(*finding->file && *finding->text);
  *errors += !finding->warning;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static bool prepared;
  for (int i = 0; !prepared && i < STY_BUNDLE_FILES; i++) put_file(sty_bundle_files[i], (const uint8_t *)"?", 1);
  prepared = true;
  put_file(STY_BUNDLE_INDEX, data, size);
  StyLoadedBundle bundle;
  StyError error;
  int errors = 0;
  const StyStatus status = sty_load_bundle(get_folder(), take_finding, &errors, &bundle, &error);
  require(status && errors);
  require_message(status, &error);
  return 0;
}
