#pragma once
// An experiment and a verdict as the analysis would give them, for the tests of the report.

#include "base/random.h"
#include "gap/data/experiment.h"
#include "gap/verdict/verdict.h"

#include <cmath>

namespace puckloop::gap::tests {

inline Experiment made_experiment() {
    Experiment e;
    e.kind = Kind::Proximity;
    e.title = "white wall, near & far";
    e.robot = "e-puck 7";
    e.description = "six sweeps over <distance>";
    for (int r = 0; r < 6; ++r) {
        Run run;
        run.name = "sweep" + std::to_string(r + 1);
        run.rows = 160;
        for (int i = 0; i < 160; ++i) {
            run.columns["distance_m"].push_back(0.005 + 0.0005 * (i / 2));
            run.columns["sensor"].push_back(i % 2);
            run.columns["t_s"].push_back(0.1 * i);
        }
        e.runs.push_back(run);
    }
    return e;
}

inline Series made_series(const Experiment& e) {
    RandomStream random(11, "report");
    Series s;
    s.observable = "reading";
    s.unit = "counts";
    for (std::size_t r = 0; r < e.runs.size(); ++r)
        for (std::size_t i = 0; i < e.runs[r].rows; ++i) {
            const double d = 1000 * e.runs[r].column("distance_m")[i];
            const double before = 4.17e5 / std::pow(d + 9.9, 2);
            const double after = before * (i % 2 == 0 ? 0.8 : 1.1);
            s.run.push_back(static_cast<std::uint32_t>(r));
            s.row.push_back(static_cast<std::uint32_t>(i));
            s.before.push_back(before);
            s.after.push_back(after);
            s.measured.push_back(std::round(after + 12 * random.normal()));
            s.scale.push_back(12);
        }
    return s;
}

inline Verdict made_verdict(const Experiment& e) {
    Verdict v;
    v.decision = Decision::Named;
    v.summary =
        "The sensors' gains differ from the simulator's: sensor 0 reads 20 % low, sensor 1 10 % high.";
    Cause cause;
    cause.name = "gain_spread";
    cause.number = 18;
    cause.title = "gains differ from sensor to sensor";
    cause.evidence = 1234.5;
    cause.parameters = {{"proximity.gain0", "1", 0.8, 0.79, 0.81, 1.0, true},
                        {"proximity.gain1", "1", 1.1, 1.09, 1.11, 1.0, true}};
    cause.sentence = "Gain of sensor 0: 0.80 (0.79 to 0.81).";
    v.causes = {cause};
    Cause rival = cause;
    rival.name = "reflectivity";
    rival.number = 26;
    rival.title = "the surface reflects otherwise";
    v.rivals = {{rival, "gain_spread", 40.0, "a second object at one distance"}};
    v.heldout = {4.1,
                 1.02,
                 0.25,
                 0.22,
                 0.28,
                 -3.2,
                 -1.4,
                 1.6,
                 2.0,
                 6,
                 6,
                 true,
                 "On runs that were not fitted the error falls to a quarter."};
    v.observables = {{"reading", "counts", 160.0, 12.1, 0.076, 0.07, 0.08}};
    v.suggestions = {
        {"measure a second surface at 2 cm with all sensors", 0.8, {"gain_spread", "reflectivity"}}};
    v.tried = {{"gain_spread", 18, 1234.5, 610.0, 0.0001, "chosen first"},
               {"offset", 19, -3.2, -0.4, 0.6, ""}};
    v.cautions = {"six runs, all of one morning"};
    v.series = {made_series(e)};
    return v;
}

}  // namespace puckloop::gap::tests
