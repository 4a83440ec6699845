// A run that had a part in fitting is not held out: whatever was measured in held-out runs, nothing that the
// others teach changes, and neither does what is predicted for them. For every kind.

#include "base/random.h"
#include "gap/diagnostics/heldout.h"
#include "gap/extension/learn.h"
#include "gap/extension/subjects.h"
#include "gap/fit/intervals.h"
#include "gap/fit/study.h"
#include "gap/kinds/columns.h"
#include "gap/reading/read_experiment.h"
#include "selftest/benches/benches.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

using namespace puckloop;
using namespace puckloop::gap;
using namespace puckloop::gap::selftest;

namespace {

constexpr std::uint64_t kSeed = 20;
constexpr std::size_t kHeld = 0;  // fold

Experiment written_and_read(const WrittenExperiment& experiment) {
    const auto folder = puckloop::tests::scratch_path("gap_held_out");
    std::filesystem::remove_all(folder);
    write_folder(experiment, folder);
    Experiment read = read_experiment(folder);
    std::filesystem::remove_all(folder);
    return read;
}

/// Distances by the sensor that is described as an example.
WrittenExperiment described() {
    WrittenExperiment experiment;
    experiment.kind = "ir_distance";
    experiment.kind_file = std::string(PUCKLOOP_SOURCE) + "/scenarios/kinds/ir_distance.toml";
    RandomStream random(kSeed, "test/distances");
    for (int r = 0; r < 6; ++r) {
        WrittenRun run;
        for (int i = 0; i < 60; ++i) {
            const double distance = 0.1 + 0.5 * random.uniform();
            run.column("t_s", "s").values.push_back(0.1 * i);
            run.column("sensor").values.push_back(i % 2);
            run.column("distance_m", "m").values.push_back(distance);
            run.column("temperature_c", "degC").values.push_back(20 + i / 10);
            run.column("reading", "counts")
                .values.push_back(std::round(60 / (distance + 0.02) + 3 * random.normal()));
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

std::vector<Experiment> one_of_each_kind() {
    std::vector<Experiment> all;
    for (const auto& bench : benches()) {
        WrittenExperiment experiment = bench->exact(kSeed);
        bench->measure(experiment, {}, kSeed);
        all.push_back(written_and_read(experiment));
    }
    all.push_back(written_and_read(described()));
    return all;
}

std::vector<char> held_runs(const Study& study) {
    std::vector<char> held(study.experiment().runs.size(), 0);
    for (std::size_t o = 0; o < study.fold_of().size(); ++o)
        for (std::size_t i = 0; i < study.fold_of()[o].size(); ++i)
            if (study.fold_of()[o][i] == static_cast<int>(kHeld))
                held[study.model().observables()[o].run[i]] = 1;
    return held;
}

/// By how much a measured value is changed: about its noise, by whole steps of its instrument; 0: an event.
double changed_by(const std::string& column) {
    if (column == "x_m" || column == "y_m") return 1e-3;
    if (column == "bearing_rad") return 0.07;
    if (column == "strength") return 100;
    if (column == "t_host_s") return 5e-4;
    if (column == "reading" || column == "level" || column.starts_with("a")) return 6;
    return 0;
}

/// Other measured values in these runs; what was set up stays.
Experiment measured_otherwise(Experiment experiment, const std::vector<char>& runs) {
    const bool drives = experiment.kind == Kind::Motion;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        if (runs[r] == 0) continue;
        for (const ColumnInfo& column : columns_of(experiment.kind)) {
            const auto found = experiment.runs[r].columns.find(column.name);
            if (found == experiment.runs[r].columns.end()) continue;
            const bool place = drives && (found->first == "x_m" || found->first == "y_m");
            if (column.role != Role::Observable && !place) continue;
            auto& values = found->second;
            const double by = changed_by(found->first);
            if (by == 0)
                std::ranges::reverse(values);
            else  // off, and in turns
                for (std::size_t i = 0; i < values.size(); ++i)
                    values[i] += i % 3 == 0 ? by : i % 3 == 1 ? -by : 2 * by;
        }
    }
    return experiment;
}

/// The first effect that these data can show.
std::size_t some_effect(const Study& study) {
    std::size_t one = 0;
    while (!study.candidates()[one].remark.empty())
        ++one;
    return one;
}

bool same(const NoiseParameters& a, const NoiseParameters& b) {
    return a.log_sd == b.log_sd && a.carry == b.carry && a.log_tail == b.log_tail && a.memory == b.memory;
}

}  // namespace

TEST_CASE("what is measured in held-out runs changes nothing that is fitted to the others") {
    for (const Experiment& experiment : one_of_each_kind()) {
        INFO(kind_name(experiment.kind));
        const Study study(experiment, kSeed);
        const Experiment changed = measured_otherwise(experiment, held_runs(study));
        const Study other(changed, kSeed);
        REQUIRE(study.fold_of() == other.fold_of());
        const std::size_t effect = some_effect(study);
        const Fit fit = study.fit_set({effect}, study.fit_none().fitted.state);
        for (const Effort& effort : {kPart, kHeldOut}) {
            const State own = study.without_fold(kHeld, fit, effort).state,
                        others = other.without_fold(kHeld, fit, effort).state;
            CHECK(own.values == others.values);
            for (std::size_t o = 0; o < own.noise.size(); ++o)
                CHECK(same(own.noise[o], others.noise[o]));
        }
        // Where the fit to all rows ended, which held-out runs do move, is a start and no more: what comes of
        // it is the same within what the rows leave open (a scale and a drift give way to each other).
        const Fit again = other.fit_set({effect}, other.fit_none().fitted.state);
        const State learnt = study.without_fold(kHeld, fit, kHeldOut).state,
                    learnt_again = other.without_fold(kHeld, again, kHeldOut).state;
        const Precision precision = precision_of(study, fit);
        for (std::size_t j = 0; j < fit.freed.size(); ++j) {
            const auto index = fit.freed[j].index;
            INFO(study.model().parameters()[index].name << " +- " << precision.sd[j]);
            CHECK(std::abs(learnt.values[index] - learnt_again.values[index]) < 2 * precision.sd[j]);
        }
        for (std::size_t o = 0; o < learnt.noise.size(); ++o) {
            const Observable& observable = study.model().observables()[o];
            if (noise_parameters(observable) == 0) continue;
            INFO(observable.name);
            CHECK(learnt.noise[o].log_sd == Approx(learnt_again.noise[o].log_sd).margin(0.05));
            if (observable.noise == NoiseKind::Carry)
                CHECK(learnt.noise[o].carry == Approx(learnt_again.noise[o].carry).margin(0.05));
        }
    }
}

TEST_CASE("reported figures of held-out runs do not go by where the fit to all runs ended") {
    for (const Experiment& experiment : one_of_each_kind()) {
        INFO(kind_name(experiment.kind));
        const Study study(experiment, kSeed);
        const Experiment changed = measured_otherwise(experiment, held_runs(study));
        const Study other(changed, kSeed);
        const auto figures_from = [&](const Study& begun) {
            Selection selection;
            selection.none = begun.fit_none();
            selection.chosen = begun.fit_set({some_effect(study)}, selection.none.fitted.state);
            return held_figures(study, selection, kSeed).all;
        };
        const Held own = figures_from(study), others = figures_from(other);
        CHECK(own.score_before == Approx(others.score_before).margin(0.02));
        CHECK(own.score_after == Approx(others.score_after).margin(0.02));
    }
}

TEST_CASE("what is measured in held-out runs changes no term that the others teach") {
    for (const Experiment& experiment : one_of_each_kind()) {
        INFO(kind_name(experiment.kind));
        const Study study(experiment, kSeed);
        const Experiment changed = measured_otherwise(experiment, held_runs(study));
        const Study other(changed, kSeed);
        const auto subjects_in = [](const Study& of) {
            const auto values = of.model().neutral();
            return subjects_of(of.experiment(), of.model(), values, of.model().predicted(values));
        };
        const auto subjects = subjects_in(study), others = subjects_in(other);
        REQUIRE(subjects.size() == others.size());
        CHECK(std::ranges::any_of(subjects, [&](const Subject& one) {
            return one.error != others[static_cast<std::size_t>(&one - subjects.data())].error;
        }));
        for (std::size_t s = 0; s < subjects.size(); ++s) {
            INFO(subjects[s].quantity << " " << subjects[s].observable);
            std::vector<char> used;
            for (const int fold : study.fold_of()[subjects[s].observable])
                used.push_back(fold != static_cast<int>(kHeld) ? 1 : 0);
            const Learnt own = learnt_from(subjects[s], used), again = learnt_from(others[s], used);
            CHECK(own.law.number == again.law.number);
            CHECK(own.law.sd == again.law.sd);
            CHECK(own.evidence == again.evidence);
            REQUIRE(own.parts.size() == again.parts.size());
            for (std::size_t p = 0; p < own.parts.size(); ++p) {
                CHECK(own.parts[p].basis.places() == again.parts[p].basis.places());
                CHECK(own.parts[p].value == again.parts[p].value);
            }
            CHECK(own.in_rows(subjects[s]) == again.in_rows(others[s]));
        }
    }
}
