/* FLANN shuffles by the system's chance. In this program chance is the same each
 * time, and so is what is said of a forest. */
#include <random>

std::random_device::result_type std::random_device::_M_getval() { return 1; }
