#include "guide/bands.h"

#include <pthread.h>
#include <string.h>

/* A band is of so many values at most and of so many rows at least. Narrow ones are higher, so that they are worth the
 * handing over. */
static const size_t BAND_VALUES = (size_t)1 << 24, BAND_PIXELS = (size_t)1 << 16;
enum { ROW_STEP = 32, MOST_ROWS = 128, MOST_NARROW_ROWS = 8192 };

static size_t clamp(size_t value, size_t least, size_t most) {
  return value < least ? least : value > most ? most : value;
}

/* Rows on their way to the sink, in a thread of their own. */
typedef struct Delivery {
  const StyRowSink *sink;
  StyImage *rows;  /* owned */
  StyImage *spare; /* owned: rows that have arrived */
  pthread_t thread;
  bool threaded;
  StyStatus status;
  StyError error;
} Delivery;

static void *deliver(void *context) {
  Delivery *delivery = context;
  delivery->status = delivery->sink->take(delivery->sink->context, delivery->rows, &delivery->error);
  return NULL;
}

/* Waits for what is on its way. */
static StyStatus await_delivery(Delivery *delivery, StyError *error) {
  if (!delivery->rows) return STY_OK;
  if (delivery->threaded) pthread_join(delivery->thread, NULL);
  sty_destroy_image(&delivery->spare);
  delivery->spare = delivery->rows;
  delivery->rows = NULL;
  return delivery->status ? sty_fail(error, delivery->status, "%s", delivery->error.text) : STY_OK;
}

/* Takes the rows over. */
static void start_delivery(Delivery *delivery, StyImage *rows) {
  delivery->rows = rows;
  delivery->threaded = pthread_create(&delivery->thread, NULL, deliver, delivery) == 0;
  if (!delivery->threaded) deliver(delivery);
}

int sty_choose_band_rows(int width, int height) {
  const size_t most = clamp(BAND_PIXELS / (size_t)width / ROW_STEP * ROW_STEP, MOST_ROWS, MOST_NARROW_ROWS);
  const size_t held = BAND_VALUES / ((size_t)width * (1 + STY_GROUP_COUNT)) / ROW_STEP * ROW_STEP;
  const size_t rows = clamp(held, ROW_STEP, most);
  return rows < (size_t)height ? (int)rows : height;
}

/* A band to be filled: rows that have arrived before, whose memory is at hand, or new ones. */
static StyStatus open_band(const StyBands *bands, int rows, StyImage **spare, StyGuide *out, StyError *error) {
  if (!*spare || (*spare)->height != rows) return sty_create_guide(bands->width, rows, bands->groups, out, error);
  *out = sty_view_guide(*spare, bands->groups);
  *spare = NULL;
  return STY_OK;
}

static StyStatus make_band(const StyBands *bands, int first, int rows, const StyRun *run, StyImage **spare,
                           StyImage **out, StyError *error) {
  StyShare share = {run, (double)first / bands->height, (double)rows / bands->height};
  const StyRun own = sty_share_run(&share);
  StyGuide band = {0};
  StyStatus status = open_band(bands, rows, spare, &band, error);
  if (!status) status = bands->fill(bands->context, first, &band, &own, error);
  if (status)
    sty_destroy_image(&band.image);
  else
    *out = band.image;
  return status;
}

static StyStatus stream_bands(const StyBands *bands, const StyRun *run, Delivery *delivery, StyBandTimes *times,
                              StyError *error) {
  const int step = sty_choose_band_rows(bands->width, bands->height);
  for (int first = 0; first < bands->height; first += step) {
    const int rows = bands->height - first < step ? bands->height - first : step;
    StyImage *band = NULL;
    const double start = sty_get_milliseconds();
    StyStatus status = make_band(bands, first, rows, run, &delivery->spare, &band, error);
    if (status) return status;
    times->fill_ms += sty_get_milliseconds() - start;
    if (first == 0) times->first_ms = times->fill_ms;
    status = await_delivery(delivery, error);
    if (status) {
      sty_destroy_image(&band);
      return status;
    }
    start_delivery(delivery, band);
  }
  return STY_OK;
}

StyStatus sty_stream_bands(const StyBands *bands, const StyRun *run, const StyRowSink *sink, StyBandTimes *times,
                           StyError *error) {
  Delivery delivery = {.sink = sink};
  *times = (StyBandTimes){0};
  const StyStatus status = stream_bands(bands, run, &delivery, times, error);
  StyError cause;
  const StyStatus delivered = await_delivery(&delivery, status ? &cause : error);
  sty_destroy_image(&delivery.spare);
  return status ? status : delivered;
}
