// The same scene gives the same bits on every processor: where whole runs end, as hashes. They change with
// the physics (then the test says the new ones), and with nothing else.
#include <gtest/gtest.h>

#include "core/instruction_set.h"
#include "core/read_file.h"
#include "folder.h"
#include "io/checksum.h"
#include "physics/whole_scenes.h"
#include "result_bits.h"

namespace cairn {
namespace {

/// The first example with fewer grains and in less time.
std::string main_job() {
  std::string scene = read_file(CAIRN_EXAMPLES "/diamonds.toml", "diamonds.toml");
  const auto change = [&](const std::string& from, const std::string& until, const std::string& to) {
    const std::size_t at = scene.find(from), end = scene.find(until, at);
    ASSERT_TRUE(at != std::string::npos && end != std::string::npos) << from;
    scene.replace(at, end - at, to);
  };
  change("count = 300", "\n", "count = 40");
  change("duration = 6500", "\n", "duration = 1500");
  change("duration = 2500", "\n", "duration = 300");
  change("duration = 24000", "\n", "duration = 1000");
  change("path = [", "on_failure", "path = [[0, 18000], [1000, 7000]]\n");
  change("duration = 6000", "\n", "duration = 100");
  return scene;
}

/// Hashes with fused multiply-adds (AVX2, AVX-512, NEON) and without (SSE4).
struct Golden {
  std::string text, fused, plain;
};

const std::map<std::string, Golden>& goldens() {
  static const std::map<std::string, Golden> all{
      {"main job", {main_job(), "85a5c42c56d8e2b5fa47c9ece87f973b", "f38fd295a4b846f4276f3f15fa676e2e"}},
      {"recipe", {kRecipe, "4efcd6d4622e02818c9d8eb85b1c31b9", "689af52de0508408b28ecb5e599ea1b8"}},
      {"walls", {kWalls, "46ddf01e26a8a7199eea06a0a54dca16", "8582896c23637e529c331ad81500124c"}},
      {"flyby", {kFlyby, "395352663c2d0693ff9c3e63dc700114", "45281b23fda637af79652639f113bff0"}},
      {"periodic box", {kBox, "aba370af68180c3151920fa12f4d5003", "e533cf7c7b23343ba840035f2172bd57"}},
      {"collapse with the tree",
       {kCollapse, "3416467dde6da633fb90ca8763039cf9", "1050850a0b6e2e4560621e6a9589fda8"}}};
  return all;
}

/// Of where a run has ended.
std::string hash(const std::filesystem::path& path) {
  Bodies bodies;
  ResultFile::open(path).read_checkpoint(motion_fields(bodies));
  RunningChecksum sum;
  for (const StoredField& field : encode(motion_fields(bodies))) sum.add(field.value.bytes);
  return sum.digest();
}

class GoldenRuns : public testing::TestWithParam<std::string> {};

TEST_P(GoldenRuns, AreTheSameOnEveryProcessor) {
  const OneThread one;
  const Golden& golden = goldens().at(GetParam());
  std::map<std::string, ResultBits> all;
  for (const std::string& set : instruction_sets()) {
    const Folder folder;
    const std::filesystem::path path = folder / "run.h5";
    use_instruction_set(set);
    EXPECT_EQ(new_run(golden.text, path).advance({}), RunEnd::finished);
    EXPECT_EQ(hash(path), set == "SSE4" ? golden.plain : golden.fused) << set;
    all[set] = result_bits(path);
  }
  use_instruction_set(instruction_sets().front());
  if (all.contains("AVX-512")) {
    EXPECT_EQ(difference(all.at("AVX-512"), all.at("AVX2")), "");
  }
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto& [name, golden] : goldens()) out.push_back(name);
  return out;
}

std::string test_name(const testing::TestParamInfo<std::string>& parameter) {
  std::string name = parameter.param;
  std::ranges::replace(name, ' ', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Scenes, GoldenRuns, testing::ValuesIn(names()), test_name);

}  // namespace
}  // namespace cairn
