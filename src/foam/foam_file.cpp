#include "elrom/foam/foam_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/io/text_file.hpp"

namespace elrom::foam {
namespace {

std::filesystem::path with_gz(const std::filesystem::path& path) { return path.string() + ".gz"; }

bool is_punctuation(char c) { return std::string_view("(){}[];").find(c) != std::string_view::npos; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

}  // namespace

bool FoamFile::exists(const std::filesystem::path& path) {
  return std::filesystem::is_regular_file(path) || std::filesystem::is_regular_file(with_gz(path));
}

FoamFile::FoamFile(const std::filesystem::path& path) {
  const bool plain = std::filesystem::is_regular_file(path);
  if (!plain && !std::filesystem::is_regular_file(with_gz(path))) {
    throw InputError(
        {.what = "missing OpenFOAM file", .where = path.string(), .expected = "it, or it with .gz"});
  }
  path_ = plain ? path.string() : with_gz(path).string();
  text_ = io::read_text_file(path_);
  check_header();
}

void FoamFile::check_header() {
  if (peek() != "FoamFile") return;
  token();
  expect("{");
  while (peek() != "}") {
    const auto keyword = token();
    if (keyword == "format") {
      const auto format = token();
      if (format != "ascii")
        fail("format " + std::string(format), "format ascii (convert with foamFormatConvert)");
      expect(";");
    } else if (keyword == "class") {
      class_ = token();
      expect(";");
    } else {
      skip_entry();
    }
  }
  expect("}");
  body_ = at_;
}

void FoamFile::to_body() { at_ = body_; }

bool FoamFile::seek(std::string_view keyword) {
  to_body();
  while (!at_end()) {
    const auto found = token();
    if (found == keyword) return true;
    skip_entry();
  }
  return false;
}

void FoamFile::seek_required(std::string_view keyword) {
  if (!seek(keyword)) fail("no entry '" + std::string(keyword) + "'", "it at the top level of the file");
}

void FoamFile::skip_entry() {
  for (int depth = 0; !at_end();) {
    const auto word = token();
    if (word == "(" || word == "{" || word == "[") ++depth;
    if (word == ")" || word == "}" || word == "]") --depth;
    if (depth < 0) fail("an unmatched " + std::string(word), "balanced brackets");
    if (depth == 0 && word == ";") return;
    if (depth == 0 && word == "}") {  // of a dictionary, or of a uniform list, which ends like any value
      if (peek() == ";") token();
      return;
    }
  }
}

std::string FoamFile::body_with(std::string_view keyword, std::string_view value) {
  seek_required(keyword);
  skip_blanks();
  const auto begin = at_;
  skip_entry();
  const std::string before = text_.substr(begin, text_.rfind(';', at_ - 1) - begin);
  std::string body = text_.substr(body_, begin - body_);
  body.append(value).append(";");
  const std::string repeated = "$" + std::string(keyword);
  for (auto from = at_;;) {
    const auto found = text_.find(repeated, from);
    body += text_.substr(from, found - from);
    if (found == std::string::npos) return body;
    body += before;
    from = found + repeated.size();
  }
}

void FoamFile::skip_blanks() {
  while (at_ < text_.size()) {
    if (is_blank(text_[at_])) {
      ++at_;
    } else if (text_.compare(at_, 2, "//") == 0) {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (text_.compare(at_, 2, "/*") == 0) {
      const auto end = text_.find("*/", at_ + 2);
      at_ = end == std::string::npos ? text_.size() : end + 2;
    } else {
      return;
    }
  }
}

bool FoamFile::at_end() {
  skip_blanks();
  return at_ >= text_.size();
}

std::string_view FoamFile::token() {
  skip_blanks();
  if (at_ >= text_.size()) fail("the end of the file", "more (is the file truncated?)");
  const auto begin = at_;
  if (is_punctuation(text_[at_])) {
    ++at_;
  } else {
    while (at_ < text_.size() && !is_blank(text_[at_]) && !is_punctuation(text_[at_])) ++at_;
  }
  return std::string_view(text_).substr(begin, at_ - begin);
}

std::string_view FoamFile::peek() {
  if (at_end()) return {};
  const auto before = at_;
  const auto word = token();
  at_ = before;
  return word;
}

void FoamFile::expect(std::string_view wanted) {
  const auto found = token();
  if (found != wanted) fail("'" + std::string(found.substr(0, 40)) + "'", "'" + std::string(wanted) + "'");
}

double FoamFile::number() {
  const auto word = token();
  double value = 0;
  const auto* end = word.data() + word.size();
  const auto [stop, fault] = std::from_chars(word.data() + (word.front() == '+' ? 1 : 0), end, value);
  if (fault != std::errc{} || stop != end || !std::isfinite(value)) {
    fail("'" + std::string(word.substr(0, 40)) + "'", "a finite number");
  }
  return value;
}

std::size_t FoamFile::label() {
  const auto word = token();
  std::size_t value = 0;
  const auto* end = word.data() + word.size();
  const auto [stop, fault] = std::from_chars(word.data(), end, value);
  if (fault != std::errc{} || stop != end)
    fail("'" + std::string(word.substr(0, 40)) + "'", "a whole number");
  return value;
}

std::size_t FoamFile::list_size(std::size_t n_expected, std::size_t least_bytes) {
  const auto n = label();
  if (n_expected != 0 && n != n_expected) {
    fail("a list of " + std::to_string(n), std::to_string(n_expected) + " entries");
  }
  // A uniform list `N{value}` is short whatever N is; its N is checked against something by every caller.
  if (peek() != "{" && n > (text_.size() - at_) / least_bytes) {
    fail("a list of " + std::to_string(n), "as many entries in the file (is it truncated?)");
  }
  return n;
}

std::vector<double> FoamFile::scalars(std::size_t n_expected) {
  const auto n = list_size(n_expected, 2);
  if (peek() == "{") {
    if (n_expected == 0) fail("a uniform list", "a list of numbers");
    token();
    const double value = number();
    expect("}");
    return std::vector<double>(n, value);
  }
  std::vector<double> values(n);
  expect("(");
  for (auto& value : values) value = number();
  expect(")");
  return values;
}

std::vector<std::size_t> FoamFile::labels(std::size_t n_expected) {
  std::vector<std::size_t> values(list_size(n_expected, 2));
  expect("(");
  for (auto& value : values) value = label();
  expect(")");
  return values;
}

MatrixD FoamFile::vectors(std::size_t n_expected) {
  const auto n = list_size(n_expected, 7);
  const auto read_one = [&](Eigen::Ref<Eigen::RowVectorXd> row) {
    expect("(");
    for (int d = 0; d < 3; ++d) row(d) = number();
    expect(")");
  };
  Eigen::RowVectorXd one(3);
  if (peek() == "{") {
    if (n_expected == 0) fail("a uniform list", "a list of vectors");
    token();
    read_one(one);
    expect("}");
    return one.replicate(static_cast<Eigen::Index>(n), 1);
  }
  MatrixD values(static_cast<Eigen::Index>(n), 3);
  expect("(");
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    read_one(one);
    values.row(i) = one;
  }
  expect(")");
  return values;
}

double FoamFile::dictionary_number(std::string_view keyword) {
  seek_required(keyword);
  while (peek() != ";") {
    const auto next = peek();
    if (next == "[") {
      while (token() != "]") {
      }
    } else if (next.front() == '-' || next.front() == '+' || next.front() == '.' ||
               std::isdigit(static_cast<unsigned char>(next.front()))) {
      return number();
    } else {
      token();
    }
  }
  fail("no number behind '" + std::string(keyword) + "'", "one");
}

std::string FoamFile::dictionary_word(std::string_view keyword) {
  seek_required(keyword);
  return std::string(token());
}

void FoamFile::fail(std::string_view found, std::string_view expected) const {
  const auto end = text_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, text_.size()));
  const auto line = std::count(text_.begin(), end, '\n') + 1;
  throw InputError({.what = "cannot read OpenFOAM file",
                    .where = path_ + ":" + std::to_string(line),
                    .found = std::string(found),
                    .expected = std::string(expected)});
}

MatrixD read_internal_field(const std::filesystem::path& path, std::size_t n_cells, int n_components) {
  FoamFile file(path);
  file.seek_required("internalField");
  const auto rows = static_cast<Eigen::Index>(n_cells);
  const auto kind = file.token();
  if (kind == "uniform") {
    MatrixD value(1, n_components);
    if (n_components == 3) file.expect("(");
    for (int d = 0; d < n_components; ++d) value(0, d) = file.number();
    return value.replicate(rows, 1);
  }
  if (kind != "nonuniform") file.fail("'" + std::string(kind) + "'", "uniform or nonuniform");
  file.token();  // List<scalar> or List<vector>; the entries' brackets tell
  if (n_components == 3) return file.vectors(n_cells);
  const auto values = file.scalars(n_cells);
  return Eigen::Map<const MatrixD>(values.data(), rows, 1);
}

}  // namespace elrom::foam
