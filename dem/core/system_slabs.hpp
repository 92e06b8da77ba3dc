#pragma once
// A simulation that holds one slab of the grains (dem/company.hpp): which grains are here, how they go over to a
// neighbour with all that their contacts remember, and the ghosts of the neighbours' spheres.
#include <limits>
#include <set>

#include "dem/core/system.hpp"
#include "dem/slab_cuts.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

inline bool System::in_company() const { return setup_.company && setup_.company->parts() > 1; }

inline void System::join_company() {
  if (!in_company()) return;
  base::require_user(setup_.company->ring() == (setup_.periods[0].length > 0),
                     "dem: parts lie in a ring where space repeats itself along x, and only there");
  ring_.lower.x = periods_.lower.x;
  ring_.length.x = periods_.length.x;
  periods_.length.x = 0;
}

/// The largest over all parts.
inline double System::over_parts(double value) const {
  if (in_company()) setup_.company->largest(std::span<double>(&value, 1));
  return value;
}

inline int System::part_of(double x) const {
  const auto& cuts = ghosts_.cuts;
  return static_cast<int>(std::upper_bound(cuts.begin(), cuts.end(), x) - cuts.begin());
}

/// Where the slabs lie so that these grains are shared out evenly, by their spheres.
inline void System::cut_slabs(std::span<const Grain> all) {
  SlabWork work;
  work.bins.resize(1024);
  double reach = 0;
  work.low = ring_.any() ? ring_.lower.x : std::numeric_limits<double>::infinity();
  work.high = ring_.any() ? ring_.lower.x + ring_.length.x : -work.low;
  for (const Grain& g : all) {
    reach = std::max(reach, g.radius);
    if (ring_.any()) continue;
    work.low = std::min(work.low, g.position.x - g.radius);
    work.high = std::max(work.high, g.position.x + g.radius);
  }
  for (const Grain& g : all) {
    const double x = g.position.x + ring_.return_path(g.position).x;
    work.add(x, g.shape < 0 ? 1 : static_cast<double>(shapes_[static_cast<std::size_t>(g.shape)].spheres.size()));
  }
  const int parts = setup_.company->parts();
  const double least = least_slab(reach, 0.1 * reach);
  ghosts_.cuts = slab_cuts(work, parts, least);
  if (ghosts_.cuts.empty()) refuse_slabs(work.high - work.low, least, reach);
}

inline void System::refuse_slabs(double along, double least, double reach) const {
  char message[200];
  std::snprintf(message, sizeof message,
                "dem: grains over %.4g m along x cannot be cut into %d slabs of %.4g m or more (four grains of radius "
                "%.4g m); use fewer ranks for grains",
                along, setup_.company->parts(), least, reach);
  throw base::UserError(message);
}

inline std::vector<Grain> System::own_grains(std::span<const Grain> all) {
  if (ghosts_.cuts.empty() && !all.empty()) cut_slabs(all);
  std::vector<Grain> own;
  for (const Grain& g : all)
    if (part_of(g.position.x + ring_.return_path(g.position).x) == setup_.company->part()) own.push_back(g);
  return own;
}

/// Ghosts and all else behind the own rows, gone.
inline void System::drop_ghosts() {
  if (!in_company()) return;
  const std::size_t n = grains_.id.size(), parts = grains_.parts;
  grains_.place.resize(n);
  grains_.motion.resize(parts * n);
  grains_.pull.resize(parts * n);
  grains_.material.resize(n);
  grains_.old_of_new.resize(n);
  if (bodies_.any()) bodies_.of_sphere.resize(n);
}

/// Before new lists are made: every grain to the part whose slab it lies in.
inline void System::migrate() {
  balance();
  if (ring_.any()) {
    const bool referenced = gravity_referenced_;
    settle_gravity();
    if (bodies_.any())
      launch(bodies_.size(),
             ReturnBodies{ring_, pointer(bodies_.place), pointer(grains_.place), pointer(bodies_.start)});
    else
      launch(grains_.size(), ReturnGrains{ring_, pointer(grains_.place)});
    reference_gravity(referenced);
  }
  drop_ghosts();
  // A grain may have farther to go than to a neighbour, where cuts have been moved far.
  do {
  } while (over_parts(pass_on()) > 0);
}

