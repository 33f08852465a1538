#include "elrom/io/csv.hpp"

#include <algorithm>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "text_encoding.hpp"

namespace elrom::io {

namespace {

constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

class Parser {
 public:
  Parser(std::string_view text, char separator, std::string where)
      : text_(text), separator_(separator), where_(std::move(where)) {}

  [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }
  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] std::string_view rest() const { return text_.substr(at_); }

  // The cells of the next record, or an empty list for a line to skip.
  std::vector<std::string> record() {
    if (skip_line()) return {};
    std::vector<std::string> cells;
    do cells.push_back(cell());
    while (take(separator_));
    if (!at_end() && !end_line()) fail("text after a closing quote");
    return cells;
  }

 private:
  [[noreturn]] void fail(std::string what) const {
    throw InputError({.what = std::move(what), .where = where_ + ":" + std::to_string(line_)});
  }

  bool take(char c) {
    if (at_end() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  bool end_line() {
    const bool carriage = take('\r');
    if (!take('\n') && !carriage) return false;
    ++line_;
    return true;
  }

  bool skip_line() {
    const auto end = text_.find_first_of("\r\n", at_);
    const auto line = text_.substr(at_, end - at_);
    const bool skipped = line.find_first_not_of(" \t") == std::string_view::npos || line.front() == '#';
    if (!skipped) return false;
    at_ = end == std::string_view::npos ? text_.size() : end;
    end_line();
    return true;
  }

  std::string cell() {
    while (!at_end() && (text_[at_] == ' ' || text_[at_] == '\t') && separator_ != text_[at_]) ++at_;
    if (take('"')) return quoted();
    const char stops[] = {separator_, '\r', '\n'};
    const auto end = std::min(text_.find_first_of(std::string_view(stops, sizeof stops), at_), text_.size());
    const auto plain = text_.substr(at_, end - at_);
    at_ = end;
    return base::trim(plain);
  }

  std::string quoted() {
    std::string value;
    const auto begin = line_;
    while (!at_end()) {
      const char c = text_[at_++];
      if (c == '"' && !take('"')) {
        while (take(' ') || take('\t')) {
        }
        return value;
      }
      if (c == '\n') ++line_;
      value += c;
    }
    line_ = begin;
    fail("a quote that is never closed");
  }

  std::string_view text_;
  char separator_;
  std::string where_;
  std::size_t at_ = 0, line_ = 1;
};

/// The first line that is no comment.
std::string_view heading_line(std::string_view text) {
  while (!text.empty()) {
    const auto line = text.substr(0, text.find_first_of("\r\n"));
    if (line.find_first_not_of(" \t") != std::string_view::npos && line.front() != '#') return line;
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return text;
}

constexpr std::string_view separators = ",;\t";

/// Spreadsheets of some countries separate by semicolons, some programs by tabs.
char separator_of(std::string_view text) {
  const auto heading = heading_line(text);
  return *std::ranges::max_element(separators, {}, [&](char c) { return std::ranges::count(heading, c); });
}

std::string name_of_separator(char c) { return c == ',' ? "commas" : c == ';' ? "semicolons" : "tabs"; }

/// Why a line may have another number of cells than there are headings.
std::string advice_on_cells(std::string_view line, std::size_t n_cells, std::size_t n_headings,
                            char separator) {
  for (const char other : separators)
    if (other != separator && std::ranges::count(line, other) + 1 == static_cast<std::ptrdiff_t>(n_headings))
      return "the headings are separated by " + name_of_separator(separator) + " and this line by " +
             name_of_separator(other) + ": use one of them throughout";
  if (separator == ',' && n_cells > n_headings)
    return "commas separate here: write numbers with a decimal point, or separate by semicolons";
  return "";
}

/// Excel's own first line, "sep=;", says what separates. @return whether it was there; it is taken away
bool take_separator_line(std::string_view& text, char& separator) {
  constexpr std::string_view key = "sep=";
  const auto line = text.substr(0, text.find_first_of("\r\n"));
  if (!line.starts_with(key) || line.size() != key.size() + 1) return false;
  separator = line.back();
  text.remove_prefix(line.size());  // its end stays, so that lines are counted right
  return true;
}

std::string cells(std::size_t n) { return std::to_string(n) + (n == 1 ? " cell" : " cells"); }

}  // namespace

std::string CsvTable::place(std::size_t row, std::size_t column) const {
  return where + ":" + std::to_string(lines[row]) + ", column '" + headings[column] + "'";
}

base::Quantity CsvTable::quantity(std::size_t row, std::size_t column) const {
  auto cell = rows[row][column];
  const bool comma = std::ranges::count(cell, ',') == 1 && cell.find('.') == std::string::npos;
  if (comma && separator != ',') std::ranges::replace(cell, ',', '.');
  const bool has_comma = cell.find(',') != std::string::npos;
  auto found = base::split_quantity(cell);
  if (found && !has_comma) return *std::move(found);
  throw InputError({.what = "no finite number",
                    .where = place(row, column),
                    .found = "'" + cell.substr(0, 40) + "'",
                    .advice = has_comma ? "write numbers with a decimal point" : ""});
}

CsvTable parse_csv(std::string_view text, std::string where) {
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  if (text.find('\0') != std::string_view::npos)
    throw InputError({.what = "not a text file",
                      .where = where,
                      .advice = "a spreadsheet saves its table as 'CSV UTF-8'"});
  CsvTable table{.where = where};
  if (!take_separator_line(text, table.separator)) table.separator = separator_of(text);
  Parser parser(text, table.separator, where);
  while (!parser.at_end()) {
    const auto line = parser.line();
    const auto rest = parser.rest();
    auto record = parser.record();
    if (record.empty()) continue;
    if (table.headings.empty()) {
      table.headings = std::move(record);
      continue;
    }
    if (record.size() != table.headings.size()) {
      throw InputError({.what = "wrong number of cells",
                        .where = where + ":" + std::to_string(line),
                        .found = cells(record.size()),
                        .expected = std::to_string(table.headings.size()),
                        .advice = advice_on_cells(rest.substr(0, rest.find_first_of("\r\n")), record.size(),
                                                  table.headings.size(), table.separator)});
    }
    const bool blank = std::ranges::all_of(record, [](const std::string& cell) { return cell.empty(); });
    if (blank && record.size() > 1) continue;  // a row that a spreadsheet left behind
    table.rows.push_back(std::move(record));
    table.lines.push_back(line);
  }
  if (table.headings.empty())
    throw InputError({.what = "empty file", .where = where, .expected = "a line of headings"});
  return table;
}

CsvTable read_csv(const std::filesystem::path& path) {
  return parse_csv(read_small_text(path), path.string());
}

std::string read_small_text(const std::filesystem::path& path) {
  std::error_code fault;
  const auto size = std::filesystem::file_size(path, fault);
  if (!fault && size > most_text_bytes) {
    throw InputError({.what = "file is too large for a table of cases",
                      .where = path.string(),
                      .found = std::to_string(size >> 20) + " MB",
                      .expected = "at most " + std::to_string(most_text_bytes >> 20) + " MB"});
  }
  return in_utf8(base::read_text(path));
}

std::string csv_cell(std::string_view cell) {
  const bool plain = cell.find_first_of(",;\"\r\n#") == std::string_view::npos && base::trim(cell) == cell;
  if (plain) return std::string(cell);
  std::string quoted = "\"";
  for (const char c : cell) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace elrom::io
