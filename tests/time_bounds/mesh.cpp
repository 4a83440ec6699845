// Scenarios of TAMs, their radio modules and a coordinator's.

#include "tests/end_to_end/kit/api_frame.h"
#include "tests/time_bounds/scenarios.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

namespace puckloop::tests {

namespace {

using Bytes = std::vector<int>;

Bytes target(Draw& draw) {
    Bytes address{0x00, 0x13, 0xA2, 0x00, 0x40, 0x00, 0x00, 1 + static_cast<int>(draw.below(3))};
    if (draw.one_in(2)) address = {0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
    address.insert(address.end(), {0xFF, 0xFE});
    return address;
}

/// An AT command with its value; what restarts a module or moves it to another network is frequent.
Bytes command(Draw& draw) {
    switch (draw.below(12)) {
    case 0:
    case 1:
        return {'F', 'R'};
    case 2:
        return {'R', 'E'};
    case 3:
        return {'W', 'R'};
    case 4:
        return {'C', 'H', 12 + static_cast<int>(draw.below(2))};
    case 5:
        return {'I', 'D', 0x01, 0xB4 + static_cast<int>(draw.below(2))};
    case 6:
        return {'S', 'M', static_cast<int>(draw.of(std::array{0, 4, 5}))};
    case 7:
        return {'S', 'T', 0x00, 0x01 + static_cast<int>(draw.below(200))};
    case 8:
        return {'M', 'T', static_cast<int>(draw.below(4))};
    case 9:
        return {'N', 'D'};
    case 10:
        return {'B', 'D', 2 + static_cast<int>(draw.below(6))};
    default:
        return {'A', 'C'};
    }
}

Bytes request(Draw& draw) {
    Bytes data;
    const auto add = [&](const Bytes& more) { data.insert(data.end(), more.begin(), more.end()); };
    const int id = static_cast<int>(draw.below(3));
    switch (draw.below(4)) {
    case 0:
        data = {0x08, id};
        add(command(draw));
        break;
    case 1:
        data = {0x17, id};
        add(target(draw));
        data.push_back(2);
        add(command(draw));
        break;
    default:
        data = {0x10, id};
        add(target(draw));
        add({0, 0});
        add(Bytes(1 + draw.below(60), 0x0A));
    }
    return data;
}

}  // namespace

std::string drawn_requests(Draw& draw, double end) {
    std::vector<double> times;
    for (std::uint64_t i = 20 + draw.below(60); i > 0; --i)
        times.push_back(draw.uniform(0.1, end));
    std::ranges::sort(times);
    std::string text;
    for (const double time : times)
        text += fmt::format("{:.6f} {}\n", time, api_frame(request(draw)));
    return text;
}

std::string drawn_tam(Draw& draw, int number, double end) {
    std::string text =
        fmt::format("[[tam]]\nname = \"t{}\"\nposition = [\"{} cm\", \"40 cm\"]\nheading = \"-90 deg\"\n"
                    "firmware = \"own\"\n",
                    number, -60 + 40 * number);
    if (draw.one_in(2)) text += fmt::format("start = {}\n", draw.time(0, 0.5));
    text += "reset = [";
    std::vector<double> resets(draw.below(5));
    for (double& at : resets)
        at = draw.uniform(0.5 + 0.1 * end, end);  // after its start
    std::sort(resets.begin(), resets.end());
    for (const double at : resets)
        text += fmt::format("\"{:.9f} s\", ", at);
    return text +
           fmt::format("]\n[tam.xbee]\nboot = \"{:.3f} s\"\nparameters = {{ RR = {}, MT = {}, MR = {} }}\n",
                       draw.of(std::array{0.005, 0.05, 0.2}), draw.below(4), draw.below(4), draw.below(2));
}

DrawnScenario draw_mesh(Draw& draw) {
    DrawnScenario drawn;
    drawn.seconds = 6;
    drawn.toml = drawn_head(draw, 4, 3);
    for (int i = 0; i < 2 + static_cast<int>(draw.below(2)); ++i)
        drawn.toml += drawn_tam(draw, i, drawn.seconds);
    drawn.toml +=
        fmt::format("[radio]\nprocessing = \"{:.4f} s\"\nloss = {:.2f}\n",
                    draw.of(std::array{0.0002, 0.001, 0.005}), draw.one_in(2) ? draw.uniform(0, 0.3) : 0.0);
    drawn.toml += "[coordinator]\n";
    if (draw.one_in(2)) {
        drawn.toml += fmt::format("program = [\"puckloop-coordinator\", \"--experiment\", \"random-task\"]\n"
                                  "start = {}\n",
                                  draw.time(0, 0.5));
    } else {
        drawn.script = drawn_requests(draw, drawn.seconds);
        drawn.toml += fmt::format("uart = \"script:{}\"\n", kScript);
    }
    return drawn;
}

}  // namespace puckloop::tests
