#include <csignal>
#include <thread>

#include "campaign.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/io/hdf5.hpp"
#include "elrom/model/predictor.hpp"
#include "process.hpp"

namespace elrom::faults {
namespace {

namespace fs = std::filesystem;

/// Starts the command and kills it at a random moment of `seconds`. @return whether it was still at work
bool kill_at_random(const std::vector<std::string>& command, double seconds, base::Random& random) {
  Process process(command);
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds * random.uniform(0.0, 1.1)));
  process.kill(SIGKILL);
  return process.wait().signal == SIGKILL;
}

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
    kill_at_random(shop.import_command(store, adding ? more : first), seconds, random);
    const long state = store_state(store);
    const bool known = adding ? state == 8 || state == 12 : state == -1 || state == 8;
    tally.count(known, "import: a store in state " + std::to_string(state));
    if (state == (adding ? 12 : 8)) continue;
    const auto again = run(shop.import_command(store, adding ? more : first));
    tally.count(again.status == 0 && store_state(store) == (adding ? 12 : 8),
                "import after a kill: " + again.output);
  }
}

void kill_trainings(const Workshop& shop, std::size_t n, base::Random& random, Tally& tally) {
  const auto whole = shop.folder / "study_whole", study = shop.folder / "study_killed";
  shop.make_study(whole, 12);
  const auto trained = run(shop.train_command(whole));
  if (trained.status != 0) throw std::runtime_error("cannot train: " + trained.output);
  const auto wanted = base::sha256_file(whole / "model.elrom");
  for (std::size_t i = 0; i < n; ++i) {
    if (i % 5 == 0) {  // five kills in a row through one study
      fs::remove_all(study);
      fs::create_directories(study);
      fs::copy_file(whole / "snapshots.h5", study / "snapshots.h5");
      fs::copy_file(whole / "study.toml", study / "study.toml");
    }
    kill_at_random(shop.train_command(study), trained.seconds, random);
    const bool absent = !fs::exists(study / "model.elrom");
    tally.count(absent || bundle_whole(study / "model.elrom"), "training: a broken bundle");
    if (i % 5 != 4 && i + 1 != n) continue;
    const auto again = run(shop.train_command(study));
    tally.count(again.status == 0, "training after kills: " + again.output);
    tally.count(again.status == 0 && base::sha256_file(study / "model.elrom") == wanted,
                "training after kills: another bundle than without");
  }
}

void kill_predictions(const Workshop& shop, std::size_t n, base::Random& random, Tally& tally) {
  const auto bundle = shop.folder / "study_whole" / "model.elrom";
  const auto output = shop.folder / "predictions";
  const auto command = shop.predict_command(bundle, output);
  const double seconds = run(command).seconds;
  for (std::size_t i = 0; i < n; ++i) {
    if (i % 2 == 0) fs::remove_all(output);  // and every other time over older predictions
    kill_at_random(command, seconds, random);
    tally.count(predictions_whole(output), "prediction: a broken file");
  }
  const auto again = run(command);
  tally.count(again.status == 0 && predictions_whole(output), "prediction after kills: " + again.output);
}

}  // namespace

Tally kills(const Workshop& workshop) {
  Tally tally;
  base::Random random(workshop.seed.derive("kills"));
  kill_imports(workshop, workshop.times(60, 6), random, tally);
  kill_trainings(workshop, workshop.times(100, 10), random, tally);
  kill_predictions(workshop, workshop.times(40, 6), random, tally);
  return tally;
}

}  // namespace elrom::faults
