// The sidecar that shows a result file in ParaView.
#include "io/xdmf.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <sstream>

#include "core/error.h"
#include "folder.h"

namespace cairn {
namespace {

namespace fs = std::filesystem;

std::string slurp(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Every element is closed in its order, attributes are quoted, and there is no stray '<' or '&'.
bool well_formed(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t at = 0; at < xml.size(); ++at) {
    if (xml[at] == '&') {
      const std::string entity = xml.substr(at, xml.find(';', at) - at + 1);
      if (entity != "&amp;" && entity != "&lt;" && entity != "&gt;" && entity != "&quot;") return false;
    }
    if (xml[at] != '<') continue;
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (tag.find('<') != std::string::npos || std::ranges::count(tag, '"') % 2 != 0) return false;
    const std::string name = tag.substr(0, tag.find(' '));
    if (name.starts_with('/')) {
      if (open.empty() || "/" + open.back() != name) return false;
      open.pop_back();
    } else if (!tag.starts_with('?') && !tag.ends_with('/')) {
      open.push_back(name);
    }
  }
  return open.empty();
}

/// What stands in every "<Time Value=...>", in their order.
std::vector<double> times(const std::string& xml) {
  std::vector<double> all;
  const std::string begin = "<Time Value=\"";
  for (std::size_t at = 0; (at = xml.find(begin, at)) != xml.npos; at += begin.size())
    all.push_back(std::stod(xml.substr(at + begin.size())));
  return all;
}

class SidecarTest : public testing::Test {
 protected:
  /// Adds a snapshot of two spheres.
  void add(ResultFile& file, double time, std::uint64_t epoch = 0) {
    file.add_snapshot(time, "s", {{"sphere_position", "m", "", &position_, "sphere"}}, epoch);
  }

  const Folder folder;
  std::vector<Vec3f> position_{2, Vec3f::Ones()};
  std::vector<double> radius_{1.0, 2.0};
};

TEST_F(SidecarTest, DescribesTheSpheres) {
  const fs::path path = folder / "a & b.h5";
  std::vector<double> radius{1.0, 2.0};
  std::vector<std::uint32_t> body{0, 0};
  std::vector<float> pressure{3.0f, 4.0f};
  std::vector<Vec3f> position(2, Vec3f::Ones());
  std::vector<Vec3> pose(1, Vec3::Ones());
  std::vector<Quat> turn(2, Quat::Identity());
  ResultFile file = ResultFile::create(path, {}, false);
  file.write_static("spheres", {{"radius", "m", "", &radius, "sphere"}, {"body", "", "", &body, "sphere"}});
  file.add_snapshot(0.1, "settle <1>",
                    {{"sphere_position", "m", "", &position, "sphere"},
                     {"pressure", "Pa", "", &pressure, "sphere"},
                     {"turn", "", "", &turn, "sphere"},
                     {"position", "m", "", &pose, "body"}});
  file.add_snapshot(0.2, "no spheres", {{"position", "m", "", &pose, "body"}});
  file.commit();
  const fs::path sidecar = Sidecar().write(ResultFile::open(path));
  EXPECT_EQ(sidecar, path.string() + ".xdmf");
  const std::string xml = slurp(sidecar);
  EXPECT_TRUE(well_formed(xml)) << xml;
  const auto holds = [&](const std::string& part) { return xml.find(part) != std::string::npos; };
  EXPECT_TRUE(holds("<Time Value=\"0.10000000000000001\"/>"));
  EXPECT_TRUE(holds("TopologyType=\"Polyvertex\" NumberOfElements=\"2\""));
  EXPECT_TRUE(
      holds("NumberType=\"Float\" Precision=\"4\" Dimensions=\"2 3\">a &amp; "
            "b.h5:/snapshots/000000/sphere_position<"));
  EXPECT_TRUE(holds("NumberType=\"Float\" Precision=\"8\" Dimensions=\"2\">a &amp; b.h5:/spheres/radius<"));
  EXPECT_TRUE(holds("NumberType=\"UInt\" Precision=\"4\" Dimensions=\"2\">a &amp; b.h5:/spheres/body<"));
  EXPECT_TRUE(holds("a &amp; b.h5:/snapshots/000000/pressure<"));
  EXPECT_FALSE(holds("turn"));
  EXPECT_FALSE(holds("000000/position"));
  EXPECT_FALSE(holds("snapshots/000001"));
}

TEST_F(SidecarTest, SnapshotsAtOneTimeAreAllSeen) {
  ResultFile file = ResultFile::create(folder / "run.h5", {}, false);
  const std::vector<double> taken{0, 0, 50, 50, 50, 50 * (1 + 1e-12), 100, 1e9, 1e9};
  for (const double time : taken) add(file, time);
  file.commit();
  const std::vector<double> shown = times(slurp(Sidecar().write(file)));
  ASSERT_EQ(shown.size(), taken.size());
  for (std::size_t k = 0; k < taken.size(); ++k) {
    EXPECT_NEAR(shown[k], taken[k], 1e-8 * std::max(1.0, taken[k])) << k;
    if (k > 0) {
      EXPECT_GT(shown[k], shown[k - 1] * (1 + 1e-10)) << k;
    }
  }
  for (const std::size_t k : {0, 2, 6, 7}) EXPECT_EQ(shown[k], taken[k]);
}

TEST_F(SidecarTest, GrowsWithTheFileAndIsTheSameAsOneMadeAnew) {
  const fs::path path = folder / "run.h5", sidecar = folder / "run.h5.xdmf";
  ResultFile file = ResultFile::create(path, {}, false);
  file.write_static("spheres", {{"radius", "m", "", &radius_, "sphere"}});
  Sidecar growing;
  int written = 0;
  std::string last;
  const auto commit = [&](double time, std::uint64_t epoch) {
    add(file, time, epoch);
    file.commit();
    growing.update(file);
    const std::string now = slurp(sidecar);
    EXPECT_GE(times(now).size(), file.snapshots().size() - file.snapshots().size() / 16);
    written += now != last;
    last = now;
  };
  for (int k = 0; k < 200; ++k) commit(k, 0);
  EXPECT_LT(written, 80);
  EXPECT_GT(written, 20);
  // A stage changes the bodies: the radii of the snapshots so far get another name.
  file.write_static("spheres_0", {{"radius", "m", "", &radius_, "sphere"}});
  file.write_static("spheres", {{"radius", "m", "", &radius_, "sphere"}});
  commit(199, 1);
  EXPECT_EQ(times(last).size(), 201u);
  EXPECT_NE(last.find("run.h5:/spheres_0/radius"), std::string::npos);
  EXPECT_EQ(last.find("run.h5:/spheres_0/radius", last.find("snapshots/000200")), std::string::npos);
  commit(300, 1);
  file.finish({}, "finished");
  growing.update(file);
  last = slurp(sidecar);
  EXPECT_EQ(times(last).size(), 202u);
  Sidecar().write(ResultFile::open(path));
  EXPECT_EQ(slurp(sidecar), last);
}

TEST_F(SidecarTest, ReplacesNothingButASidecar) {
  const fs::path path = folder / "run.h5", sidecar = folder / "run.h5.xdmf";
  folder.write("precious", "precious");
  ResultFile file = ResultFile::create(path, {}, false);
  file.commit();
  const auto refused = [&] {
    EXPECT_THROW(require_sidecar(path), InputError);
    EXPECT_THROW(Sidecar().write(file), InputError);
  };
  fs::create_symlink("precious", sidecar);
  refused();
  fs::remove(sidecar);
  ASSERT_EQ(mkfifo(sidecar.c_str(), 0600), 0);
  refused();
  fs::remove(sidecar);
  folder.write("run.h5.xdmf", "precious");
  refused();
  EXPECT_EQ(slurp(sidecar), "precious");
  EXPECT_EQ(slurp(folder / "precious"), "precious");
  fs::remove(sidecar);
  Sidecar().write(file);
  require_sidecar(path);
  Sidecar().write(file);
}

}  // namespace
}  // namespace cairn
