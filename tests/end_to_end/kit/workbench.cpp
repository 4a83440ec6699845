#include "tests/end_to_end/kit/workbench.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace puckloop::tests {

namespace {

// Of scenarios/hello.toml and own_binaries.toml; the body's radius is the physical model's.
constexpr double kHalfLength = 0.60, kHalfWidth = 0.45, kBodyRadius = 0.035;

// What scenarios/hello.toml is about, in a form that tests may rely on line by line.
const std::string kScenario = R"([run]
duration = "60 s"

[arena]
size = ["1.2 m", "90 cm"]

[[box]]
centre = ["30 cm", "15 cm"]
size = ["15 cm", "10 cm", "10 cm"]
heading = "20 deg"

[[robot]]
name = "robot0"
position = ["-10 cm", "0 cm"]
heading = "30 deg"

[robot.pic]
firmware = ")" PUCKLOOP_SOURCE R"(/firmware/epuck/epuck.hex"

[robot.linux]
program = ["puckloop-control", "--behaviour", "wander", "--duration", "55"]
start = "1 s"
)";

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');)
        cells.push_back(cell);
    return cells;
}

}  // namespace

Workbench::Workbench() {
    std::string name = (std::filesystem::temp_directory_path() / "puckloop_e2e_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no folder for the test");
    folder_ = name;
}

Workbench::~Workbench() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

std::filesystem::path Workbench::file(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
}

std::filesystem::path Workbench::hello(const std::string& more) const {
    return file("hello.toml", kScenario + more);
}

std::unique_ptr<Process> Workbench::start(const Words& words, const std::string& input) const {
    Words all{PUCKLOOP_PROGRAM};
    all.insert(all.end(), words.begin(), words.end());
    return std::make_unique<Process>(all, folder_, input);
}

Ended Workbench::puckloop(const Words& words, const std::string& input) const {
    return start(words, input)->wait();
}

Ended Workbench::run(const std::string& name, Words words) const {
    words.insert(words.begin(), {"run", "--out", out(name)});
    return puckloop(words);
}

nlohmann::json Workbench::report(const std::string& name) const {
    return nlohmann::json::parse(text_of(out(name) / "report.json"));
}

std::vector<Row> Workbench::csv(const std::string& name, const std::string& file) const {
    std::istringstream in(text_of(out(name) / file));
    std::string line;
    std::getline(in, line);
    const std::vector<std::string> columns = cells_of(line);
    std::vector<Row> rows;
    while (std::getline(in, line)) {
        const std::vector<std::string> cells = cells_of(line);
        Row row;
        for (std::size_t i = 0; i < columns.size(); ++i)
            row[columns[i]] = i < cells.size() ? cells[i] : "";
        rows.push_back(std::move(row));
    }
    return rows;
}

std::optional<std::filesystem::path> outside(const char* variable, const std::string& name) {
    const char* folder = std::getenv(variable);
    if (!folder) return std::nullopt;
    const auto path = std::filesystem::path(folder) / name;
    if (!std::filesystem::exists(path)) return std::nullopt;
    return path;
}

Journey journey(const std::vector<Row>& trajectory, double from_s) {
    Journey result;
    std::optional<double> last_x, last_y;
    for (const Row& row : trajectory) {
        result.last_s = std::stod(row.at("t_s"));
        const double x = std::stod(row.at("x_m")), y = std::stod(row.at("y_m"));
        const double wall = std::min(kHalfLength - std::abs(x), kHalfWidth - std::abs(y));
        result.clearance = std::min(result.clearance, wall - kBodyRadius);
        if (result.last_s < from_s) continue;
        if (last_x) result.length += std::hypot(x - *last_x, y - *last_y);
        last_x = x;
        last_y = y;
    }
    return result;
}

std::vector<int> bytes_sent(const std::vector<Row>& trace, const std::string& link, const std::string& from) {
    std::vector<int> bytes;
    for (const Row& row : trace)
        if (row.at("link") == link && row.at("from") == from && row.at("kind") == "uart")
            bytes.push_back(std::stoi(row.at("value"), nullptr, 16));
    return bytes;
}

}  // namespace puckloop::tests
