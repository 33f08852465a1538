#pragma once
// A request's JSON, read as strictly as our other files: no unknown key, no other type, no repeated key.
//
// Thread rule: plain data.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace elrom::serve {

using Json = nlohmann::ordered_json;

class JsonBody {
 public:
  /// @param keys that it may have
  /// @throws UsageError for what is no JSON (or nested too deeply); InputError for no object, an unknown or a
  ///         repeated key, a text with a NUL
  JsonBody(const std::string& text, const std::vector<std::string>& keys, std::string where = "request");

  [[nodiscard]] bool has(const std::string& key) const { return root_.contains(key); }
  // Each: @throws InputError when it is missing or of another type
  [[nodiscard]] std::string text(const std::string& key) const;
  [[nodiscard]] std::string text_or(const std::string& key, std::string otherwise) const;
  [[nodiscard]] double number(const std::string& key) const;
  [[nodiscard]] double number_or(const std::string& key, double otherwise) const;
  [[nodiscard]] std::int64_t whole(const std::string& key) const;
  [[nodiscard]] bool flag_or(const std::string& key, bool otherwise) const;
  [[nodiscard]] std::vector<std::string> texts(const std::string& key) const;  ///< missing: empty
  [[nodiscard]] std::vector<std::int64_t> wholes(const std::string& key) const;
  [[nodiscard]] JsonBody object(const std::string& key, const std::vector<std::string>& keys) const;
  [[nodiscard]] const Json& at(const std::string& key) const;

 private:
  JsonBody(Json root, const std::vector<std::string>& keys, std::string where, int);
  void expect_keys(const std::vector<std::string>& keys) const;
  [[noreturn]] void fail(const std::string& key, const std::string& expected) const;

  Json root_;
  std::string where_;
};

}  // namespace elrom::serve
