#include "audit/stored.h"

size_t sty_count_bytes(const StyLutSpec *spec, StyEncoding encoding) {
  const size_t texel = encoding == STY_ENCODE_F32 ? 8 : encoding == STY_ENCODE_RG8 ? 2 : 4;
  return sty_count_texels(spec) * texel;
}

StyStatus sty_restore_lut(const StyLut *lut, StyEncoding encoding, StyLut **out, StyError *error) {
  const StyLutHints hints = {.sampling = -1};
  StyImage *image = NULL;
  StyStatus status = sty_encode_lut(lut, encoding, &image, error);
  if (!status) status = sty_decode_lut("LUT", image, &hints, out, error);
  sty_destroy_image(&image);
  return status;
}
