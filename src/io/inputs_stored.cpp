// The files of a scene in its result file.
#include "core/error.h"
#include "io/input_store.h"
#include "io/results.h"

namespace cairn {

namespace {

std::string dataset(std::size_t k) {
  return fmt::format("{:04}", k);
}

}  // namespace

void InputFiles::write(ResultFile& file) const {
  if (store_->inputs.empty()) return;
  std::vector<std::string> names, checksums;
  std::vector<std::uint8_t> whole;
  std::vector<std::vector<std::uint8_t>> bytes;
  for (const auto& [name, input] : store_->inputs) {
    names.push_back(name);
    checksums.push_back(input.checksum);
    whole.push_back(input.whole);
    bytes.emplace_back(input.bytes.begin(), input.bytes.end());
  }
  FieldTable table{{"name", "", "of a file, as the scene calls it", &names, "file"},
                   {"checksum", "", "of its content", &checksums, "file"},
                   {"whole", "", "1: its content is here, in the dataset of its number", &whole, "file"}};
  for (std::size_t k = 0; k < bytes.size(); ++k)
    if (whole[k]) table.push_back({dataset(k), "", "bytes of " + names[k], &bytes[k], ""});
  file.write_static("inputs", table);
}

void InputFiles::restore(const ResultFile& file) const {
  store_->inputs.clear();
  store_->closed = true;
  if (!file.has_group("inputs")) return;
  std::vector<std::string> names, checksums;
  std::vector<std::uint8_t> whole;
  file.read_static("inputs", {{"name", "", "", &names, "file"},
                              {"checksum", "", "", &checksums, "file"},
                              {"whole", "", "", &whole, "file"}});
  for (std::size_t k = 0; k < names.size(); ++k) {
    Input input{checksums[k], whole[k] != 0, {}};
    if (input.whole) {
      std::vector<std::uint8_t> bytes;
      file.read_static("inputs", {{dataset(k), "", "", &bytes, ""}});
      input.bytes.assign(bytes.begin(), bytes.end());
      if (checksum_of(input.bytes) != input.checksum)
        throw InputError("{}: inputs/{}: damaged", file.path().string(), dataset(k));
    }
    store_->inputs[names[k]] = std::move(input);
  }
}

}  // namespace cairn
