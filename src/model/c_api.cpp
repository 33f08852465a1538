// No exception leaves this file: each becomes a status and a line of text kept for the calling thread.
#include <algorithm>
#include <cstring>
#include <mutex>
#include <new>

#include "elrom/base/c_interface.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "elrom/model/elrom.h"
#include "elrom/model/prediction_file.hpp"

using elrom::model::Predictor;

struct elrom_predictor {
  Predictor predictor;
  mutable std::mutex mutex;
  mutable std::vector<std::unique_ptr<Predictor::Scratch>> idle;  //!< scratch memory of calls that have ended

  elrom_predictor(const char* bundle, elrom::model::Selection selection)
      : predictor(bundle, std::move(selection)) {}
};

namespace {

/// Scratch memory for one call, given back at its end, so that repeated calls allocate nothing.
class Loan {
 public:
  explicit Loan(const elrom_predictor& owner) : owner_(owner) {
    const std::scoped_lock lock(owner_.mutex);
    if (owner_.idle.empty()) {
      scratch_ = std::make_unique<Predictor::Scratch>();
    } else {
      scratch_ = std::move(owner_.idle.back());
      owner_.idle.pop_back();
    }
  }
  ~Loan() {
    const std::scoped_lock lock(owner_.mutex);
    try {
      owner_.idle.push_back(std::move(scratch_));
    } catch (...) {  // then the next call makes a new one
    }
  }
  Loan(const Loan&) = delete;
  Loan& operator=(const Loan&) = delete;
  Predictor::Scratch& scratch() { return *scratch_; }

 private:
  const elrom_predictor& owner_;
  std::unique_ptr<Predictor::Scratch> scratch_;
};

/// One for the process: the HDF5 library is not thread-safe.
std::mutex& hdf5_library() {
  static std::mutex mutex;
  return mutex;
}

void check_threads(int n_threads) {
  if (n_threads < 1) throw elrom::UsageError("n_threads must be 1 or more");
}

std::span<const double> inputs_of(const elrom_predictor& predictor, const double* inputs) {
  elrom::base::c_need(inputs != nullptr, "inputs");
  return {inputs, predictor.predictor.bundle().info().schema.size()};
}

}  // namespace

const char* elrom_last_error(void) { return elrom::base::c_last_error.c_str(); }
const char* elrom_version(void) {
  static const std::string text(elrom::version());
  return text.c_str();
}

elrom_predictor* elrom_open(const char* bundle, const char* fields) {
  elrom_predictor* opened = nullptr;
  elrom::base::c_guarded([&] {
    elrom::base::c_need(bundle != nullptr, "bundle");
    elrom::model::Selection selection;
    if (fields != nullptr && *fields != '\0') {
      for (const auto& name : elrom::base::split(fields, ','))
        selection.fields.push_back(elrom::base::trim(name));
    }
    opened = new elrom_predictor(bundle, std::move(selection));
  });
  return opened;
}

void elrom_close(elrom_predictor* predictor) { delete predictor; }

size_t elrom_n_inputs(const elrom_predictor* p) { return p ? p->predictor.bundle().info().schema.size() : 0; }
size_t elrom_n_fields(const elrom_predictor* p) { return p ? p->predictor.fields().size() : 0; }
size_t elrom_n_planes(const elrom_predictor* p) { return p ? p->predictor.planes().size() : 0; }
size_t elrom_n_columns(const elrom_predictor* p) { return p ? p->predictor.n_columns() : 0; }

const char* elrom_input_name(const elrom_predictor* p, size_t i) {
  return i < elrom_n_inputs(p) ? p->predictor.bundle().info().schema[i].name.c_str() : nullptr;
}
const char* elrom_input_unit(const elrom_predictor* p, size_t i) {
  return i < elrom_n_inputs(p) ? p->predictor.bundle().info().schema[i].unit.c_str() : nullptr;
}
const char* elrom_field_name(const elrom_predictor* p, size_t i) {
  return i < elrom_n_fields(p) ? p->predictor.fields()[i].name.c_str() : nullptr;
}
const char* elrom_field_unit(const elrom_predictor* p, size_t i) {
  return i < elrom_n_fields(p) ? p->predictor.fields()[i].unit.c_str() : nullptr;
}

int elrom_cell_centres(const elrom_predictor* p, double* xyz) {
  return elrom::base::c_guarded([&] {
    elrom::base::c_need(p != nullptr && xyz != nullptr, "predictor or xyz");
    const auto mesh = p->predictor.bundle().mesh();
    std::copy_n(mesh.centre.data(), mesh.centre.size(), xyz);
  });
}

int elrom_read_case(const elrom_predictor* p, const char* cases, const char* name, double* inputs) {
  return elrom::base::c_guarded([&] {
    elrom::base::c_need(p != nullptr && cases != nullptr && name != nullptr && inputs != nullptr,
                        "an argument of elrom_read_case");
    const auto table = elrom::field::read_cases(cases, p->predictor.bundle().info().schema);
    std::vector<std::string> names;
    for (const auto& item : table) {
      names.push_back(item.name);
      if (item.name != name) continue;
      std::copy(item.values.begin(), item.values.end(), inputs);
      return;
    }
    throw elrom::InputError({.what = "no case '" + std::string(name) + "'",
                             .where = cases,
                             .advice = elrom::base::name_advice(name, names)});
  });
}

int elrom_predict(const elrom_predictor* p, const double* inputs, float* values, int n_threads) {
  return elrom::base::c_guarded([&] {
    elrom::base::c_need(p != nullptr && values != nullptr, "predictor or values");
    check_threads(n_threads);
    Loan loan(*p);
    p->predictor.predict(inputs_of(*p, inputs), {values, p->predictor.size()}, {}, loan.scratch(), n_threads);
  });
}

int elrom_write_prediction(const elrom_predictor* p, const double* inputs, const char* name, double load,
                           const char* path, int n_threads) {
  return elrom::base::c_guarded([&] {
    elrom::base::c_need(p != nullptr && name != nullptr && path != nullptr, "predictor, name or path");
    check_threads(n_threads);
    const auto given = inputs_of(*p, inputs);
    const auto& predictor = p->predictor;
    const elrom::field::CaseInputs one{name, load, {given.begin(), given.end()}};
    const auto assessment = predictor.guard().assess(given);
    std::vector<float> values(predictor.size());
    Loan loan(*p);
    predictor.predict(given, values, {}, loan.scratch(), n_threads);
    const elrom::model::PredictionFrame frame(predictor, elrom::model::Extent(predictor.bundle()));
    const std::scoped_lock lock(hdf5_library());
    elrom::model::write_prediction(
        frame, {.inputs = &one, .assessment = &assessment, .values = values, .half_width = {}}, path);
  });
}

int elrom_validity(const elrom_predictor* p, const double* inputs, int* verdict, char* reason,
                   size_t reason_size) {
  return elrom::base::c_guarded([&] {
    elrom::base::c_need(p != nullptr && verdict != nullptr, "predictor or verdict");
    const auto assessment = p->predictor.guard().assess(inputs_of(*p, inputs));
    *verdict = static_cast<int>(assessment.verdict);
    if (reason == nullptr || reason_size == 0) return;
    const std::size_t n = std::min(reason_size - 1, assessment.reason.size());
    std::memcpy(reason, assessment.reason.data(), n);
    reason[n] = '\0';
  });
}
