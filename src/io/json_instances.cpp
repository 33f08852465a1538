#include "json_instances.hpp"

ELROM_JSON_INSTANCES(, nlohmann::json);
ELROM_JSON_INSTANCES(, nlohmann::ordered_json);
