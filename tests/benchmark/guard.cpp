// bench-guard: how often the validity guard flags cases that belong to the design it learned from, and how
// often it finds a case with one input moved.
//
// A moved case has one input at 3 conditional sigma from what is usual at its load, above or below, its other
// inputs as they were. Usual is what a user reads off a plot of that input against load: a parabola through
// all training cases, and a sigma that grows in proportion to the load; the guard does not see the load.
// Judged are the held-out cases by a guard of all training cases, and every training case by a guard of the
// others, for each folder of cases and for all of them together.

#include "elrom/model/guard.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/text.hpp"
#include "elrom/math/statistics.hpp"
#include "support/benchmark.hpp"

namespace {

using namespace elrom;
using Json = nlohmann::ordered_json;

constexpr double moved_by = 3;

struct Options {
  bool small = false;
  std::filesystem::path json;
  std::vector<std::string> folders;
};

struct Design {
  field::InputSchema schema;
  std::vector<field::CaseInputs> training, held_out;
};

void add_cases(Design& design, const std::filesystem::path& folder) {
  const auto path = folder / "cases.csv";
  if (design.schema.size() == 0) design.schema = field::read_schema(path);
  for (auto& one : field::read_cases(path, design.schema)) {
    if (one.name.starts_with("load_")) design.held_out.push_back(one);
    if (one.name.starts_with("train_")) design.training.push_back(std::move(one));
  }
}

model::Guard guard_of(const Design& design, std::size_t without) {
  std::vector<std::string> names;
  std::vector<double> loads;
  MatrixD inputs(static_cast<Eigen::Index>(design.training.size()),
                 static_cast<Eigen::Index>(design.schema.size()));
  for (std::size_t i = 0; i < design.training.size(); ++i) {
    if (i == without) continue;
    const auto& one = design.training[i];
    inputs.row(static_cast<Eigen::Index>(names.size())) =
        Eigen::Map<const Eigen::RowVectorXd>(one.values.data(), inputs.cols());
    names.push_back(one.name);
    loads.push_back(one.load);
  }
  inputs.conservativeResize(static_cast<Eigen::Index>(names.size()), Eigen::NoChange);
  return {design.schema, inputs, names, loads};
}

/// What is usual for one input at a load.
struct UsualAtLoad {
  Eigen::Vector3d curve;
  double relative = 0;  ///< sigma over load

  [[nodiscard]] double value(double load) const { return curve.dot(Eigen::Vector3d(1, load, load * load)); }
};

UsualAtLoad usual_at_load(const Design& design, std::size_t input) {
  const auto n = static_cast<Eigen::Index>(design.training.size());
  Eigen::MatrixXd powers(n, 3);
  Eigen::VectorXd values(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& one = design.training[static_cast<std::size_t>(i)];
    powers.row(i) << 1, one.load, one.load * one.load;
    values[i] = one.values[input];
  }
  UsualAtLoad usual{powers.colPivHouseholderQr().solve(values), 0};
  const Eigen::ArrayXd left = values - powers * usual.curve;
  // Where the scatter does not grow with the load, the same sigma stands at every load.
  const Eigen::ArrayXd load = powers.col(1);
  const double constant = std::sqrt(left.square().mean());
  const Eigen::ArrayXd by_load = left / load;
  const double likelihood = -std::log(std::sqrt(by_load.square().mean())) - load.log().mean();
  usual.relative = likelihood > -std::log(constant) ? std::sqrt(by_load.square().mean()) : -constant;
  return usual;
}

double sigma_at(const UsualAtLoad& usual, double load) {
  return usual.relative > 0 ? usual.relative * load : -usual.relative;
}

struct Tally {
  std::size_t flagged = 0, of_cases = 0, found = 0, of_moved = 0;