inline void System::reference_gravity(bool referenced) {
  if (!referenced || !setup_.track_energy) return;
  gravity_reference_ = gravity_potential();
  gravity_referenced_ = true;
}

/// New cuts where the parts' counted work has become too uneven.
inline void System::balance() {
  constexpr double tolerated = 1.1;
  constexpr int rarely = 16;  // of the rebuilds
  if (rebuilds_ % rarely == 0 && ghosts_.imbalance > tolerated && !ghosts_.cuts.empty()) ghosts_.next_cuts = new_cuts();
}

/// Where this part's work was counted with its lists, it lies alike on all its spheres. The old cuts where grains have
/// become too few for others.
inline std::vector<double> System::new_cuts() {
  ghosts_.imbalance = 1;
  const auto place = download(grains_.place);
  const int n = grains_.size();
  double ends[3] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 0};
  for (int g = 0; g < n; ++g) {
    ends[0] = std::fmax(ends[0], place[g].radius - place[g].position.x);
    ends[1] = std::fmax(ends[1], place[g].radius + place[g].position.x);
    ends[2] = std::fmax(ends[2], place[g].radius);
  }
  for (const Place& body : download(bodies_.place)) ends[2] = std::fmax(ends[2], body.radius);
  setup_.company->largest(ends);
  SlabWork work;
  work.low = ring_.any() ? ring_.lower.x : -ends[0];
  work.high = ring_.any() ? ring_.lower.x + ring_.length.x : ends[1];
  work.bins.resize(1024);
  const double each = ghosts_.work > 0 ? ghosts_.work / n : 1;
  for (int g = 0; g < n; ++g) work.add(place[g].position.x + ring_.return_path(place[g].position).x, each);
  setup_.company->sum(work.bins);
  const auto cuts = slab_cuts(work, setup_.company->parts(), least_slab(ends[2], skin_));
  if (cuts.empty() && ghosts_.cuts.empty()) refuse_slabs(work.high - work.low, least_slab(ends[2], skin_), ends[2]);
  return cuts.empty() ? ghosts_.cuts : cuts;
}

/// Hands grains that lie in other slabs one part on, and takes such from the neighbours. Returns how many have farther
/// to go.
inline double System::pass_on() {
  Company& company = *setup_.company;
  const int here = company.part(), parts = company.parts(), n = bodies_.any() ? bodies_.size() : grains_.size();
  const auto place = download(bodies_.any() ? bodies_.place : grains_.place);
  std::vector<int> side(static_cast<std::size_t>(n), -1), staying;
  bool leaves = false;
  for (int g = 0; g < n; ++g) {
    const int there = part_of(place[g].position.x);
    int way = there - here;
    if (company.ring() && 2 * std::abs(way) > parts) way = -way;
    if (way != 0) side[g] = way < 0 ? Company::below : Company::above;
    if (way == 0) staying.push_back(g);
    leaves = leaves || way != 0;
  }
  std::array<Company::Letter, 2> out, in;
  const bool referenced = gravity_referenced_;
  settle_gravity();
  if (leaves) {
    write_leaving(side, out);
    Vector<int> kept;
    upload(staying, kept);
    if (bodies_.any())
      bodies_.keep(kept, grains_);
    else
      grains_.keep(kept);
  }
  company.swap(out, in);
  double farther = 0;
  for (const auto& letter : in) farther += read_arriving(letter);
  reference_gravity(referenced);
  return farther;
}

