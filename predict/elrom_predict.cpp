// elrom-predict: fields of a furnace from its boundary conditions.
#include "arguments.hpp"
#include "elrom/base/app.hpp"
#include "run.hpp"

int main(int argc, char** argv) {
  return elrom::base::run_app("elrom-predict", [&] {
    const auto parsed = elrom::predict::parse_arguments(argc, argv);
    return parsed.exit_status ? *parsed.exit_status : elrom::predict::run(parsed.arguments);
  });
}
