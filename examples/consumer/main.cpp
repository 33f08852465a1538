// The smallest program on top of an installed ELROM: opens a bundle and says what it holds.
#include <iostream>

#include "elrom/base/app.hpp"
#include "elrom/base/version.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/model/predictor.hpp"

int main(int argc, char** argv) {
  return elrom::base::run_app("consumer", [&] {
    std::cout << elrom::program_version() << " knows " << elrom::field::standard_fields().size()
              << " fields\n";
    if (argc < 2) return 0;
    const elrom::model::Predictor predictor(argv[1]);
    for (const auto& field : predictor.fields()) std::cout << field.name << " [" << field.unit << "]\n";
    std::cout << predictor.planes().size() << " planes of " << predictor.n_columns() << " columns\n";
    return 0;
  });
}
