// What every door to CGAL ends its C++ with: exceptions become a status.
#ifndef STYLUT_BRIDGE_GUARD_H
#define STYLUT_BRIDGE_GUARD_H

#include <exception>
#include <new>

#include "stylut/status.h"

// The status of body(); where it throws, that of memory for `what`, of which it takes about so many bytes, or CGAL's.
template <class Body>
StyStatus guard(const char *what, double bytes, StyError *error, const Body &body) {
  try {
    return body();
  } catch (const std::bad_alloc &) {
    return sty_fail_memory(error, what, bytes);
  } catch (const std::exception &exception) {
    return sty_fail(error, STY_ERROR_LIBRARY, "CGAL: %s", exception.what());
  } catch (...) {
    return sty_fail(error, STY_ERROR_LIBRARY, "CGAL: unknown exception");
  }
}

#endif
