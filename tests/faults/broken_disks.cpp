#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <initializer_list>
#include <map>
#include <sstream>

#include "campaign.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/io/tensor_file.hpp"
#include "process.hpp"
#include "support/temporary_folder.hpp"
#include "support/tiny_disk.hpp"

namespace elrom::faults {
namespace {

namespace fs = std::filesystem;

/// What fails: see failing_calls.c.
struct Failure {
  std::string name, variable;
  std::map<std::string, std::string> environment = {};
  std::size_t few = 8;             ///< how many are tried in the short campaign
  bool libraries_may_die = false;  ///< those of others; we may not, and files may not suffer
};

/// Where a program died, from what failing_calls.c tells: the innermost frame outside the C and C++ runtimes.
struct Death {
  std::string library;   ///< not of ours; empty: our own code, or nobody knows
  std::string function;  ///< where it is known
};

Death death_told_in(const std::string& output) {
  static const std::string mark = "[died in ";
  const auto begin = output.find(mark);
  if (begin == std::string::npos) return {};
  const auto end = output.find(']', begin);
  std::istringstream frames(output.substr(begin + mark.size(), end - begin - mark.size()));
  const auto starts_with_one_of = [](const std::string& text, std::initializer_list<const char*> beginnings) {
    return std::any_of(beginnings.begin(), beginnings.end(), [&](auto own) { return text.starts_with(own); });
  };
  for (std::string file, offset; frames >> file >> offset;) {
    const auto name = fs::path(file).filename().string();
    if (starts_with_one_of(name,
                           {"elrom-failing-calls", "libc.", "libstdc++.", "libgcc_s.", "libm.", "ld-linux"}))
      continue;
    if (name.find(".so") != std::string::npos) return {name.substr(0, name.find(".so")), {}};
    // A program of ours: what is linked into it statically is told by the function's name.
    auto function = run({"/usr/bin/addr2line", "-f", "-C", "-e", file, offset}).output;
    function = function.substr(0, function.find('\n'));
    if (function.starts_with("H5")) return {"HDF5", function};
    if (function.starts_with("nlohmann::")) return {"nlohmann/json", function};
    if (!starts_with_one_of(function, {"__", "_Unwind", "std::", "operator ", "void std::"}))
      return {{}, function};
  }
  return {};
}

/// Runs the command with its n-th call failing, for growing n, until that happens no more to it.
/// @param state_is_good looks at what is left, after every run
void fail_every_call(const Failure& failure, const std::string& name, const std::vector<std::string>& command,
                     const Workshop& shop, const std::function<void()>& prepare,
                     const std::function<bool(const Exit&)>& state_is_good, Tally& tally) {
  const std::size_t most = shop.times(2000, failure.few);
  // Steps grow: the first writes of a program are the delicate ones, later ones are much alike.
  for (std::size_t n = 1, tried = 0; tried < most; n += 1 + n / 8, ++tried) {
    prepare();
    auto environment = failure.environment;
    environment["LD_PRELOAD"] = shop.preload.string();
    environment[failure.variable] = std::to_string(n);
    const auto exit = run(command, environment);
    if (exit.output.find("[call failed]") == std::string::npos) return;
    // A library that calls exit() does so with a status that no program of ours has.
    const bool in_order = exit.signal == 0 && !exit.timed_out && exit.status != 255;
    const auto death = in_order ? Death{} : death_told_in(exit.output);
    const bool excused = failure.libraries_may_die && !death.library.empty();
    const auto story = name + ", " + failure.name + " " + std::to_string(n) + ": status " +
                       std::to_string(exit.status) + ", signal " + std::to_string(exit.signal) + ", " +
                       death.library + " " + death.function + " " + exit.output.substr(0, 300);
    const bool good = (in_order || excused) && state_is_good(exit);
    tally.count(good, story);
    if (good && excused) ++tally.died_in[death.library];
  }
}

bool whole_or_absent(const fs::path& bundle) {
  if (!fs::exists(bundle)) return true;
  try {
    io::TensorFile::open(bundle).verify_all();
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace

namespace {

/// Import, training and prediction under one kind of failure: old or new state, no death by a signal.
void fail_programs(const Failure& failure, const Workshop& shop, const fs::path& folder, Tally& tally) {
  const auto store = folder / "store.h5", old_store = folder / "old.h5";
  fail_every_call(
      failure, "import", shop.import_command(store, shop.case_files(3, 8)), shop,
      [&] { fs::copy_file(old_store, store, fs::copy_options::overwrite_existing); },
      [&](const Exit& exit) {
        const long state = store_state(store);
        return exit.status == 0 ? state == 11 : state == 8 || state == 11;
      },
      tally);

  const auto study = folder / "study", study_before = folder / "study_before";
  const auto fresh = [&] {
    fs::remove_all(study);
    fs::copy(study_before, study);
  };
  const auto good_study = [&](const Exit& exit) {
    return whole_or_absent(study / "model.elrom") && (exit.status != 0 || fs::exists(study / "model.elrom"));
  };
  fail_every_call(failure, "training", shop.train_command(study), shop, fresh, good_study, tally);
  fresh();
  const auto after = run(shop.train_command(study));
  tally.count(after.status == 0 && good_study(after), "training after failures: " + after.output);

  const auto output = folder / "predictions";
  fail_every_call(
      failure, "prediction", shop.predict_command(study / "model.elrom", output), shop,
      [&] { fs::remove_all(output); },
      [&](const Exit& exit) {
        if (!predictions_whole(output)) return false;
        if (exit.status == 0 || exit.signal != 0 || exit.status == 255 || !fs::exists(output)) return true;
        // A program that ends in order clears its temporary files away; whole predictions may stand.
        return std::none_of(fs::directory_iterator(output), fs::directory_iterator{},
                            [](const auto& entry) { return entry.path().extension() == ".tmp"; });
      },
      tally);
}

void fail_collisions(const Failure& failure, const Workshop& shop, const fs::path& folder, Tally& tally) {
  const auto set = folder / "collisions.h5", good_set = folder / "good_collisions.h5";
  if (!fs::exists(good_set) && run(shop.collide_command(good_set)).status != 0)
    throw std::runtime_error("cannot collide");
  // What one failing run leaves the next one goes on from.
  fail_every_call(
      failure, "collisions", shop.collide_command(set), shop, [&] { fs::remove(set); },
      [&](const Exit& exit) { return collisions_whole(set) && (exit.status != 0 || fs::exists(set)); },
      tally);
  const auto after = run(shop.collide_command(set));
  tally.count(after.status == 0 && test::read_bytes(set) == test::read_bytes(good_set),
              "collisions after failures: " + after.output);
}

Tally under(const std::vector<Failure>& failures, const Workshop& shop, const std::string& name) {
  Tally tally;
  const auto folder = shop.folder / name;
  fs::create_directories(folder);
  if (run(shop.import_command(folder / "old.h5", shop.case_files(8))).status != 0)
    throw std::runtime_error("cannot import");
  shop.make_study(folder / "study_before", 10, std::string(Workshop::quick) + Workshop::two_fields);
  for (const auto& failure : failures) {
    fail_programs(failure, shop, folder, tally);
    fail_collisions(failure, shop, folder, tally);
  }
  return tally;
}

}  // namespace

Tally failing_writes(const Workshop& shop) {
  return under({{"full disk at call", "ELROM_FAIL_AT"},
                {"broken disk at call", "ELROM_FAIL_AT", {{"ELROM_FAIL_WITH", std::to_string(EIO)}}, 3},
                {"short write", "ELROM_SHORT_AT", {}, 3}},
               shop, "failing_writes");
}

Tally failing_allocations(const Workshop& shop) {
  return under(
      {{.name = "no memory at allocation", .variable = "ELROM_FAIL_ALLOCATION", .libraries_may_die = true},
       {.name = "no memory in a child at allocation", .variable = "ELROM_FAIL_CHILD", .few = 4}},
      shop, "failing_allocations");
}

Tally disk_full(const Workshop& shop) {
  Tally tally;
  const auto folder = shop.folder / "tiny_disk";
  for (const std::string size : {"64k", "400k", "1500k"}) {
    const test::TinyDisk disk(folder, size);
    if (!disk.mounted()) {
      tally.skipped = "no small file system may be mounted here (" + disk.reason() + ")";
      return tally;
    }
    const auto store = folder / "store.h5";
    const auto exit = run(shop.import_command(store, shop.case_files(10)));
    const long state = store_state(store);
    tally.count(
        exit.signal == 0 && (exit.status == 0 ? state == 10 : state == -1),
        "import to a disk of " + size + ": status " + std::to_string(exit.status) + ", " + exit.output);
    fs::remove(store);
    const auto set = folder / "collisions.h5";
    const auto collided = run(shop.collide_command(set));
    tally.count(collided.signal == 0 && fs::exists(set) == (collided.status == 0) && collisions_whole(set),
                "collisions to a disk of " + size + ": status " + std::to_string(collided.status) + ", " +
                    collided.output);
  }
  return tally;
}

Tally two_at_once(const Workshop& shop) {
  Tally tally;
  const auto store = shop.folder / "shared.h5";
  for (std::size_t i = 0; i < shop.times(20, 3); ++i) {
    fs::remove(store);
    Process first(shop.import_command(store, shop.case_files(8)));
    Process second(shop.import_command(store, shop.case_files(8, 8)));
    // Readers see the old file or the new one, never a half.
    long seen = -1;
    bool whole = true;
    for (int k = 0; k < 20; ++k) {
      seen = store_state(store);
      whole = whole && seen != -2;
      usleep(10000);
    }
    const auto a = first.wait(), b = second.wait();
    const long state = store_state(store);
    const long wanted = (a.status == 0 ? 8 : 0) + (b.status == 0 ? 8 : 0);
    const auto refused_well = [](const Exit& e) {
      return e.status == 0 || e.output.find("another process") != std::string::npos;
    };
    tally.count(whole, "a reader saw half a store");
    tally.count(wanted > 0 && state == wanted && refused_well(a) && refused_well(b),
                "two imports: state " + std::to_string(state) + "\n" + a.output + b.output);
  }
  const auto study = shop.folder / "shared_study";
  shop.make_study(study, 10);
  Process first(shop.train_command(study)), second(shop.train_command(study));
  const auto a = first.wait(), b = second.wait();
  tally.count((a.status == 0) != (b.status == 0) || (a.status == 0 && b.status == 0),
              "two trainings: " + a.output + b.output);
  tally.count(whole_or_absent(study / "model.elrom") && fs::exists(study / "model.elrom"),
              "two trainings: no bundle");
  return tally;
}

}  // namespace elrom::faults
