#include "bridge/neighbours.h"

#ifndef STY_WITH_CGAL

StyStatus sty_open_neighbours(const float *, size_t, int, StyNeighbours **, StyError *error) {
  return sty_fail(error, STY_ERROR_UNAVAILABLE, "engine cgal: stylut was built without CGAL");
}
void sty_close_neighbours(StyNeighbours **) {}
int sty_find_neighbours(const StyNeighbours *, const float *, int, int *) { return -1; }
int sty_find_neighbours_within(const StyNeighbours *, const float *, double, int, int *) { return -1; }

#else

#include <CGAL/Fuzzy_sphere.h>
#include <CGAL/Kd_tree.h>
#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_2.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <iterator>
#include <utility>
#include <vector>

#include "bridge/guard.h"

/* What 2 and 3 dimensions have in common. */
struct StyNeighbours {
  virtual ~StyNeighbours() = default;
  virtual int find(const float *at, int count, int *found) const = 0;
  virtual int find_within(const float *at, double radius, int most, int *found) const = 0;
};

namespace {

using Kernel = CGAL::Simple_cartesian<double>;

struct Plane {
  using Point = Kernel::Point_2;
  using Traits = CGAL::Search_traits_2<Kernel>;
  static Point make(const float *v) { return {v[0], v[1]}; }
};

struct Space {
  using Point = Kernel::Point_3;
  using Traits = CGAL::Search_traits_3<Kernel>;
  static Point make(const float *v) { return {v[0], v[1], v[2]}; }
};

/* Takes the first `most` indices and counts on, so that a crowd is noticed. */
class IndexTaker {
 public:
  using iterator_category = std::output_iterator_tag;
  using value_type = void;
  using difference_type = void;
  using pointer = void;
  using reference = void;
  IndexTaker(int *indices, int room, int *taken) : found(indices), most(room), count(taken) {}
  IndexTaker &operator*() { return *this; }
  IndexTaker &operator++() { return *this; }
  IndexTaker &operator++(int) { return *this; }
  template <class Item>
  IndexTaker &operator=(const Item &item) {
    if (*count < most) found[(*count)++] = item.second;
    return *this;
  }

 private:
  int *found, most, *count;
};

template <class Frame>
struct Tree final : StyNeighbours {
  using Item = std::pair<typename Frame::Point, int>;
  using Traits = CGAL::Search_traits_adapter<Item, CGAL::First_of_pair_property_map<Item>, typename Frame::Traits>;
  using Search = CGAL::Orthogonal_k_neighbor_search<Traits>;
  using Sphere = CGAL::Fuzzy_sphere<Traits>;
  using Index = typename Search::Tree;
  Index index;

  Tree(const float *values, std::size_t count, int dims) {
    std::vector<Item> items;
    items.reserve(count);
    for (std::size_t i = 0; i < count; i++)
      items.emplace_back(Frame::make(values + static_cast<std::size_t>(dims) * i), static_cast<int>(i));
    index.insert(items.begin(), items.end());
    index.build();
  }

  int find(const float *at, int count, int *found) const override {
    Search search(index, Frame::make(at), static_cast<unsigned>(count));
    int n = 0;
    for (auto it = search.begin(); it != search.end() && n < count; ++it) found[n++] = it->first.second;
    return n;
  }

  int find_within(const float *at, double radius, int most, int *found) const override {
    int count = 0;
    index.search(IndexTaker(found, most, &count), Sphere(Item(Frame::make(at), 0), radius));
    return count;
  }
};

}  // namespace

StyStatus sty_open_neighbours(const float *values, size_t count, int dims, StyNeighbours **out, StyError *error) {
  return guard("engine cgal", static_cast<double>(count) * 64.0, error, [&] {
    if (dims == 2)
      *out = new Tree<Plane>(values, count, dims);
    else
      *out = new Tree<Space>(values, count, dims);
    return STY_OK;
  });
}

void sty_close_neighbours(StyNeighbours **tree) {
  delete *tree;
  *tree = nullptr;
}

int sty_find_neighbours(const StyNeighbours *tree, const float *at, int count, int *found) {
  try {
    return tree->find(at, count, found);
  } catch (...) {
    return -1;
  }
}

int sty_find_neighbours_within(const StyNeighbours *tree, const float *at, double radius, int most, int *found) {
  try {
    return tree->find_within(at, radius, most, found);
  } catch (...) {
    return -1;
  }
}

#endif
