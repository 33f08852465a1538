// elrom-predict: fields of a furnace from its boundary conditions.
#include "elrom/base/app.hpp"
#include "elrom/fields/arguments.hpp"
#include "elrom/fields/run.hpp"

int main(int argc, char** argv) {
  return elrom::base::run_app("elrom-predict", [&] {
    const auto parsed = elrom::fields::parse_arguments(argc, argv);
    return parsed.exit_status ? *parsed.exit_status : elrom::fields::run(parsed.arguments);
  });
}