/// Memories of contacts of the spheres with these old rows, by side.
inline void System::write_memories(const std::vector<int>& side_of_old, std::array<Company::Letter, 2>& out) const {
  std::array<std::vector<ContactMemory>, 2> memories;
  const auto leaving = [&](int row) {
    return row < static_cast<int>(side_of_old.size()) ? side_of_old[static_cast<std::size_t>(row)] : -1;
  };
  const auto& material = ghosts_.material;
  const int materials = static_cast<int>(setup_.materials.size());
  const auto owner = download(images_.owner);
  const auto note = [&](int i, int row, const double* history, int numbers) {
    const int j = owner.empty() || row < images_.first ? row : owner[static_cast<std::size_t>(row - images_.first)];
    std::set<int> sides{leaving(i), leaving(j)};
    sides.erase(-1);
    if (sides.empty() || std::all_of(history, history + numbers, [](double h) { return h == 0; })) return;
    ContactMemory memory{.a = ghosts_.keys[i], .b = ghosts_.keys[j], .kind = 0, .numbers = numbers, .state = {}};
    memory.kind = std::min(material[i], material[j]) * materials + std::max(material[i], material[j]);
    std::copy_n(history, numbers, memory.history);
    for (const int to : sides) memories[static_cast<std::size_t>(to)].push_back(memory);
  };
  each_pair(note);
  for (int to : {0, 1}) {
    LetterWriter writer(out[to]);
    writer.put(static_cast<std::int64_t>(memories[to].size()));
    writer.put_rows(memories[to].data(), memories[to].size());
    memories[to].clear();
  }
  const auto slot = download(near_walls_.slot), start = download(near_walls_.start);
  const auto candidate = download(near_walls_.candidate);
  const auto state = download(near_walls_.state);
  const auto history = download(near_walls_.history);
  const auto wall_ledger = download(near_walls_.ledger);
  const int stride = near_walls_.history_stride;
  for (std::size_t row = 0; row < slot.size(); ++row) {
    const int to = leaving(static_cast<int>(row));
    if (to < 0 || slot[row] < 0) continue;
    for (int c = start[slot[row]]; c < start[slot[row] + 1]; ++c) {
      if (!(state[c].overlap > 0)) continue;
      ContactMemory memory{.a = ghosts_.keys[row], .b = {}, .kind = candidate[c], .numbers = stride, .state = state[c]};
      std::copy_n(history.data() + static_cast<std::size_t>(c) * stride, stride, memory.history);
      if (!wall_ledger.empty()) {
        memory.elastic_normal = wall_ledger[c].elastic_normal;
        memory.elastic_shear = wall_ledger[c].elastic_shear;
      }
      memories[to].push_back(memory);
    }
  }
  for (int to : {0, 1}) {
    LetterWriter writer(out[to]);
    writer.put(static_cast<std::int64_t>(memories[to].size()));
    writer.put_rows(memories[to].data(), memories[to].size());
  }
}

/// A body on its way to another part; its spheres follow.
struct TravellingBody {
  Place place;
  Quad state[2], pull[2];
  kernels::Quaternion orientation;
  Vec3 inertia, inertia_per_mass;
  double volume = 0;
  std::int64_t id = 0;
  int material = 0, shape = -1, spheres = 0;
};
/// A sphere; `state` and `pull` are those of its body where there are bodies.
struct TravellingSphere {
  Place place;
  Quad state[2], motion[2], pull[2];
  Vec3 offset;
  std::int64_t id = 0;
  int material = 0;
};

