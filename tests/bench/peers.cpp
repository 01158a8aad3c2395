#include "peers.h"

#include <CGAL/Kd_tree.h>
#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_2.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>
#include <flann/flann.hpp>

#include <chrono>
#include <exception>
#include <nanoflann.hpp>
#include <string>
#include <utility>
#include <vector>

namespace {

class Watch {
 public:
  double get_milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }

 private:
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
};

struct Cloud {
  const float *points;
  std::size_t count;
  std::size_t kdtree_get_point_count() const { return count; }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[2 * i + axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box &) const {
    return false;
  }
};

constexpr int leaf_size = 10;

double run_nanoflann(const float *points, std::size_t count, const float *queries, std::size_t query_count,
                     int *nearest) {
  using Metric = nanoflann::L2_Simple_Adaptor<float, Cloud>;
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<Metric, Cloud, 2, unsigned>;
  const Cloud cloud{points, count};
  const Watch watch;
  Tree tree(2, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(leaf_size));
  tree.buildIndex();
  for (std::size_t q = 0; q < query_count; q++) {
    unsigned index = 0;
    float distance = 0;
    nearest[q] = tree.knnSearch(queries + 2 * q, 1, &index, &distance) ? static_cast<int>(index) : -1;
  }
  return watch.get_milliseconds();
}

double search_flann(const flann::IndexParams &kind, int checks, const float *points, std::size_t count,
                    const float *queries, std::size_t query_count, int *nearest) {
  std::vector<float> distances(query_count);
  const Watch watch;
  flann::Index<flann::L2_Simple<float>> index(flann::Matrix<float>(const_cast<float *>(points), count, 2), kind);
  index.buildIndex();
  flann::Matrix<int> found(nearest, query_count, 1);
  flann::Matrix<float> apart(distances.data(), query_count, 1);
  flann::SearchParams parameters(checks);
  parameters.cores = 1;
  index.knnSearch(flann::Matrix<float>(const_cast<float *>(queries), query_count, 2), found, apart, 1, parameters);
  return watch.get_milliseconds();
}

double run_flann(const float *points, std::size_t count, const float *queries, std::size_t query_count, int *nearest) {
  return search_flann(flann::KDTreeSingleIndexParams(leaf_size), flann::FLANN_CHECKS_UNLIMITED, points, count, queries,
                      query_count, nearest);
}

double run_flann_forest(const float *points, std::size_t count, const float *queries, std::size_t query_count,
                        int *nearest) {
  return search_flann(flann::KDTreeIndexParams(4), 32, points, count, queries, query_count, nearest);
}

double run_flann_linear(const float *points, std::size_t count, const float *queries, std::size_t query_count,
                        int *nearest) {
  return search_flann(flann::LinearIndexParams(), flann::FLANN_CHECKS_UNLIMITED, points, count, queries, query_count,
                      nearest);
}

double run_cgal(const float *points, std::size_t count, const float *queries, std::size_t query_count, int *nearest) {
  using Kernel = CGAL::Simple_cartesian<float>;
  using Item = std::pair<Kernel::Point_2, int>;
  using Traits =
      CGAL::Search_traits_adapter<Item, CGAL::First_of_pair_property_map<Item>, CGAL::Search_traits_2<Kernel>>;
  using Search = CGAL::Orthogonal_k_neighbor_search<Traits>;
  const Watch watch;
  std::vector<Item> items;
  items.reserve(count);
  for (std::size_t i = 0; i < count; i++)
    items.emplace_back(Kernel::Point_2(points[2 * i], points[2 * i + 1]), static_cast<int>(i));
  Search::Tree tree(items.begin(), items.end());
  tree.build();
  for (std::size_t q = 0; q < query_count; q++) {
    Search search(tree, Kernel::Point_2(queries[2 * q], queries[2 * q + 1]), 1);
    nearest[q] = search.begin()->first.second;
  }
  return watch.get_milliseconds();
}

double guard(Peer *run, const float *points, std::size_t count, const float *queries, std::size_t query_count,
             int *nearest) {
  try {
    return run(points, count, queries, query_count, nearest);
  } catch (const std::exception &) {
    return -1;
  }
}

}  // namespace

const char *get_nanoflann_version() {
  /* 0xABC is A.B.C. */
  static const std::string version = std::to_string(NANOFLANN_VERSION >> 8) + "." +
                                     std::to_string(NANOFLANN_VERSION >> 4 & 15) + "." +
                                     std::to_string(NANOFLANN_VERSION & 15);
  return version.c_str();
}

double search_with_nanoflann(const float *points, size_t count, const float *queries, size_t query_count,
                             int *nearest) {
  return guard(run_nanoflann, points, count, queries, query_count, nearest);
}

double search_with_flann(const float *points, size_t count, const float *queries, size_t query_count, int *nearest) {
  return guard(run_flann, points, count, queries, query_count, nearest);
}

double search_with_flann_forest(const float *points, size_t count, const float *queries, size_t query_count,
                                int *nearest) {
  return guard(run_flann_forest, points, count, queries, query_count, nearest);
}

double search_with_flann_linear(const float *points, size_t count, const float *queries, size_t query_count,
                                int *nearest) {
  return guard(run_flann_linear, points, count, queries, query_count, nearest);
}

double search_with_cgal(const float *points, size_t count, const float *queries, size_t query_count, int *nearest) {
  return guard(run_cgal, points, count, queries, query_count, nearest);
}
