#include "fuzz_targets.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>

#include "../../data/foam_file.hpp"
#include "../stability/hard_data.hpp"
#include "elrom/base/error.hpp"
#include "elrom/field/boundary_conditions.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "elrom/model/predictor.hpp"
#include "elrom/study/peers.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::faults {
namespace {

namespace fs = std::filesystem;

/// One folder a process, in memory where the system has such a place.
const fs::path& folder() {
  static const test::TemporaryFolder kept;
  return kept.path();
}

fs::path file_of(const std::string& name, Bytes input) {
  const auto path = folder() / (std::to_string(getpid()) + name);  // a fork shares the folder, not the files
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(input.data()), static_cast<std::streamsize>(input.size()));
  return path;
}

/// A small bundle of two methods, made once.
const fs::path& good_bundle() {
  static const fs::path path = [] {
    const auto data = stability::all_hard_data().front();
    model::Bundle bundle;
    bundle.info.method = "auto";
    bundle.info.fields = data.fields;
    bundle.info.schema = data.cases.schema;
    bundle.info.cases = data.cases.names;
    bundle.mesh = data.cases.mesh;
    bundle.guard = model::Guard(data.cases.schema, data.cases.inputs, data.cases.names, data.cases.loads);
    std::vector<std::size_t> rows(data.cases.n_cases());
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    const char* const methods[] = {"pod_gp", "pod_rbf"};
    for (std::size_t f = 0; f < data.fields.size(); ++f) {
      const study::FieldData field{&data.cases, data.fields[f], data.values[f]};
      bundle.models[data.fields[f].name] = study::make_peer(methods[f % 2])->fit(field, rows, {});
    }
    const auto target = folder() / "good.elrom";
    bundle.write(target);
    return target;
  }();
  return path;
}

void load_and_predict(const fs::path& path, bool verify) {
  const model::Predictor predictor(
      model::BundleReader(path, verify ? io::Verify::on_use : io::Verify::never));
  std::vector<float> values(predictor.size());
  const std::vector<double> inputs(predictor.bundle().info().schema.size(), 1.0);
  model::Predictor::Scratch scratch;
  predictor.predict(inputs, values, {}, scratch);
  (void)predictor.guard().assess(inputs);
  (void)predictor.bundle().mesh();
}

void fuzz_bundle(Bytes input) {
  try {
    const auto path = file_of("any.elrom", input);
    io::TensorFile::open(path).verify_all();
    load_and_predict(path, true);
  } catch (const Error&) {
  }
}

/// Takes numbers from the input, zeros when it is used up.
class Dice {
 public:
  explicit Dice(Bytes input) : input_(input) {}
  std::size_t below(std::size_t n) {
    std::size_t value = 0;
    for (int i = 0; i < 2 && at_ < input_.size(); ++i) value = value << 8 | input_[at_++];
    return n == 0 ? 0 : value % n;
  }
  [[nodiscard]] bool used_up() const { return at_ >= input_.size(); }

 private:
  Bytes input_;
  std::size_t at_ = 0;
};

void change_text(io::TensorFile& file, Dice& dice) {
  auto entry = file.texts().begin();
  std::advance(entry, dice.below(file.texts().size()));
  auto [key, text] = *entry;
  if (text.empty()) return;
  const auto at = dice.below(text.size());
  switch (dice.below(4)) {
    case 0:
      text[at] = static_cast<char>(dice.below(256));
      break;
    case 1:
      text.erase(at, 1 + dice.below(20));
      break;
    case 2:
      text.insert(at, std::to_string(dice.below(65536) * 99991));
      break;
    default:
      text.insert(at, 1 + dice.below(200), static_cast<char>(dice.below(256)));
  }
  file.set_text(key, text);
}

void change_tensor(io::TensorFile& file, Dice& dice) {
  auto entry = file.tensors().begin();
  std::advance(entry, dice.below(file.tensors().size()));
  const auto& tensor = entry->second;
  if (tensor.type() != io::DType::f32 && tensor.type() != io::DType::f64) return;
  auto shape = tensor.shape();
  std::vector<float> values(tensor.size(), 0.5f);
  constexpr float hard[] = {0.f,
                            -1.f,
                            1e38f,
                            1e-42f,
                            std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity()};
  if (!values.empty()) values[dice.below(values.size())] = hard[dice.below(6)];
  if (dice.below(2) == 1 && !shape.empty()) {
    shape[dice.below(shape.size())] = dice.below(5);
    values.assign(std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>()), 0.5f);
  }
  if (dice.below(2) == 1) {
    const std::vector<double> doubles(values.begin(), values.end());
    file.set(entry->first, io::Tensor::copy(std::span<const double>(doubles), shape));
  } else {
    file.set(entry->first, io::Tensor::copy(std::span<const float>(values), shape));
  }
}

