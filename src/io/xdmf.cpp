#include "io/xdmf.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <optional>

#include "core/error.h"

namespace cairn {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPosition = "sphere_position";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// XDMF's name of a number type; none for text.
std::optional<std::string> number_type(ElementType type) {
  switch (type) {
    case ElementType::f64:
      return "NumberType=\"Float\" Precision=\"8\"";
    case ElementType::f32:
      return "NumberType=\"Float\" Precision=\"4\"";
    case ElementType::u64:
      return "NumberType=\"UInt\" Precision=\"8\"";
    case ElementType::i64:
      return "NumberType=\"Int\" Precision=\"8\"";
    case ElementType::u32:
      return "NumberType=\"UInt\" Precision=\"4\"";
    case ElementType::u16:
      return "NumberType=\"UInt\" Precision=\"2\"";
    case ElementType::u8:
      return "NumberType=\"UChar\" Precision=\"1\"";
    case ElementType::text:
      return std::nullopt;
  }
  return std::nullopt;
}

std::string data_item(const std::string& file, const std::string& group, const DatasetInfo& dataset) {
  std::string dimensions;
  for (const std::uint64_t n : dataset.shape)
    dimensions += fmt::format("{}{}", dimensions.empty() ? "" : " ", n);
  return fmt::format("<DataItem Format=\"HDF\" {} Dimensions=\"{}\">{}:/{}/{}</DataItem>",
                     *number_type(dataset.type), dimensions, escaped(file), group, escaped(dataset.name));
}

/// A colour for ParaView: one number or a vector per sphere; empty when the dataset is neither.
std::string attribute(const std::string& file, const std::string& group, const DatasetInfo& dataset,
                      std::uint64_t spheres) {
  if (dataset.axis != "sphere" || dataset.shape.empty() || dataset.shape[0] != spheres) return {};
  const bool vector = dataset.shape.size() == 2 && dataset.shape[1] == 3;
  if ((dataset.shape.size() != 1 && !vector) || !number_type(dataset.type)) return {};
  return fmt::format("        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">{}</Attribute>\n",
                     escaped(dataset.name), vector ? "Vector" : "Scalar", data_item(file, group, dataset));
}

std::string grid(const ResultFile& result, const std::string& file, std::size_t k,
                 const std::string& constants_group, const std::vector<DatasetInfo>& constants) {
  const std::vector<DatasetInfo> fields = result.list_snapshot(k);
  const auto position = std::ranges::find(fields, kPosition, &DatasetInfo::name);
  if (position == fields.end() || position->shape.size() != 2 || position->shape[1] != 3) return {};
  const std::string group = fmt::format("snapshots/{:06}", k);
  const std::uint64_t spheres = position->shape[0];
  std::string text = fmt::format(
      "      <Grid Name=\"{}\" GridType=\"Uniform\">\n"
      "        <Time Value=\"{:.17g}\"/>\n"
      "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\" NodesPerElement=\"1\"/>\n"
      "        <Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
      escaped(result.snapshots()[k].stage), result.snapshots()[k].time, spheres,
      data_item(file, group, *position));
  for (const DatasetInfo& constant : constants) text += attribute(file, constants_group, constant, spheres);
  for (const DatasetInfo& field : fields)
    if (field.name != kPosition) text += attribute(file, group, field, spheres);
  return text + "      </Grid>\n";
}

}  // namespace

fs::path write_xdmf(const ResultFile& result) {
  const fs::path sidecar = result.path().string() + ".xdmf";
  const fs::path temporary = sidecar.string() + ".part";
  const std::string file = result.path().filename().string();
  std::ofstream out(temporary);
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
         "    <Grid Name=\"spheres\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  std::string group;
  std::vector<DatasetInfo> constants;
  std::optional<std::uint64_t> epoch;
  for (std::size_t k = 0; k < result.snapshots().size(); ++k) {
    if (epoch != result.snapshots()[k].epoch) {
      epoch = result.snapshots()[k].epoch;
      group = result.constants("spheres", *epoch);
      constants = result.has_group(group) ? result.list(group) : std::vector<DatasetInfo>{};
    }
    out << grid(result, file, k, group, constants);
  }
  out << "    </Grid>\n  </Domain>\n</Xdmf>\n";
  out.close();
  std::error_code error;
  if (!out) error = std::error_code(errno, std::generic_category());
  if (!error) fs::rename(temporary, sidecar, error);
  if (!error) return sidecar;
  std::error_code ignored;
  fs::remove(temporary, ignored);
  throw InputError("{}: {}", sidecar.string(), error.message());
}

}  // namespace cairn