/// Grains that go, then what their contacts remember. `side`: of every grain, -1: stays.
inline void System::write_leaving(const std::vector<int>& side, std::array<Company::Letter, 2>& out) {
  const int parts = grains_.parts;
  const auto place = download(grains_.place);
  const auto state = download(grains_.state), motion = download(grains_.motion), pull = download(grains_.pull);
  const auto material = download(grains_.material), old = download(grains_.old_of_new);
  const auto id = download(grains_.id);
  std::vector<int> side_of_old(ghosts_.keys.size(), -1);
  const auto sphere = [&](int s, int to) {
    TravellingSphere t;
    t.place = place[s];
    t.id = id[s];
    t.material = material[s];
    for (int part = 0; part < parts; ++part) {
      const auto at = static_cast<std::size_t>(parts * s + part);
      if (!state.empty()) t.state[part] = state[at];
      t.motion[part] = motion[at];
      t.pull[part] = pull[at];
    }
    if (old[s] >= 0) {
      side_of_old[static_cast<std::size_t>(old[s])] = to;
      ghosts_.left.emplace(ghosts_.keys[static_cast<std::size_t>(old[s])], old[s]);
    }
    return t;
  };
  std::array<std::int64_t, 2> numbers{};
  for (const int to : side)
    if (to >= 0) ++numbers[static_cast<std::size_t>(to)];
  for (int to : {0, 1}) LetterWriter(out[to]).put(numbers[static_cast<std::size_t>(to)]);
  if (bodies_.any()) {
    const auto centre = download(bodies_.place);
    const auto body_state = download(bodies_.state), body_pull = download(bodies_.pull);
    const auto orientation = download(bodies_.orientation);
    const auto inertia = download(bodies_.inertia), per_mass = download(bodies_.inertia_per_mass);
    const auto volume = download(bodies_.volume);
    const auto body_material = download(bodies_.material), shape = download(bodies_.shape);
    const auto start = download(bodies_.start);
    const auto offset = download(bodies_.offset);
    const auto body_id = download(bodies_.id);
    for (std::size_t b = 0; b < side.size(); ++b) {
      if (side[b] < 0) continue;
      LetterWriter writer(out[side[b]]);
      writer.put(TravellingBody{.place = centre[b],
                                .state = {body_state[2 * b], body_state[2 * b + 1]},
                                .pull = {body_pull[2 * b], body_pull[2 * b + 1]},
                                .orientation = orientation[b],
                                .inertia = inertia[b],
                                .inertia_per_mass = per_mass[b],
                                .volume = volume[b],
                                .id = body_id[b],
                                .material = body_material[b],
                                .shape = shape[b],
                                .spheres = start[b + 1] - start[b]});
      for (int s = start[b]; s < start[b + 1]; ++s) {
        TravellingSphere t = sphere(s, side[b]);
        t.offset = offset[s];
        writer.put(t);
      }
    }
  } else {
    for (std::size_t g = 0; g < side.size(); ++g)
      if (side[g] >= 0) LetterWriter(out[side[g]]).put(sphere(static_cast<int>(g), side[g]));
  }
  for (int to : {0, 1}) {
    // A grain that is only passing through brings along what it came with.
    LetterWriter writer(out[to]);
    writer.put(static_cast<std::int64_t>(ghosts_.brought_pairs.size()));
    writer.put_rows(ghosts_.brought_pairs.data(), ghosts_.brought_pairs.size());
    writer.put(static_cast<std::int64_t>(ghosts_.brought_walls.size()));
    writer.put_rows(ghosts_.brought_walls.data(), ghosts_.brought_walls.size());
  }
  write_memories(side_of_old, out);
}

