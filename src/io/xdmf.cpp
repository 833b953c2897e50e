#include "io/xdmf.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

#include "core/error.h"
#include "core/safe_file.h"

namespace cairn {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPosition = "sphere_position";
constexpr std::string_view kHead =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
    "    <Grid Name=\"spheres\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
constexpr std::string_view kTail = "    </Grid>\n  </Domain>\n</Xdmf>\n";

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

/// One snapshot at a time (s) to show it at; empty when it has no spheres.
std::string grid(const ResultFile& result, std::size_t k, double time, const std::string& constants_group,
                 const std::vector<DatasetInfo>& constants) {
  const std::vector<DatasetInfo> fields = result.list_snapshot(k);
  const auto position = std::ranges::find(fields, kPosition, &DatasetInfo::name);
  if (position == fields.end() || position->shape.size() != 2 || position->shape[1] != 3) return {};
  const std::string file = result.path().filename().string();
  const std::string group = fmt::format("snapshots/{:06}", k);
  const std::uint64_t spheres = position->shape[0];
  std::string text = fmt::format(
      "      <Grid Name=\"{}\" GridType=\"Uniform\">\n"
      "        <Time Value=\"{:.17g}\"/>\n"
      "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\" NodesPerElement=\"1\"/>\n"
      "        <Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
      escaped(result.snapshots()[k].stage), time, spheres, data_item(file, group, *position));
  for (const DatasetInfo& constant : constants) text += attribute(file, constants_group, constant, spheres);
  for (const DatasetInfo& field : fields)
    if (field.name != kPosition) text += attribute(file, group, field, spheres);
  return text + "      </Grid>\n";
}

/// After `last`, and by more than a reader of decimal numbers may drop.
double distinct(double time, double last) {
  constexpr double apart = 1e-9;
  return time > last ? time : last + apart * std::max(1.0, std::abs(last));
}

fs::path sidecar_of(const fs::path& result) {
  return result.string() + ".xdmf";
}

}  // namespace

void require_sidecar(const fs::path& result) {
  const fs::path sidecar = sidecar_of(result);
  struct stat info {};
  if (lstat(sidecar.c_str(), &info) != 0) {
    if (errno == ENOENT) return;
    fail(sidecar, errno);
  }
  std::string begin(kHead.size(), '\0');
  if (S_ISREG(info.st_mode)) {
    const FileDescriptor file = open_for_reading(sidecar);
    const ssize_t got = uninterrupted([&] { return pread(file.get(), begin.data(), begin.size(), 0); });
    if (got < 0) fail(sidecar, errno);
    if (begin == kHead) return;
  }
  throw InputError(
      "{}: is in the way of the sidecar for ParaView and not one of this program's; move it away",
      sidecar.string());
}

void Sidecar::take_in(const ResultFile& result) {
  // When a stage changes bodies, the constants of the snapshots before it get another name.
  if (epoch_ && result.constants("spheres", *epoch_) != constants_group_) *this = {};
  for (; taken_ < result.snapshots().size(); ++taken_) {
    const SnapshotInfo& snapshot = result.snapshots()[taken_];
    if (epoch_ != snapshot.epoch) {
      epoch_ = snapshot.epoch;
      constants_group_ = result.constants("spheres", *epoch_);
      constants_ =
          result.has_group(constants_group_) ? result.list(constants_group_) : std::vector<DatasetInfo>{};
    }
    const std::string text =
        grid(result, taken_, distinct(snapshot.time, time_), constants_group_, constants_);
    if (text.empty()) continue;
    grids_ += text;
    time_ = distinct(snapshot.time, time_);
  }
}

void Sidecar::update(const ResultFile& result) {
  take_in(result);
  if (shown_ == 0 || result.finished() || taken_ - shown_ > taken_ / 16) write(result);
}

fs::path Sidecar::write(const ResultFile& result) {
  take_in(result);
  require_sidecar(result.path());
  const fs::path sidecar = sidecar_of(result.path());
  write_file(sidecar, fmt::format("{}{}{}", kHead, grids_, kTail), true);
  shown_ = taken_;
  return sidecar;
}

}  // namespace cairn
