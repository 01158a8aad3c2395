/* The transfer's loop over runs, for the files that include it (one per vector unit). Before that each defines
 *   UNIT(name), what its functions are called;
 *   static int count_alike(const uint8_t *guide, int most): pixels from the first on that are covered if it is, and
 *     aren't if it isn't; at least 1;
 *   static void empty_matches(StyMatch *, int count): no_match in all;
 *   static void match_run(const Run *). */

/* Pixels from the first on that are stylized as it is, and have its object where that matters. */
static int measure_run(const StyBundle *bundle, const StyFrame *frame, int style, size_t first, int most) {
  const int alike = count_alike(frame->guide + 4 * first, most);
  if (!frame->styles && !frame->anchors) return alike;
  int length = 1;
  while (length < alike && get_pixel_style(bundle, frame, first + (size_t)length) == style &&
         (!frame->anchors || get_object(frame, first + (size_t)length) == get_object(frame, first)))
    length++;
  return length;
}

StyRuntimeStatus UNIT(transfer)(const StyBundle *bundle, const StyFrame *frame, StyRect rect, StyMatch *matches) {
  OpenSources open;
  memset(open.styles, 0, sizeof open.styles);
  Run run = {.frame = frame};
  for (run.y = rect.y0; run.y < rect.y1; run.y++)
    for (run.x = rect.x0; run.x < rect.x1; run.x += run.length) {
      run.first = get_pixel_index(frame, run.x, run.y);
      run.matches = matches + run.first;
      const int style = get_pixel_style(bundle, frame, run.first);
      run.length = measure_run(bundle, frame, style, run.first, rect.x1 - run.x);
      if (style == 0) {
        empty_matches(run.matches, run.length);
        continue;
      }
      if (run.length > RUN_LENGTH) run.length = RUN_LENGTH;
      const StyRuntimeStatus status = find_source(bundle, frame, style, &open, &run.source);
      if (status != STY_RUNTIME_OK) return status;
      run.anchor = get_anchor(frame, run.first);
      match_run(&run);
    }
  return STY_RUNTIME_OK;
}
