// Tables of cell values as text: Fluent's ASCII solution data, and plain CSV with `name [unit]` headings.

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "column_names.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "elrom/io/text_file.hpp"

namespace elrom::ingest {
namespace {

struct Column {
  std::string heading;
  ColumnMeaning meaning;
  base::Unit unit{};           //!< of the values in the file
  std::ptrdiff_t target = -1;  //!< row of CfdCase::values, for fields
};

/// Reads a text line by line without copying it.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}
  /// Next line that is not blank; nullopt at the end.
  std::optional<std::string_view> next() {
    while (begin_ < text_.size()) {
      const auto end = std::min(text_.find('\n', begin_), text_.size());
      const auto line = text_.substr(begin_, end - begin_);
      begin_ = end + 1;
      ++number_;
      if (line.find_first_not_of(" \t\r") != std::string_view::npos) return line;
    }
    return std::nullopt;
  }
  [[nodiscard]] std::size_t number() const { return number_; }

 private:
  std::string_view text_;
  std::size_t begin_ = 0, number_ = 0;
};

std::vector<std::string> split_header(std::string_view line, bool commas) {
  std::vector<std::string> headings;
  if (commas) {
    for (auto& part : base::split(line, ',')) headings.push_back(base::trim(part));
    if (headings.back().empty()) headings.pop_back();  // a comma at the end of every line
    return headings;
  }
  // "pressure [Pa]" is one heading also where blanks separate: a bracket belongs to the word before it.
  std::string blanks(line);
  std::ranges::replace(blanks, '\t', ' ');
  for (const auto& word : base::split(base::trim(blanks), ' ')) {
    const auto text = base::trim(word);
    if (text.empty()) continue;
    if (text.front() == '[' && !headings.empty())
      headings.back() += " " + text;
    else
      headings.push_back(text);
  }
  return headings;
}

// A column of a field that no program is known to have: its unit says that it is one.
void become_own_field(Column& column, const std::string& name, const std::string& symbol,
                      const std::string& where) {
  if (name.empty() || name.find('/') != std::string::npos) {
    throw InputError({.what = "no name for a field",
                      .where = where,
                      .found = "'" + name + "'",
                      .expected = "a name without '/' before the unit"});
  }
  column.meaning = {ColumnKind::field, name, base::unit(symbol).si};
}

Column make_column(const std::string& heading, const std::string& where) {
  const auto [name, symbol] = base::split_unit(heading);
  Column column{.heading = heading, .meaning = column_meaning(name)};
  if (column.meaning.kind == ColumnKind::ignored && !symbol.empty())
    become_own_field(column, name, symbol, where);
  if (column.meaning.kind == ColumnKind::ignored) return column;
  column.unit = base::unit(symbol.empty() ? column.meaning.si : symbol);
  if (column.unit.si != column.meaning.si) {
    throw InputError({.what = "wrong unit of column '" + name + "'",
                      .where = where,
                      .found = symbol,
                      .expected = "one of " + base::join(base::units_of(column.meaning.si), ", ")});
  }
  return column;
}

const Column* find(const std::vector<Column>& columns, ColumnKind kind, std::string_view field = {}) {
  const Column* found = nullptr;
  for (const auto& column : columns) {
    if (column.meaning.kind == kind && column.meaning.field == field) found = &column;
  }
  return found;
}

void require_place(const std::vector<Column>& columns, const std::string& where) {
  const std::array<std::pair<ColumnKind, std::string>, 3> places{
      {{ColumnKind::x, "x"}, {ColumnKind::y, "y"}, {ColumnKind::z, "z"}}};
  for (const auto& [kind, letter] : places) {
    if (find(columns, kind)) continue;
    std::vector<std::string> headings;
    for (const auto& column : columns) headings.push_back(column.heading);
    throw InputError({.what = "missing column '" + letter + "-coordinate'",
                      .where = where,
                      .found = "columns " + base::join(headings, ", "),
                      .expected = letter + "-coordinate or " + letter + " [m]"});
  }
}

// A field may be left out, but not misspelt.
void refuse_misspelt(const std::vector<Column>& columns, const std::string& where) {
  std::vector<std::string> unread;
  for (const auto& column : columns)
    if (column.meaning.kind == ColumnKind::ignored) unread.push_back(column.heading);
  for (const auto& field : field::standard_fields()) {
    if (find(columns, ColumnKind::field, field.name)) continue;
    const auto near = base::closest_name(field.name, unread);
    if (!near) continue;
    throw InputError({.what = "missing column '" + field.name + "'",
                      .where = where,
                      .expected = "a heading among " + base::join(known_headings(field.name), ", "),
                      .advice = "is '" + *near + "' meant?"});
  }
}

// The fields of a table: the standard ones in their order, then the others as they come.
std::vector<field::FieldInfo> number_fields(std::vector<Column>& columns) {
  std::vector<field::FieldInfo> fields;
  const auto take = [&](Column& column) {
    column.target = static_cast<std::ptrdiff_t>(fields.size());
    fields.push_back(field::field_info(column.meaning.field, column.meaning.si));
  };
  for (const auto& info : field::standard_fields())
    for (auto& column : columns)
      if (column.meaning.field == info.name) take(column);
  for (auto& column : columns)
    if (column.meaning.kind == ColumnKind::field && column.target < 0) take(column);
  return fields;
}

std::vector<Column> read_columns(std::string_view header, bool commas, const std::string& where) {
  std::vector<Column> columns;
  for (const auto& heading : split_header(header, commas)) {
    auto column = make_column(heading, where);
    const auto* same = find(columns, column.meaning.kind, column.meaning.field);
    if (column.meaning.kind != ColumnKind::ignored && same) {
      throw InputError({.what = "two columns stand for the same quantity",
                        .where = where,
                        .found = "'" + same->heading + "' and '" + heading + "'",
                        .expected = "one of them"});
    }
    columns.push_back(std::move(column));
  }
  require_place(columns, where);
  refuse_misspelt(columns, where);
  return columns;
}

bool is_separator(char c, bool commas) { return c == ' ' || c == '\t' || c == '\r' || (commas && c == ','); }

/// Numbers of one line into `row`. @return how many there were; row.size() + 1 when there are more than fit
std::size_t parse_row(std::string_view line, bool commas, std::vector<double>& row,
                      const std::string& where) {
  const char* at = line.data();
  const char* const end = at + line.size();
  std::size_t n = 0;
  for (;;) {
    while (at != end && is_separator(*at, commas)) ++at;
    if (at == end) return n;
    if (n == row.size()) return n + 1;
    if (*at == '+') ++at;
    const auto [stop, fault] = std::from_chars(at, end, row[n]);
    if (fault != std::errc{} || (stop != end && !is_separator(*stop, commas))) {
      const char* word_end = at;
      while (word_end != end && !is_separator(*word_end, commas)) ++word_end;
      throw InputError(
          {.what = "not a number",
           .where = where,
           .found = "'" +
                    std::string(at, std::min<std::size_t>(40, static_cast<std::size_t>(word_end - at))) +
                    "'"});
    }
    ++n;
    at = stop;
  }
}

std::size_t count_lines(std::string_view text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
}

/// Coordinates, volumes and fields as they come, in SI. Rows are cells.
struct AsciiTable {
  std::vector<double> centre, volume;
  std::vector<float> values;  //!< (n_cells, n_fields)
};

AsciiTable read_table(Lines& lines, const std::vector<Column>& columns, std::size_t n_fields, bool commas,
                      std::size_t n_expected, const std::string& path) {
  AsciiTable table;
  table.centre.reserve(3 * n_expected);
  table.values.reserve(n_fields * n_expected);
  std::vector<double> row(columns.size());
  std::vector<float> fields(n_fields);
  while (const auto line = lines.next()) {
    const auto where = path + ":" + std::to_string(lines.number());
    const auto n = parse_row(*line, commas, row, where);
    if (n != columns.size()) {
      throw InputError(
          {.what = "wrong number of values in a line",
           .where = where,
           .found = n > columns.size() ? "more than " + std::to_string(columns.size()) : std::to_string(n),
           .expected = std::to_string(columns.size()) + ", one for each heading"});
    }
    double position[3] = {0, 0, 0};
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto& column = columns[i];
      if (column.meaning.kind == ColumnKind::ignored) continue;
      const double value = column.unit.to_si(row[i]);
      if (!std::isfinite(value) || !std::isfinite(static_cast<float>(value))) {
        throw InputError({.what = "value that is no finite number",
                          .where = where + " column '" + column.heading + "'",
                          .found = base::number(row[i])});
      }
      if (column.meaning.kind == ColumnKind::field)
        fields[static_cast<std::size_t>(column.target)] = static_cast<float>(value);
      else if (column.meaning.kind == ColumnKind::volume)
        table.volume.push_back(value);
      else
        position[static_cast<int>(column.meaning.kind) - static_cast<int>(ColumnKind::x)] = value;
    }
    table.centre.insert(table.centre.end(), position, position + 3);
    table.values.insert(table.values.end(), fields.begin(), fields.end());
  }
  return table;
}

