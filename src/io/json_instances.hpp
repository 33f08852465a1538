#pragma once
// JSON's code, compiled once (json_instances.cpp) instead of in each of the sources that use it. Comes to
// them with the precompiled header; without it they compile their own, so nobody needs to include this.

#include <nlohmann/json.hpp>
#include <string>

// nlohmann's library lets its names be found through these aliases alone. Members are
// named one by one: all of them would bring the readers and writers of five binary
// formats along, which nobody uses and which cost more than the rest.
#define ELROM_JSON_INSTANCES(DECLARED, Json)                                                 \
  DECLARED template class nlohmann::detail::parser<                                          \
      Json, nlohmann::detail::iterator_input_adapter<std::string::const_iterator>>;          \
  DECLARED template class nlohmann::detail::lexer<                                           \
      Json, nlohmann::detail::iterator_input_adapter<std::string::const_iterator>>;          \
  DECLARED template class nlohmann::detail::serializer<Json>;                                \
  DECLARED template Json::basic_json(const Json&);                                           \
  DECLARED template Json::basic_json(Json::initializer_list_t, bool, Json::value_t);         \
  DECLARED template void Json::json_value::destroy(Json::value_t);                           \
  DECLARED template Json::string_t Json::dump(int, char, bool, Json::error_handler_t) const; \
  DECLARED template void Json::push_back(Json&&);                                            \
  DECLARED template void Json::push_back(const Json&);                                       \
  DECLARED template Json& Json::operator[](Json::size_type);                                 \
  DECLARED template Json& Json::operator[](Json::object_t::key_type);                        \
  DECLARED template const Json& Json::operator[](const Json::object_t::key_type&) const;     \
  DECLARED template Json& Json::at(Json::size_type);                                         \
  DECLARED template const Json& Json::at(Json::size_type) const;                             \
  DECLARED template Json& Json::at(const Json::object_t::key_type&);                         \
  DECLARED template const Json& Json::at(const Json::object_t::key_type&) const

ELROM_JSON_INSTANCES(extern, nlohmann::json);
ELROM_JSON_INSTANCES(extern, nlohmann::ordered_json);
