#include "derived_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "elrom/math/statistics.hpp"

namespace elrom::methods {

namespace {

using model::Feature;
using model::FeatureTerm;
using model::LinearForm;

/// The smallest, largest and mean value of a form over the training cases.
struct Range {
  double least = std::numeric_limits<double>::infinity(), most = -least, mean = 0;
  [[nodiscard]] bool wide() const { return least > 0 && most > 2 * least; }
};

/// The symmetric part of the inputs that mirrors exchange, as a sum over them.
struct Quantity {
  std::string name;
  std::vector<std::size_t> inputs;
  LinearForm sum;
  Range range;
  std::string unit;
};

class Builder {
 public:
  Builder(const field::CaseSet& cases, std::span<const std::size_t> rows,
          const std::vector<SymmetryClass>& classes, std::span<const std::string> wanted)
      : cases_(cases), rows_(rows), classes_(classes), wanted_(wanted) {
    for (const auto& orbit : input_orbits(cases)) add_quantity(orbit);
    for (const Quantity& q : quantities_) {
      if (!is_inlet(q)) continue;
      gas_.inputs.insert(gas_.inputs.end(), q.sum.inputs.begin(), q.sum.inputs.end());
      gas_.weights.insert(gas_.weights.end(), q.sum.weights.begin(), q.sum.weights.end());
    }
  }

  DerivedInputs build() {
    add_symmetric();
    for (std::size_t c = 1; c < classes_.size(); ++c) add_imbalances(c);
    return {model::FeatureMap(std::move(features_), static_cast<std::size_t>(cases_.inputs.cols())),
            std::move(class_of_), std::move(forms_), scales()};
  }

 private:
  [[nodiscard]] std::span<const double> inputs_of(std::size_t row) const {
    return {cases_.inputs.row(static_cast<Eigen::Index>(row)).data(),
            static_cast<std::size_t>(cases_.inputs.cols())};
  }

  [[nodiscard]] Range range_of(const LinearForm& form) const {
    Range range;
    for (std::size_t row : rows_) {
      const double value = form.value(inputs_of(row));
      range.least = std::min(range.least, value);
      range.most = std::max(range.most, value);
      range.mean += value / static_cast<double>(rows_.size());
    }
    return range;
  }

  [[nodiscard]] static bool is_inlet(const Quantity& q) { return q.unit == "kg/s" && q.range.least > 0; }

  void add_quantity(const std::vector<std::size_t>& orbit) {
    Quantity q{cases_.schema[orbit.front()].name,
               orbit,
               project_input(cases_, orbit.front(), classes_.front()),
               {},
               {}};
    if (q.sum.inputs.empty()) return;  // like a share q that mirrors take to 1 - q: no symmetric part
    for (double& w : q.sum.weights) w *= static_cast<double>(orbit.size());
    q.sum.offset *= static_cast<double>(orbit.size());
    q.range = range_of(q.sum);
    q.unit = cases_.schema[orbit.front()].unit;
    quantities_.push_back(std::move(q));
  }

  [[nodiscard]] bool varies(const Feature& feature) const {
    math::RunningMoments moments;
    for (std::size_t row : rows_) moments.add(feature.value(inputs_of(row)));
    return moments.deviation() > 1e-9 * std::max(1.0, std::abs(moments.mean()));
  }

  /// Keeps a feature that varies.
  void add(Feature feature, std::size_t class_index) {
    if (!varies(feature)) return;
    features_.push_back(std::move(feature));
    class_of_.push_back(class_index);
  }

  /// log of a form that is positive in all training cases;
  /// held above a thousandth of its mean outside of them.
  [[nodiscard]] static FeatureTerm log_of(const LinearForm& form, const Range& range, double coefficient) {
    return {FeatureTerm::Kind::logarithm, coefficient, form, {}, 1e-3 * range.mean};
  }

  [[nodiscard]] const Quantity* only(const std::string& unit) const {
    const Quantity* found = nullptr;
    for (const Quantity& q : quantities_) {
      if (q.unit != unit || !(q.range.least > 0)) continue;
      if (found != nullptr) return nullptr;
      found = &q;
    }
    return found;
  }

  [[nodiscard]] const Quantity* spread() const {
    for (const Quantity& q : quantities_) {
      if (q.unit == "1" && q.name.find("spread") != std::string::npos) return &q;
    }
    return nullptr;
  }

