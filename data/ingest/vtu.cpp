// VTK's XML file format of unstructured grids:
// https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html

#include "vtu.hpp"

#include <expat.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <exception>
#include <map>

#include "cell_shapes.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/text_file.hpp"
#include "vtk_array.hpp"

namespace elrom::ingest {
namespace {

using Attributes = std::map<std::string, std::string>;

std::string value_of(const Attributes& attributes, const std::string& name, const std::string& missing = "") {
  const auto found = attributes.find(name);
  return found == attributes.end() ? missing : found->second;
}

struct Array {
  Attributes attributes;
  std::string text;
};

// What the XML says.
struct Document {
  Attributes file, piece;
  std::size_t n_pieces = 0;
  std::map<std::string, Array> arrays;  //!< "points", and of the cells by name
};

[[noreturn]] void refuse(const std::string& where, const std::string& what, const std::string& found,
                         const std::string& expected, const std::string& advice = "") {
  throw InputError({.what = what, .where = where, .found = found, .expected = expected, .advice = advice});
}

class Parser {
 public:
  explicit Parser(std::string where) : where_(std::move(where)), parser_(XML_ParserCreate(nullptr)) {
    check(parser_ != nullptr, "memory for an XML parser");
    XML_SetUserData(parser_, this);
    XML_SetElementHandler(parser_, begin, end);
    XML_SetCharacterDataHandler(parser_, text);
    XML_SetStartDoctypeDeclHandler(parser_, doctype);
  }
  ~Parser() { XML_ParserFree(parser_); }
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  void feed(std::string_view xml, bool last) {
    constexpr std::size_t most = 1 << 24;  // expat counts in int
    do {
      const auto part = xml.substr(0, most);
      xml.remove_prefix(part.size());
      const auto status =
          XML_Parse(parser_, part.data(), static_cast<int>(part.size()), last && xml.empty() ? 1 : 0);
      if (thrown_) std::rethrow_exception(thrown_);
      if (status == XML_STATUS_OK) continue;
      refuse(where_ + ":" + std::to_string(XML_GetCurrentLineNumber(parser_)), "not a .vtu file",
             XML_ErrorString(XML_GetErrorCode(parser_)), "XML");
    } while (!xml.empty());
  }
  [[nodiscard]] Document take() { return std::move(document_); }

 private:
  // No exception may pass through expat.
  template <class Work>
  static void guarded(void* user, Work work) {
    auto& self = *static_cast<Parser*>(user);
    if (self.thrown_) return;
    try {
      work(self);
    } catch (...) {
      self.thrown_ = std::current_exception();
      XML_StopParser(self.parser_, XML_FALSE);
    }
  }
  static void begin(void* user, const XML_Char* name, const XML_Char** pairs) {
    guarded(user, [&](Parser& self) {
      Attributes attributes;
      for (; *pairs; pairs += 2) attributes[pairs[0]] = pairs[1];
      if (self.array_) ++self.inside_array_;
      self.element(name, std::move(attributes));
    });
  }
  static void end(void* user, const XML_Char* name) {
    guarded(user, [&](Parser& self) {
      if (self.array_ && self.inside_array_-- == 0) self.array_ = nullptr;
      if (self.section_ == name) self.section_.clear();
    });
  }
  static void text(void* user, const XML_Char* characters, int n) {
    guarded(user, [&](Parser& self) {
      if (self.array_ && self.inside_array_ == 0)
        self.array_->text.append(characters, static_cast<std::size_t>(n));
    });
  }
  static void doctype(void* user, const XML_Char*, const XML_Char*, const XML_Char*, int) {
    guarded(user,
            [&](Parser& self) { refuse(self.where_, "not a .vtu file", "a document type", "VTKFile"); });
  }

  void element(const std::string& name, Attributes attributes) {
    if (name == "VTKFile")
      document_.file = std::move(attributes);
    else if (name == "Piece" && ++document_.n_pieces == 1)
      document_.piece = std::move(attributes);
    else if (name == "Points" || name == "Cells")
      section_ = name;
    else if (name == "DataArray" && !array_ && document_.n_pieces == 1 && !section_.empty()) {
      const auto key = section_ == "Points" ? "points" : value_of(attributes, "Name");
      array_ = &document_.arrays[key];
      inside_array_ = 0;
      *array_ = {.attributes = std::move(attributes)};
    }
  }

