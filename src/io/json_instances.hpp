#pragma once
// JSON's code, compiled once (json_instances.cpp) instead of in each of the sources that use it. Comes to
// them with the precompiled header; without it they compile their own, so nobody needs to include this.

#include <nlohmann/json.hpp>
#include <string>

// nlohmann's library lets its names be found through these aliases alone.
#define ELROM_JSON_INSTANCES(DECLARED, Json)                                        \
  DECLARED template class nlohmann::detail::parser<                                 \
      Json, nlohmann::detail::iterator_input_adapter<std::string::const_iterator>>; \
  DECLARED template class nlohmann::detail::lexer<                                  \
      Json, nlohmann::detail::iterator_input_adapter<std::string::const_iterator>>; \
  DECLARED template class nlohmann::detail::serializer<Json>

ELROM_JSON_INSTANCES(extern, nlohmann::json);
ELROM_JSON_INSTANCES(extern, nlohmann::ordered_json);
extern template class nlohmann::basic_json<>;
extern template class nlohmann::basic_json<nlohmann::ordered_map>;