  void judge(const model::Guard& guard, const field::CaseInputs& one, const std::vector<UsualAtLoad>& usual) {
    ++of_cases;
    if (guard.assess(one.values).verdict != model::Verdict::inside) ++flagged;
    for (std::size_t i = 0; i < usual.size(); ++i) {
      for (const double sign : {-1.0, 1.0}) {
        auto moved = one.values;
        moved[i] = usual[i].value(one.load) + sign * moved_by * sigma_at(usual[i], one.load);
        ++of_moved;
        if (guard.assess(moved).verdict != model::Verdict::inside) ++found;
      }
    }
  }
  [[nodiscard]] Json json(const std::string& name) const {
    return {{"cases", name},
            {"flagged_heldout", flagged},
            {"of", of_cases},
            {"found_moved", found},
            {"of_moved", of_moved}};
  }
  void print(const std::string& name) const {
    const auto percent = [](std::size_t a, std::size_t b) {
      return b > 0 ? 100 * static_cast<double>(a) / static_cast<double>(b) : 0.0;
    };
    fmt::print("{:<44} flagged {:3} of {:3} ({:4.1f} %)   moved by {} sigma, found {:5} of {:5} ({:.1f} %)\n",
               name, flagged, of_cases, percent(flagged, of_cases), moved_by, found, of_moved,
               percent(found, of_moved));
  }
};

Json judge(const Design& design, const std::string& name, bool small) {
  std::vector<UsualAtLoad> usual;
  for (std::size_t i = 0; i < design.schema.size(); ++i) usual.push_back(usual_at_load(design, i));
  Tally held_out, left_out;
  const auto guard = guard_of(design, design.training.size());
  for (const auto& one : design.held_out) held_out.judge(guard, one, usual);
  for (std::size_t i = 0; i < design.training.size(); i += small ? 4 : 1)
    left_out.judge(guard_of(design, i), design.training[i], usual);
  const auto title = fmt::format("{} ({} training cases)", name, design.training.size());
  held_out.print(title + ", held out");
  left_out.print(title + ", left out one by one");
  return {held_out.json(title + ", held out"), left_out.json(title + ", left out one by one")};
}

/// Training cases that the guard has never met, by a guard of the folders before.
Json judge_unseen(const Design& design, const Design& unseen, const std::string& folder) {
  std::vector<UsualAtLoad> usual;
  for (std::size_t i = 0; i < design.schema.size(); ++i) usual.push_back(usual_at_load(design, i));
  const auto guard = guard_of(design, design.training.size());
  Tally tally;
  for (const auto& one : unseen.training) tally.judge(guard, one, usual);
  const auto title = fmt::format("{} by the {} training cases before it", folder, design.training.size());
  tally.print(title);
  return tally.json(title);
}

Json measure(const Options& options) {
  Json sets = Json::array();
  Design all;
  for (const auto& folder : options.folders) {
    if (!all.training.empty()) {
      Design unseen;
      add_cases(unseen, folder);
      sets.push_back(judge_unseen(all, unseen, folder));
    }
    add_cases(all, folder);
    const auto name = &folder == &options.folders.front() ? folder : "with " + folder;
    for (auto& set : judge(all, name, options.small)) sets.push_back(std::move(set));
  }
  Json figures = sets.back();  // all cases left out one by one
  figures["sets"] = std::move(sets);
  return figures;
}

}  // namespace

int main(int argc, char** argv) {
  return base::run_app("bench-guard", [&] {
    Options options;
    benchmark::CommandLine line(
        "How often the guard flags healthy cases, and how often it finds a moved input.");
    line.add("--small", options.small, "every fourth case only");
    line.add("--json", options.json, "write the figures there");
    line.add_repeated("--cases", options.folders,
                      "folder with cases.csv; may be repeated: its cases join the others");
    if (const auto status = line.parse(argc, argv)) return *status;
    if (options.folders.empty()) options.folders = {ELROM_SOURCE_DIR "/data/cases"};
    const auto figures = measure(options);
    if (!options.json.empty()) base::write_text(options.json, figures.dump(2) + "\n");
    return 0;
  });
}
