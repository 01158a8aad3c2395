/* OpenImageIO's handler of libpng's errors returns, whereupon libpng prints
 * "libpng error: ..." on stderr and leaves by itself. stylut says one line per
 * failure, its own. So this module answers first when OpenImageIO sets its
 * handlers, and sets quiet ones that leave at once. */
#include <dlfcn.h>
#include <png.h>

static void leave(png_structp png, png_const_charp message) {
  (void)message;
  png_longjmp(png, 1);
}

static void ignore(png_structp png, png_const_charp message) {
  (void)png;
  (void)message;
}

void png_set_error_fn(png_structrp png, png_voidp error_pointer, png_error_ptr error_function,
                      png_error_ptr warning_function) {
  (void)error_function;
  (void)warning_function;
  /* libpng's own function of this name; it is loaded, as OpenImageIO needs it. */
  void *library = dlopen("libpng16.so.16", RTLD_NOW | RTLD_NOLOAD);
  union {
    void *object;
    void (*function)(png_structrp, png_voidp, png_error_ptr, png_error_ptr);
  } original = {library ? dlsym(library, "png_set_error_fn") : NULL};
  if (original.object) original.function(png, error_pointer, leave, ignore);
}
