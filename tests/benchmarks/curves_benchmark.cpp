// Drawings: a million points along curves, and reading a drawing of a hundred thousand splines.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <iterator>
#include <numbers>
#include <string>

#include "host/file.hpp"
#include "host/model/read_dxf.hpp"
#include "host/model/read_svg.hpp"
#include "host/model/spline.hpp"
#include "host/points/divide.hpp"

namespace lamplock {
namespace {

/// Rings of Bezier curves, ellipses and squares on a page of 100 mm.
model::Curves drawing(int rings) {
  using std::numbers::pi;
  model::Curves curves;
  for (int i = 1; i <= rings; ++i) {
    const double r = 50.0 * i / rings;
    curves.paths.push_back({{model::Arc{{}, {r, 0, 0}, {0, r / 2, 0}, 0, 2 * pi}}, true});
    curves.paths.push_back({{model::bezier({{r, 0, 0}, {r, r, 0}, {-r, r, 0}, {-r, 0, 0}})}});
    curves.paths.push_back(
        {{model::Line{{r, r, 0}, {-r, r, 0}}, model::Line{{-r, r, 0}, {-r, -r, 0}}}});
  }
  return curves;
}

void divide(benchmark::State& state) {
  const model::Curves curves = drawing(340);
  std::size_t number = 0;
  for (auto _ : state) number = points::divide(curves, {.spacing_mm = 0.1}).size();
  state.counters["points"] = static_cast<double>(number);
}
BENCHMARK(divide)->Unit(benchmark::kMillisecond);

constexpr int splines = 100'000;

std::string dxf() {
  std::string text = "0\nSECTION\n2\nENTITIES\n";
  for (int i = 0; i < splines; ++i) {
    fmt::format_to(
        std::back_inserter(text),
        "0\nSPLINE\n8\ncut\n70\n8\n71\n3\n40\n0\n40\n0\n40\n0\n40\n0\n40\n1\n40\n1\n40\n1\n"
        "40\n1\n10\n{0}.25\n20\n0.5\n10\n{0}.5\n20\n1.5\n10\n{0}.75\n20\n2\n10\n{0}.9\n20\n3\n",
        i % 100);
  }
  return text + "0\nENDSEC\n0\nEOF\n";
}

std::string svg() {
  std::string text = "<svg width='100mm' height='100mm' viewBox='0 0 100 100'>";
  for (int i = 0; i < splines; ++i) {
    fmt::format_to(std::back_inserter(text), "<path d='M{0}.25 .5C{0}.5 1.5 {0}.75 2 {0}.9 3'/>\n",
                   i % 100);
  }
  return text + "</svg>";
}

void read_drawing(benchmark::State& state, const char* extension, const std::string& bytes,
                  model::Curves (*read)(const std::filesystem::path&)) {
  const auto path = std::filesystem::temp_directory_path() /
                    fmt::format("lamplock_benchmark_{}{}", ::getpid(), extension);
  write_file(path, bytes);
  for (auto _ : state) benchmark::DoNotOptimize(read(path));
  std::filesystem::remove(path);
  state.counters["MB"] = static_cast<double>(bytes.size()) / 1e6;
}
void read_dxf(benchmark::State& state) { read_drawing(state, ".dxf", dxf(), model::read_dxf); }
void read_svg(benchmark::State& state) { read_drawing(state, ".svg", svg(), model::read_svg); }
BENCHMARK(read_dxf)->Unit(benchmark::kMillisecond);
BENCHMARK(read_svg)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamplock
