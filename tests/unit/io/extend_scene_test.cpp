#include "io/extend_scene.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "io/scene.h"

namespace cairn {
namespace {

constexpr const char* kBody = "[[body]]\nshape = 'sphere'\ndensity = 1\n";
constexpr const char* kStages = "[[stage]]\nname = 'a'\nduration = 1\n[[stage]]  # é\nname = 'b' # to be\n";

std::string error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

Scene parsed(const std::string& text) {
  return parse_scene(text, "scene.toml", ".");
}

TEST(ExtendScene, PutsTheExtensionIntoTheLastStageAndChangesItThere) {
  const std::string ends[] = {"  duration = 2.5 # s\n[output]\nsnapshot_interval = 1\n", "duration = 2.5",
                              "duration = 2.5\n[stage.spin]\npath = [[0, 10]]\n",
                              "duration = 2.5\nextension = 1.25e2\nimpact_speed = 3\n",
                              "extension = 0\nduration = 2.5\n"};
  for (const std::string& end : ends) {
    const std::string text = std::string(kBody) + kStages + end;
    const std::string once = extend_last_stage(text, 0.1), twice = extend_last_stage(once, 7.0);
    Scene was = parsed(text);
    for (const auto& [longer, extension] : {std::pair(once, 0.1), std::pair(twice, 7.0)}) {
      const Scene is = parsed(longer);
      ASSERT_EQ(is.stages.size(), 2u);
      EXPECT_EQ(is.stages[1].extension, extension) << longer;
      EXPECT_EQ(is.stages[1].duration, 2.5);
      EXPECT_EQ(is.stages[0].extension, 0.0);
      EXPECT_EQ(is.stages[1].impact_speed, was.stages[1].impact_speed);
      EXPECT_EQ(is.stages[1].spin.has_value(), was.stages[1].spin.has_value());
      EXPECT_EQ(is.output.snapshot_interval, was.output.snapshot_interval);
      EXPECT_EQ(total_duration(is), 3.5 + extension);
    }
    EXPECT_EQ(once.find("'b' # to be"), text.find("'b' # to be"));  // what stands before is untouched
  }
  const std::string row = "stage = [{ name = 'a', duration = 1 }, { name = 'é', duration = 2 }]\n";
  EXPECT_EQ(extend_last_stage(row + kBody, 3.0),
            "stage = [{ name = 'a', duration = 1 }, { name = 'é', extension = 3, duration = 2 }]\n" +
                std::string(kBody));
}

TEST(ExtendScene, AddsStagesAfterAllElse) {
  const std::string text = std::string(kBody) + kStages + "duration = 2\n[output]\nseries_interval = 1";
  const std::string more = "# later\n[[stage]]\nname = 'c'\nduration = 4\nfield = [0, 0, 1]\n";
  const std::string longer = add_stages(text, more, "more.toml");
  EXPECT_EQ(longer, text + "\n" + more);
  const Scene scene = parsed(longer);
  ASSERT_EQ(scene.stages.size(), 3u);
  EXPECT_EQ(scene.stages[2].name, "c");
  EXPECT_EQ(scene.stages[2].duration, 4.0);
  EXPECT_EQ(scene.output.series_interval, 1.0);
}

TEST(ExtendScene, ErrorsNameTheFileAndItsLine) {
  const std::string text = std::string(kBody) + kStages + "duration = 2\n",
                    more = "\n[[stage]]\nname = 'a'\n";
  SourceMap sources;
  sources.file = "run.h5";
  sources.added_file = "more.toml";
  sources.first_added = 1 + static_cast<std::uint32_t>(std::count(text.begin(), text.end(), '\n'));
  const auto error = [&](const std::string& whole) {
    return error_of([&] { parse_scene(whole, sources, "."); });
  };
  EXPECT_EQ(error(text + more + "duration = 1\n"),
            "more.toml:3:8: key 'stage[2].name': expected a name of its own, found 'a' for a second time");
  EXPECT_EQ(error(text + "\n[[stage]]\nname = 'c'\n").find("more.toml:2:"), 0u);
  EXPECT_EQ(error("[[body]]\nshape = 1\n" + text),
            "run.h5:2:9: key 'body[0].shape': expected a string, found an "
            "integer");
}

TEST(ExtendScene, SaysWhatIsWrongWithAddedStages) {
  const std::string text = std::string(kBody) + kStages + "duration = 2\n";
  const auto refused = [&](const std::string& scene, const std::string& more, const std::string& words) {
    const std::string what = error_of([&] { add_stages(scene, more, "more.toml"); });
    EXPECT_NE(what.find(words), std::string::npos) << what;
  };
  refused(text, "[[stage]]\nname = 'c'\nduraton = 4\n", "more.toml:3:1: key 'stage[0].duraton'");
  refused(text, "[[stage]]\nname = 'c'\nduration = -4\n", "more.toml:3:12: key 'stage[0].duration'");
  refused(text, "[[stage]]\nname = 'c'\n[gravity]\nmethod = 'none'\n", "more.toml:3:2: key 'gravity'");
  refused(text, "stage = [{ name = 'c', duration = 1 }]\n", "expected [[stage]] tables");
  refused(text, "\n", "more.toml");
  refused(text, "[[stage]\n", "more.toml:1:");
  refused("stage = [{ name = 'a', duration = 1 }]\n" + std::string(kBody),
          "[[stage]]\nname = 'c'\nduration = 1\n", "stage = [...]");
}

}  // namespace
}  // namespace cairn
