#pragma once
// Small .vtu files in all the ways in which arrays are held.

#include <zlib.h>

#include <cstdint>
#include <string>
#include <vector>

namespace elrom::test {

/// One array, and how its file holds it.
struct VtuStyle {
  enum class Format { ascii, inline_base64, appended_base64, appended_raw };
  Format format = Format::ascii;
  bool compressed = false;
  bool long_header = false;  ///< UInt64
};

/// A box of 1 x 1 x 2 (hexahedron) under a wedge, a pyramid beside it, and a tetrahedron apart.
class VtuFile {
 public:
  explicit VtuFile(VtuStyle style = {}) : style_(style) {}

  std::vector<double> points{0, 0, 0, 1, 0, 0, 1, 1, 0,   0, 1, 0, 0, 0,  2, 1, 0, 2, 1, 1, 2, 0, 1,
                             2, 0, 0, 3, 0, 1, 3, 4, 0.5, 1, 9, 0, 0, 10, 0, 0, 9, 1, 0, 9, 0, 1};
  std::vector<std::int64_t> connectivity{0, 1, 2, 3, 4, 5, 6,  7,  4,  5,  8, 7,
                                         6, 9, 1, 2, 6, 5, 10, 11, 12, 13, 14};
  std::vector<std::int32_t> offsets{8, 14, 19, 23};
  std::vector<std::uint8_t> types{12, 13, 14, 10};

  [[nodiscard]] std::string text() {
    appended_.clear();
    std::string body = "<Points>" + array("Points", "Float64", points, " NumberOfComponents=\"3\"") +
                       "</Points><Cells>" + array("connectivity", "Int64", connectivity) +
                       array("offsets", "Int32", offsets) + array("types", "UInt8", types) + "</Cells>";
    std::string file =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
        "byte_order=\"LittleEndian\"";
    if (style_.long_header) file += " header_type=\"UInt64\"";
    if (style_.compressed) file += " compressor=\"vtkZLibDataCompressor\"";
    file += ">\n<UnstructuredGrid><Piece NumberOfPoints=\"" + std::to_string(points.size() / 3) +
            "\" NumberOfCells=\"" + std::to_string(types.size()) + "\">" + body +
            "</Piece></UnstructuredGrid>\n";
    if (!appended_.empty()) {
      const bool raw = style_.format == VtuStyle::Format::appended_raw;
      file += std::string("<AppendedData encoding=\"") + (raw ? "raw" : "base64") + "\">\n_" + appended_ +
              "\n</AppendedData>\n";
    }
    return file + "</VTKFile>\n";
  }

  static std::string base64(const std::string& bytes) {
    static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
      unsigned bits = 0;
      for (std::size_t k = 0; k < 3; ++k)
        bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
      for (std::size_t k = 0; k < 4; ++k)
        text += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
  }

 private:
  // As VTK notes the range of lengths behind the numbers.
  static constexpr const char* note =
      "<InformationKey name=\"L2_NORM_RANGE\"><Value index=\"0\">0</Value></InformationKey>";

  [[nodiscard]] std::string number(std::uint64_t value) const {
    return {reinterpret_cast<const char*>(&value), style_.long_header ? 8U : 4U};
  }

  template <class T>
  std::string array(const std::string& name, const std::string& type, const std::vector<T>& values,
                    const std::string& more = "") {
    std::string head = "<DataArray type=\"" + type + "\" Name=\"" + name + "\"" + more;
    if (style_.format == VtuStyle::Format::ascii) {
      std::string text;
      for (const auto value : values) text += std::to_string(value) + " ";
      return head + " format=\"ascii\">\n" + text + note + "\n</DataArray>";
    }
    const std::string bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    std::string header = number(bytes.size()), data = bytes;
    if (style_.compressed) std::tie(header, data) = packed(bytes);
    const bool raw = style_.format == VtuStyle::Format::appended_raw;
    // VTK encodes the header of compressed data by itself.
    const auto encoded = raw                 ? header + data
                         : style_.compressed ? base64(header) + base64(data)
                                             : base64(header + data);
    if (style_.format == VtuStyle::Format::inline_base64)
      return head + " format=\"binary\">\n   " + encoded + note + "\n</DataArray>";
    head += " format=\"appended\" offset=\"" + std::to_string(appended_.size()) + "\"/>";
    appended_ += encoded;
    return head;
  }

  /// In blocks of 64 bytes; the last, or the only one, may be shorter.
  [[nodiscard]] std::pair<std::string, std::string> packed(const std::string& bytes) const {
    constexpr std::size_t block = 64;
    const auto n_blocks = (bytes.size() + block - 1) / block;
    std::string header = number(n_blocks) + number(block) + number(bytes.size() % block), data;
    for (std::size_t i = 0; i < n_blocks; ++i) {
      const auto part = bytes.substr(i * block, block);
      std::string out(compressBound(part.size()), '\0');
      uLongf size = out.size();
      compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(part.data()),
               part.size());
      header += number(size);
      data += out.substr(0, size);
    }
    return {header, data};
  }

  VtuStyle style_;
  std::string appended_;
};

}  // namespace elrom::test