std::string case_name(const std::filesystem::path& path) {
  auto name = path.filename();
  if (name.extension() == ".gz") name = name.stem();
  return name.stem().string();
}

}  // namespace

bool begins_like_cells(const std::filesystem::path& path) {
  constexpr std::size_t longest_header = std::size_t{1} << 16;
  constexpr std::ptrdiff_t enough = 2;
  const auto text = io::begin_of_text_file(path, longest_header);
  Lines lines(text);
  const auto header = lines.next();
  if (!header) return false;
  const auto headings = split_header(*header, header->find(',') != std::string_view::npos);
  return std::ranges::count_if(headings, [](const std::string& heading) {
           return column_meaning(base::split_unit(heading).name).kind != ColumnKind::ignored;
         }) >= enough;
}

CfdCase read_fluent_ascii(const std::filesystem::path& path) {
  const auto text = io::read_text_file(path);
  Lines lines(text);
  const auto header = lines.next();
  if (!header)
    throw InputError({.what = "empty table", .where = path.string(), .expected = "a line of headings"});
  const bool commas = header->find(',') != std::string_view::npos;
  auto columns = read_columns(*header, commas, path.string() + ":" + std::to_string(lines.number()));
  auto fields = number_fields(columns);
  const auto table = read_table(lines, columns, fields.size(), commas, count_lines(text), path.string());
  const auto n_cells = static_cast<Eigen::Index>(table.centre.size() / 3);
  if (n_cells == 0) throw InputError({.what = "table without cells", .where = path.string()});

  CfdCase result;
  result.record.source = path.filename().string();
  result.record.source_digest = base::sha256_file(path);
  result.record.inputs.name = case_name(path);
  result.record.inputs.load = std::nan("");
  result.centre = Eigen::Map<const MatrixD>(table.centre.data(), n_cells, 3);
  result.volume = table.volume;
  result.values =
      ConstMapF(table.values.data(), n_cells, static_cast<Eigen::Index>(fields.size())).transpose();
  result.fields = std::move(fields);
  return result;
}

}  // namespace elrom::ingest