/// Takes in the grains of a letter; returns how many of them belong to yet another part.
inline double System::read_arriving(const Company::Letter& letter) {
  if (letter.empty()) return 0;
  LetterReader reader(letter);
  const auto number = reader.get<std::int64_t>();
  const int here = in_company() ? setup_.company->part() : 0, parts = grains_.parts;
  double farther = 0;
  std::vector<TravellingBody> bodies;
  std::vector<TravellingSphere> spheres;
  std::vector<int> starts, owners;
  const int first_sphere = grains_.size();
  for (std::int64_t k = 0; k < number; ++k) {
    if (!bodies_.any()) {
      spheres.push_back(reader.get<TravellingSphere>());
      farther += part_of(spheres.back().place.position.x) != here;
      continue;
    }
    bodies.push_back(reader.get<TravellingBody>());
    farther += part_of(bodies.back().place.position.x) != here;
    for (int s = 0; s < bodies.back().spheres; ++s) {
      spheres.push_back(reader.get<TravellingSphere>());
      owners.push_back(bodies_.size() + static_cast<int>(k));
    }
    starts.push_back(first_sphere + static_cast<int>(spheres.size()));
  }
  auto &pairs = ghosts_.brought_pairs, &walls = ghosts_.brought_walls;
  for (auto* memories : {&pairs, &walls, &pairs, &walls}) {  // brought along, then the neighbour's own
    const auto count = static_cast<std::size_t>(reader.get<std::int64_t>()), before = memories->size();
    memories->resize(before + count);
    reader.get_rows(memories->data() + before, count);
  }
  base::require_internal(reader.ends(), "a letter between parts is too long");
  if (number == 0) return 0;

  const std::size_t before = grains_.id.size();
  std::vector<Place> places;
  std::vector<Quad> states, motions, pulls;
  std::vector<int> materials;
  std::vector<std::int64_t> ids;
  std::vector<Vec3> offsets;
  for (const auto& s : spheres) {
    places.push_back(s.place);
    materials.push_back(s.material);
    ids.push_back(s.id);
    offsets.push_back(s.offset);
    for (int part = 0; part < parts; ++part) {
      states.push_back(s.state[part]);
      motions.push_back(s.motion[part]);
      pulls.push_back(s.pull[part]);
    }
  }
  append(grains_.place, places, before);
  if (grains_.own_state) append(grains_.state, states, parts * before);
  append(grains_.motion, motions, parts * before);
  append(grains_.pull, pulls, parts * before);
  append(grains_.material, materials, before);
  append(grains_.id, ids, before);
  append(grains_.old_of_new, std::vector<int>(ids.size(), -1), before);
  if (bodies_.any()) append_bodies(bodies, offsets, starts, owners);
  if (keeps_grain_ledger()) grains_.ledger.resize(bodies_.any() ? bodies_.size() : grains_.size());
  rows_moved_ = true;
  return farther;
}

inline void System::append_bodies(const std::vector<TravellingBody>& bodies, const std::vector<Vec3>& offsets,
                                  const std::vector<int>& starts, const std::vector<int>& owners) {
  const auto column = [&](const auto& of) {
    std::vector<std::remove_cvref_t<decltype(of(bodies[0]))>> values;
    for (const auto& body : bodies) values.push_back(of(body));
    return values;
  };
  std::vector<Quad> states, pulls;
  for (const auto& body : bodies)
    for (int part : {0, 1}) {
      states.push_back(body.state[part]);
      pulls.push_back(body.pull[part]);
    }
  append(bodies_.place, column([](const TravellingBody& b) { return b.place; }));
  append(bodies_.state, states);
  append(bodies_.pull, pulls);
  append(bodies_.orientation, column([](const TravellingBody& b) { return b.orientation; }));
  append(bodies_.inertia, column([](const TravellingBody& b) { return b.inertia; }));
  append(bodies_.inertia_per_mass, column([](const TravellingBody& b) { return b.inertia_per_mass; }));
  append(bodies_.volume, column([](const TravellingBody& b) { return b.volume; }));
  append(bodies_.material, column([](const TravellingBody& b) { return b.material; }));
  append(bodies_.shape, column([](const TravellingBody& b) { return b.shape; }));
  append(bodies_.id, column([](const TravellingBody& b) { return b.id; }));
  append(bodies_.start, starts);
  append(bodies_.of_sphere, owners);
  append(bodies_.offset, offsets);
}

