// Tokens: a secret is "elrom.<name>.<random>", so that it is looked up by what is no secret.

#include <algorithm>

#include "database.hpp"
#include "elrom/base/text.hpp"
#include "elrom/repository/secret.hpp"
#include "elrom/repository/transaction.hpp"

namespace elrom::repository {
namespace {

bool is_token_name(std::string_view name) {
  constexpr std::size_t longest = 100;
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
  };
  return !name.empty() && name.size() <= longest && std::ranges::all_of(name, is_plain);
}

}  // namespace

std::string Transaction::make_token(const std::string& name, Role role) {
  if (!is_token_name(name))
    throw UsageError(Problem{
        .what = "no name for a token", .found = "'" + name + "'", .expected = "letters, digits, '-'"});
  const auto secret = "elrom." + name + "." + random_secret();
  const auto row =
      connection_.query("INSERT INTO tokens VALUES ($1, $2, $3, $4) ON CONFLICT DO NOTHING RETURNING name",
                        {name, std::string(roles.name(role)), secret_hash(secret), now_});
  if (!row->next())
    throw ConflictError(Problem{.what = "a token of that name is there already",
                                .found = "'" + name + "'",
                                .advice = "remove it first, or choose another name"});
  return secret;
}

void Transaction::remove_token(const std::string& name) {
  if (!connection_.query("DELETE FROM tokens WHERE name = $1 RETURNING name", {name})->next())
    throw NotFoundError(Problem{.what = "no token '" + name + "'"});
}

std::vector<Token> Transaction::tokens() {
  return list_of(connection_.query("SELECT name, role, at FROM tokens ORDER BY name", {}),
                 [](const DbRows& row) {
                   return Token{.name = row.text(0), .role = roles.value(row.text(1)), .at = row.real(2)};
                 });
}

std::optional<Token> Transaction::token_of(const std::string& secret) {
  const auto parts = base::split(secret, '.');
  const bool has_name = parts.size() == 3 && is_token_name(parts[1]);
  const auto row = connection_.query("SELECT name, role, hash, at FROM tokens WHERE name = $1",
                                     {has_name ? parts[1] : std::string()});
  const bool known = row->next();
  const auto hash = known ? row->text(2) : secret_hash("nobody's");
  const bool same = same_in_constant_time(secret_hash(secret), hash);
  if (!known || !same) return std::nullopt;
  return Token{.name = row->text(0), .role = roles.value(row->text(1)), .at = row->real(3)};
}

}  // namespace elrom::repository
