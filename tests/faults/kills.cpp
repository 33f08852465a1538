#include <csignal>

#include "campaign.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/io/hdf5.hpp"
#include "elrom/io/tensor_file.hpp"
#include "elrom/networks/search.hpp"
#include "process.hpp"

namespace elrom::faults {
namespace {

namespace fs = std::filesystem;

/// Starts the command and kills it at a random moment of `seconds`. @return false when it ended before
bool kill_at_random(const std::vector<std::string>& command, double seconds, base::Random& random) {
  return Process(command).wait(random.uniform(0.0, seconds)).signal == SIGKILL;
}

bool bundle_whole(const fs::path& path) {
  try {
    io::TensorFile::open(path).verify_all();
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

void kill_imports(const Workshop& shop, std::size_t n, base::Random& random, Tally& tally) {
  const auto first = shop.case_files(8), more = shop.case_files(4, 8);
  const auto whole = shop.folder / "kill_whole.h5";
  const double seconds = run(shop.import_command(whole, first)).seconds;
  const auto store = shop.folder / "kill_import.h5";
  for (std::size_t i = 0; i < n; ++i) {
    // Half of the kills hit the making of a store, half an addition to one.
    const bool adding = i % 2 == 1;
    fs::remove(store);
    if (adding) fs::copy_file(whole, store);
    kill_at_random(shop.import_command(store, adding ? more : first), 1.1 * seconds, random);
    const long state = store_state(store);
    const bool known = adding ? state == 8 || state == 12 : state == -1 || state == 8;
    tally.count(known, "import: a store in state " + std::to_string(state));
    if (state == (adding ? 12 : 8)) continue;
    const auto again = run(shop.import_command(store, adding ? more : first));
    tally.count(again.status == 0 && store_state(store) == (adding ? 12 : 8),
                "import after a kill: " + again.output);
  }
}

/// A study of the same store and settings in which nothing is done yet.
void begin_anew(const fs::path& whole, const fs::path& study) {
  fs::remove_all(study);
  fs::create_directories(study);
  fs::copy_file(whole / "snapshots.h5", study / "snapshots.h5");
  fs::copy_file(whole / "study.toml", study / "study.toml");
}

void kill_trainings(const Workshop& shop, std::size_t n, base::Random& random, Tally& tally) {
  const auto whole = shop.folder / "study_whole", study = shop.folder / "study_killed";
  shop.make_study(whole, 12);
  const auto trained = run(shop.train_command(whole));
  if (trained.status != 0) throw std::runtime_error("cannot train: " + trained.output);
  const auto wanted = base::sha256_file(whole / "model.elrom");
  for (std::size_t i = 0; i < n; ++i) {
    if (i % 5 == 0) begin_anew(whole, study);  // five kills in a row through one study
    kill_at_random(shop.train_command(study), 1.1 * trained.seconds, random);
    const bool absent = !fs::exists(study / "model.elrom");
    tally.count(absent || bundle_whole(study / "model.elrom"), "training: a broken bundle");
    if (i % 5 != 4 && i + 1 != n) continue;
    const auto again = run(shop.train_command(study));
    tally.count(again.status == 0, "training after kills: " + again.output);
    tally.count(again.status == 0 && base::sha256_file(study / "model.elrom") == wanted,
                "training after kills: another bundle than without");
  }
}

/// Two versions of a model, of which one is made to answer by turns.
void kill_promotions(const Workshop& shop, std::size_t n, base::Random& random, Tally& tally) {
  const auto study = shop.folder / "study_versions", model = study / "model.elrom";
  fs::remove_all(study);
  fs::create_directories(study);
  fs::copy_file(shop.folder / "study_whole" / "model.elrom", model);  // from before there were versions
  const auto first = base::sha256_file(model);
  const auto promote = [&](int number) {
    return std::vector<std::string>{shop.program("elrom-train"), "promote", study.string(),
                                    std::to_string(number)};
  };
  const double seconds = run(promote(1)).seconds;
  fs::copy_file(study / "models" / "1.elrom", study / "models" / "2.elrom");
  for (std::size_t i = 0; i < n; ++i) {
    if (i % 4 == 0) {  // a quarter of the kills hits the taking in
      fs::remove_all(study / "models");
      fs::remove(model);
      fs::copy_file(shop.folder / "study_whole" / "model.elrom", model);
    } else if (!fs::exists(study / "models" / "2.elrom")) {
      fs::copy_file(shop.folder / "study_whole" / "model.elrom", study / "models" / "2.elrom");
    }
    kill_at_random(promote(i % 4 == 0 ? 1 : 1 + static_cast<int>(i % 2)), 1.5 * seconds, random);
    tally.count(fs::exists(model) && base::sha256_file(model) == first, "versions: no whole model answers");
    const auto again = run(promote(1));
    tally.count(again.status == 0 && fs::is_symlink(model), "versions after a kill: " + again.output);
  }
}

void kill_predictions(const Workshop& shop, std::size_t n, base::Random& random, Tally& tally) {
  const auto bundle = shop.folder / "study_whole" / "model.elrom";
  const auto output = shop.folder / "predictions";
  const auto command = shop.predict_command(bundle, output);
  const double seconds = run(command).seconds;
  for (std::size_t i = 0; i < n; ++i) {
    if (i % 2 == 0) fs::remove_all(output);  // and every other time over older predictions
    kill_at_random(command, 1.1 * seconds, random);
    tally.count(predictions_whole(output), "prediction: a broken file");
  }
  const auto again = run(command);
  tally.count(again.status == 0 && predictions_whole(output), "prediction after kills: " + again.output);
}

/// Of all files of a folder, their names too.
std::string digest_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder)] = base::sha256_file(entry.path());
  base::Sha256 digest;
  for (const auto& [name, of_file] : files) digest.add(name).add(of_file);
  return digest.hex();
}

/// Time folders of an OpenFOAM case, replaced by turns by the starts of two cases.
void kill_starts(const Workshop& shop, std::size_t n, base::Random& random, Tally& tally) {
  const auto foam = shop.folder / "foam", start = foam / "0";
  fs::copy(shop.source / "data/formats/instants/case", foam, fs::copy_options::recursive);
  const auto command = [&](const std::string& name) {
    auto words = shop.predict_command(shop.folder / "study_whole" / "model.elrom", foam);
    for (const auto& word :
         {"--case", name.c_str(), "--format", "openfoam", "--onto", foam.c_str(), "--overwrite"})
      words.emplace_back(word);
    return words;
  };
  std::map<std::string, std::string> whole;
  double seconds = 0;
  for (const auto* name : {"load_064", "load_098"}) {
    const auto made = run(command(name));
    if (made.status != 0) throw std::runtime_error("cannot make a start: " + made.output);
    seconds = made.seconds;
    whole[digest_of(start)] = name;
  }
  const auto others = digest_of(foam / "13");
  for (std::size_t i = 0; i < n; ++i) {
    kill_at_random(command(i % 2 == 0 ? "load_064" : "load_098"), 1.1 * seconds, random);
    tally.count(fs::exists(start) && whole.contains(digest_of(start)), "starts: a broken time folder");
  }
  const auto again = run(command("load_064"));
  tally.count(again.status == 0 && whole[digest_of(start)] == "load_064",
              "start after kills: " + again.output);
  tally.count(digest_of(foam / "13") == others, "starts: another time folder changed");
}

/// Kills through one set until a run ends by itself; its bytes are those of a run left alone.
void kill_collisions(const Workshop& shop, std::size_t n, base::Random& random, Tally& tally) {
  const auto whole = shop.folder / "whole_collisions.h5", output = shop.folder / "killed_collisions.h5";
  const std::size_t n_pairs = shop.times(60000, 20000);
  const auto made = run(shop.collide_command(whole, n_pairs));
  if (made.status != 0) throw std::runtime_error("cannot collide: " + made.output);
  const auto wanted = base::sha256_file(whole);
  for (std::size_t n_kills = 0; n_kills < n;) {
    fs::remove(output);
    while (n_kills < n && kill_at_random(shop.collide_command(output, n_pairs), made.seconds, random)) {
      ++n_kills;
      tally.count(!fs::exists(output) || base::sha256_file(output) == wanted, "collisions: a broken file");
    }
    const auto again = run(shop.collide_command(output, n_pairs));
    tally.count(again.status == 0 && base::sha256_file(output) == wanted,
                "collisions after kills: another file than without, or none: " + again.output);
    tally.count(!fs::exists(shop.folder / ".killed_collisions.h5.blocks"), "collisions: blocks stay");
  }
}

/// The learned numbers of a collision model; its texts hold the seconds it took.
std::string tensors_of(const fs::path& model) {
  base::Sha256 digest;
  const auto file = io::TensorFile::open(model);
  for (const auto& [name, tensor] : file.tensors()) {
    digest.add(name);
    digest.add(tensor.bytes());
  }
  return digest.hex();
}

/// Kills a search for trees' hyperparameters until it ends by itself, with the model of a run left alone.
void kill_tree_searches(const Workshop& shop, std::size_t n, base::Random& random, Tally& tally) {
  const auto set = shop.folder / "kill_learn.h5", whole = shop.folder / "learn_whole.elrom",
             model = shop.folder / "learn_killed.elrom";
  const auto command = [&](const fs::path& output) {
    return std::vector<std::string>{shop.program("elrom-train"),
                                    "collisions",
                                    set.string(),
                                    "--regressor",
                                    "trees",
                                    "--trials",
                                    "10",
                                    "--output",
                                    output.string()};
  };
  const auto made = run(shop.collide_command(set, 6000));
  if (made.status != 0) throw std::runtime_error("cannot collide: " + made.output);
  const auto learned = run(command(whole));
  if (learned.status == static_cast<int>(ExitStatus::not_built)) return;  // without XGBoost
  if (learned.status != 0) throw std::runtime_error("cannot learn: " + learned.output);
  const auto wanted = tensors_of(whole);
  for (std::size_t n_kills = 0; n_kills < n;) {
    fs::remove(model);
    fs::remove(model.string() + ".trials.sqlite");
    while (n_kills < n && kill_at_random(command(model), learned.seconds, random)) {
      ++n_kills;
      tally.count(!fs::exists(model) || tensors_of(model) == wanted, "collision model: a broken file");
    }
    const auto again = run(command(model));
    tally.count(again.status == 0 && tensors_of(model) == wanted,
                "collision model after kills: other trees than without, or none: " + again.output);
  }
}

/// What every trial of a study's searches was worth.
std::map<std::string, double> trials_of(const fs::path& study) {
  std::map<std::string, double> values;
  for (const auto& search : networks::TrialStore(study / "search.sqlite").searches()) {
    for (const auto& trial : search.trials) {
      values[search.digest + " " + networks::SearchSpace::key(trial.hyperparameters) + " " +
             std::to_string(trial.i_seed)] = trial.value;
    }
  }
  return values;
}

/// Two fields, screened, banded, searched and built by networks of a few epochs: every stage of a training,
/// in seconds.
constexpr const char* network_settings = R"(
method = "networks"
effort = "quick"
seed = 5
threads = 2
[fields]
names = ["gas_velocity_z", "pressure"]
[screen]
builds = 2
max_epochs = 5
[search]
trials = 6
confirm = 2
confirm_seeds = 1
max_epochs = 6
n_units = [8, 16]
[fit]
builds = 2
max_epochs = 8
[peers]
methods = ["linear"]
folds = 3
)";

}  // namespace