/// Intervals along x that the parts' spheres take [m]: low and high of every part, low > high: none.
inline std::vector<double> System::extents() {
  constexpr double none = 1e300;
  Company& company = *setup_.company;
  const int parts = company.parts(), here = company.part();
  std::vector<double> all(static_cast<std::size_t>(3 * parts));
  double low = none, high = -none;
  for (const Place& p : download(grains_.place)) {
    low = std::fmin(low, p.position.x - p.radius);
    high = std::fmax(high, p.position.x + p.radius);
  }
  all[static_cast<std::size_t>(3 * here)] = low;
  all[static_cast<std::size_t>(3 * here + 1)] = high;
  all[static_cast<std::size_t>(3 * here + 2)] = ghosts_.work;
  company.sum(all);
  double most = 0, total = 0;
  for (int p = 0; p < parts; ++p) {
    most = std::fmax(most, all[static_cast<std::size_t>(3 * p + 2)]);
    total += all[static_cast<std::size_t>(3 * p + 2)];
  }
  if (total > 0) ghosts_.imbalance = most * parts / total;
  // Nobody may touch past a neighbour.
  for (int p = 0; p < parts; ++p)
    for (int q = p + 2; q < parts; ++q) {
      if (company.ring() && p == 0 && q == parts - 1) continue;
      const double gap = all[static_cast<std::size_t>(3 * q)] - all[static_cast<std::size_t>(3 * p + 1)];
      if (gap > skin_) continue;
      char message[220];
      std::snprintf(message, sizeof message,
                    "dem: the neighbours of the slab of part %d come near each other: it is thin for these grains and "
                    "this neighbour skin of %.3g m; use fewer ranks for grains",
                    p + 1, skin_);
      throw base::UserError(message);
    }
  return all;
}

/// Names of the own spheres, in the order of their rows.
inline void System::list_keys() {
  const auto ids = download(grains_.id);
  const auto start = download(bodies_.start), owner = download(bodies_.of_sphere);
  ghosts_.keys.clear();
  for (std::size_t s = 0; s < ids.size(); ++s)
    ghosts_.keys.push_back({ids[s], start.empty() ? 0 : static_cast<std::int64_t>(s) - start[owner[s]]});
  ghosts_.material = download(grains_.material);
}

/// After the own rows have been sorted: ghosts of the neighbours' spheres behind them, and the neighbours' of these.
inline void System::take_ghosts() {
  Company& company = *setup_.company;
  const int here = company.part(), parts = company.parts(), n = grains_.size();
  const auto interval = extents();
  const auto before = ghosts_.keys;
  const int old_first = ghosts_.first;
  RowOfKey old_ghost;
  for (std::size_t row = static_cast<std::size_t>(old_first); row < before.size(); ++row)
    old_ghost.emplace(before[row], static_cast<int>(row));

  const auto place = download(grains_.place);
  const auto motion = download(grains_.motion);
  const auto material = download(grains_.material);
  list_keys();

  struct Ghost {
    Place place;
    Quad motion[2];
    SphereKey key;
    std::int64_t material;
  };
  std::array<Company::Letter, 2> out, in;
  for (const auto side : {Company::below, Company::above}) {
    std::vector<int> rows;
    if (company.has(side)) {
      const bool seam = side == Company::below ? here == 0 : here + 1 == parts;
      const int there = seam ? (side == Company::below ? parts - 1 : 0) : here + (side == Company::below ? -1 : 1);
      const double shift = seam ? (side == Company::below ? ring_.length.x : -ring_.length.x) : 0;
      const double low = interval[static_cast<std::size_t>(3 * there)],
                   high = interval[static_cast<std::size_t>(3 * there + 1)];
      LetterWriter writer(out[side]);
      for (int g = 0; g < n; ++g) {
        const double x = place[g].position.x + shift, far = place[g].radius + skin_;
        if (!(x - far < high && x + far > low)) continue;
        rows.push_back(g);
        Ghost ghost{
            .place = place[g], .motion = {}, .key = ghosts_.keys[static_cast<std::size_t>(g)], .material = material[g]};
        ghost.place.position.x = x;
        for (int part = 0; part < grains_.parts; ++part) ghost.motion[part] = motion[grains_.parts * g + part];
        writer.put(ghost);
      }
      ghosts_.shift[side] = -shift;  // of what comes from there
    }
    upload(rows, ghosts_.sent[side]);
  }
  company.swap(out, in);

  std::vector<Place> places;
  std::vector<Quad> motions;
  std::vector<int> materials, old;
  for (const auto side : {Company::below, Company::above}) {
    LetterReader reader(in[side]);
    ghosts_.count[side] = 0;
    for (; !reader.ends(); ++ghosts_.count[side]) {
      const auto ghost = reader.get<Ghost>();
      places.push_back(ghost.place);
      for (int part = 0; part < grains_.parts; ++part) motions.push_back(ghost.motion[part]);
      materials.push_back(static_cast<int>(ghost.material));
      ghosts_.keys.push_back(ghost.key);
      const auto found = old_ghost.find(ghost.key);
      const auto left = ghosts_.left.find(ghost.key);
      old.push_back(found != old_ghost.end() ? found->second : left != ghosts_.left.end() ? left->second : -1);
    }
  }
  // What was a ghost and is here now keeps its contacts.
  auto old_of_new = download(grains_.old_of_new);
  for (int g = 0; g < n; ++g)
    if (old_of_new[g] < 0)
      if (const auto found = old_ghost.find(ghosts_.keys[static_cast<std::size_t>(g)]); found != old_ghost.end())
        old_of_new[g] = found->second;
  upload(old_of_new, grains_.old_of_new);
  ghosts_.left.clear();

  ghosts_.first = n;
  const auto rows = static_cast<std::size_t>(n);
  append(grains_.place, places, rows);
  append(grains_.motion, motions, grains_.parts * rows);
  append(grains_.pull, std::vector<Quad>(motions.size()), grains_.parts * rows);
  append(grains_.material, materials, rows);
  append(grains_.old_of_new, old, rows);
  if (bodies_.any()) append(bodies_.of_sphere, std::vector<int>(places.size(), -1), rows);
  ghosts_.material = download(grains_.material);
}

