// An experiment's own columns become the covariates of its residuals.

#include "base/random.h"
#include "gap/residuals/residual_structure.h"
#include "gap/validate/placements.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

Experiment motion_of(int runs, int rows) {
    Experiment e;
    e.kind = Kind::Motion;
    for (int r = 0; r < runs; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.conditions["sense"] = r % 2 == 0 ? "left" : "right";
        run.conditions["place"] = std::to_string(r);
        run.rows = static_cast<std::size_t>(rows);
        for (int i = 0; i < rows; ++i) {
            run.columns["t_s"].push_back(0.1 * i);
            run.columns["steps_left"].push_back(i < rows / 2 ? 30.0 * i : 30.0 * (rows - i));
            run.columns["steps_right"].push_back(i < rows / 2 ? 30.0 * i : 30.0 * (rows - i));
            run.columns["session"].push_back(r / 2 + 1);
        }
        e.runs.push_back(run);
    }
    return e;
}

Series residuals_of(const Experiment& e, double by_speed) {
    RandomStream random(3, "structure");
    Series s;
    s.observable = "x_m";
    s.unit = "m";
    for (std::size_t r = 0; r < e.runs.size(); ++r)
        for (std::size_t i = 0; i < e.runs[r].rows; ++i) {
            s.run.push_back(static_cast<std::uint32_t>(r));
            s.row.push_back(static_cast<std::uint32_t>(i));
            const double speed = i < e.runs[r].rows / 2 ? 1 : -1;
            s.measured.push_back(10 + random.normal() + by_speed * speed);
            s.before.push_back(10);
            s.after.push_back(10 + by_speed * speed);
        }
    return s;
}

bool found(const std::vector<stats::Finding>& table, const std::string& covariate) {
    for (const auto& f : table)
        if (f.covariate.find(covariate) != std::string::npos && f.p_adjusted < 0.01) return true;
    return false;
}

}  // namespace

TEST_CASE("covariates: derived speed, sessions, conditions that group runs") {
    const Experiment e = motion_of(6, 60);
    const auto list = covariates_of(e, residuals_of(e, 0));
    std::string names;
    for (const auto& c : list)
        names += c.name + ";";
    CHECK(names.find("wheel speed;") != std::string::npos);
    CHECK(names.find("session;") != std::string::npos);
    CHECK(names.find("sense;") != std::string::npos);
    CHECK(names.find("place;") == std::string::npos);  // a name of its own for each run
    CHECK(names.find("steps") == std::string::npos);
}

TEST_CASE("structure against the sign of the speed is there before and gone after") {
    const Experiment e = motion_of(6, 60);
    const Series s = residuals_of(e, 1.5);
    const stats::TestOptions options{.seed = 2, .permutations = 299};
    CHECK(found(residual_structure(e, s, Stage::Before, options), "wheel speed"));
    const auto after = residual_structure(e, s, Stage::After, options);
    for (const auto& f : after)
        CHECK(f.p_adjusted > 0.01);
}

TEST_CASE("offsets that belong to the placement are told apart from the scatter of repeats") {
    const auto caution = [](double offset) {
        RandomStream random(5, "placement");
        Experiment e;
        e.kind = Kind::Proximity;
        Series s;
        s.observable = "reading";
        s.unit = "counts";
        for (int r = 0; r < 3; ++r) {
            Run run;
            run.rows = 200;
            for (int d = 0; d < 10; ++d) {
                const double placed = offset * random.normal();
                for (int i = 0; i < 20; ++i) {
                    run.columns["distance_m"].push_back(0.01 * d);
                    s.run.push_back(static_cast<std::uint32_t>(r));
                    s.row.push_back(static_cast<std::uint32_t>(20 * d + i));
                    s.measured.push_back(placed + random.normal());
                    s.after.push_back(0);
                }
            }
            e.runs.push_back(run);
        }
        return placement_caution(e, s);
    };
    CHECK(caution(0.0).empty());
    CHECK(caution(3.0).find("30 placements") != std::string::npos);
}
