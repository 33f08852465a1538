#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "elrom/base/atomic_file.hpp"
#include "elrom/scene/scene_run.hpp"

namespace elrom::scene {
namespace {

static_assert(std::endian::native == std::endian::little);

// Arrays behind the document, each with its number of bytes before it.
class Appended {
 public:
  template <class T>
  std::string add(const std::string& name, const char* type, int components, const std::vector<T>& values) {
    const auto header = fmt::format(
        R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="appended" offset="{}"/>)", type,
        name, components, bytes_.size());
    const std::uint64_t size = values.size() * sizeof(T);
    const auto at = bytes_.size();
    bytes_.resize(at + sizeof size + size);
    std::memcpy(bytes_.data() + at, &size, sizeof size);
    if (size > 0) std::memcpy(bytes_.data() + at + sizeof size, values.data(), size);
    return header;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::vector<float> floats(const Vectors& vectors) {
  std::vector<float> values;
  for (std::size_t i = 0; i < vectors[0].size(); ++i)
    for (const auto& component : vectors) values.push_back(static_cast<float>(component[i]));
  return values;
}

Vectors inside(const Particles& p, const Domain& domain) {
  auto places = p.place;
  if (domain.images().any())
    for (std::size_t i = 0; i < p.size(); ++i) set(places, i, domain.wrapped(get(p.place, i)));
  return places;
}

}  // namespace

void write_vtp(const std::filesystem::path& path, const Particles& p, const Domain& domain) {
  Appended data;
  std::vector<std::int32_t> numbers(p.size()), ends(p.size());
  for (std::size_t i = 0; i < p.size(); ++i)
    numbers[i] = static_cast<std::int32_t>(i), ends[i] = static_cast<std::int32_t>(i + 1);
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n";
  text += fmt::format("<PolyData><Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\">\n<Points>", p.size());
  text += data.add("Points", "Float32", 3, floats(inside(p, domain))) + "</Points>\n<Verts>";
  text += data.add("connectivity", "Int32", 1, numbers) + data.add("offsets", "Int32", 1, ends) +
          "</Verts>\n<PointData>";
  text +=
      data.add("diameter", "Float64", 1, p.diameter) + data.add("velocity", "Float32", 3, floats(p.velocity));
  text += data.add("group", "Int32", 1, p.group) + data.add("id", "Int64", 1, p.id);
  if (p.rotates) text += data.add("spin", "Float32", 3, floats(p.spin));
  text += "</PointData>\n</Piece></PolyData>\n<AppendedData encoding=\"raw\">\n_" + data.bytes() +
          "\n</AppendedData>\n</VTKFile>\n";
  base::write_text(path, text);
}

}  // namespace elrom::scene
