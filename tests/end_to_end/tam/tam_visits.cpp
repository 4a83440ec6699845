#include "tests/end_to_end/tam/tam_visits.h"

#include <cmath>
#include <regex>

namespace puckloop::tests {

namespace {

constexpr double kWithin = 0.03;                  // m
constexpr double kBoothX = 0.30, kBoothY = 0.30;  // of scenarios/tam.toml, the other one mirrored

}  // namespace

std::vector<RobotVisits> visits_of(const Workbench& bench, const std::string& run, int robots) {
    std::vector<RobotVisits> visits(static_cast<std::size_t>(robots));
    std::map<std::string, std::size_t> index;
    for (std::size_t i = 0; i < visits.size(); ++i) {
        const std::string name = "robot" + std::to_string(i);
        index[name] = i;
        const std::string log = text_of(bench.out(run) / (name + ".linux.log"));
        const std::regex line("infra-red word 0x([0-9a-f]{2}) from");
        for (std::sregex_iterator match(log.begin(), log.end(), line), end; match != end; ++match)
            visits[i].heard.insert(std::stoi((*match)[1], nullptr, 16));
    }
    std::vector<bool> inside(visits.size());
    for (const Row& row : bench.csv(run, "trajectory.csv")) {
        const std::size_t i = index.at(row.at("robot"));
        const bool in = std::abs(std::abs(std::stod(row.at("x_m"))) - kBoothX) < kWithin &&
                        std::abs(std::stod(row.at("y_m")) - kBoothY) < kWithin;
        if (in && !inside[i]) visits[i].entered.push_back(std::stod(row.at("t_s")));
        if (!in && inside[i]) visits[i].left = true;
        inside[i] = in;
    }
    return visits;
}

std::map<std::string, std::vector<std::string>> values_of(const Workbench& bench, const std::string& run,
                                                          const std::string& event) {
    std::map<std::string, std::vector<std::string>> values;
    for (const Row& row : bench.csv(run, "coordinator/tam_events.csv"))
        if (row.at("event") == event) values[row.at("tam")].push_back(row.at("value"));
    return values;
}

}  // namespace puckloop::tests
