#include "physics/report.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "physics/svg.h"

namespace cairn::report {

namespace {

/// What one suite has to show.
struct Section {
  std::string name, rows, rest;
};

/// Keeps the sections in the order of the tests; each entry is written at once, so that a run cut off leaves
/// what it has shown.
class Book {
 public:
  static Book& book() {
    static Book only;
    return only;
  }

  Section& section() {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->test_suite_name();
    for (Section& s : sections_)
      if (s.name == name) return s;
    return sections_.emplace_back(Section{name, "", ""});
  }

  const char* folder() const { return std::getenv("CAIRN_REPORT"); }

  void write() const {
    if (!folder()) return;
    std::ofstream out(std::filesystem::path(folder()) / "tables.md");
    for (const Section& s : sections_) {
      out << "\n## " << s.name << "\n";
      if (!s.rows.empty())
        out << "\n| what | against | expected | measured | error | tolerance |\n|---|---|---|---|---|---|\n"
            << s.rows;
      out << s.rest;
    }
  }

 private:
  std::vector<Section> sections_;
};

/// Text for a cell of a table: a bar would end the cell.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? "\\|" : std::string(1, c);
  return out;
}

void row(const std::string& claim, const std::string& against, const std::string& expected,
         const std::string& measured, const std::string& difference, const std::string& tolerance) {
  Book::book().section().rows += fmt::format("| {} | {} | {} | {} | {} | {} |\n", cell(claim), cell(against),
                                             expected, measured, difference, tolerance);
  Book::book().write();
}

}  // namespace

void near(const std::string& claim, const std::string& against, double measured, double expected,
          double tolerance) {
  EXPECT_NEAR(measured, expected, tolerance) << claim;
  row(claim, against, fmt::format("{:.6g}", expected), fmt::format("{:.6g}", measured),
      fmt::format("{:.1e}", std::abs(measured - expected)), fmt::format("{:.1e}", tolerance));
}

void close(const std::string& claim, const std::string& against, double measured, double expected,
           double relative) {
  EXPECT_NEAR(measured, expected, relative * std::abs(expected)) << claim;
  row(claim, against, fmt::format("{:.6g}", expected), fmt::format("{:.6g}", measured),
      fmt::format("{:.1e} rel.", std::abs(measured / expected - 1.0)), fmt::format("{:.1e} rel.", relative));
}

void error(const std::string& claim, const std::string& against, double measured, double tolerance) {
  EXPECT_GE(measured, 0.0) << claim;
  EXPECT_LE(measured, tolerance) << claim;
  row(claim, against, "0", fmt::format("{:.1e}", measured), fmt::format("{:.1e}", measured),
      fmt::format("{:.1e}", tolerance));
}

void within(const std::string& claim, const std::string& against, double measured, double low, double high) {
  EXPECT_GE(measured, low) << claim;
  EXPECT_LE(measured, high) << claim;
  row(claim, against, fmt::format("{:.6g} to {:.6g}", low, high), fmt::format("{:.6g}", measured), "", "");
}

void note(const std::string& text) {
  Book::book().section().rest += "\n" + text + "\n";
  Book::book().write();
}

void plot(const std::string& name, const std::string& caption, const Axes& axes,
          const std::vector<Curve>& curves) {
  Book& book = Book::book();
  if (!book.folder()) return;
  std::ofstream(std::filesystem::path(book.folder()) / (name + ".svg")) << svg(axes, curves);
  book.section().rest += fmt::format("\n![{0}](validation/{1}.svg)\n\n*{0}*\n", caption, name);
  book.write();
}

}  // namespace cairn::report
