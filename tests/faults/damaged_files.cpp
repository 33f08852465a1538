#include <fstream>

#include "campaign.hpp"
#include "elrom/base/error.hpp"
#include "elrom/io/tensor_file.hpp"
#include "elrom/model/predictor.hpp"
#include "process.hpp"

namespace elrom::faults {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_bytes(const fs::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// A trained bundle, small enough to try every byte.
fs::path small_bundle(const Workshop& shop) {
  const auto study = shop.folder / "study_bytes";
  if (!fs::exists(study / "model.elrom")) {
    shop.make_study(study, 10);
    const auto exit = run(shop.train_command(study));
    if (exit.status != 0) throw std::runtime_error("cannot train: " + exit.output);
  }
  return study / "model.elrom";
}

/// What the library says to a bundle: empty when it takes it.
std::string complaint_of_bundle(const fs::path& path) {
  try {
    io::TensorFile::open(path).verify_all();
    const model::Predictor predictor(path);
    return {};
  } catch (const Error& error) {
    return error.what();
  } catch (const std::exception& error) {
    return std::string("NOT OURS: ") + error.what();
  }
}

void cut_bundle(const Workshop& shop, Tally& tally) {
  const auto bytes = bytes_of(small_bundle(shop));
  const auto cut = shop.folder / "cut.elrom";
  const auto n = shop.times(500, 100);
  for (std::size_t i = 0; i < n; ++i) {
    const auto length = bytes.size() * i / n;
    write_bytes(cut, std::string_view(bytes).substr(0, length));
    const auto complaint = complaint_of_bundle(cut);
    tally.count(
        complaint.find("cut.elrom") != std::string::npos && complaint.find("NOT OURS") == std::string::npos,
        "bundle of " + std::to_string(length) + " bytes: " + complaint);
  }
}

/// Cuts a file and lets a program have it: exit status 3 and the file's name, never a signal.
void cut_for_program(const fs::path& whole, const std::string& name, std::size_t n,
                     const std::function<std::vector<std::string>(const fs::path&)>& command,
                     const Workshop& shop, Tally& tally) {
  const auto bytes = bytes_of(whole);
  const auto cut = shop.folder / name;
  for (std::size_t i = 0; i < n; ++i) {
    const auto length = bytes.size() * i / n;
    write_bytes(cut, std::string_view(bytes).substr(0, length));
    const auto exit = run(command(cut));
    tally.count(
        exit.status == static_cast<int>(ExitStatus::input) && exit.output.find(name) != std::string::npos,
        name + " of " + std::to_string(length) + " bytes: status " + std::to_string(exit.status) + ", " +
            exit.output);
  }
}

/// Places of the fields' tensors in a bundle: what every prediction reads.
std::vector<std::size_t> field_bytes(const fs::path& bundle, const std::string& bytes) {
  std::vector<std::size_t> places;
  const auto file = io::TensorFile::open(bundle);
  for (const auto& [name, tensor] : file.tensors()) {
    const std::string_view content(reinterpret_cast<const char*>(tensor.bytes().data()),
                                   tensor.bytes().size());
    if (!name.starts_with("fields/")) continue;
    const auto begin = bytes.find(content);
    for (std::size_t i = 0; i < content.size(); ++i) places.push_back(begin + i);
  }
  return places;
}

/// The same for the program, whose threads and runtime are its own: exit status 3, never a signal.
void flip_for_program(const Workshop& shop, std::string bytes, base::Random& random, Tally& tally) {
  const auto path = shop.folder / "flipped.elrom";
  const auto places = field_bytes(small_bundle(shop), bytes);
  for (std::size_t i = 0; i < shop.times(300, 20); ++i) {
    const auto at = places[random.below(places.size())];
    auto changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    write_bytes(path, changed);
    const auto exit = run(shop.predict_command(path, shop.folder / "flipped_predictions"));
    tally.count(exit.status == static_cast<int>(ExitStatus::input),
                "elrom-predict, byte " + std::to_string(at) + ": status " + std::to_string(exit.status) +
                    ", signal " + std::to_string(exit.signal) + ", " + exit.output);
  }
}

}  // namespace

Tally truncations(const Workshop& shop) {
  Tally tally;
  cut_bundle(shop, tally);
  const auto check = [&](const fs::path& path) {
    return std::vector<std::string>{shop.program("elrom-data"), "check", path.string()};
  };
  const auto train = [&](const fs::path& path) {
    return std::vector<std::string>{shop.program("elrom-train"), "run", (shop.folder / "study_cut").string(),
                                    "--store", path.string()};
  };
  const auto predict = [&](const fs::path& path) {
    return std::vector<std::string>{shop.program("elrom-predict"),
                                    "--bundle",
                                    path.string(),
                                    "--cases",
                                    (shop.source / "data/cases/cases.csv").string(),
                                    "--output",
                                    (shop.folder / "cut_predictions").string()};
  };
  fs::create_directories(shop.folder / "study_cut");
  const auto n = shop.times(100, 10);
  cut_for_program(shop.case_files(1).front(), "cut_case.h5", n, check, shop, tally);
  cut_for_program(shop.source / "data/formats/fluent_ascii/load_064_space.txt.gz", "cut_fluent.txt.gz", n,
                  check, shop, tally);
  cut_for_program(small_bundle(shop).parent_path() / "snapshots.h5", "cut_store.h5", n, train, shop, tally);
  cut_for_program(small_bundle(shop), "cut_model.elrom", n, predict, shop, tally);
  return tally;
}

Tally flipped_bytes(const Workshop& shop) {
  Tally tally;
  auto bytes = bytes_of(small_bundle(shop));
  const auto path = shop.folder / "flipped.elrom";
  base::Random random(shop.seed.derive("flips"));
  const std::size_t stride = shop.small ? std::max<std::size_t>(1, bytes.size() / 500) : 1;
  for (std::size_t i = 0; i < bytes.size(); i += stride) {
    const char before = bytes[i];
    bytes[i] = static_cast<char>(static_cast<unsigned char>(before) ^ (1 + random.below(255)));
    write_bytes(path, bytes);
    const auto complaint = complaint_of_bundle(path);
    tally.count(!complaint.empty() && complaint.find("NOT OURS") == std::string::npos,
                "byte " + std::to_string(i) + ": " + (complaint.empty() ? "not found" : complaint));
    bytes[i] = before;
  }
  flip_for_program(shop, bytes, random, tally);
  return tally;
}

}  // namespace elrom::faults