/// Place and motion of the ghosts as their originals have them now.
inline void System::move_ghosts() {
  if (!in_company()) return;
  const std::size_t width = 3 + 3 * static_cast<std::size_t>(grains_.parts);
  for (int side : {0, 1}) {
    const auto rows = ghosts_.sent[side].size();
    auto& leaving = ghosts_.leaving[side];
    leaving.resize(width * rows);
    queue_.launch(static_cast<int>(rows),
                  PackRows{pointer(ghosts_.sent[side]), pointer(grains_.place), std::as_const(grains_).motions(),
                           -ghosts_.shift[side], pointer(leaving)});
    queue_.fetch(pointer(leaving), ghosts_.leaving_host[side].make(leaving.size()), leaving.size());
  }
  queue_.wait();
  for (int side : {0, 1}) {
    ghosts_.out[side].resize(ghosts_.leaving[side].size() * sizeof(double));
    if (!ghosts_.out[side].empty())
      std::memcpy(ghosts_.out[side].data(), ghosts_.leaving_host[side].data(), ghosts_.out[side].size());
    ghosts_.in[side].resize(width * static_cast<std::size_t>(ghosts_.count[side]) * sizeof(double));
  }
  setup_.company->swap_known(ghosts_.out, ghosts_.in);
  int row = ghosts_.first;
  for (int side : {0, 1}) {
    const int number = ghosts_.count[side];
    auto& arriving = ghosts_.arriving[side];
    arriving.resize(width * static_cast<std::size_t>(number));
    double* const host = ghosts_.arriving_host[side].make(arriving.size());  // the last copy from there is long done
    if (!arriving.empty()) std::memcpy(host, ghosts_.in[side].data(), ghosts_.in[side].size());
    queue_.send(host, pointer(arriving), arriving.size());
    queue_.launch(number, UnpackRows{row, pointer(grains_.place), grains_.motions(), pointer(arriving)});
    row += number;
  }
}

/// Spheres by bucket, ghosts among them.
inline void System::enter_ghosts(const CellGrid& grid, Vector<int>& bucket, Vector<int>& entry) {
  const int rows = ghosts_.total();
  bucket.resize(rows);
  launch(rows, BucketOf{grid, pointer(grains_.place), pointer(bucket)});
  entry.resize(rows);
  thrust::sequence(policy(), entry.begin(), entry.end());
  thrust::stable_sort_by_key(policy(), bucket.begin(), bucket.end(), entry.begin());
}