  /// log(flow * T / Sauter diameter): of a log-normal distribution by mass, d32 = d50 exp(-spread^2 / 2).
  [[nodiscard]] Feature velocity(const std::string& name, const LinearForm& flow, const Range& range) const {
    Feature feature{name, {log_of(flow, range, 1)}};
    if (const Quantity* t = only("K")) feature.terms.push_back(log_of(t->sum, t->range, 1));
    if (const Quantity* d = only("m")) {
      feature.terms.push_back(log_of(d->sum, d->range, -1));
      if (const Quantity* s = spread())
        feature.terms.push_back({FeatureTerm::Kind::square, 0.5, s->sum, {}, 0});
    }
    return feature;
  }

  /// The usual form, which has the quantity's name, or another one that is wanted.
  [[nodiscard]] Feature usual_or_wanted(const Quantity& q) {
    Feature plain{q.name, {{FeatureTerm::Kind::value, 1, q.sum, {}, 0}}};
    if (!(q.range.least > 0)) return plain;
    Feature logarithm{q.name, {log_of(q.sum, q.range, 1)}};
    (q.unit == "1" ? logarithm.name : plain.name) += q.unit == "1" ? ", log" : ", as it is";
    Feature inverse{q.name + ", inverse",
                    {{FeatureTerm::Kind::quotient, 1, {.offset = q.range.mean}, q.sum, 1e-3 * q.range.mean}}};
    const Feature& usual = q.unit == "1" ? plain : logarithm;
    if (!q.range.wide()) return usual;
    forms_.push_back({plain.name, logarithm.name, inverse.name});
    for (const Feature* feature : {&plain, &logarithm, &inverse})
      if (std::ranges::find(wanted_, feature->name) != wanted_.end()) return *feature;
    return usual;
  }

  void add_symmetric() {
    std::vector<const Quantity*> inlets;
    for (const Quantity& q : quantities_)
      if (is_inlet(q)) inlets.push_back(&q);
    if (inlets.size() > 1) {
      const Range range = range_of(gas_);
      const Quantity* largest =
          *std::max_element(inlets.begin(), inlets.end(),
                            [](const auto* a, const auto* b) { return a->range.mean < b->range.mean; });
      add(velocity("velocity of all gas over diameter", gas_, range), 0);
      add(velocity("velocity of " + largest->name + " over diameter", largest->sum, largest->range), 0);
      for (const Quantity* q : inlets) {
        if (q != largest)
          add({"share of " + q->name, {log_of(q->sum, q->range, 1), log_of(gas_, range, -1)}}, 0);
      }
    }
    for (const Quantity& q : quantities_) {
      if (inlets.size() > 1 && std::find(inlets.begin(), inlets.end(), &q) != inlets.end()) continue;
      add(usual_or_wanted(q), 0);
    }
  }

  [[nodiscard]] std::vector<Feature> scales() const {
    std::vector<Feature> scales;
    const auto add_scale = [&](const std::string& name, LinearForm form) {
      const double mean = range_of(form).mean;
      for (double& weight : form.weights) weight /= mean;
      form.offset /= mean;
      Feature scale{name, {{FeatureTerm::Kind::logarithm, 1, std::move(form), {}, 1e-3}}};
      if (varies(scale)) scales.push_back(std::move(scale));
    };
    if (!gas_.inputs.empty()) add_scale("all gas", gas_);
    for (const Quantity& q : quantities_)
      if (!is_inlet(q) && (q.unit != "1" || q.range.wide()) && q.range.least > 0) add_scale(q.name, q.sum);
    return scales;
  }

  void add_imbalances(std::size_t class_index) {
    for (const auto& orbit : input_orbits(cases_)) {
      const LinearForm odd = project_input(cases_, orbit.front(), classes_[class_index]);
      if (odd.inputs.empty()) continue;
      const LinearForm even = project_input(cases_, orbit.front(), classes_.front());
      const Range range = range_of(even);
      FeatureTerm term{FeatureTerm::Kind::value, 1, odd, {}, 0};
      if (orbit.size() > 1 && range.least > 0)
        term = {FeatureTerm::Kind::quotient, 1, odd, even, 1e-3 * range.mean};
      add({"imbalance of " + cases_.schema[orbit.front()].name, {std::move(term)}}, class_index);
    }
  }

  const field::CaseSet& cases_;
  std::span<const std::size_t> rows_;
  const std::vector<SymmetryClass>& classes_;
  std::span<const std::string> wanted_;
  std::vector<std::vector<std::string>> forms_;
  std::vector<Quantity> quantities_;
  LinearForm gas_;  // all inlets together
  std::vector<Feature> features_;
  std::vector<std::size_t> class_of_;
};

}  // namespace

DerivedInputs derive_inputs(const field::CaseSet& cases, std::span<const std::size_t> rows,
                            const std::vector<SymmetryClass>& classes, std::span<const std::string> wanted) {
  return Builder(cases, rows, classes, wanted).build();
}

}  // namespace elrom::methods
