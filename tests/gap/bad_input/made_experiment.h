#pragma once
// Small clean experiments of every kind, to be spoilt in one way each.

#include "base/error.h"
#include "base/random.h"
#include "gap/data/experiment.h"
#include "gap/reading/read_experiment.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

namespace puckloop::gap::tests {

/// A CSV file in the making: header and cells.
struct Made {
    std::string kind;
    std::vector<std::string> names;
    std::vector<std::vector<std::string>> rows;
    std::string toml;  ///< more lines for experiment.toml, before the runs
    int runs = 3;      ///< files with the same stimuli and other noise
};

inline std::size_t place_of(const Made& made, const std::string& name) {
    return static_cast<std::size_t>(std::find(made.names.begin(), made.names.end(), name) -
                                    made.names.begin());
}

/// Every cell of a column anew.
inline Made changed(Made made, const std::string& name,
                    const std::function<std::string(std::size_t, double)>& cell) {
    const std::size_t at = place_of(made, name);
    for (std::size_t i = 0; i < made.rows.size(); ++i)
        made.rows[i][at] = cell(i, std::stod(made.rows[i][at]));
    return made;
}

inline Made scaled(const Made& made, const std::string& name, double factor) {
    return changed(made, name,
                   [factor](std::size_t, double value) { return fmt::format("{:.9g}", value * factor); });
}

inline Made swapped(Made made, const std::string& a, const std::string& b) {
    std::swap(made.names[place_of(made, a)], made.names[place_of(made, b)]);
    return made;
}

inline Made clean(const std::string& kind) {
    Made made{kind, {}, {}, "", 3};
    RandomStream random(1, "gap/bad input/" + kind);
    const auto noise = [&](double sd) { return sd * random.normal(); };
    const auto row = [&](std::initializer_list<double> values) {
        made.rows.emplace_back();
        for (const double value : values)
            made.rows.back().push_back(fmt::format("{:.7g}", value));
    };
    if (kind == "proximity") {
        made.names = {"t_s", "sensor", "distance_m", "angle_rad", "reading"};
        for (int i = 0; i < 60; ++i) {
            const double mm = 10 + 2 * ((i * 7) % 20);
            row({i * 0.1, i % 4 * 1.0, mm / 1000, 0.05 * (i * 5 % 9),
                 std::round(4.17e5 / (mm * mm) + noise(4))});
        }
    } else if (kind == "motion") {
        made.names = {"t_s", "cmd_left", "cmd_right", "steps_left", "steps_right", "x_m", "y_m", "theta_rad"};
        const double metre = 2 * std::numbers::pi * 0.0205 / 1000;
        double x = 0, y = 0, theta = 0, left = 0, right = 0;
        for (int i = 0; i < 80; ++i) {
            const bool straight = i % 40 < 20;
            const double cl = straight ? 300 : 200, cr = straight ? 300 : 400;
            row({i * 0.1, cl, cr, left, right, x + noise(2e-4), y + noise(2e-4), theta + noise(1e-3)});
            left += cl / 10, right += cr / 10;
            const double way = (cl + cr) / 20 * metre, turn = (cr - cl) / 10 * metre / 0.053;
            x += way * std::cos(theta + turn / 2), y += way * std::sin(theta + turn / 2), theta += turn;
        }
    } else if (kind == "ground") {
        made.names = {"t_s", "sensor", "grey", "reading"};
        for (int i = 0; i < 60; ++i)
            row({i * 0.1, i % 3 * 1.0, i % 5 / 4.0, std::round(331 + 155 * (i % 5) + noise(5))});
    } else if (kind == "accelerometer") {
        made.names = {"t_s", "ax", "ay", "az", "pitch_rad"};
        for (int i = 0; i < 80; ++i)
            row({i * 0.01, std::round(2048 + noise(5)),
                 std::round(2048 - 800 * std::sin(0.01 * (i % 20)) + noise(5)), std::round(2848 + noise(5)),
                 0.01 * (i % 20)});
    } else if (kind == "rab") {
        made.names = {"t_s", "distance_m", "true_bearing_rad", "received", "strength", "bearing_rad"};
        for (int i = 0; i < 80; ++i)
            row({i * 0.02, 0.1 + 0.1 * (i % 5), 0.524, 1, std::round(1200 - 60 * (i % 5) + noise(60)),
                 0.524 + noise(0.05)});
    } else if (kind == "microphone") {
        made.names = {"t_s", "mic", "distance_m", "level"};
        for (int i = 0; i < 60; ++i)
            row({i * 0.1, i % 3 * 1.0, 0.1 + 0.1 * (i % 4), std::round(310.0 / (1 + i % 4) + noise(5))});
    } else {
        made.names = {"seq", "t_robot_s", "t_host_s"};
        for (int i = 0; i < 80; ++i)
            row({i * 1.0, 1 + 0.1 * i, 1.004 + 0.1 * i + noise(5e-4)});
    }
    return made;
}

inline void write_file(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

/// A folder that goes with the object.
class Folder {
  public:
    Folder() : path_(puckloop::tests::scratch_path("gap_bad_input")) {
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    explicit Folder(const Made& made) : Folder() {
        std::string toml = fmt::format("kind = \"{}\"\n{}", made.kind, made.toml);
        RandomStream random(2, "gap/bad input/runs");
        for (int r = 0; r < made.runs; ++r) {
            toml += fmt::format("[[run]]\nfile = \"run{}.csv\"\n", r);
            std::string csv = fmt::format("{}\n", fmt::join(made.names, ","));
            for (auto cells : made.rows) {
                // Another run has other noise in its last column, or it would be a copy.
                try {
                    if (r > 0)
                        cells.back() =
                            fmt::format("{:.9g}", std::stod(cells.back()) * (1 + 1e-3 * random.normal()));
                } catch (const std::exception&) {
                }
                csv += fmt::format("{}\n", fmt::join(cells, ","));
            }
            write_file(path_ / fmt::format("run{}.csv", r), csv);
        }
        write_file(path_ / "experiment.toml", toml);
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

/// "" if it can be read, else the one line that is said; `cautions` receives the rest.
inline std::string refusal(const std::filesystem::path& folder, std::string* cautions = nullptr) {
    try {
        const Experiment experiment = read_experiment(folder);
        if (cautions != nullptr)
            for (const std::string& caution : experiment.cautions)
                *cautions += caution + "\n";
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

inline std::string refusal(const Made& made, std::string* cautions = nullptr) {
    const Folder folder(made);
    return refusal(folder.path(), cautions);
}

/// What an experiment that is not refused is warned of.
inline std::string cautions_of(const Made& made) {
    std::string cautions;
    CHECK(refusal(made, &cautions) == "");
    return cautions;
}

}  // namespace puckloop::gap::tests
