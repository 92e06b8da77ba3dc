#pragma once
// Rows on the backend as columns of a checkpoint (base/columns.hpp). A walk() names every member once, and saves or
// loads it.
#include <functional>

#include "base/columns.hpp"
#include "dem/core/rows.hpp"
#include "dem/core/snapshot.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

class ToColumns : public base::Saver {
 public:
  using base::Saver::rows;
  using base::Saver::Saver;
  template <class T>
  void rows(const std::string& name, const Vector<T>& rows_of) {
    rows(name, download(rows_of));
  }
};

/// The same without waiting for rows: what is left to do when the snapshot is there.
class ToColumnsLater : public base::Saver {
 public:
  using base::Saver::rows;
  ToColumnsLater(base::Columns& now, Snapshot& snapshot, Queue& queue)
      : base::Saver(now), snapshot_(snapshot), queue_(queue) {}
  template <class T>
  void rows(const std::string& name, const Vector<T>& rows_of) {
    const auto taken = snapshot_.take(queue_, rows_of);
    left_.push_back([name, taken](base::Columns& to) { base::Saver(to).rows(name, taken); });
  }
  std::vector<std::function<void(base::Columns&)>> left() { return std::move(left_); }

 private:
  Snapshot& snapshot_;
  Queue& queue_;
  std::vector<std::function<void(base::Columns&)>> left_;
};

class FromColumns : public base::Loader {
 public:
  using base::Loader::Loader;
  using base::Loader::rows;
  template <class T>
  void rows(const std::string& name, Vector<T>& rows_of) {
    std::vector<T> host;
    rows(name, host);
    upload(host, rows_of);
  }
};

/// One vector of each of several lists, as one column; `field` gives it.
template <class Walk, class List, class Field>
void walk_ragged(Walk& walk, const std::string& name, const std::vector<List*>& lists, const Field& field) {
  std::vector<int> sizes;
  std::vector<typename std::remove_cvref_t<decltype(field(*lists[0]))>::value_type> all;
  for (List* list : lists) {
    sizes.push_back(static_cast<int>(field(*list).size()));
    all.insert(all.end(), field(*list).begin(), field(*list).end());
  }
  walk.rows(name + "_size", sizes);
  walk.rows(name, all);
  if constexpr (Walk::loads) {
    std::size_t next = 0;
    base::require_user(sizes.size() == lists.size(), "column " + name + " is of other lists");
    for (std::size_t k = 0; k < lists.size(); ++k) {
      base::require_user(sizes[k] >= 0 && next + sizes[k] <= all.size(), "column " + name + " is too short");
      field(*lists[k]).assign(all.begin() + next, all.begin() + next + sizes[k]);
      next += sizes[k];
    }
  }
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
