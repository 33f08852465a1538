#include "symmetry_classes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace elrom::methods {

bool SymmetryClass::symmetric() const {
  return std::all_of(signs.begin(), signs.end(), [](int s) { return s > 0; });
}

std::vector<SymmetryClass> symmetry_classes(std::size_t n_mirrors) {
  std::vector<SymmetryClass> classes{{}};
  for (std::size_t k = 0; k < n_mirrors; ++k) {
    std::vector<SymmetryClass> longer;
    for (int sign : {1, -1}) {
      for (SymmetryClass c : classes) {
        c.signs.push_back(sign);
        longer.push_back(std::move(c));
      }
    }
    classes = std::move(longer);
  }
  return classes;
}

model::LinearForm project_input(const field::CaseSet& cases, std::size_t input,
                                const SymmetryClass& symmetry) {
  const auto n = static_cast<std::size_t>(cases.inputs.cols());
  std::vector<double> weights(n, 0.0);
  weights[input] = 1;
  double offset = 0;
  for (std::size_t k = 0; k < cases.mirrors.size(); ++k) {
    const field::Mirror& mirror = cases.mirrors[k];
    std::vector<double> image(n, 0.0);  // the form of the mirrored inputs
    double image_offset = offset;
    for (std::size_t i = 0; i < n; ++i) {
      image[static_cast<std::size_t>(mirror.input_from[i])] += weights[i] * mirror.input_sign[i];
      image_offset += weights[i] * mirror.input_offset[i];
    }
    for (std::size_t i = 0; i < n; ++i) weights[i] = 0.5 * (weights[i] + symmetry.signs[k] * image[i]);
    offset = 0.5 * (offset + symmetry.signs[k] * image_offset);
  }
  model::LinearForm form;
  form.offset = offset;
  for (std::size_t i = 0; i < n; ++i) {
    if (std::abs(weights[i]) < 1e-12) continue;
    form.inputs.push_back(static_cast<std::int32_t>(i));
    form.weights.push_back(weights[i]);
  }
  return form;
}

std::vector<std::vector<std::size_t>> input_orbits(const field::CaseSet& cases) {
  const auto n = static_cast<std::size_t>(cases.inputs.cols());
  std::vector<std::size_t> label(n);
  std::iota(label.begin(), label.end(), std::size_t{0});
  for (bool changed = true; changed;) {
    changed = false;
    for (const field::Mirror& mirror : cases.mirrors) {
      for (std::size_t i = 0; i < n; ++i) {
        const auto j = static_cast<std::size_t>(mirror.input_from[i]);
        const std::size_t least = std::min(label[i], label[j]);
        changed = changed || label[i] != least || label[j] != least;
        label[i] = label[j] = least;
      }
    }
  }
  std::vector<std::vector<std::size_t>> orbits;
  for (std::size_t first = 0; first < n; ++first) {
    std::vector<std::size_t> orbit;
    for (std::size_t i = first; i < n; ++i) {
      if (label[i] == first) orbit.push_back(i);
    }
    if (!orbit.empty()) orbits.push_back(std::move(orbit));
  }
  return orbits;
}

}  // namespace elrom::methods