bool predictions_whole(const fs::path& folder) {
  if (!fs::exists(folder)) return true;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".hdf") continue;
    try {
      const auto file = io::Hdf5File::open(entry.path());
      for (const auto& name : file.group("elrom/fields").names()) {
        (void)file.dataset("elrom/fields/" + name).read<float>();
      }
    } catch (const std::exception&) {
      return false;
    }
  }
  return true;
}

Tally network_kills(const Workshop& shop) {
  Tally tally;
  base::Random random(shop.seed.derive("network kills"));
  const auto whole = shop.folder / "networks_whole", study = shop.folder / "networks_killed";
  shop.make_study(whole, 24, network_settings);
  const auto trained = run(shop.train_command(whole));
  if (trained.status == static_cast<int>(ExitStatus::not_built)) {
    tally.skipped = "this build has no LibTorch";
    return tally;
  }
  if (trained.status != 0) throw std::runtime_error("cannot train networks: " + trained.output);
  const auto wanted = base::sha256_file(whole / "model.elrom");
  const auto wanted_trials = trials_of(whole);
  // Kills through one study until a run ends by itself, and through as many studies as that takes.
  for (std::size_t n_kills = 0, n = shop.times(50, 5); n_kills < n;) {
    begin_anew(whole, study);
    while (n_kills < n && kill_at_random(shop.train_command(study), trained.seconds, random)) {
      ++n_kills;
      const bool absent = !fs::exists(study / "model.elrom");
      tally.count(absent || bundle_whole(study / "model.elrom"), "networks: a broken bundle");
    }
    const auto again = run(shop.train_command(study));
    tally.count(again.status == 0 && base::sha256_file(study / "model.elrom") == wanted,
                "networks after kills: another bundle than without, or none: " + again.output);
    tally.count(trials_of(study) == wanted_trials, "networks after kills: other trials than without");
  }
  return tally;
}

Tally kills(const Workshop& workshop) {
  Tally tally;
  base::Random random(workshop.seed.derive("kills"));
  kill_imports(workshop, workshop.times(60, 6), random, tally);
  kill_trainings(workshop, workshop.times(100, 10), random, tally);
  kill_promotions(workshop, workshop.times(40, 8), random, tally);
  kill_predictions(workshop, workshop.times(40, 6), random, tally);
  kill_starts(workshop, workshop.times(100, 8), random, tally);
  kill_collisions(workshop, workshop.times(60, 6), random, tally);
  kill_tree_searches(workshop, workshop.times(40, 4), random, tally);
  return tally;
}

}  // namespace elrom::faults
