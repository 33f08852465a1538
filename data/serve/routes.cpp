#include "desk.hpp"

namespace elrom::serve {

const std::vector<Route>& routes() {
  static const std::vector<Route> all = [] {
    std::vector<Route> table;
    for (auto&& part : {server_routes(), model_routes(), version_routes(), file_routes(), scenario_routes(),
                        run_routes(), field_routes()})
      table.insert(table.end(), part.begin(), part.end());
    return table;
  }();
  return all;
}

}  // namespace elrom::serve
