#include "elrom/model/feature_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "elrom/base/enum_names.hpp"
#include "elrom/base/error.hpp"
#include "model_parts.hpp"

namespace elrom::model {

namespace {

using Json = nlohmann::json;

constexpr base::EnumNames<FeatureTerm::Kind, 4> kinds{"derived input",
                                                      {{FeatureTerm::Kind::value, "value"},
                                                       {FeatureTerm::Kind::square, "square"},
                                                       {FeatureTerm::Kind::logarithm, "logarithm"},
                                                       {FeatureTerm::Kind::quotient, "quotient"}}};

void check_form(const LinearForm& form, std::size_t n_inputs) {
  const bool fits = form.inputs.size() == form.weights.size() &&
                    std::all_of(form.inputs.begin(), form.inputs.end(), [&](std::int32_t i) {
                      return i >= 0 && static_cast<std::size_t>(i) < n_inputs;
                    });
  if (!fits) {
    throw InputError({.what = "a derived input refers to an input that is not there",
                      .expected = "indices below " + std::to_string(n_inputs) + ", each with a weight"});
  }
}

Json to_json(const LinearForm& form) {
  return {{"inputs", form.inputs}, {"weights", form.weights}, {"offset", form.offset}};
}

LinearForm form_of(const Json& json) {
  std::vector<std::int32_t> inputs;
  for (const Json& input : json.at("inputs")) inputs.push_back(whole_number<std::int32_t>(input));
  return {std::move(inputs), json.at("weights").get<std::vector<double>>(), json.at("offset").get<double>()};
}

Json to_json(const Feature& feature) {
  Json terms = Json::array();
  for (const FeatureTerm& term : feature.terms) {
    Json entry{
        {"kind", kinds.name(term.kind)}, {"coefficient", term.coefficient}, {"form", to_json(term.form)}};
    if (term.kind == FeatureTerm::Kind::quotient) entry["denominator"] = to_json(term.denominator);
    if (term.floor > 0) entry["floor"] = term.floor;
    terms.push_back(std::move(entry));
  }
  return {{"name", feature.name}, {"terms", std::move(terms)}};
}

FeatureTerm term_of(const Json& json) {
  FeatureTerm term;
  term.kind = kinds.value(json.at("kind").get<std::string>());
  term.coefficient = json.at("coefficient").get<double>();
  term.form = form_of(json.at("form"));
  if (term.kind == FeatureTerm::Kind::quotient) term.denominator = form_of(json.at("denominator"));
  term.floor = json.value("floor", 0.0);
  return term;
}

}  // namespace

double LinearForm::value(std::span<const double> all_inputs) const {
  double sum = offset;
  for (std::size_t i = 0; i < inputs.size(); ++i)
    sum += weights[i] * all_inputs[static_cast<std::size_t>(inputs[i])];
  return sum;
}

double Feature::value(std::span<const double> inputs) const {
  double sum = 0;
  for (const FeatureTerm& term : terms) {
    const double argument = term.form.value(inputs);
    switch (term.kind) {
      case FeatureTerm::Kind::value:
        sum += term.coefficient * argument;
        break;
      case FeatureTerm::Kind::square:
        sum += term.coefficient * argument * argument;
        break;
      case FeatureTerm::Kind::logarithm:
        sum += term.coefficient * std::log(std::max(argument, term.floor));
        break;
      case FeatureTerm::Kind::quotient:
        sum += term.coefficient * argument / std::max(term.denominator.value(inputs), term.floor);
        break;
    }
  }
  return sum;
}

FeatureMap::FeatureMap(std::vector<Feature> features, std::size_t n_inputs)
    : features_(std::move(features)), n_inputs_(n_inputs) {
  for (const Feature& feature : features_) {
    for (const FeatureTerm& term : feature.terms) {
      check_form(term.form, n_inputs_);
      check_form(term.denominator, n_inputs_);
      const bool needs_floor =
          term.kind == FeatureTerm::Kind::logarithm || term.kind == FeatureTerm::Kind::quotient;
      if (needs_floor && !(term.floor > 0)) {
        throw InputError(
            {.what = "derived input '" + feature.name + "' has no floor", .expected = "a positive one"});
      }
    }
  }
}

void FeatureMap::evaluate(std::span<const double> inputs, std::span<double> out) const {
  check(inputs.size() == n_inputs_ && out.size() == features_.size(), "derived inputs: sizes");
  for (std::size_t i = 0; i < features_.size(); ++i) out[i] = features_[i].value(inputs);
}

void FeatureMap::save(io::TensorFile& file, const std::string& key) const {
  Json features = Json::array();
  for (const Feature& feature : features_) features.push_back(to_json(feature));
  file.set_text(key, Json{{"n_inputs", n_inputs_}, {"features", std::move(features)}}.dump());
}

FeatureMap FeatureMap::load(const io::TensorFile& file, const std::string& key) {
  try {
    const Json json = parse_json(file.text(key));
    std::vector<Feature> features;
    for (const Json& entry : json.at("features")) {
      Feature feature{entry.at("name").get<std::string>(), {}};
      for (const Json& term : entry.at("terms")) feature.terms.push_back(term_of(term));
      features.push_back(std::move(feature));
    }
    return FeatureMap(std::move(features), whole_number<std::size_t>(json.at("n_inputs")));
  } catch (const Json::exception& error) {
    throw InputError({.what = "broken description of derived inputs",
                      .where = file.where() + ":" + key,
                      .found = error.what()});
  }
}

}  // namespace elrom::model