  std::string where_;
  XML_Parser parser_;
  Document document_;
  std::string section_;
  Array* array_ = nullptr;        //!< whose numbers come
  std::size_t inside_array_ = 0;  //!< depth of what VTK notes in it, which is no number of it
  std::exception_ptr thrown_;
};

// The file's arrays, wherever they lie in it.
class Vtu {
 public:
  Vtu(const std::string& text, std::string where) : where_(std::move(where)) {
    const std::string_view whole = text;
    // What is appended raw is no XML.
    const auto appendix = whole.find("<AppendedData");
    Parser parser(where_);
    parser.feed(whole.substr(0, appendix), appendix == std::string_view::npos);
    if (appendix != std::string_view::npos) {
      parser.feed("</VTKFile>", true);
      find_appended(whole.substr(appendix));
    }
    document_ = parser.take();
    read_header(text.size());
  }

  [[nodiscard]] std::size_t count(const std::string& name) const {
    const auto text = value_of(document_.piece, name, "nothing");
    const auto value = base::to_double(text);
    if (!value || !(*value >= 1 && *value <= 2e9) || *value != std::floor(*value))
      refuse(where_, "'" + name + "' of the piece", text, "a whole number, 1 or more");
    return static_cast<std::size_t>(*value);
  }

  [[nodiscard]] std::vector<double> numbers(const std::string& name, std::size_t n) const {
    const auto found = document_.arrays.find(name);
    const auto where = where_ + ", array '" + name + "'";
    if (found == document_.arrays.end()) refuse(where, "missing array", "nothing", "a DataArray");
    const auto& [attributes, text] = found->second;
    const auto type = value_of(attributes, "type"), format = value_of(attributes, "format", "ascii");
    if (bytes_of_vtk_type(type) == 0)
      refuse(where, "unknown type", type, "Float64, Int64 or another of VTK's");
    if (format == "ascii") return vtk_numbers(text, n, where);
    auto encoding = encoding_;
    encoding.where = where;
    if (format == "binary") return vtk_numbers(text, true, type, n, encoding);
    if (format != "appended") refuse(where, "unknown format", format, "ascii, binary or appended");
    const auto offset = base::to_double(value_of(attributes, "offset", "0"));
    if (!offset || !(*offset >= 0 && *offset < static_cast<double>(appended_.size())))
      refuse(where, "offset", value_of(attributes, "offset"), "a place in the appended data");
    return vtk_numbers(appended_.substr(static_cast<std::size_t>(*offset)), base64_, type, n, encoding);
  }

 private:
  void find_appended(std::string_view rest) {
    const auto close = rest.find('>');
    const auto mark = close == std::string_view::npos ? close : rest.find('_', close);
    if (mark == std::string_view::npos) refuse(where_, "damaged file", "AppendedData without '_'", "data");
    base64_ = rest.substr(0, close).find("raw") == std::string_view::npos;
    appended_ = rest.substr(mark + 1);
  }

  void read_header(std::size_t n_bytes) {
    const auto& file = document_.file;
    if (value_of(file, "type") != "UnstructuredGrid")
      refuse(where_, "not a .vtu file", "'" + value_of(file, "type") + "'",
             "a VTKFile of type UnstructuredGrid");
    if (document_.n_pieces != 1)
      refuse(where_, "pieces", std::to_string(document_.n_pieces), "one",
             "merge them: ParaView's Merge Blocks, and save as .vtu");
    if (value_of(file, "byte_order", "LittleEndian") != "LittleEndian")
      refuse(where_, "byte order", value_of(file, "byte_order"), "LittleEndian", "save it again in ParaView");
    const auto compressor = value_of(file, "compressor");
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
      refuse(where_, "compressor", compressor, "none, or zlib",
             "save it again in ParaView with ZLib or none");
    const auto header = value_of(file, "header_type", "UInt32");
    if (header != "UInt32" && header != "UInt64") refuse(where_, "header type", header, "UInt32 or UInt64");
    encoding_ = {
        .header_bytes = bytes_of_vtk_type(header), .compressed = !compressor.empty(), .file_bytes = n_bytes};
  }

  std::string where_;
  Document document_;
  std::string_view appended_;
  bool base64_ = true;
  VtkEncoding encoding_;
};

using Indices = std::vector<std::int32_t>;

// Points of a cell in VTK's order for its type -> bottom and top; a flat cell is both.
struct Shape {
  int type;
  std::vector<std::size_t> bottom, top;

  [[nodiscard]] bool flat() const { return bottom == top; }
  [[nodiscard]] std::size_t n_points() const { return std::max(highest(bottom), highest(top)) + 1; }

