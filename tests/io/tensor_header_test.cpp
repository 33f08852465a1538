#include "tensor_header.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"

namespace elrom::io {
namespace {

using Json = nlohmann::json;

TensorHeader small_header() {
  TensorHeader header;
  header.metadata = {{"plain", "text"},
                     {"escapes", "\" \\ / \b \f \n \r \t \x01 \x7f"},
                     {"json", R"({"a": [1, 2.5, {"b": "c\"d"}]})"},
                     {"units", "\u00b5m, \u00b0C, \u03b5\u209b, \U0001f525"},
                     {"", "an empty name"}};
  header.tensors = {{"a", {DType::f32, {2, 3}, 0, 24}},
                    {"b/\"quoted\" \u03b5", {DType::u8, {}, 24, 25}},
                    {"c", {DType::i64, {0, 7}, 25, 25}}};
  return header;
}

std::optional<TensorHeader> read_header(const std::string& json) {
  try {
    return parse_header(json, 25, "test");
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void expect_equal(const TensorHeader& a, const TensorHeader& b) {
  EXPECT_EQ(a.metadata, b.metadata);
  ASSERT_EQ(a.tensors.size(), b.tensors.size());
  for (const auto& [name, entry] : a.tensors) {
    ASSERT_TRUE(b.tensors.contains(name)) << name;
    const auto& other = b.tensors.at(name);
    EXPECT_EQ(entry.type, other.type);
    EXPECT_EQ(entry.shape, other.shape);
    EXPECT_EQ(std::pair(entry.begin, entry.end), std::pair(other.begin, other.end));
  }
}

TEST(TensorHeader, ReadsWhatItWrote) {
  const auto header = read_header(format_header(small_header()));
  ASSERT_TRUE(header);
  expect_equal(*header, small_header());
}

TEST(TensorHeader, ReadsTheSameInOtherWords) {
  // Spaces, another order, and every character escaped that can be.
  const auto escaped = [](const std::string& text) { return Json(text).dump(-1, ' ', true); };
  std::string json = "{ \t\r\n";
  const auto header = small_header();
  for (auto it = header.tensors.rbegin(); it != header.tensors.rend(); ++it) {
    json += escaped(it->first) + " : { \"data_offsets\" : [ " + std::to_string(it->second.begin) + " , " +
            std::to_string(it->second.end) + " ] , \"dtype\":\"\\u00" +
            (it->second.type == DType::u8    ? "55"
             : it->second.type == DType::f32 ? "46"
                                             : "49") +
            std::string(name_of(it->second.type)).substr(1) +
            "\" , \"shape\" : " + Json(it->second.shape).dump() + "},\n";
  }
  json += "\"__metadata__\" : {";
  for (const auto& [name, text] : header.metadata)
    json += (json.back() == '{' ? "" : ",") + escaped(name) + ":" + escaped(text);
  json += "} } \n";

  const auto found = read_header(json);
  ASSERT_TRUE(found) << json;
  expect_equal(*found, header);
}

/// What a general parser finds in a header; nullopt where it finds no JSON, or one name twice in an object.
std::optional<Json> general(const std::string& json) {
  std::vector<std::set<std::string>> names;  // of the objects the parser is inside of
  bool twice = false;
  const auto watch = [&](int, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::object_start) names.emplace_back();
    if (event == Json::parse_event_t::object_end) names.pop_back();
    if (event == Json::parse_event_t::key) twice |= !names.back().insert(value.get<std::string>()).second;
    return true;
  };
  auto document = Json::parse(json, watch, false);
  if (document.is_discarded() || twice) return std::nullopt;
  return document;
}

/// Tensors as they are in the good header, whatever their names, and texts.
bool is_a_header(const Json& document, const std::multiset<std::string>& good_tensors) {
  if (!document.is_object()) return false;
  std::multiset<std::string> tensors;
  for (const auto& [name, value] : document.items()) {
    if (!value.is_object()) return false;
    if (name != metadata_key) {
      tensors.insert(value.dump());
      for (const auto& [key, item] : value.items())
        if (item.is_array() &&
            !std::ranges::all_of(item, [](const Json& n) { return n.is_number_unsigned(); }))
          return false;
    } else if (!std::ranges::all_of(value, [](const Json& text) { return text.is_string(); })) {
      return false;
    }
  }
  return tensors == good_tensors;
}

// Oracle: a general JSON parser. What it refuses is refused, what is accepted is what it reads, and where it
// still finds a header nothing is refused.
TEST(TensorHeader, AgreesWithAGeneralParserOnDamagedHeaders) {
  const std::string good = format_header(small_header());
  base::Random random(base::Seed(6));
  const std::string bits = "{}[]\",:\\u0019azEe.-+ \n\x01\x7f\x80\xbf\xc0\xc3\xe2\xed\xf0\xf4\xff";
  std::multiset<std::string> tensors;
  for (const auto& [name, value] : general(good)->items())
    if (name != metadata_key) tensors.insert(value.dump());
  int accepted = 0;
  for (int i = 0; i < 60'000; ++i) {
    std::string bad = good;
    for (auto n = 1 + random.below(2); n > 0; --n) {
      const auto place = random.below(bad.size());
      const char c = bits[random.below(bits.size())];
      switch (random.below(3)) {
        case 0:
          bad[place] = c;
          break;
        case 1:
          bad.insert(place, 1, c);
          break;
        default:
          bad.erase(place, 1);
      }
    }
    const auto found = read_header(bad);
    const auto document = general(bad);
    ASSERT_TRUE(found || !document || !is_a_header(*document, tensors)) << "refused: " << bad;
    if (!found) continue;
    ++accepted;
    ASSERT_TRUE(document) << "accepted, but no JSON: " << bad;
    ASSERT_EQ(document->size(), found->tensors.size() + (document->contains(metadata_key) ? 1 : 0)) << bad;
    for (const auto& [name, text] : found->metadata)
      ASSERT_EQ(document->at("__metadata__").at(name), text) << bad;
    for (const auto& [name, entry] : found->tensors) {
      ASSERT_EQ(document->at(name).at("shape").get<std::vector<std::size_t>>(), entry.shape) << bad;
      ASSERT_EQ(document->at(name).at("dtype"), std::string(name_of(entry.type))) << bad;
    }
  }
  EXPECT_GT(accepted, 1000) << "damage inside texts is no fault of the grammar";
}

}  // namespace
}  // namespace elrom::io