void fuzz_bundle_content(Bytes input) {
  try {
    auto file = io::TensorFile::open(good_bundle());
    for (Dice dice(input); !dice.used_up();) {
      if (dice.below(2) == 0)
        change_text(file, dice);
      else
        change_tensor(file, dice);
    }
    const auto path = folder() / (std::to_string(getpid()) + "content.elrom");
    file.write(path);
    load_and_predict(path, false);
  } catch (const Error&) {
  }
}

void fuzz_cases(const std::string& name, Bytes input) {
  try {
    const auto path = file_of(name, input);
    if (name.ends_with(".csv")) (void)field::read_schema(path);
    (void)field::read_cases(path, stability::all_hard_data().front().cases.schema);
  } catch (const Error&) {
  }
}
void fuzz_cases_csv(Bytes input) { fuzz_cases("cases.csv", input); }
void fuzz_cases_json(Bytes input) { fuzz_cases("cases.json", input); }
void fuzz_cases_toml(Bytes input) { fuzz_cases("cases.toml", input); }

void fuzz_fluent(Bytes input) {
  try {
    (void)ingest::read_fluent_ascii(file_of("table.txt", input));
  } catch (const Error&) {
  }
}

void fuzz_foam(Bytes input) {
  try {
    ingest::FoamFile file(file_of("foam", input));
    file.to_body();
    (void)file.vectors();
    if (file.seek("internalField")) (void)file.scalars();
  } catch (const Error&) {
  }
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

const std::vector<FuzzTarget>& fuzz_targets() {
  static const std::vector<FuzzTarget> targets = {{"bundle", fuzz_bundle},
                                                  {"bundle_content", fuzz_bundle_content},
                                                  {"cases_csv", fuzz_cases_csv},
                                                  {"cases_json", fuzz_cases_json},
                                                  {"cases_toml", fuzz_cases_toml},
                                                  {"fluent_ascii", fuzz_fluent},
                                                  {"foam", fuzz_foam}};
  return targets;
}

std::vector<std::string> seeds_of(const std::string& target) {
  const std::string heading =
      "case,load,primary_air [kg/s],secondary_left [t/h],gas_temperature [degC],solids_d50 "
      "[um],return_left_fraction [1]\n";
  const std::string json =
      R"({"case": "a", "load": 0.5, "inputs": {"primary_air [kg/s]": 100, "secondary_left [kg/s]": 5, )"
      R"("gas_temperature [K]": 1100, "solids_d50 [um]": 300, "return_left_fraction": 0.5}})";
  const std::string toml =
      "case = \"a\"\nload = 0.5\n[inputs]\n\"primary_air [kg/s]\" = 100\nsecondary_left = 5\n"
      "gas_temperature = 850\nsolids_d50 = 300\nreturn_left_fraction = 0.5\n";
  const std::string fluent =
      "cellnumber, x-coordinate, y-coordinate, z-coordinate, solids-x-velocity, solids-y-velocity, "
      "solids-z-velocity, "
      "x-velocity, y-velocity, z-velocity, pressure [kPa], solids-diameter, solids-vof\n"
      "1, 0.5, 0.5, 0.5, 1, 2, 3, 4, 5, 6, 7e2, 3e-4, 0.1\n2, 1.5, 0.5, 0.5, 1, 2, 3, 4, 5, 6, 7e2, 3e-4, "
      "0.1\n";
  if (target == "bundle") return {text_of(good_bundle())};
  if (target == "bundle_content")
    return {std::string("\0\1\0\2\0\3\0\4", 8), std::string("\1\1\1\2\1\3\1\4", 8)};
  if (target == "cases_csv") return {heading + "a,0.5,100,20,850,300,0.5\n\"b,c\",0.6,120,22,850,310,0.4\n"};
  if (target == "cases_json") return {json, "[" + json + "]"};
  if (target == "cases_toml") return {toml, "[[cases]]\n" + toml};
  if (target == "fluent_ascii") return {fluent};
  return {"FoamFile{format ascii;}\n2((1 2 3)(4 5 6))\ninternalField nonuniform List<scalar> 2(1 2);",
          "/* x */ 3{(1 2 3)}"};
}

}  // namespace elrom::faults