 private:
  static std::size_t highest(const std::vector<std::size_t>& places) {
    return *std::max_element(places.begin(), places.end());
  }
};

const Shape& shape_of(double type, const std::string& where) {
  static const std::vector<Shape> shapes = {
      {5, {0, 1, 2}, {0, 1, 2}},  {8, {0, 1, 3, 2}, {0, 1, 3, 2}},  {9, {0, 1, 2, 3}, {0, 1, 2, 3}},
      {10, {0, 1, 2}, {3, 3, 3}}, {11, {0, 1, 3, 2}, {4, 5, 7, 6}}, {12, {0, 1, 2, 3}, {4, 5, 6, 7}},
      {13, {0, 1, 2}, {3, 4, 5}}, {14, {0, 1, 2, 3}, {4, 4, 4, 4}}};
  for (const auto& shape : shapes)
    if (shape.type == type) return shape;
  refuse(where, "a cell of another type", "VTK type " + base::number(type),
         "tetrahedron, voxel, hexahedron, wedge, pyramid, triangle, pixel or quad",
         "ParaView's Tetrahedralize makes simple cells of others");
}

Corners corners_in(const Shape& shape, std::span<const double> points) {
  const auto chosen = [&](const std::vector<std::size_t>& places) {
    Indices indices;
    for (const auto place : places) indices.push_back(static_cast<std::int32_t>(points[place]));
    return indices;
  };
  return corners_of(chosen(shape.bottom), chosen(shape.top));
}

// [m2], of two triangles
double area_of(const Corners& corners, const MatrixD& points) {
  using Eigen::Vector3d;
  const auto at = [&](std::size_t i) { return Vector3d(points.row(corners[i]).transpose()); };
  const Vector3d diagonal = at(2) - at(0);
  return 0.5 * ((at(1) - at(0)).cross(diagonal).norm() + diagonal.cross(at(3) - at(0)).norm());
}

class Cells {
 public:
  Cells(const Vtu& vtu, std::string where) : where_(std::move(where)) {
    const auto n_cells = vtu.count("NumberOfCells"), n_points = vtu.count("NumberOfPoints");
    const auto coordinates = vtu.numbers("points", 3 * n_points);
    set_.points = Eigen::Map<const MatrixD>(coordinates.data(), static_cast<Eigen::Index>(n_points), 3);
    if (!set_.points.allFinite()) refuse(where_, "a point that is not finite", "", "");
    types_ = vtu.numbers("types", n_cells);
    ends_ = vtu.numbers("offsets", n_cells);
    read_connectivity(vtu, static_cast<double>(n_points));
    set_.centre.resize(static_cast<Eigen::Index>(n_cells), 3);
    set_.corners.reserve(8 * n_cells);
    for (std::size_t i = 0; i < n_cells; ++i) add(i);
  }
  [[nodiscard]] CellSet take() { return std::move(set_); }

 private:
  void read_connectivity(const Vtu& vtu, double n_points) {
    double before = 0;
    for (const double end : ends_) {
      if (!(end > before && end <= 16e9)) refuse(where_, "offsets", base::number(end), "ascending numbers");
      before = end;
    }
    connectivity_ = vtu.numbers("connectivity", static_cast<std::size_t>(before));
    for (const double point : connectivity_)
      if (!(point >= 0 && point < n_points))
        refuse(where_, "a corner that is no point", base::number(point),
               "0 to " + base::number(n_points - 1));
  }

  void add(std::size_t i) {
    const auto where = where_ + ", cell " + std::to_string(i);
    const auto& shape = shape_of(types_[i], where);
    const auto begin = i == 0 ? 0 : static_cast<std::size_t>(ends_[i - 1]);
    const auto points = std::span(connectivity_).subspan(begin, static_cast<std::size_t>(ends_[i]) - begin);
    if (points.size() != shape.n_points())
      refuse(where, "corners of a cell", std::to_string(points.size()), std::to_string(shape.n_points()));
    const auto corners = upright(corners_in(shape, points), set_.points);
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (const double point : points) sum += set_.points.row(static_cast<Eigen::Index>(point));
    set_.centre.row(static_cast<Eigen::Index>(i)) = sum / static_cast<double>(points.size());
    set_.corners.insert(set_.corners.end(), corners.begin(), corners.end());
    set_.volume.push_back(shape.flat() ? area_of(corners, set_.points) : volume_of(corners, set_.points));
    if (!(set_.volume.back() > 0) || !std::isfinite(set_.volume.back()))
      refuse(where, "a cell without volume", base::number(set_.volume.back()) + " m3", "a positive volume");
  }

  std::string where_;
  std::vector<double> types_, ends_, connectivity_;
  CellSet set_;
};

}  // namespace

CellSet read_vtu(const std::filesystem::path& path) {
  const auto text = io::read_text_file(path);
  const auto where = path.string();
  return Cells(Vtu(text, where), where).take();
}

}  // namespace elrom::ingest