/// After new lists have been made: contacts of grains that have come from other parts remember what they did there.
inline void System::recall() {
  if (!ghosts_.brought_pairs.empty() || !ghosts_.brought_walls.empty()) {
    if (!in_company()) list_keys();
    RowOfKey row;
    for (std::size_t k = 0; k < ghosts_.keys.size(); ++k) row.emplace(ghosts_.keys[k], static_cast<int>(k));
    recall_pairs(row);
    recall_walls(row);
  }
  ghosts_.brought_pairs.clear();
  ghosts_.brought_walls.clear();
}

inline void System::recall_pairs(const RowOfKey& row) {
  std::vector<double> columns;
  std::vector<int> start, second;
  if (!sweeps()) {
    columns = pairs_.kept_numbers();
    start = download(pairs_.own_start);
    second = download(pairs_.second);
  }
  std::vector<int> recalled;
  for (const ContactMemory& memory : ghosts_.brought_pairs) {
    const auto a = row.find(memory.a), b = row.find(memory.b);
    if (a == row.end() || b == row.end()) continue;
    const int i = a->second, j = b->second, low = std::min(i, j), high = std::max(i, j);
    if (low >= grains_.size()) continue;  // two ghosts
#if !defined(TRACKBED_DEM_CUDA)
    if (sweeps()) {
      sweep_lists_.recall(i, j, memory.kind, memory.numbers, memory.history);
      continue;
    }
#endif
    const int c = find_sorted(second.data(), start[low], start[low + 1], high);
    if (c < 0) continue;
    const unsigned flips = grain_parameters_host_[memory.kind].flips;
    for (int k = 0; k < memory.numbers && k < pairs_.history_stride; ++k)
      columns[static_cast<std::size_t>(c) * pairs_.history_stride + k] =
          i > j && (flips >> k & 1) ? -memory.history[k] : memory.history[k];
    recalled.push_back(c);
  }
  if (recalled.empty()) return;
  pairs_.keep_numbers(columns);
  Vector<int> touching;
  upload(recalled, touching);
  with_numbers(setup_.precision, [&]<class Real>() {
    launch(static_cast<int>(recalled.size()),
           MarkTouching<Real>{pointer(touching), pointer(pairs_.numbers<Real>().result)});
  });
}

inline void System::recall_walls(const RowOfKey& row) {
  if (ghosts_.brought_walls.empty() || near_walls_.size() == 0) return;
  const auto slot = download(near_walls_.slot), start = download(near_walls_.start);
  const auto candidate = download(near_walls_.candidate);
  auto state = download(near_walls_.state);
  auto history = download(near_walls_.history);
  auto ledger = download(near_walls_.ledger);
  const int stride = near_walls_.history_stride;
  for (const ContactMemory& memory : ghosts_.brought_walls) {
    const auto found = row.find(memory.a);
    if (found == row.end() || found->second >= grains_.size() || slot[found->second] < 0) continue;
    const int w = slot[found->second];
    for (int c = start[w]; c < start[w + 1]; ++c) {
      if (candidate[c] != memory.kind) continue;
      state[c] = memory.state;
      std::copy_n(memory.history, std::min(stride, memory.numbers),
                  history.data() + static_cast<std::size_t>(c) * stride);
      if (ledger.empty()) continue;
      ledger[c].elastic_normal = memory.elastic_normal;
      ledger[c].elastic_shear = memory.elastic_shear;
    }
  }
  upload(ledger, near_walls_.ledger);
  upload(state, near_walls_.state);
  upload(history, near_walls_.history);
}

/// After the lists: what this part had to look at, in spheres and pairs.
inline void System::count_work() {
  double pairs = pairs_.size();
#if !defined(TRACKBED_DEM_CUDA)
  if (sweeps()) pairs = static_cast<double>(sweep_lists_.near_pairs());
#endif
  ghosts_.work = grains_.size() + 0.5 * pairs;
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
